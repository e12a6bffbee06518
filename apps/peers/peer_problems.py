"""Problems of the comparison, with exact tips: cantilevers of a square section, straight or circular, with a dead load at the tip;
no Poisson effect, shear factor 1, GJ = EI."""

from math import cos, dist, hypot, pi, sin
from typing import NamedTuple


class Problem(NamedTuple):
    E: float
    side: float
    EA: float
    GA: float
    EI: float  # GJ too
    length: float = 1.0
    radius: float = 0.0  # 0: straight, along x
    force: tuple = (0.0, 0.0, 0.0)
    moment: tuple = (0.0, 0.0, 0.0)
    truth: tuple = ()  # displacement of the tip; empty: unknown

    def place(self, s):
        """Returns a point of the centerline and its tangent."""
        if not self.radius:
            return (s, 0.0, 0.0), (1.0, 0.0, 0.0)
        angle = s / self.radius
        return (self.radius * sin(angle), self.radius * (cos(angle) - 1), 0.0), (cos(angle), -sin(angle), 0.0)

    def error(self, tip):
        return dist(tip, self.truth) / hypot(*self.truth) if self.truth else 0.0


def problem(E, side, **more):
    return Problem(E, side, E * side**2, E / 2 * side**2, E * side**4 / 12, **more)


def roll_up(slenderness):
    """Makes a rod wound to two full circles, closed form: the tip returns to the clamp."""
    return problem(12 * slenderness**4, 1 / slenderness, moment=(0, 0, 4 * pi), truth=(-1, 0, 0))


def arc(slenderness, truth):
    """Makes an eighth of a circle, loaded across its plane; truth by shooting on the rod equations, Runge-Kutta 7(8)."""
    radius, side = 100.0, 100.0 / slenderness
    return problem(1e7, side, length=radius * pi / 4, radius=radius, force=(0, 0, 600 * side**4), truth=truth)


def elastica(force, back=0.0, down=0.0):
    """Makes an elastica; truth: elliptic integrals of the inextensible rod, plus F L / EA along the force, exact for EA = GA."""
    one = problem(12 * 1000.0**4, 1e-3, force=(0, -force, 0))
    return one._replace(GA=one.EA, truth=(-back, -down - force / one.EA, 0) if back else ())


PROBLEMS = {
    "roll_up_100": roll_up(100.0), "roll_up_1000": roll_up(1000.0),
    "arc_100": arc(100.0, (-23.560239545026, 13.604521347306, 53.474858791825)),
    "arc_1000": arc(1000.0, (-23.559392276570, 13.604246495401, 53.468661045426)),
    "elastica": elastica(10.0, 0.5549955977538, 0.8106090248803)}
CHAIN = elastica(0.3)  # for the growth of cost: mildly bent, so that every program needs one load step only
