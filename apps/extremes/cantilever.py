"""Structure of most sweeps: a straight cantilever with EI2 = EI3 under a dead load at its tip, and its closed forms."""

import math

from numpy.polynomial.legendre import leggauss

from mixbeam.errors import InputError

CARLSON = 1e-3  # deviations at which the series of an elliptic integral are exact to rounding
SMALL_LOAD = 0.03  # up to here the series is exact to rounding; beyond, the elliptic form loses at most two digits
# Beyond this load the directions of tip and force differ by less than exp(-40), and the rod acts as an infinitely long
# one.
LONG_ROD = 1600.0
HALVINGS = 200  # of an interval; 60 exhaust the digits
SERIES_ANGLE = 0.5  # below, theta - sin(theta) is a series: the difference would lose three digits and more


def elastica_tip(load):
    """Returns (back, across, angle) of the tip of an inextensible, shear rigid cantilever of length 1 and EI = 1 under a dead
    transverse force, load = F L^2 / EI > 0. The error is a few roundings, relative to the motion for loads below 0.03, else
    to the length. (Bisshopp and Drucker, Quart. Appl. Math. 3, 1945)"""
    if load <= SMALL_LOAD:
        return _short_rod(load)
    if load <= LONG_ROD:
        return _pendulum_tip(load, 0.5 * math.pi)
    return 1 - math.sqrt(2 / load), 1 - (2 - math.sqrt(2)) / math.sqrt(load), 0.5 * math.pi  # k = 1


def thrust_tip(thrust, eccentricity):
    """Returns the same under a thrust P L^2 / EI > 0 with the fraction `eccentricity` > 0 of it as transverse force: the
    stable equilibrium, which bends towards that force; angle up to pi. The relative error is a few roundings over the
    eccentricity."""
    return _pendulum_tip(thrust * math.hypot(1, eccentricity), math.atan(eccentricity))


def _short_rod(load):
    """Sums the power series of theta'' = -load cos(theta), theta(0) = theta'(1) = 0, with exact fractions; omitted terms are
    below 1e-3 load^8 of the first ones."""
    x = load * load

    def series(a, b, c, d):
        return a + x * (b + x * (c + x * d))

    return (x * series(1 / 15, -4 / 315, 2126 / 675675, -356164 / 402026625),
            load * series(1 / 3, -4 / 105, 47 / 5775, -21584 / 10135125),
            load * series(0.5, -11 / 240, 3601 / 403200, -3086639 / 1383782400))


def _carlson(x, y, z, weight):
    """Applies the duplication theorem. Returns (mean, deviations of x, y, z from it, sum of the terms split off, power of
    1/4); z has `weight` in the mean. (Carlson, Numer. Math. 33, 1979)"""
    total, power = 0.0, 1.0
    while True:
        mean = (x + y + weight * z) / (2 + weight)
        deviations = [(mean - one) / mean for one in (x, y, z)]
        if max(map(abs, deviations)) < CARLSON:
            return mean, deviations, total, power
        p, q, r = (math.sqrt(one) for one in (x, y, z))
        shift = p * (q + r) + q * r
        total += power / (r * (z + shift))
        power *= 0.25
        x, y, z = ((one + shift) * 0.25 for one in (x, y, z))


def elliptic_rf(x, y, z):
    mean, (a, b, c), _, _ = _carlson(x, y, z, 1)
    e2, e3 = a * b - c * c, a * b * c
    return (1 + (e2 / 24 - 0.1 - 3 / 44 * e3) * e2 + e3 / 14) / math.sqrt(mean)


def elliptic_rd(x, y, z):
    mean, (a, b, c), total, power = _carlson(x, y, z, 3)
    ea, eb = a * b, c * c
    ec, ed = ea - eb, ea - 6 * eb
    ef = ed + ec + ec
    series = ed * (-3 / 14 + 9 / 88 * ed - 9 / 52 * c * ef) + c * (ef / 6 + c * (-9 / 22 * ec + c * 3 / 26 * ea))
    return 3 * total + power * (1 + series) / (mean * math.sqrt(mean))


def _pendulum_rod(load_angle, u):
    """Returns (k, cos(psi_0), F(chi, k), E(k) - E(psi_0, k)). With phi the angle to the load R, phi'' = -R sin(phi),
    phi'(1) = 0, is a pendulum: from `load_angle` at the clamp to the tip, k = sin(phi_tip / 2), in u = log(k / k'), which
    resolves both ends. sin(phi / 2) = k sin(psi), sqrt(R) = K(k) - F(psi_0, k) = F(chi, k), tan(chi) = 1 / (k' tan(psi_0))."""
    k, k_prime = 1 / math.sqrt(1 + math.exp(-2 * u)), 1 / math.sqrt(1 + math.exp(2 * u))
    sin_psi = min(1.0, math.sin(0.5 * load_angle) / k)
    cos_psi = math.sqrt((1 - sin_psi) * (1 + sin_psi))
    product = (k_prime * sin_psi)**2
    total = product + cos_psi * cos_psi
    sin_chi, cos2_chi, delta2 = cos_psi / math.sqrt(total), product / total, k_prime * k_prime / total
    first = sin_chi * elliptic_rf(cos2_chi, delta2, 1)
    second = first - k * k / 3 * sin_chi**3 * elliptic_rd(cos2_chi, delta2, 1) - k * k * sin_chi * sin_psi
    return k, cos_psi, first, second


def _pendulum_tip(load, load_angle):
    """Returns the tip as elastica_tip; `load_angle`: angle of the load to the axis of the clamp."""
    root = math.sqrt(load)
    low, high = math.log(math.tan(0.5 * load_angle)) * (1 - 1e-15), root + 3  # low: the tip is parallel to the clamp
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if _pendulum_rod(load_angle, middle)[2] < root:
            low = middle
        else:
            high = middle
    u = 0.5 * (low + high)
    k, cos_psi, _, second = _pendulum_rod(load_angle, u)
    along, across = 2 / root * second - 1, 2 * k / root * cos_psi
    cosine, sine = math.cos(load_angle), math.sin(load_angle)
    return 1 - (cosine * along + sine * across), cosine * across - sine * along, 2 * math.atan(math.exp(u)) - load_angle


def _one_minus_sinc(x):
    """Returns 1 - sin(x) / x without cancellation."""
    if abs(x) > SERIES_ANGLE:
        return 1 - math.sin(x) / x
    term, total = 1.0, 0.0
    for j in range(1, 10):  # truncation x^20 / 21!
        term *= -x * x / (2 * j * (2 * j + 1))
        total -= term
    return total


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def quaternion(axis, angle):
    """Returns (w, x, y, z) of the rotation by `angle` about a unit vector."""
    s = math.sin(0.5 * angle)
    return math.cos(0.5 * angle), s * axis[0], s * axis[1], s * axis[2]


def product(p, q):
    """Multiplies quaternions."""
    v = [p[0] * b + q[0] * a + c for a, b, c in zip(p[1:], q[1:], cross(p[1:], q[1:]))]
    return p[0] * q[0] - sum(a * b for a, b in zip(p[1:], q[1:])), *v


def or_one(size):
    """Returns the size of a motion as its scale; a zero motion is measured against the structure."""
    return size if size > 0 else 1.0


class Cantilever:
    """One scene of a sweep with its exact solution. Set geometry, mesh and stiffness first, then the load, which computes the
    exact motion of the tip. Initially inextensible and shear rigid.

    ratio: longest to shortest element, growing from the clamp by a constant factor; 0: equal elements. steps: number of
    equal load steps; 0: by the solver's parameters."""

    def __init__(self, scene):
        self.scene = scene
        if not self._is_one():
            raise InputError(
                "the study needs a scene of one straight member from the origin along x, of one section with EI2 = EI3, "
                "clamped at its start, with one dead load at its end and nothing else; other scenes: --single")
        section, rod = next(iter(scene.sections.values())), next(iter(scene.members.values()))
        self.end = rod.end
        self.length = scene.points[self.end][0]
        self.bending, self.torsion, self.force_stiffness = section["EI3"], section["GIt"], math.inf
        self.order, self.elements, self.ratio, self.steps = rod.order, rod.elements, 0.0, 0
        self.force, self.moment = [0.0] * 3, [0.0] * 3

    def _is_one(self):
        scene = self.scene
        lists = [scene.sections, scene.members, scene.supports, scene.point_loads]
        known = {"Sections", "Points", "Members", "Supports", "Point Loads"}
        if any(len(one) != 1 for one in lists) or not set(scene["Scene"]) <= known:
            return False
        section, rod, support, load = (next(iter(one.values())) for one in lists)
        start, end = scene.points.get(rod.start), scene.points.get(rod.end)
        return (section.get("EI2") is not None and section.get("EI2") == section.get("EI3") and "GIt" in section
                and not len(rod.curve) and start is not None and end is not None and not any(start)
                and end[0] > 0 and not any(end[1:]) and support.point == rod.start and set(support) == {"Point"}
                and load.point == rod.end and load.frame == "dead" and load.stage == 1)

    def set_slenderness(self, slenderness):
        """Sets a square section of side L / slenderness, EA = 12 slenderness^2 EI / L^2; GA = EA keeps the closed form."""
        self.force_stiffness = 12 * (slenderness / self.length)**2 * self.bending

    def pull(self, load):
        """Applies a dead force along y, F L^2 / EI = load >= 0. Exact: elastica; with C = EA = GA2 = GA3 every point moves by
        s F / C further for any rotations (r' = g1 + n / C, and m' = - r' x n does not depend on C)."""
        self.force[1] = load * self.bending / (self.length * self.length)
        self._set_exact(elastica_tip(load), self.length * self.force[1] / self.force_stiffness)

    def pull_in_units(self, of_length, of_force, load):
        """Applies the same force at slenderness 100, with the units of length and force divided by these numbers."""
        self.length *= of_length
        self.bending *= of_force * of_length * of_length
        self.torsion *= of_force * of_length * of_length
        self.set_slenderness(100.0)
        self.pull(load)

    def push(self, load, eccentricity):
        """Applies a dead thrust, as a multiple of Euler's load, and the fraction `eccentricity` > 0 of it along y. Exact:
        elastica (only inextensible and shear rigid), the stable equilibrium on the side of the force along y."""
        thrust = 0.25 * math.pi * math.pi * load
        size = thrust * self.bending / (self.length * self.length)
        self.force = [-size, eccentricity * size, 0.0]
        self._set_exact(thrust_tip(thrust, eccentricity), 0.0)

    def turn(self, bending_turn, twist):
        """Applies a dead moment with transverse part bending_turn = (0, y, z) EI / L, as spatial vector, that twists the rod by
        `twist`. Exact (EI2 = EI3, no forces): the spatial moment m and its component M1 along the tangent are constant; the
        rotations are exp(s m / EI) exp(s M1 (1/GIt - 1/EI) e1), the centerline is a helix about m."""
        along = self.torsion * twist / self.length  # M1
        turned = [self.length * along / self.bending, bending_turn[1], bending_turn[2]]  # m L / EI
        self.moment = [one * self.bending / self.length for one in turned]
        angle = math.hypot(*turned)
        half_sine = math.sin(0.5 * angle)
        axis = [1 / or_one(angle) * one for one in turned]
        binormal = cross(axis, [1.0, 0.0, 0.0])
        a, b = 2 * half_sine * half_sine / or_one(angle), _one_minus_sinc(angle)
        # integral of exp(s m / EI) e1: Rodrigues' formula, term by term
        self.exact_displacement = [self.length * (a * u + b * v) for u, v in zip(binormal, cross(axis, binormal))]
        self.exact_rotation = product(quaternion(axis, angle), quaternion([1.0, 0.0, 0.0], twist - turned[0]))
        self.displacement_scale = or_one(math.hypot(*self.exact_displacement) / self.length) * self.length
        self.rotation_scale = min(1.0, or_one(max(angle, abs(twist))))

    def turn_by_gauss_rule(self, angle):
        """Applies a dead moment about z that rotates the tip by `angle`. Exact: the solution of the discrete equations on equal
        elements, the k-point Gauss rule of the exact tangent (rotations are exact and force strains vanish at these points),
        because the circle is a poor reference if an element rotates by a radian or more."""
        self.turn([0.0, 0.0, angle], 0.0)
        points, weights = (values.tolist() for values in leggauss(self.order))
        x = y = 0.0
        for e in range(self.elements):
            for point, weight in zip(points, weights):
                half = 0.5 * angle * (e + 0.5 * (1 + point)) / self.elements
                share = self.length / self.elements * weight
                x -= share * math.sin(half)**2  # cos - 1, sin; no cancellation
                y += share * math.sin(half) * math.cos(half)
        self.exact_displacement = [x, y, 0.0]
        self.displacement_scale = or_one(math.hypot(x, y) / self.length) * self.length

    def _set_exact(self, tip, shift):
        back, across, angle = tip
        self.exact_displacement = [-self.length * back, self.length * across + shift, 0.0]
        self.exact_rotation = quaternion([0.0, 0.0, 1.0], angle)
        self.displacement_scale = math.hypot(*self.exact_displacement)
        self.rotation_scale = min(1.0, angle)

    def scene_with_all_this(self):
        scene = self.scene.copy()
        section, rod = next(iter(scene.sections.values())), next(iter(scene.members.values()))
        for name in ("Inextensible", "Shear Rigid"):
            section.pop(name, None)
        for name in ("EA", "GA2", "GA3"):
            section[name] = self.force_stiffness
        section["GIt"], section["EI2"], section["EI3"] = self.torsion, self.bending, self.bending
        rod.order, rod.elements = self.order, self.elements
        if self.ratio > 0:
            rod.elements, rod.stations = None, self._graded_stations()
        scene.points[self.end][0] = self.length
        load = next(iter(scene.point_loads.values()))
        load.force, load.moment = self.force, self.moment
        if self.steps:
            scene.solver.load_path.update_by_name({"Method": "fixed", "Steps": self.steps})
        return scene

    def _graded_stations(self):
        """Returns the ends of elements over the length of the member."""
        growth = self.ratio**(1 / (self.elements - 1)) if self.elements > 1 else 1.0
        ends, length = [0.0], 1.0
        for _ in range(self.elements):
            ends.append(ends[-1] + length)
            length *= growth
        return [end / ends[-1] for end in ends]

    def error(self, trial):
        """Returns the error of the tip, the larger of displacement and rotation over their scales: the exact displacement, so
        that tiny motions are judged too, and the angle, at most one radian."""
        distance = [a - b for a, b in zip(trial.displacement(self.end), self.exact_displacement)]
        vector = trial.rotation(self.end)
        angle = math.hypot(*vector)
        rotation = quaternion([one / or_one(angle) for one in vector], angle)
        w, *v = product(rotation, (self.exact_rotation[0], *(-one for one in self.exact_rotation[1:])))
        position_error = math.hypot(*distance) / self.displacement_scale
        rotation_error = 2 * math.atan2(math.hypot(*v), abs(w)) / self.rotation_scale
        return max(position_error, rotation_error) if math.isfinite(rotation_error) else rotation_error
