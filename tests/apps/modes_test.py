#!/usr/bin/python3
"""Natural modes as `mixbeam run` answers them: files, terminal, quantities, and what it refuses.

usage: modes_test.py MIXBEAM [CLASS]...
"""

import math
import unittest

import h5py
from support import BAD_INPUT, CHECK_FAILED, InFolder, changed

FREQUENCY = 1.875104068711961**2 / (2 * math.pi)  # the first one of a cantilever, EI = m = L = 1; the mesh leaves 1e-12
CLAMP, MASS, PLANE = "Supports: {clamp: {Point: wall}}", ", Mass: 1", ", In Plane: true"


def scene(modes, section=MASS, supports=CLAMP, more=""):
    return f"""Scene:
  Sections: {{rod: {{EA: 1e9, GA2: 1e9, GA3: 1e9, GIt: 1, EI2: 1, EI3: 1{section}}}}}
  Points: {{wall: [0, 0, 0], tip: [1, 0, 0]}}
  Members: {{beam: {{Start: wall, End: tip, Section: rod, Order: 4, Elements: 8}}}}
  {supports}
Analysis: {{Modes: {{{modes}}}}}
{more}
"""


def clamp_and(more):
    return f"{CLAMP}\n  {more}"


class Modes(InFolder):
    def test_they_are_in_file_terminal_and_quantities(self):
        quantity = "Quantities: {f: {Quantity: natural frequency, Mode: 1}}\nExpected: {f: {Quantity: f, Relative Tolerance: 1e-6, Source: x, "
        for share, code in ((1, 0), (1.01, CHECK_FAILED)):
            out = self.run_scene(scene("Number: 2" + PLANE, more=f"{quantity}Value: {share * FREQUENCY}}}}}"), code=code)
        self.expect(out, "natural modes", "3.516015", without=["nothing acts", "not confirmed"])
        with h5py.File(self.folder / "results/scene.h5") as file:
            self.assertAlmostEqual(file["steps/000001/vibration/0"].attrs["frequency"], FREQUENCY, delta=1e-8 * FREQUENCY)

    def test_frequencies_have_estimated_errors(self):
        """So meshes are chosen for them, and limits count."""
        for limit, code in (("0.5596", 0), ("0.5595", CHECK_FAILED)):  # the value is 0.55959
            text = scene("Number: 2" + PLANE, more=f"""Quantities: {{f: {{Quantity: natural frequency, Mode: 1, Limit: {limit}}}}}
Expected: {{f: {{Quantity: f, Relative Tolerance: 1e-8, Source: closed form, Value: {FREQUENCY!r}}}}}""")
            text = changed(text, ", Order: 4, Elements: 8", "")
            self.run_scene(changed(text, "Scene:\n", "Scene:\n  Accuracy: 1e-8\n  Accuracy Of: f\n"), code=code)

    def test_supports_may_be_missing_where_nothing_acts(self):
        self.expect(self.run_scene(scene("Number: 5" + PLANE, supports="")), "22.373285")  # of a slender beam; shear takes 6e-9 of it
        pushed = scene("Number: 5", supports="Point Loads: {push: {Point: tip, Force: [0, 1, 0]}}")
        self.expect(self.run_scene(pushed, code=BAD_INPUT), "Supports", "no support")

    def test_free_frames_in_space_have_their_own_frequencies(self):
        """Their tangent has pivots that are exactly zero. The first elastic frequency is that of a spectral program with 6x6 masses, written
        for this."""
        out = self.run_scene("""Scene:
  Sections: {rod: {EA: 1000, GA2: 50, GA3: 40, GIt: 1, EI2: 1.2, EI3: 0.8, Mass: 1.3, Rotary Inertia: [0.009, 0.004, 0.006],
                   Mass Offset: [0.1, 0]}}
  Points: {a: [0, 0, 0], corner: [1, 0, 0], b: [1, 1, 0.5]}
  Members:
    one: {Start: a, End: corner, Second Axis: [0, 1, 0], Order: 6, Elements: 3}
    two: {Start: b, End: corner, Second Axis: [0, 0, 1], Order: 6, Elements: 3}
Analysis: {Modes: {Number: 7}}
""")
        self.expect(out, "7         3.01573025", without=["not confirmed"])

    def test_they_are_at_the_load_factors_asked_for(self):
        """Of a column under a dead load and one whose load grows by a formula, without and with fixed steps: the path stops at load factors
        that are listed, and nowhere else are there modes but at its end."""
        for amplitude in ("", ", Amplitude: t^2"):
            for solver in ("", "Solver: {Load Path: {Method: fixed, Steps: 2}}"):
                self.run_scene(scene(f"Number: 1{PLANE}, Load Factors: [0.6, 0, 0.3]", more=solver, supports=clamp_and(
                    f"Point Loads: {{push: {{Point: tip, Force: [-2, 0, 0]{amplitude}}}}}")))
                with h5py.File(self.folder / "results/scene.h5") as file:
                    found = [step.attrs["load_factor"] for step in file["steps"].values() if "vibration/0" in step]
                for one, wanted in zip(found, (0, 0.3, 0.6, 1), strict=True):
                    self.assertAlmostEqual(one, wanted, delta=1e-15)
        self.expect(self.run_scene(scene("Number: 1, Load Factors: [0.5, 2]"), code=BAD_INPUT), '"Analysis / Modes / Load Factors"',
                    "no load factor of the path")

    def test_they_keep_their_numbers_where_frequencies_cross(self):
        """Bending falls with the load through the frequency of torsion, pi/2 sqrt(GIt/J1), between load factors 0.5 and 0.6: its column stays
        that of torsion, also in a run that goes on after the crossing or before it."""
        text = scene("Number: 3, At: every step", ", Mass: 1, Rotary Inertia: [2e-4, 1e-4, 1e-4]", """Supports:
    hinge: {Point: wall, Fixed Displacement: [x, y, z], Fixed Rotation: [x]}
    slide: {Point: tip, Fixed Displacement: [y, z], Fixed Rotation: []}
  Point Loads: {push: {Point: tip, Force: [-9, 0, 0]}}""", "Solver: {Load Path: {Method: fixed, Steps: 5}}")
        self.expect(self.run_scene(changed(text, "GIt: 1, EI2: 1, EI3: 1", "GIt: 4e-3, EI2: 1, EI3: 1.1")), "frequencies over the path", "motion 3")
        table, torsion = "results/scene-frequencies.csv", 0.5 * math.pi * math.sqrt(4e-3 / 2e-4)
        whole, rows = self.text(table), self.rows(table)
        self.assertEqual(",".join(rows[0]), "step,load_factor,omega_1,omega_2,omega_3,frequency_1,frequency_2,frequency_3")
        self.assertEqual(len(rows), 6)
        for step, row in enumerate(rows):
            self.assertAlmostEqual(float(row["omega_1"]), torsion, delta=1e-8 * torsion)
            self.assertEqual(float(row["omega_2"]) < torsion, step >= 3)  # the twin: by their order the columns would change places
        for step in ("2", "4"):
            self.mixbeam("resume", "results/scene.h5", "--from", step)
            self.assertEqual(self.text(table), whole, step)

    def test_what_has_no_meaning_is_refused(self):
        lopsided = ", Mass: 1, Rotary Inertia: [1, 1, 3]"
        for text, *parts in (
                (scene("Number: 1", ""), '"Scene / Sections / rod / Mass"', "missing"),
                (scene("Number: 1", ", Mass: -1"), '"Scene / Sections / rod / Mass"', "-1"),
                (scene("Number: 1", lopsided), "Rotary Inertia", "larger than the sum of the others"),
                (scene("Number: 1", ", Rotary Inertia: [2, 1, 1]"), 'given without "Mass"'),
                (scene("Number: 1", supports=clamp_and("Point Masses: {body: {Point: tip, Mass: 1, Inertia: [1, 1, 3]}}")),
                 '"Scene / Point Masses / body / Inertia"', "larger than the sum of the others"),
                (scene("Number: 900"), '"Analysis / Modes / Number"', "unknowns carry mass"),
                (scene("Number: 1", ", Mass: 1, Damping: {Beta: -1}"), '"Scene / Sections / rod / Damping / Beta"', "-1"),
                (scene("Number: 1", more="Quantities: {f: {Quantity: natural frequency, Mode: 2}}"), '"Quantities / f / Mode"', "allowed: up to"),
                (scene("Number: 1" + PLANE, supports=clamp_and("Point Loads: {twist: {Point: tip, Moment: [1, 0, 0]}}")), "In Plane",
                 "keeps to no plane"),
                (scene("Number: 1" + PLANE, ", Mass: 1, Mass Offset: [0.1, 0.1]"), "In Plane", "inertia of a section is not symmetric")):
            self.expect(self.run_scene(text, code=BAD_INPUT), *parts)
        self.expect(self.run_scene(scene("Number: 1", lopsided), code=BAD_INPUT), without=["missing"])

    def test_bodies_in_an_inclined_plane(self):
        """Turned about x by 45 degrees as in that of x and y; values of a spectral program."""
        def frame(tip, normal, inertia="[0.1, 0.1, 0.1]", code=0):
            mesh = f"Second Axis: {normal}, Order: 4, Elements: 4"
            return self.run_scene(f"""Scene:
  Sections: {{rod: {{EA: 1e4, GA2: 1e4, GA3: 1e4, GIt: 10, EI2: 10, EI3: 10, Mass: 1}}}}
  Points: {{wall: [0, 0, 0], corner: [1, 0, 0], tip: {tip}}}
  Members: {{one: {{Start: wall, End: corner, {mesh}}}, two: {{Start: corner, End: tip, {mesh}}}}}
  Supports: {{wall: {{Point: wall}}}}
  Point Masses: {{body: {{Point: tip, Mass: 1, Inertia: {inertia}}}}}
Analysis: {{Modes: {{Number: 2, In Plane: true}}}}
""", code=code)
        inclined = "[1, 0.7071067811865476, 0.7071067811865476]", "[0, -1, 1]"
        for plane in (("[1, 1, 0]", "[0, 0, 1]"), inclined):
            self.expect(frame(*plane), "2.044734", "6.016521")
        self.expect(frame(*inclined, "[0.1, 0.1, 0.15]", BAD_INPUT), "In Plane", "inertia of a body is not symmetric")

    def test_in_plane_under_loads_along_members_that_follow(self):
        """They have no planar equations; their structures keep to their plane all the same. Of a cantilever under next to no load: 1.8751^2 and
        4.6941^2 over 2 pi, each of them twice in space."""
        def pushed(force, modes, code=0):
            load = f"Distributed Loads: {{p: {{Member: beam, Frame: follower, Force: {force}}}}}"
            return self.run_scene(scene(modes, supports=clamp_and(load)), code=code)
        second = "3.50689"
        self.expect(pushed("[-1e-6, 0, 0]", "Number: 2" + PLANE), "0.55959", second)
        self.expect(pushed("[-1e-6, 0, 0]", "Number: 2"), "0.55959", without=[second])
        self.expect(pushed("[0, -1e-6, 1e-6]", "Number: 2" + PLANE, BAD_INPUT), "In Plane", "keeps to no plane")

    def test_columns_flutter_under_loads_that_follow(self):
        """Beck's column at 20.0509536 EI/L^2, of a section that is not quite rigid."""
        def ended(load, code):
            thrust = f"Point Loads: {{p: {{Point: tip, Member: beam, Frame: follower, Force: [-{load}, 0, 0]}}}}"
            falls = "Expected: {falls: {Quantity: stable, Value: false, Source: Beck 1952}}"
            return self.run_scene(scene("Number: 2" + PLANE, supports=clamp_and(thrust), more=falls), code=code)
        self.expect(ended(30, 0), "flutter at load factor 0.66836", "omega 11.0155", "grows as exp(7.10", "stable: false")
        self.expect(ended(20, CHECK_FAILED), "stable: true", without=["flutter"])

    def test_shafts_on_an_inclined_axis(self):
        """Seen from a frame that turns about the shaft its frequency is pi^2 less and more the angular velocity; the forces on it are those of
        rounding. A disc, m = 1, J = 0.02, on a shaft without mass: |w - 1.5| of z = y + iz with 2 x 2 matrices."""
        def turning(velocity, stiffness, mesh, rest):
            return self.run_scene(f"""Scene:
  Rotating Frame: {{Axis: [1, 2, 2], Angular Velocity: {velocity}}}
  Sections: {{rod: {{{stiffness}, EI2: 1, EI3: 1}}}}
  Points: {{a: [0, 0, 0], b: [0.3333333333333333, 0.6666666666666666, 0.6666666666666666]}}
  Members: {{shaft: {{Start: a, End: b, {mesh}}}}}
  {rest}
""")
        axes = "Axes: [1, 2, 2, -2, -1, 2], Fixed Rotation: [x]"
        self.expect(turning(3, "Inextensible: true, Shear Rigid: true, GIt: 1, Mass: 1", "Order: 5, Elements: 4", f"""Supports:
    a: {{Point: a, {axes}}}
    b: {{Point: b, Fixed Displacement: [y, z], {axes}}}
Analysis: {{Modes: {{Number: 2}}}}"""), "6.869604", "12.8696")
        self.expect(turning(1.5, "Inextensible: true, Shear Rigid: true, GIt: 1000", "Order: 4, Elements: 2", """Supports: {a: {Point: a}}
  Point Masses: {disc: {Point: b, Mass: 1, Inertia: [0.02, 0.02, 0.02]}}
Analysis: {Modes: {Number: 4}}"""), "0.2269421401", "3.160560689", "13.69925689", "15.26563834")

    def test_bodies_at_points(self):
        """A point mass is heavy where Gravity acts, and bodies may carry all of the mass: sqrt(3 EI / m L^3), and the reaction; sqrt(GIt / J1 L),
        sqrt(EI / J2 L) of a body without mass."""
        for number, masses, *words in ((2, "{body: {Point: tip, Mass: 2}}\n  Gravity: {Acceleration: [0, 0, -0.001]}", "1.22474", "0.002"),
                                       (3, "{disc: {Point: tip, Inertia: [1, 0.5, 0.5]}}", "0.1591549431", "0.22507907")):
            self.expect(self.run_scene(scene(f"Number: {number}", "", clamp_and(f"Point Masses: {masses}"))), *words)


if __name__ == "__main__":
    unittest.main()
