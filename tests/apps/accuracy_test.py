#!/usr/bin/python3
"""Scenes with an accuracy, as a user runs them.

usage: accuracy_test.py MIXBEAM [CLASS]...
"""

import math
import re
import unittest
from pathlib import Path

import numpy as np
from support import BAD_INPUT, CHECK_FAILED, PROGRAM, InFolder, scene_of, with_lists


def elastica(accuracy, division="", more="{}"):
    """The gallery's with an accuracy, its member with this in place of order and elements."""
    free = re.sub(r"(, )?(Order|Elements): \d+", "", scene_of("apps/gallery/elastica.xml"))
    return with_lists(with_lists(free, f"Scene: {{Accuracy: {accuracy}, Members: {{strip: {{{division}}}}}}}"), more)


class AccuracyCase(InFolder):
    def chosen_mesh(self):
        return self.summary()["chosen_meshes"][0]

    def quantity(self, scene, code=0):
        """Value and error of the first one."""
        self.out = self.run_scene(scene, code=code)
        found = self.summary()["quantities"][0]
        return found["value"], found.get("error", math.nan)

    def expect_covered(self, value, error, exact):
        """The true error, by a bound that is at most twice as large: 1.5 times the difference, and what the formula leaves out."""
        missed = abs(value - exact)
        self.assertLessEqual(missed, error)
        self.assertLessEqual(error, 2 * missed)
        return missed / abs(exact)


class OfAScene(AccuracyCase):
    def test_it_is_reached_and_reported(self):
        self.expect(self.run_scene(elastica("1e-9")), "wanted accuracy of displacements 1.0e-09", ": reached", "load path", "order ")
        mesh = self.chosen_mesh()
        self.assertEqual(mesh["outcome"], "reached")
        self.assertLess(mesh["estimated"], 1e-9)
        self.assertGreaterEqual(mesh["members"][0]["order"], 5)
        self.assertTrue(mesh["meshes"])
        self.expect(self.contents(), "members/order")
        self.expect(self.mixbeam("resume", "results/scene.h5", code=BAD_INPUT), "scene.h5", "cannot be resumed", "accuracy")

    def test_it_is_missed_where_a_member_keeps_its_mesh(self):
        """Three elements of order 2 are what they are; the expected values of the scene notice it, too."""
        self.expect(self.run_scene(elastica("1e-9", "Order: 2, Elements: 3"), code=CHECK_FAILED),
                    "orders or elements that members keep prevent it", "estimated error of displacements")
        member = self.chosen_mesh()["members"][0]
        self.assertEqual((member["order"], member["elements"]), (2, 3))

    def test_bad_values_are_refused(self):
        for value in ("0", "-1e-6", "1e-12", "1", "nan", "small"):
            self.expect(self.run_scene(elastica(value), code=BAD_INPUT), "scene.yaml:", '"Scene / Accuracy"', value.replace("e-6", "e-06"))
        self.run_scene(elastica("1e-4", more="Scene: {Accuracy Of: strss}"), code=BAD_INPUT)

    def test_check_tells_the_start_mesh(self):
        self.expect(self.check_scene(elastica("1e-6")), "start mesh for an accuracy of 1.0e-06", "order ", "elements ")

    def test_it_is_for_mixbeam_only(self):
        """Programs with studies set the meshes themselves."""
        self.write("fork.yaml", with_lists(scene_of("apps/fork/fork.xml"), "Scene: {Accuracy: 1e-6}"))
        ended = self.ended("fork.yaml", "--single", executable=Path(PROGRAM).with_name("fork"))
        self.assertEqual(ended.returncode, BAD_INPUT)
        self.expect(ended.stderr, "fork.yaml:", '"Scene / Accuracy"', "mixbeam run")

    def test_it_is_reached_next_to_a_critical_load(self):
        """A residual within the tolerance leaves 8e-9 of the tip at 1.0005 P_cr, 3e-8 at 1.00005: over the smallest eigenvalue."""
        for over, push in ((5e-4, 0.0), (5e-5, 0.0), (5e-4, 1e-6)):
            load = (1 + over) * 0.25 * math.pi**2
            tip, _ = self.quantity(f"""Scene:
  Accuracy: 1e-8
  Sections: {{rod: {{Inextensible: true, Shear Rigid: true, GIt: 1, EI2: 1, EI3: 1}}}}
  Points: {{a: [0, 0, 0], b: [0, 0, 1]}}
  Members: {{rod: {{Start: a, End: b, Second Axis: [0, 1, 0]}}}}
  Supports: {{a: {{Point: a}}, b: {{Point: b, Fixed Displacement: [y], Fixed Rotation: [x, z]}}}}
  Point Loads: {{p: {{Point: b, Force: [{push!r}, 0, {-load!r}]}}}}
{"" if push else "Analysis: {Branch: positive}"}
Quantities: {{tip: {{Quantity: displacement, Point: b, Component: x}}}}
""")
            exact = tip_of_column(math.hypot(load, push), math.atan2(push, load))
            self.assertAlmostEqual(abs(tip), exact, delta=1e-8 * exact)

    def test_of_the_tip_alone_it_takes_a_coarser_mesh(self):
        """alpha = 10, elliptic integrals. Everything as accurate takes order 8; the tip converges with the power 2 k."""
        work = []
        for more in ("", "Scene: {Accuracy Of: tip}"):
            tip, _ = self.quantity(elastica("1e-8", more=f"Quantities: {{tip: {{Quantity: displacement, Point: tip, Component: y}}}}\n{more}"))
            member = self.chosen_mesh()["members"][0]
            work.append(member["order"] * member["elements"])
        self.expect(self.out, 'wanted accuracy of "tip" 1.0e-08')
        self.assertAlmostEqual(tip, -0.810609024880296, delta=1e-8)
        self.assertLess(3 * work[1], 2 * work[0])

    def test_factors_of_linear_buckling_reach_it(self):
        """Two guided ends: P_n = (n pi)^2 EI / L^2."""
        out = self.run_scene("""Scene:
  Accuracy: 1e-4
  Sections: {rod: {Inextensible: true, Shear Rigid: true, GIt: 200, EI2: 1, EI3: 200}}
  Points: {foot: [0, 0, 0], head: [1, 0, 0]}
  Members: {column: {Start: foot, End: head, Second Axis: [0, 0, 1]}}
  Supports:
    foot: {Point: foot, Fixed Rotation: [x, y]}
    head: {Point: head, Fixed Displacement: [y, z], Fixed Rotation: [x, y]}
  Point Loads: {load: {Point: head, Force: [-1, 0, 0]}}
Analysis: {Buckling Modes: 3}
""")
        third = float(re.search(r"load factors \S+ \([^)]*\) \S+ \([^)]*\) (\S+) \(error", out)[1])
        self.assertAlmostEqual(third, 9 * math.pi**2, delta=1e-4 * 9 * math.pi**2)


def tip_of_column(load, lean):
    """Sideways displacement of the tip, in the frame of the axis, of a clamped column of length and EI one under P that leans from its axis by
    `lean`: P = (K(k) - F(f, k))^2 with k sin f = sin(lean/2)."""
    points, weights = np.polynomial.legendre.leggauss(60)

    def from_start(k, power):
        """Elliptic integrals of the first kind (power -1/2) and the second (1/2) from f to pi/2."""
        start = math.asin(math.sin(0.5 * lean) / k)
        half = 0.5 * (0.5 * math.pi - start)
        return half * weights @ (1 - (k * np.sin(start + half * (1 + points)))**2)**power

    low, high = math.sin(0.5 * lean) * (1 + 1e-12) or 1e-12, 0.9  # k, by halving
    for _ in range(200):
        k = 0.5 * (low + high)
        low, high = (k, high) if from_start(k, -0.5) < math.sqrt(load) else (low, k)
    along = 2 / math.sqrt(load) * from_start(low, 0.5) - 1
    across = 2 / math.sqrt(load) * math.sqrt(low**2 - math.sin(0.5 * lean)**2)
    return across * math.cos(lean) - along * math.sin(lean)


# A wire of 20 mm that a force bends at its clamp within 0.2 m.
PULL, ACROSS, YOUNG, POISSON, RADIUS = 38000.0, 2400.0, 160e9, 0.3, 0.01
COARSE = ", Order: 3, Elements: 1"


def wire(mesh, limit="", scene=""):
    return f"""Scene:
  {scene}
  Sections: {{rod: {{Shape: circle, Diameter: {2 * RADIUS}, Material: {{E: {YOUNG}, nu: {POISSON}, Strength: 1.5e9}}}}}}
  Points: {{a: [0, 0, 0], b: [2, 0, 0]}}
  Members: {{rod: {{Start: a, End: b{mesh}}}}}
  Supports: {{a: {{Point: a}}}}
  Point Loads: {{p: {{Point: b, Force: [{PULL}, 0, {-ACROSS}]}}}}
Quantities:
  stress: {{Quantity: von Mises stress, Member: rod, Take: largest{limit}}}
"""


def stress_of_wire():
    """At the clamp. Along a beam without line loads M^2/2EI + N + N^2/2EA + Q^2/2GA is constant (theory (69)); at the free end of one that is
    ten layers long M = 0 and it points along the force, to exp(-20) of the moment."""
    area = math.pi * RADIUS**2
    inertia = 0.25 * area * RADIUS**2
    shear = 6 * (1 + POISSON) / (7 + 6 * POISSON) * YOUNG / (2 * (1 + POISSON)) * area

    def without_moment(n, q):
        return n + 0.5 * n * n / (YOUNG * area) + 0.5 * q * q / shear
    moment = math.sqrt(2 * YOUNG * inertia * (without_moment(math.hypot(PULL, ACROSS), 0) - without_moment(PULL, ACROSS)))
    return PULL / area + moment * RADIUS / inertia


class StressWithAnError(AccuracyCase):
    def test_of_a_wire_in_one_element(self):
        """It cannot bend within a twelfth of its length, whatever its order; the closed form of the layer tells."""
        exact = stress_of_wire()
        self.assertGreater(self.expect_covered(*self.quantity(wire(COARSE)), exact), 0.05)
        self.expect(self.out, "bends within sqrt(EI/N) = 0.18", "closed form")
        # twin: what sees the layer has no such warning, and a small error
        fine, small = self.quantity(wire(", Order: 6, Elements: 8"))
        self.assertAlmostEqual(fine, exact, delta=1e-6 * exact)
        self.assertLessEqual(small, 1e-3 * exact)
        self.expect(self.out, without=["bends within"])

    def test_it_counts_in_a_limit(self):
        """In a batch as in a single run; inside of such an element nothing is estimated, and no limit is kept."""
        def batch(limit, code):
            self.write("scene.yaml", wire(COARSE, limit) + """Batch:
  Output: quantities
  Vary: {pull: {Parameter: "Point Loads/p/Force[2]", First: -2400, Last: -2399, Count: 2}}
""")
            return self.mixbeam("batch", "scene.yaml", code=code)
        coarse, error = self.quantity(wire(COARSE))
        for share, code in ((0.5, CHECK_FAILED), (1.01, 0)):
            limit = f", Limit: {coarse + share * error}"
            self.quantity(wire(COARSE, limit), code)
            batch(limit, code)
        inside = '}\n  inside: {Quantity: material moment, Member: rod, Component: "2", Position: 0.1, Limit: 1e9'
        self.expect(batch(inside, CHECK_FAILED), "0 of 2 checks passed", "an error that is not known")

    def test_of_the_sag_beside_layers(self):
        """Of a wire held at both ends, stretched by a thousandth, under a weight in its middle: the clamped ends and the kink hold it up to
        N F^-1 w = L/4 - l tanh(L/4l), l = sqrt(EI/N); a difference of two orders saw a thirteenth of what the elements miss."""
        def weighted(mesh):
            return f"""Scene:
  Sections: {{wire: {{Shape: circle, Diameter: 0.01, Material: {{E: 160e9, nu: 0.3}}}}}}
  Points: {{a: [0, 0, 0], m: [5, 0, 0], b: [10, 0, 0]}}
  Members:
    left: {{Start: a, End: m, Section: wire, {mesh}}}
    right: {{Start: m, End: b, Section: wire, {mesh}}}
  Supports: {{a: {{Point: a}}, b: {{Point: b}}}}
  Eigenstrains: {{e: {{Member: "*", Strain: [-0.001, 0, 0]}}}}
  Point Loads: {{p: {{Point: m, Force: [0, 0, -1]}}}}
Quantities: {{sag: {{Quantity: displacement, Point: m, Component: z}}}}
"""
        area = math.pi * 0.005**2
        tension = 0.001 * 160e9 * area
        layer = math.sqrt(0.25 * 160e9 * area * 0.005**2 / tension)
        exact = -(2.5 - layer * math.tanh(2.5 / layer)) / tension
        of_stretching = 1e-4  # and shear: the weight adds 3e-7 of strain
        for mesh in ("Order: 2, Elements: 1", "Order: 3, Elements: 1", "Order: 4, Elements: 2"):
            self.assertGreater(self.expect_covered(*self.quantity(weighted(mesh)), exact), 10 * of_stretching)
        fine, small = self.quantity(weighted("Order: 6, Elements: 16"))  # twin
        self.assertAlmostEqual(fine, exact, delta=of_stretching * abs(exact))
        self.assertLessEqual(small, of_stretching * abs(exact))

    def test_of_the_largest_force_of_a_bent_rod(self):
        """The force at the clamp is what hangs on it. Material components turn with the axis, and their polynomials of two orders missed it
        alike: the true error was 4.4 times the estimate."""
        found = self.quantity("""Scene:
  Sections: {rod: {Shape: circle, Diameter: 0.02, Material: {E: 160e9, nu: 0.3}}}
  Points: {a: [0, 0, 0], b: [3.337, 0, 0]}
  Members: {rod: {Start: a, End: b, Order: 2, Elements: 2}}
  Supports: {a: {Point: a}}
  Point Loads: {p: {Point: b, Force: [1672, 0, -348]}}
  Distributed Loads: {q: {Member: rod, Force: [0, 0, -165]}}
Quantities: {force: {Quantity: material force, Member: rod, Component: norm, Take: largest}}
""")
        self.assertGreater(self.expect_covered(*found, math.hypot(1672, 348 + 165 * 3.337)), 0.005)

    def test_it_is_made_small_where_the_accuracy_is_of_it(self):
        exact, wanted = stress_of_wire(), 1e-4
        value, error = self.quantity(wire("", "", "Accuracy: 1e-4\n  Accuracy Of: stress"))
        self.assertAlmostEqual(value, exact, delta=wanted * exact)
        self.assertLessEqual(error, wanted * exact)
        self.expect(self.out, 'wanted accuracy of "stress" 1.0e-04')


if __name__ == "__main__":
    unittest.main()
