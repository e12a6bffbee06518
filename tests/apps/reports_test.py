#!/usr/bin/python3
"""What `mixbeam run` says of stresses and strains, and where a path passes near a singular point: answers, files, exit codes, words. The
answers of the solver itself are in tests/problems.

usage: reports_test.py MIXBEAM [CLASS]...
"""

import math
import unittest

import h5py
import numpy as np
from support import BAD_INPUT, CHECK_FAILED, InFolder, changed

CIRCLE = "Shape: circle, Diameter: 0.02"
FORCE = "Force: [0, 0, -10]"
LARGEST = 32 * 10 / (math.pi * 0.02**3)  # M c / I at the clamp, tension on the upper side


def cantilever(shape=CIRCLE, load=FORCE, lists="", strength="", member="", section=""):
    """Of length 1 along x, with a load at its tip."""
    return f"""Scene:
  Sections: {{rod: {{{shape}, Material: {{E: 210e9, nu: 0.3{strength}}}{section}}}}}
  Points: {{wall: [0, 0, 0], tip: [1, 0, 0]}}
  Supports: {{clamp: {{Point: wall}}}}
  Members: {{beam: {{Start: wall, End: tip, Section: rod, Second Axis: [0, 1, 0], Elements: 10{member}}}}}
  Point Loads: {{load: {{Point: tip, {load}}}}}
{lists}
"""


def stresses(choice):
    return f"Analysis: {{Stresses: '{choice}'}}"


class Stresses(InFolder):
    def numbers(self, name):
        with h5py.File(self.folder / "results/scene.h5") as file:
            return file[f"steps/000001/{name}"][()].ravel()

    def test_the_most_stressed_members_are_named(self):
        self.expect(self.run_scene(cantilever(strength=", Strength: 1e8")), "largest stress in", "beam", "1.27324e+07", "0.01", "utilisation",
                    "0.127", without=["warning"])
        self.assertAlmostEqual(self.numbers("von_mises_stress")[0], LARGEST, delta=1e-5 * LARGEST)
        # at the tip Q alone: (3 + 2 nu) / (8 (1 + nu)) Q a^2 / I in the middle, by sqrt(3)
        shear = 3.6 / 10.4 * 10 * 4 / (math.pi * 1e-4)
        self.assertAlmostEqual(self.numbers("largest_shear_stress")[-1], shear, delta=1e-4 * shear)
        self.expect(self.contents(), without=["steps/000000/von_mises_stress"])  # of the end of the path only

    def test_they_stand_in_the_xdmf_file(self):
        """What ParaView shows: stresses where the file has them, of runs that are gone on with too."""
        self.run_scene(cantilever(strength=", Strength: 1e8"))
        np.testing.assert_allclose(self.numbers("utilisation"), self.numbers("von_mises_stress") / 1e8, rtol=1e-15)
        text = self.text("results/scene.xdmf")
        self.expect(text, "scene.h5:/steps/000001/utilisation", "scene.h5:/steps/000001/von_mises_stress",
                    without=["/steps/000000/von_mises_stress"])  # of the end of the path only
        (self.folder / "results/scene.xdmf").unlink()
        self.mixbeam("resume", "results/scene.h5")
        self.assertEqual(self.text("results/scene.xdmf"), text)

    def test_every_step_or_none(self):
        self.run_scene(cantilever(lists=stresses("every step")))
        self.expect(self.contents(), "steps/000000/von_mises_stress")
        self.expect(self.text("results/scene.xdmf"), "/steps/000000/von_mises_stress", "/steps/000001/von_mises_stress",
                    without=["utilisation"])  # no strength is given
        self.expect(self.run_scene(cantilever(lists=stresses("off"))), without=["largest stress"])
        self.expect(self.contents(), without=["steps/000001/von_mises_stress"])
        self.expect(self.run_scene(cantilever(lists=stresses("evry step")), code=BAD_INPUT), "Stresses", "evry step", "every step")

    def test_none_for_sections_without_shape(self):
        stiffnesses = ", ".join(f"{name}: 1e3" for name in ("EA", "GA2", "GA3", "GIt", "EI2", "EI3"))
        text = changed(cantilever(stiffnesses), ", Material: {E: 210e9, nu: 0.3}", "")
        self.expect(self.run_scene(text), without=["largest stress"])
        self.expect(self.contents(), without=["steps/000001/von_mises_stress"])

    def test_warnings_of_strains_and_of_thick_curved_members(self):
        arc = ", Curve: {Shape: arc, Center: [0.5, 0, 0], Axis: [0, 1, 0], Angle: 3.141592653589793}"
        self.expect(self.run_scene(cantilever("Shape: circle, Diameter: 0.2", member=arc)), 'warning: member "beam" is curved', "15 %",  # 3 d / (8 R)
                    without=["is strained by"])
        roll = "Moment: [0, 16493.361431346415, 0]"  # EI2 * 10: radius 0.1
        self.expect(self.run_scene(cantilever(load=roll)), 'warning: member "beam" is strained by 10 %', "more than 5 %", "Largest Strain")
        self.expect(self.run_scene(cantilever(load=roll, section=", Largest Strain: 0.2")), without=["is strained by"])

    def test_warning_of_utilisation_above_one(self):
        self.expect(self.run_scene(cantilever(strength=", Strength: 1.25e7")), 'warning: member "beam" is stressed beyond the "Strength"',
                    "utilisation 1.02 at s = 0", "1 warning")
        self.expect(self.run_scene(cantilever(strength=", Strength: 1.3e7")), without=["warning"])

    def test_torsion_of_open_sections_is_noted(self):
        profile = "Shape: I, Width: 0.1, Height: 0.2, Flange: 0.0085, Web: 0.0056"
        self.expect(self.run_scene(cantilever(profile, "Moment: [100, 0, 0]")), "torsion makes 100 %", "warping")
        self.expect(self.run_scene(cantilever(profile)), without=["warping"])


def column(force, lists=""):
    """An inextensible cantilever of length and stiffness 1 along x, in the plane, under this force at its tip."""
    return f"""Scene:
  Sections: {{rod: {{Inextensible: true, Shear Rigid: true, GIt: 1, EI2: 1, EI3: 1}}}}
  Points: {{clamp: [0, 0, 0], tip: [1, 0, 0]}}
  Members: {{rod: {{Start: clamp, End: tip, Section: rod, Order: 5, Elements: 16}}}}
  Supports: {{clamp: {{Point: clamp}}, plane: {{Point: tip, Fixed Displacement: [z], Fixed Rotation: [x, y]}}}}
  Point Loads: {{load: {{Point: tip, Force: [{force}]}}}}
{lists}
"""


def expected(quantity, value, tolerance="1e-8"):
    """By shooting on the rod equations."""
    return f"Expected: {{value: {{Quantity: {quantity}, Value: {value}, Absolute Tolerance: {tolerance}, Source: shooting}}}}\n"


ACROSS = "displacement, Point: tip, Component: y"
JUMP = "Analysis: {Snap: jump}\n"


class SingularPaths(InFolder):
    def test_the_imperfect_column_ends_on_its_side(self):
        """1.2 times Euler's load and a hundredth of it across."""
        for value, code in (("0.65716809204", 0), ("0.65717", CHECK_FAILED)):
            self.run_scene(column("-2.9608813203268074, 0.029608813203268074, 0", expected(ACROSS, value)), code=code)

    def test_a_displacement_that_the_load_does_not_move_is_named(self):
        """The straight column is not moved sideways by its thrust, so no displacement there can be driven by it."""
        for component in "yx":
            self.write_scene(column("-1, 0, 0", f"Analysis: {{Control: {{Point: tip, Component: {component}, Target: -0.1}}}}"))
            still = self.ended("run", "scene.yaml", "--output", "results")
            self.assertIn(still.returncode, (2, 3))
            self.expect(still.stdout + still.stderr, "not move", "tip", without=["in 0 iterations"])

    def test_jumps_are_told_and_counted(self):
        self.expect(self.run_scene(column("-4, 0, 0", JUMP + expected("jumps", 1))), "scene: jump between load factors ", "energy released ",
                    'point "tip"', "stable: true")
        self.expect(self.text("summary.json"), '"jumps"', '"energy_released"', '"from_load_factor"')
        self.expect(self.text("results/scene-monitor.csv"), "jump.energy_released", "jump.largest_displacement", "jumps")
        for load, code in ((4, CHECK_FAILED), (2, 0)):
            self.run_scene(column(f"-{load}, 0, 0", JUMP + expected("jumps", 0)), code=code)

    def test_jumps_need_a_potential(self):
        twisted, traced = changed(column("0, 0, 1", JUMP), "Force", "Moment"), column("-4, 0, 0", "Analysis: {Snap: jump, Trace: true}")
        for text, *parts in ((twisted, "scene.yaml:", '"Scene / Point Loads / load / Moment"', "no potential", "allowed: dead"),
                             (traced, '"Analysis / Trace"', "allowed: false"),
                             (changed(traced, "jump", "jmup"), '"Analysis / Snap"', 'did you mean "jump"?')):
            self.expect(self.run_scene(text, code=BAD_INPUT), *parts)

    def test_a_batch_of_imperfect_columns(self):
        """P from 2 to 6 with a force across of 0.01: y of the tip by shooting."""
        vary = "Batch: {Output: expected, Vary: {P: {Parameter: 'Point Loads/load/Force[0]', First: -2, Last: -6, Count: 5}}}"
        self.write_scene(column("-1, 0.01, 0", expected(ACROSS, 0.1, tolerance=10) + vary))
        self.mixbeam("batch", "scene.yaml", "--output", "results")
        np.testing.assert_allclose([float(row["value"]) for row in self.rows("results/scene-batch.csv")],
                                   [0.01738200818, 0.66614571490, 0.80251319246, 0.79535909617, 0.76109671324], rtol=0, atol=1e-8)

    def test_a_dome_whose_path_returns_is_followed_again_more_closely(self):
        """Three legs, nearly symmetric: the path comes close to others, and the first pass changes to one of them and returns to an earlier state.
        Height of the apex at the end, that of the minimum of energy that Snap = jump finds; the two share no step."""
        legs = (0.9766109484880079, 0.21501408161642258), (-0.6745131310952063, 0.7382628501964196), (-0.30209781739280145, -0.9532769318128419)
        points = "".join(f"    foot{i}: [{x}, {y}, 0]\n" for i, (x, y) in enumerate(legs))
        members = "".join(f"    leg{i}: {{Start: foot{i}, Second Axis: [{-y}, {x}, 0], End: apex, Order: 5, Elements: 6}}\n"
                          for i, (x, y) in enumerate(legs))
        for value, more, code in (("-0.5682796882", "", 0), ("-0.5682796882", JUMP, 0), ("-0.5682", "", CHECK_FAILED)):
            self.run_scene(f"""Scene:
  Sections: {{rod: {{EA: 3000, GA2: 1500, GA3: 1500, GIt: 0.8, EI2: 1, EI3: 1}}}}
  Points:
    apex: [0, 0, 0.3]
{points}  Members:
{members}  Supports: {{feet: {{Point: "foot*"}}}}
  Point Loads: {{load: {{Point: apex, Force: [0.009632480637501132, -0.023869332136037428, -52.4]}}}}
{more}{expected("displacement, Point: apex, Component: z", value, "1e-7")}""", code=code)


if __name__ == "__main__":
    unittest.main()
