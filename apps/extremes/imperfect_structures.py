"""Random nearly perfect structures, by which path following is judged: columns, frames, arches, rings, lattices, domes and
strips that buckle or snap, with an imperfection that decides to which side."""

import math

from study import new_scene, shortest

FAMILIES = ("column", "frame", "knee", "arch", "ring", "lattice", "dome", "strip")
ORDER = 3
NORMAL = (0.0, 0.0, 1.0)  # of the plane of all structures except domes
MASK = 2**64 - 1


class RandomNumbers:
    """Random numbers by splitmix64 (Steele, Lea, Flood 2014), the same on every machine."""

    def __init__(self, seed):
        self.state = seed & MASK

    def next(self):
        self.state = (self.state + 0x9e3779b97f4a7c15) & MASK
        z = self.state
        z = ((z ^ (z >> 30)) * 0xbf58476d1ce4e5b9) & MASK
        z = ((z ^ (z >> 27)) * 0x94d049bb133111eb) & MASK
        return z ^ (z >> 31)

    def between(self, low, high):
        return low + (high - low) * ((self.next() >> 11) / 9007199254740992.0)

    def decades(self, low, high):
        """Returns ten to a random power between two numbers."""
        return 10.0**self.between(low, high)

    def below(self, count):
        return self.next() % count

    def chance(self, probability):
        return self.between(0.0, 1.0) < probability


class ImperfectStructure:
    """Structure `number` >= 0 of the series with this `seed`, in random units, with the solver's parameters of the
    scene `given`: the same on every machine.

    scene, family, load ("force", "moment", "line load", "heat", "motion"), imperfection (of the load, or of the length,
    with its sign), estimate (full load over a hand formula of the critical one; half of them exceed 1). Lengths are multiples
    of `length`, bending stiffnesses of `bending`. g3 is the normal of a plane structure, so EI3 belongs to bending in it."""

    def __init__(self, seed, number, given):
        self.random = draw = RandomNumbers(seed + 1000003 * number)
        self.family = FAMILIES[number % len(FAMILIES)]
        self.scene = new_scene(f"{self.family} {number}", given)
        self.length, self.bending = draw.decades(-1, 1), draw.decades(-2, 2)
        size = draw.decades(-6, -1)
        self.imperfection = size if draw.chance(0.5) else -size
        # Half of the loads are to pass the critical one, by at least 10 % since most of the formulas are rough.
        self.estimate = draw.between(0.2, 0.9) if draw.chance(0.5) else draw.decades(math.log10(1.1), math.log10(4.0))
        slenderness = draw.decades(1.5, 3.5)
        self.unit_force = self.bending / (self.length * self.length)
        self.axial = self.bending * slenderness * slenderness / (self.length * self.length)
        shear = math.inf if draw.chance(0.5) else 0.35 * self.axial
        across = 1.0 if draw.chance(0.5) else draw.between(1.0, 4.0)
        self.scene.sections["rod"] = {"EA": self.axial, "GA2": shear, "GA3": shear, "GIt": 0.8 * self.bending,
                                      "EI2": across * self.bending, "EI3": self.bending}
        self.in_space = draw.chance(0.35)
        self.load = getattr(self, "make_" + self.family)()

    def add_points(self, **places):
        for name, place in places.items():
            self.scene.points[name] = [self.length * one for one in place]

    def add_member(self, start, end, elements, **more):
        along = [b - a for a, b in zip(self.scene.points[start], self.scene.points[end])]
        name = f"{start} to {end}"
        self.scene.members[name] = {"Start": start, "End": end, "Section": "rod", "Order": ORDER, "Elements": elements,
                                    "Second Axis": [-along[1], along[0], 0.0], **more}  # normal x along
        return self.scene.members[name]

    def add_arc(self, start, end, angle, elements):
        """Adds an arc about the origin, counterclockwise."""
        self.add_member(start, end, elements, **{
            "Second Axis": [-one for one in self.scene.points[start]],
            "Curve": {"Shape": "arc", "Center": (0, 0, 0), "Axis": NORMAL, "Angle": angle}})

    def support(self, point, displacement, rotation, **prescribed):
        name = f"support {len(self.scene.supports)}"
        self.scene.supports[name] = {"Point": point, "Fixed Displacement": list(displacement),
                                     "Fixed Rotation": list(rotation)}
        self.scene.supports[name].update_by_name(prescribed)

    def hold_in_plane(self, *points):
        """Holds points in the plane, unless the structure may leave it."""
        for point in points if not self.in_space else ():
            self.support(point, "z", "xy")

    def push(self, point, force, moment=(0, 0, 0)):
        self.scene.point_loads[f"load {len(self.scene.point_loads)}"] = {"Point": point, "Force": force, "Moment": moment}

    def disturb(self, point, load, x, y):
        """Adds the imperfection of the load: a force across, also out of the plane if that is free."""
        force = [self.imperfection * load * x, self.imperfection * load * y, 0.0]
        if self.in_space:
            force[2] += self.imperfection * load * self.random.between(0.3, 1.0)
        self.push(point, force)

    def load_line(self, member, **what):
        self.scene.distributed_loads[member] = {"Member": member, **what}

    def heat(self, member, strain, curvature=0.0):
        self.scene.eigenstrains[member] = {"Member": member, "Strain": (strain, 0, 0), "Curvature": (0, 0, curvature)}

    def make_column(self):
        """Makes a column, free, hinged or clamped; under a force, a moved end, or heat between fixed ends."""
        ends = self.random.below(3)  # free, hinged, clamped
        kind = 0 if ends == 0 else self.random.below(3)
        imperfect = self.random.below(3)  # force, bow, moment or curvature by heat
        critical = (0.25, 1.0, 4.0)[ends] * math.pi * math.pi * self.unit_force
        load = self.estimate * critical
        self.add_points(a=(0, 0, 0), b=(1, 0, 0))
        rod = self.add_member("a", "b", 8, **{"Inner Points": {"m": 0.5}})
        loaded = "b" if ends == 0 else "m"
        rotation = "xy" if ends == 1 else "xyz"
        self.support("a", "xyz", rotation)
        if ends > 0:
            moved = {"prescribed_displacement": (-load / self.axial * self.length, 0, 0)} if kind == 1 else {}
            self.support("b", "xyz" if kind > 0 else "yz", rotation, **moved)
        self.hold_in_plane(loaded)
        if imperfect == 1 and ends > 0:
            rod.curve.update_by_name({"Shape": "spline",
                                      "Through": [self.length * 0.5, self.length * self.imperfection, 0.0]})
        if kind == 0:
            self.push("b", (-load, 0, 0))
        if kind == 2:
            self.heat("a to b", load / self.axial, self.imperfection / self.length if imperfect == 2 else 0.0)
        if kind < 2 and imperfect == 2:
            self.push("m" if ends == 2 else "b", (0, 0, 0), (0, 0, self.imperfection * load * self.length))
        if imperfect == 0 or self.in_space or (imperfect == 1 and ends == 0):
            self.disturb(loaded, load, 0, 1)
        return ("force", "motion", "heat")[kind]

    def make_frame(self):
        """Makes a portal frame of two columns and a beam, loaded at the corners or along the beam; it sways."""
        clamped = self.random.chance(0.5)
        kind = self.random.below(3)  # forces at the corners, line load, and moments beside the forces
        height, span = self.random.between(0.7, 1.3), self.random.between(0.7, 1.5)
        share = 0.25 if self.in_space else 0.75 if clamped else 0.18
        load = self.estimate * share * math.pi * math.pi * self.unit_force / (height * height)
        self.add_points(a=(0, 0, 0), b=(0, height, 0), c=(span, height, 0), d=(span, 0, 0))
        for start, end in ("ab", "bc", "cd"):
            self.add_member(start, end, 5)
        for foot in "ad":
            self.support(foot, "xyz", "xyz" if clamped else "xy")
        for corner in "bc":
            self.hold_in_plane(corner)
            if kind != 1:
                self.push(corner, (0, -load, 0), (0, 0, 0.02 * load * self.length if kind == 2 else 0.0))
        if kind == 1:
            self.load_line("b to c", Force=(0, -2 * load / (span * self.length), 0))
        self.disturb("b", load, 1, 0)
        return ("force", "line load", "moment")[kind]

    def make_knee(self):
        """Makes Roorda's frame: column and beam on hinges, loaded above the column; an asymmetric bifurcation, which an
        imperfection turns into a limit point or into a stable path."""
        beam = self.random.between(0.6, 1.5)
        moved = self.random.chance(0.3)
        load = self.estimate * 1.4 * math.pi * math.pi * self.unit_force
        self.add_points(a=(0, 0, 0), b=(0, 1, 0), c=(beam, 1, 0))
        self.add_member("a", "b", 6)
        self.add_member("b", "c", 5)
        self.support("a", "xyz", "xy", prescribed_displacement=(0, 0.05 * self.estimate * self.length * moved, 0))
        self.support("c", "xyz", "xy")
        self.hold_in_plane("b")
        if not moved:
            self.push("b", (0, -load, 0), (0, 0, self.imperfection * load * self.length))
        if moved or self.in_space:
            self.disturb("b", load, 1, 0)
        return "motion" if moved else "force"

    def make_arch(self):
        """Makes an arch, from shallow to half a circle and more."""
        clamped = self.random.chance(0.5)
        kind = self.random.below(4)  # force at the crown, line load, heat, feet that approach
        half = self.random.between(0.3, 1.6)
        # antisymmetric buckling
        thrust = self.unit_force * ((20.2 if clamped else math.pi * math.pi) / (half * half) - 1.0)
        load = self.estimate * thrust * half
        sine, cosine = math.sin(half), math.cos(half)
        self.add_points(a=(sine, cosine, 0), t=(0, 1, 0), b=(-sine, cosine, 0))
        self.add_arc("a", "t", half, 6)
        self.add_arc("t", "b", half, 6)
        approach = {"prescribed_displacement": (-0.1 * self.estimate * sine * self.length, 0, 0)} if kind == 3 else {}
        self.support("a", "xyz", "xyz" if clamped else "xy", **approach)
        self.support("b", "xyz", "xyz" if clamped else "xy")
        self.hold_in_plane("t")
        if kind == 0:
            self.push("t", (0, -load, 0))
        for part in self.scene.members:
            if kind == 1:
                self.load_line(part, Force=(0, -load / (half * self.length), 0))
            if kind == 2:
                self.heat(part, 0.01 * self.estimate)
        self.disturb("t", load, 1, 0)
        return ("force", "line load", "heat", "motion")[kind]

    def make_ring(self):
        """Makes a ring under dead radial pressure, pinched, or with one side rotated about the diameter."""
        kind = self.random.below(3)
        pressure = self.estimate * 4.0 * self.unit_force / self.length
        self.add_points(p0=(1, 0, 0), p1=(0, 1, 0), p2=(-1, 0, 0), p3=(0, -1, 0))
        for i in range(4):
            self.add_arc(f"p{i}", f"p{(i + 1) % 4}", 0.5 * math.pi, 5)
        if kind == 2:
            self.support("p0", "xyz", "xyz")
            self.support("p2", "yz", "xyz", prescribed_rotation=(self.random.between(0.2, 1.0) * self.estimate, 0, 0))
        else:
            self.support("p0", "xyz", "xy")
            self.support("p2", "yz", "xy")
            self.hold_in_plane("p1", "p3")
        for i, member in enumerate(self.scene.members if kind == 0 else ()):
            angle = f"({shortest(0.5 * math.pi * i)}+s/{shortest(self.length)})"
            size = f"-{shortest(pressure)}*"
            self.load_line(member, **{"Force Formula": [f"{size}cos{angle}", f"{size}sin{angle}", "0"]})
        pinch = 2.0 * pressure * self.length
        if kind == 1:
            self.push("p1", (0, -pinch, 0))
            self.push("p3", (0, pinch, 0))
        self.disturb("p1", pinch, 0.2, -1)
        return ("line load", "force", "motion")[kind]

    def make_lattice(self):
        """Makes a lattice of square cells; the upper side is loaded or moved downwards."""
        cells, elements = 2, 4
        moved = self.random.chance(0.5)
        load = self.estimate * (0.25 / (cells * cells) if self.in_space else 0.5) * math.pi * math.pi * self.unit_force
        places = [(i, j) for j in range(cells + 1) for i in range(cells + 1)]
        self.add_points(**{f"p{i}{j}": (i, j, 0) for i, j in places})
        for i, j in places:
            if i < cells and j > 0 and not (moved and j == cells):
                self.add_member(f"p{i}{j}", f"p{i + 1}{j}", elements)
            if j < cells:
                self.add_member(f"p{i}{j}", f"p{i}{j + 1}", elements)
        for i in range(cells + 1):
            top = f"p{i}{cells}"
            self.support(f"p{i}0", "xyz", "xyz")
            self.hold_in_plane(*(f"p{i}{j}" for j in range(1, cells)))
            if moved:
                self.support(top, "xyz", "xyz", prescribed_displacement=(0, -(cells * self.length * load / self.axial), 0))
            else:
                self.hold_in_plane(top)
                self.push(top, (0, -load, 0))
        self.disturb("p01", load, 1, 0)
        return "motion" if moved else "force"

    def make_dome(self):
        """Makes legs that meet at an apex, loaded there with an imperfection, pushed down by a motion, or heated."""
        legs, kind = 3 + self.random.below(4), self.random.below(3)
        clamped = self.random.chance(0.6)
        rise = self.random.between(0.1, 0.8)
        leg = math.hypot(1.0, rise)
        self.in_space = True
        self.add_points(apex=(0, 0, rise))
        for i in range(legs):
            angle, foot = 2.0 * math.pi * i / legs, f"foot {i}"
            self.add_points(**{foot: (math.cos(angle), math.sin(angle), 0)})
            self.add_member(foot, "apex", 5)
            self.support(foot, "xyz", "xyz" if clamped else "")
        # snap of a truss, Euler's load of the legs
        snap = self.axial * (1.0 - (1.0 / leg)**(2.0 / 3.0))**1.5
        buckling = (2.0 if clamped else 1.0) * math.pi * math.pi * self.unit_force / (leg * leg) * rise / leg
        load = self.estimate * legs * min(snap, buckling)
        if kind == 0:
            self.push("apex", (0, 0, -load))
        # motion at which the legs reach their buckling load, at most half of the way to the plane of the feet
        motion = min(0.5 * rise * self.length, buckling / self.axial * leg * self.length * (leg / rise)**2)
        if kind == 1:
            self.support("apex", "z", "", prescribed_displacement=(0, 0, -self.estimate * motion))
        for member in self.scene.members if kind == 2 else ():
            self.heat(member, 0.01 * self.estimate)
        self.push("apex", [self.imperfection * load * one for one in (1.0, 0.3, 0.0)])
        return ("force", "motion", "heat")[kind]

    def make_strip(self):
        """Makes a tall cantilever, which buckles sideways under a force or a moment in its strong direction."""
        moment = self.random.chance(0.4)
        strong = self.random.decades(1.3, 2.5)
        self.in_space = True
        self.scene.sections["rod"].update({"EI2": self.bending, "EI3": strong * self.bending})
        mean = math.sqrt(0.8) * self.unit_force  # sqrt(EI GIt) / L^2
        self.add_points(a=(0, 0, 0), b=(1, 0, 0))
        self.add_member("a", "b", 10)
        self.support("a", "xyz", "xyz")
        load = self.estimate * mean * (0.5 * math.pi if moment else 4.0126)
        self.push("b", (0, 0 if moment else -load, 0), (0, 0, load * self.length if moment else 0))
        self.push("b", (0, 0, self.imperfection * load))
        return "moment" if moment else "force"
