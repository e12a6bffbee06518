#!/usr/bin/python3
"""Answers that a scene gets unasked: its mesh, buckling about a prestressed state, the load at which it collapses, a report.

usage: answers_test.py MIXBEAM PACKAGES     the program, and the folder in which the package mixbeam lies
"""

import csv
import json
import math
import re
import resource
import sys
import unittest

from support import InFolder

sys.path.insert(0, sys.argv.pop(1))

import numpy as np  # noqa: E402

import mixbeam  # noqa: E402

ACCURACY = 1e-4     # of a scene that names no mesh (mesh_choice.hpp)
SLENDER = 1e-6      # EI/(EA L^2): what closed forms of inextensible columns leave out, times pi^2
EULER = math.pi**2 / 4  # EI / L^2 of a cantilever
LARGEST_PAGE, LONGEST_REPORT = 2_000_000, 20.0  # bytes, seconds of the processor: of seven cases (issue 35)
MOST_LINES = 80     # of seven cases on the terminal
FAILED = 1          # exit code of a check that failed

ROD = """Scene:
  Sections:
    rod: {EA: 1e6, GA2: 1e6, GA3: 1e6, GIt: 1, EI2: 1, EI3: 1}
  Points: {wall: [0, 0, 0], tip: [1, 0, 0]}
  Members:
    rod: {Start: wall, End: tip%s}
  Supports: {wall: {Point: wall}}
"""
ROLLED_UP = ROD + "  Point Loads: {end: {Point: tip, Moment: [0, 0, %s]}}\n"
FRAME = """Report: {Title: Portal <b>frame</b>, Project: "2026-117", Author: A. Engineer}
Scene:
  Units: m, N
  Load Cases: [dead, snow, wind]
  Combinations:
    first: {dead: 1.35, snow: 1.5}
    second: {dead: 1.35, wind: 1.5}
    third: {dead: 1.35, snow: 1.5, wind: 0.9}
    fourth: {dead: 1.35, snow: 0.75, wind: -1.5}
  Sections:
    s: {Shape: I, Width: 0.15, Height: 0.3, Flange: 0.0107, Web: 0.0071, Material: {E: 210e9, nu: 0.3, Strength: 235e6}}
  Points: {a: [0, 0, 0], b: [0, 0, 4], c: [6, 0, 4], d: [6, 0, 0]}
  Members:
    left: {Start: a, End: b, Second Axis: [0, 1, 0]}
    beam: {Start: b, End: c, Second Axis: [0, 1, 0]}
    right: {Start: d, End: c, Second Axis: [0, 1, 0]}
  Supports: {a: {Point: a}, d: {Point: d}}
  Point Loads:
    w: {Point: b, Force: [20000, 0, 0], Case: wind}
  Distributed Loads:
    g: {Member: beam, Force: [0, 0, -10000], Case: dead}
    q: {Member: beam, Force: [0, 0, -12000], Case: snow}
Quantities:
  sway: {Quantity: displacement, Point: c, Component: x, Limit: 0.008}
  stress: {Quantity: von Mises stress, Member: "*", Take: largest, Limit: 300e6}
"""


def column(first, second, more=""):
    """A cantilever of length and EI one, that a dead force presses in stage 1, another one in stage 2, in units of Euler's load."""
    return f"""Scene:
  Sections:
    rod: {{EA: {1 / SLENDER}, GA2: {1 / SLENDER}, GA3: {1 / SLENDER}, GIt: 1, EI2: 1, EI3: 1.5}}
  Points: {{foot: [0, 0, 0], top: [0, 0, 1]}}
  Members: {{column: {{Start: foot, End: top, Order: 5, Elements: 3}}}}
  Supports: {{foot: {{Point: foot}}}}
  Point Loads:
    first: {{Point: top, Force: [0, 0, {-first * EULER}]}}
    second: {{Point: top, Force: [0, 0, {-second * EULER}], Stage: 2}}
Analysis: {{Buckling Modes: 2}}
{more}"""


class Answers(InFolder):
    def solved(self, text, *words, code=0):
        (self.folder / "scene.yaml").write_text(text)
        return self.mixbeam("run", "scene.yaml", "--output", ".", *words, code=code)

    def results(self, case=""):
        return mixbeam.open(self.folder / f"scene{case and '-'}{case}.h5")

    def mesh_of(self, case=""):
        rod = self.results(case).members["rod"]
        return rod.order, rod.elements

    def rows(self, name):
        return list(csv.DictReader((self.folder / f"scene-{name}.csv").read_text().splitlines()))


class MeshOfASceneWithoutOne(Answers):
    def test_a_roll_up_is_right_and_one_element_is_not(self):
        moment = 4 * math.pi  # two turns: the tip is back at the wall
        out = self.solved(ROLLED_UP % ("", moment))
        self.assertIn("no mesh is given: chosen for an accuracy of 1.0e-04", out)
        self.assertLess(self.off(), ACCURACY)
        self.solved(ROLLED_UP % (", Order: 2, Elements: 1", moment))
        self.assertGreater(self.off(), 0.1)

    def off(self, case=""):
        """Of a tip that two turns have brought back to the wall."""
        return np.linalg.norm(self.results(case).displacement("tip") - [-1, 0, 0])

    def test_rigid_arms_name_none(self):
        arms = ", Start Offset: [0, 0, 0.3], End Offset: [0, 0, 0.3]"
        expected = f"Expected: {{back: {{Quantity: displacement, Point: tip, Component: x, Value: -1, Absolute Tolerance: {ACCURACY}, Source: circle}}}}\n"
        for mesh, is_right in (("", True), (", Order: 2, Elements: 1", False)):
            text = ROLLED_UP % (arms + mesh, 4 * math.pi) + expected  # two turns about an axis along the arms
            self.assertEqual("no mesh is given" in self.solved(text, code=0 if is_right else 1), is_right)

    def test_what_is_given_is_kept(self):
        for mesh, size in ((", Order: 3", (3, 1)), (", Elements: 5", (2, 5)), (", Stations: [0, 0.3, 1]", (2, 2))):
            self.assertNotIn("no mesh is given", self.solved(ROLLED_UP % (mesh, 0.5)))
            self.assertEqual(self.mesh_of(), size)

    def test_check_says_where_it_starts(self):
        (self.folder / "scene.yaml").write_text(ROLLED_UP % ("", 0.5))
        self.assertIn("no mesh is given: a run chooses one for an accuracy of 1.0e-04, from this one on", self.mixbeam("check", "scene.yaml"))

    def test_cases_share_the_mesh_of_the_worst(self):
        """The last case turns the rod twice, the first hardly."""
        text = ROD % "" + "  Load Cases: [small, middle, large]\n  Point Loads:\n" + "".join(
            f"    {name}: {{Point: tip, Moment: [0, 0, {moment}], Case: {name}}}\n"
            for name, moment in (("small", 0.01), ("middle", 1), ("large", 4 * math.pi)))
        out = self.solved(text)
        self.assertEqual(out.count("no mesh is given"), 1)
        mesh = self.mesh_of("large")
        self.assertEqual([self.mesh_of("small"), self.mesh_of("middle")], [mesh] * 2)
        self.assertLess(self.off("large"), ACCURACY)
        for words in (("--jobs", "2"), ("--case", "small")):  # the same whoever solves it, alone or beside others
            self.solved(text, *words)
            self.assertEqual(self.mesh_of("small"), mesh)

    def test_rows_of_a_batch_share_it(self):
        (self.folder / "scene.yaml").write_text(ROLLED_UP % ("", 0.1) + """Batch:
  Vary:
    moment: {Parameter: "Point Loads/end/Moment[2]", First: 0.1, Last: 12.566370614359172, Count: 5}
""")
        text = self.mixbeam("batch", "scene.yaml", "--output", ".", "--summary", "sum.json")
        self.assertEqual(text.count("no mesh is given"), 1)
        self.assertLess(abs(float(self.rows("batch")[-1]["tip.displacement.x"]) + 1), ACCURACY)

    def test_where_no_mesh_can_be_searched_the_run_goes_on_with_a_note(self):
        out = self.solved(ROD % "" + "  Point Loads: {end: {Point: tip, Force: [0, 0.5, 0]}}\nAnalysis: {Snap: jump}\n")
        self.assertIn("by the sizes of the loads alone: a path that jumps has no error estimate", out)

    def test_a_run_goes_on_with_the_mesh_of_its_file(self):
        self.solved(ROLLED_UP % ("", 4 * math.pi) + "Solver: {Load Path: {Method: fixed, Steps: 4}}\n")
        mesh, tip = self.mesh_of(), self.results().displacement("tip")
        self.assertNotIn("no mesh is given", self.mixbeam("resume", "scene.h5", "--from", "2"))
        self.assertEqual(self.mesh_of(), mesh)
        np.testing.assert_array_equal(self.results().displacement("tip"), tip)

    def test_a_loop_over_loads_chooses_once(self):
        scene = mixbeam.Scene.from_text(ROLLED_UP % ("", 3.0))
        reports = []
        for moment in (3.0, 2.0, 1.0):
            scene.point_loads["end"].moment = 0, 0, moment
            reports.append(mixbeam.run(scene).report)
        self.assertEqual([report.count("no mesh is given") for report in reports], [1, 0, 0])
        scene.members["rod"].twist = 0.1  # another structure
        self.assertIn("no mesh is given", mixbeam.run(scene).report)
        scene.point_loads["end"].moment = 0, 0, 8 * math.pi  # beyond what the mesh was chosen for: told, then chosen anew
        first, second = mixbeam.run(scene), mixbeam.run(scene)
        self.assertIn("the estimated error of displacements is", first.report)
        self.assertIn("no mesh is given", second.report)


class BucklingAboutAState(Answers):
    def factors(self):
        run = self.results()
        last = max(step for step in range(len(run)) if run.load_factors[step] == 1.0)
        return ([mode.load_factor for mode in run.buckling_modes(1)], [mode.load_factor for mode in run.buckling_modes(2, step=last)])

    def test_a_column_that_carries_a_load_already(self):
        """P1 + mu P2 = Euler's load: closed form, whether the first load presses or pulls; with the second axis 1.5 times that."""
        for first, second in ((0.4, 0.5), (-1.0, 1.0)):
            out = self.solved(column(first, second))
            undeformed, loaded = self.factors()
            self.assertAlmostEqual(abs(undeformed[0]), 1 / abs(first), delta=20 * SLENDER / abs(first))
            for factor, euler in zip(sorted(loaded), (1.0, 1.5)):
                self.assertAlmostEqual(factor, (euler - first) / second, delta=20 * SLENDER * euler / second)
            self.assertIn("linear buckling about the end of stage 1, at factors of the loads of stage 2", out)
            # a twin: the factor of the second load alone is another one
            self.assertGreater(abs(loaded[0] - 1.0 / second), 0.1)

    def test_the_last_lines_name_the_collapse(self):
        out = self.solved(column(0.4, 0.5)).splitlines()
        self.assertRegex(out[-2], r"^scene: collapse: none up to load factor 2; linear buckling about the end of stage 1, times the loads "
                                  r"of the next: 1\.2\d*, its mode moves member column at s = 1 most$")
        out = self.solved(column(0.4, 1.0), "--summary", "sum.json").splitlines()
        self.assertRegex(out[-2], r"^scene: collapse: bifurcation at load factor 1\.6\d*, its mode moves member column at s = 1 most$")
        self.assertIn("bifurcation", json.loads((self.folder / "sum.json").read_text())["ends"][0]["collapse"])


class SevenCases(Answers):
    def test_terminal_and_report(self):
        out = self.solved(FRAME, code=FAILED)
        lines = out.splitlines()
        self.assertLessEqual(len(lines), MOST_LINES)
        first = next(i for i, line in enumerate(lines) if line.startswith("envelope of the ends"))
        self.assertLess(first, next(i for i, line in enumerate(lines) if "largest displacement" in line))
        self.assertEqual(sum("largest displacement" in line for line in lines), 7)
        self.assertEqual([row["passed"] for row in self.rows("second-limits")], ["NO", "yes"])
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        self.mixbeam("report", "scene.h5")
        self.assertLess(resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before, 2 * LONGEST_REPORT)  # caches are shared
        page = (self.folder / "scene-report.html").read_text()
        self.assertLess(len(page), LARGEST_PAGE)
        for words in ("Portal &lt;b&gt;frame&lt;/b&gt;", "2026-117", "A. Engineer", "SHA-256", "limits are exceeded",
                      "1.35 dead + 0.75 snow - 1.5 wind", "Mesh chosen for an accuracy", "Case fourth", "Largest displacement"):
            self.assertIn(words, page)
        rows = re.findall(r"<td[^>]*>([^<]*)</td></tr>", page[page.index("limits are exceeded"):page.index("Envelope</h2>")])
        self.assertEqual(rows, sorted(rows))  # NO before yes
        self.assertIn("NO", rows)
        self.assertIn("yes", rows)


ARM = """Scene:
  Sections: {rod: {Shape: circle, Diameter: 0.1, Material: {E: 1e9, nu: 0.3}}}
  Points: {A: [0, 0, 0], B: [2, 0, -0.5]}
  Members: {m: {Start: A, End: B, Order: 4, Elements: 8, Start Offset: [0, 0, 0.3], End Offset: [0, 0, 0.8]}}
  Supports: {clamp: {Point: A}}
  Point Loads: {p: {Point: B, Force: [600, 300, -200]}}
Quantities:
  moment: {Quantity: reaction moment, Point: A}
  moved: {Quantity: displacement, Point: B}
  end: {Quantity: displacement, Point: end of m}
  turned: {Quantity: rotation, Point: B}
"""
BLADE = """Scene:
  Sections:
    s: {Matrix: [1e3, 0, 0, 0, 0, 0, 1e3, 0, 0, 0, 0, 1e3, 0, 0, 0, 2, 0, 0, 4, 0, 5],
        Stress Points: {%s}}
  Points: {wall: [0, 0, 0], tip: [1, 0, 0]}
  Members: {m: {Start: wall, End: tip, Section: s, Order: 2, Elements: 4, Second Axis: [0, 1, 0]}}
  Supports: {wall: {Point: wall}}
  Point Loads: {end: {Point: tip, Moment: [0, 0, 3]}}
Quantities:
  stress: {Quantity: normal stress, Member: "*", Take: largest size}
"""
ROUNDING = 1e-9  # of numbers of size one: scaled residual of 1e-11, and room


class Sections(Answers):
    def last(self, text):
        """{column of the monitor: value at the end}"""
        self.solved(text)
        return {name: float(value) for name, value in self.rows("monitor")[-1].items() if re.fullmatch(r"[-+.e\d]+", value)}

    def test_rigid_arms_turn_with_their_points(self):
        last = self.last(ARM)
        moved, end, turned, moment = (np.array([last[f"{name}.{i}"] for i in "xyz"]) for name in ("moved", "end", "turned", "moment"))
        place = np.array([2, 0, -0.5]) + moved
        np.testing.assert_allclose(moment, -np.cross(place, [600, 300, -200]), rtol=0, atol=600 * ROUNDING)  # statics
        arm, angle = np.array([0, 0, 0.8]), np.linalg.norm(turned)
        axis = turned / angle
        rotated = arm * math.cos(angle) + np.cross(axis, arm) * math.sin(angle) + axis * (axis @ arm) * (1 - math.cos(angle))
        np.testing.assert_allclose(end - moved, rotated - arm, rtol=0, atol=ROUNDING)
        self.assertGreater(np.abs(end - moved).max(), 0.05)  # a twin: an arm that does not turn

    def test_stresses_of_a_matrix(self):
        """Pure bending: kappa3 = M / EI3 everywhere, whatever the rotation."""
        by_strain = self.last(BLADE % "E: 50, Points: {edge: [0.02, 0.3], other: [-0.01, 0]}")
        self.assertAlmostEqual(abs(by_strain["stress"]), 50 * 3 / 5 * 0.02, delta=ROUNDING)
        recovered = self.last(BLADE % "Points: {cap: [0.1, 0.2]}, Recovery: {cap: [31, 1, 2, 3, 800, 7.5]}")
        self.assertAlmostEqual(abs(recovered["stress"]), 7.5 * 3, delta=ROUNDING)
        self.assertNotAlmostEqual(abs(recovered["stress"]), abs(by_strain["stress"]), delta=1)


if __name__ == "__main__":
    unittest.main()
