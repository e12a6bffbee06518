#!/usr/bin/python3
"""`mixbeam batch`: many cases at once against single runs and closed forms, cases that fail, tables that are wrong.

usage: batch_test.py MIXBEAM [CLASS]...
"""

import math
import shutil
import unittest

import yaml
from support import BAD_INPUT, CHECK_FAILED, NO_CONVERGENCE, PROGRAM, ROOT, InFolder, changed, scene_of, with_lists

TABLE = (ROOT / "apps/batch/elastica_sweep.csv").read_text()
MPIRUN = "mpirun", "--allow-run-as-root", "--oversubscribe", "--bind-to", "none", "-np"
FORCE = "Point Loads/weight/Force[1]"


def sweep(more="{}", removed=()):
    return with_lists(scene_of("apps/batch/elastica_sweep.xml"), more, removed)


def with_batch(entries):
    """The sweep's scene with another list "Batch"."""
    return sweep(f"Batch: {{{entries}}}", ["Batch"])


def with_accuracy(accuracy, division):
    """The sweep with an accuracy, its members with this in place of order and elements."""
    scene = yaml.safe_load(sweep())
    strip = scene["Scene"]["Members"]["strip"]
    del strip["Order"], strip["Elements"]
    return with_lists(yaml.dump(scene), f"Scene: {{Accuracy: {accuracy}, Members: {{strip: {{{division}}}}}}}")


class BatchCase(InFolder):
    def solve(self, scene, table="", *words, code=0):
        self.write("scene.yaml", scene)
        if table:
            self.write("elastica_sweep.csv", table)
        return self.mixbeam("batch", "scene.yaml", "--output", "results", *words, code=code)

    def found(self, name="scene-batch"):
        return self.rows(f"results/{name}.csv")

    def column(self, name):
        return [row[name] for row in self.found()]

    def numbers(self, name):
        return [float(cell) for cell in self.column(name)]


class Cases(BatchCase):
    def test_each_case_chooses_its_mesh_for_an_accuracy(self):
        self.expect(self.solve(with_accuracy("1e-9", ""), TABLE), "15 of 15 checks passed", "40 cases, 0 failed")

    def test_cases_that_miss_the_accuracy_fail(self):
        """The twin: two elements of order 2 are not enough for the larger loads."""
        self.solve(with_accuracy("1e-2", "Order: 2, Elements: 2"), TABLE, code=NO_CONVERGENCE)
        found = self.found()
        self.assertEqual((len(found), found[0]["converged"], found[-1]["converged"]), (40, "yes", "no"))
        self.expect(found[-1]["cause"], "accuracy of 1.0e-02")

    def test_a_table_of_loads_gives_the_elastica(self):
        self.expect(self.solve(sweep(), TABLE), "15 of 15 checks passed", "40 cases, 0 failed", "group   1 of")
        found = self.found()
        self.assertEqual((len(found), found[7][FORCE], found[7]["converged"]), (40, "-2", "yes"))
        self.expect(self.contents("results/scene-batch.h5"), f"columns/{FORCE}", "columns/tip turns", "columns/converged", "scene")

    def test_a_wrong_closed_form_is_found(self):
        self.expect(self.solve(sweep(), changed(TABLE, "-0.8106090", "-0.8106091"), code=CHECK_FAILED), "14 of 15 checks passed")

    def test_variables_vary_with_all_that_comes_of_them(self):
        """Whatever a formula makes of a variable follows it, in each case of its own."""
        scene = sweep('Scene: {Variables: {F: 1, twice: "=2*F"}, Point Loads: {weight: {Force: [0, "=-twice", 0]}}}')
        self.solve(scene, "Variables/F,Expected/tip turns/Value\n1,\n=8/2,\n")
        by_variable = self.column("tip moves down")
        self.solve(sweep(), f"{FORCE}\n-2\n-8\n")
        self.assertEqual(by_variable, self.column("tip moves down"))
        self.assertNotEqual(*by_variable)
        # cells know the variables of their row, in any order
        self.solve(scene, "Variables/twice,Variables/F\n=F+1,1\n=2*F,=1+3\n")
        self.assertEqual(self.column("tip moves down"), by_variable)
        stepped = with_lists(scene, 'Solver: {Load Path: {Maximum Step: "=F/4"}}')
        for text, table, *parts in ((scene, "F\n=8*G\n", "elastica_sweep.csv:2", "=8*G", "no formula", "\n    =8*G\n    ^"),
                                    (scene, "F\n=8*F\n", "elastica_sweep.csv:2", "needs itself"),
                                    (scene, "G\n1\n", 'elastica_sweep.csv:1:1: "Variables/G": no value "G"', "\n    ^"),
                                    (stepped, "F\n1\n2\n", "case 2", "Solver / Load Path / Maximum Step", "0.5 in this case and 0.25",
                                     "limits and expected")):
            self.expect(self.solve(text, f"Variables/{table}", code=BAD_INPUT), *parts)
        self.solve(changed(stepped, "=F/4", "=1/4"), "Variables/F\n1\n2\n")

    def test_expected_values_may_follow_from_variables(self):
        """By elliptic integrals, under forces of 0.5 and 2."""
        for value, code in (("-0.2445336471332", 0), ("-0.2445336", CHECK_FAILED)):
            out = self.solve(sweep(f"""
                Scene: {{Variables: {{F: 1}}, Point Loads: {{weight: {{Force: [0, "=-F", 0]}}}}}}
                Expected: {{tip turns: {{Value: "=F > 1 ? -0.7817498315565 : {value}"}}}}"""), "Variables/F\n0.5\n2\n", code=code)
            self.expect(out, f"{2 - code} of 2 checks passed")

    def test_a_grid_agrees_with_single_runs(self):
        self.solve(with_batch(f"""Vary: {{load: {{Parameter: '{FORCE}', First: -0.5, Last: -8, Count: 5, Spacing: logarithmic}},
            stiffness: {{Parameter: Sections/strip/EI3, First: 1, Last: 1.5, Count: 2}}}}"""))
        found = self.found()
        self.assertEqual(len(found), 10)
        for i in (0, 3, 9):
            load, stiffness = found[i][FORCE], found[i]["Sections/strip/EI3"]
            self.assertAlmostEqual(float(load), -0.5 * 2 ** (i // 2), delta=1e-14)
            self.assertAlmostEqual(float(stiffness), 1.5 if i % 2 else 1.0, delta=1e-15)
            self.write("single.yaml", sweep(f"Scene: {{Point Loads: {{weight: {{Force: [0, {load}, 0]}}}}, Sections: {{strip: {{EI3: {stiffness}}}}}}}"))
            self.ended("run", "single.yaml", "--output", "single")
            alone = self.rows("single/single-monitor.csv")[-1]
            both = [name for name in alone if "." in name and name in found[i]]
            self.assertEqual(len(both), 18)  # displacement and rotation of two points, force and moment of one support
            for name in both:  # to 1e-9 of the largest number of its kind, here at most about 10
                self.assertAlmostEqual(float(found[i][name]), float(alone[name]), delta=1e-9, msg=name)

    def test_results_are_the_same_bits_for_any_number_of_threads_and_ranks(self):
        table = {}
        for threads in ("1", "2"):
            self.solve(sweep(), TABLE, "--threads", threads)
            table[threads] = self.text("results/scene-batch.csv")
        self.assertEqual(table["1"], table["2"])
        for ranks in ("2", "3"):
            ended = self.ended(*MPIRUN, ranks, PROGRAM, "batch", "scene.yaml", "--output", "ranks", "--force", executable="/usr/bin/env")
            self.assertEqual(ended.returncode, 0, ended.stderr)
            self.assertEqual(self.text("ranks/scene-batch.csv"), table["1"])
            self.expect(ended.stdout, "15 of 15 checks passed", "40 cases, 0 failed")

    def test_frequencies_of_each_case(self):
        """The first frequency of a cantilever, 3.51602 / (2 pi), falls with the root of its mass."""
        self.solve("""Scene:
  Sections: {rod: {Inextensible: true, Shear Rigid: true, GIt: 1, EI2: 1, EI3: 1, Mass: 1}}
  Points: {wall: [0, 0, 0], tip: [1, 0, 0]}
  Members: {beam: {Start: wall, End: tip, Section: rod, Order: 4, Elements: 8}}
  Supports: {clamp: {Point: wall}}
Analysis: {Modes: {Number: 1, In Plane: true}}
Quantities: {f: {Quantity: natural frequency, Mode: 1}}
Batch: {Output: quantities, Vary: {mass: {Parameter: Sections/rod/Mass, First: 1, Last: 4, Count: 2}}}
""")
        for found, right in zip(self.numbers("f"), (0.55959, 0.5 * 0.55959), strict=True):
            self.assertAlmostEqual(found, right, delta=1e-5)

    def test_rows_of_a_table_keep_their_numbers(self):
        self.solve(sweep(), TABLE, "--quiet")
        whole = self.numbers("tip turns")
        self.solve(sweep(), TABLE, "--quiet", "--rows", "3:7")
        some = self.found("scene-batch-3-7")
        self.assertEqual([row["case"] for row in some], ["3", "4", "5", "6", "7"])
        of_a_residual = 1e-11  # other groups: residuals are as small, not the same
        for i, row in enumerate(some):
            self.assertAlmostEqual(float(row["tip turns"]), whole[i + 2], delta=of_a_residual)
            self.assertGreater(abs(float(row["tip turns"]) - whole[i]), 1e3 * of_a_residual)
        self.solve(sweep(), TABLE, "--rows", "39:40")
        self.assertEqual(len(self.found("scene-batch-39-40")), 2)
        for rows in ("41:50", "39:41", "7:3", "0:3", "3", "a:b"):
            self.expect(self.solve(sweep(), TABLE, "--rows", rows, code=BAD_INPUT), "option --rows", "allowed: ")

    def test_a_case_that_cannot_be_solved_spoils_no_other(self):
        """The strip as one element of order 1, rolled up by a moment: at 2 pi its ends stand at pi, where rotations end."""
        scene = with_lists(with_batch("Table: elastica_sweep.csv"),
                           "Scene: {Members: {strip: {Order: 1, Elements: 1}}, Point Loads: {weight: {Force: [0, 0, 1]}}}")
        self.write("scene.yaml", changed(scene, '"Force"', '"Moment"', '"weight"'))
        self.write("elastica_sweep.csv", "Point Loads/weight/Moment[2]\n5\n5.5\n6.2831853071795\n6\n5.25\n4.5\n")  # 2 pi (1 - 1e-14)
        ended = self.ended("batch", "scene.yaml", "--output", "results")
        self.assertEqual(ended.returncode, NO_CONVERGENCE, ended.stderr)
        self.expect(ended.stdout, "elastica_sweep.csv:4: case 3 FAILED", "6 cases, 1 failed")
        self.expect(ended.stderr, "1 of 6 cases did not converge")
        self.assertEqual(self.column("converged"), ["yes", "yes", "no", "yes", "yes", "yes"])
        found = self.found()
        failed = found.pop(2)
        self.assertEqual(failed["tip.displacement.x"], "nan")
        self.assertNotEqual(failed["cause"], "")
        for row in found:
            half = 0.5 * float(row["Point Loads/weight/Moment[2]"])
            # one element of order 1: an arc whose ends turn by half the angle against it; its chord is the element itself
            self.assertAlmostEqual(float(row["tip.displacement.x"]), math.cos(half) - 1, delta=1e-9)
            self.assertAlmostEqual(float(row["tip.displacement.y"]), math.sin(half), delta=1e-9)

    def test_each_case_tells_whether_its_end_is_stable(self):
        """Euler: a cantilever of length one under an axial load stands up to pi^2 EI / 4 = 2.467 EI."""
        scene = with_lists(with_batch("Table: elastica_sweep.csv"), "Scene: {Point Loads: {weight: {Force: [-1, 0, 0]}}}")
        out = self.solve(scene, "Point Loads/weight/Force[0]\n-2.4\n-2.5\n-1\n2.5\n-2.46\n", "--summary", "summary.json")
        self.assertEqual(self.column("stable"), ["true", "false", "true", "true", "true"])
        self.expect(out, "case 2: stable: false: a real structure does not stay there", "cases by stable: true 4, false 1, neutral 0, unknown 0",
                    "1 warning", '"Expected/<name>/Value"', without=["the scene gives no expected values"])  # it does give some
        self.expect(self.text("summary.json"), '"stable": "false"', "1 of 5 cases end unstable: a real structure does not stay there")
        self.expect(self.contents("results/scene-batch.h5"), "columns/stable")

    def test_each_case_is_judged_by_modes(self):
        """Beck's column flutters at 20.05 EI / L^2; the tangent does not tell."""
        self.solve("""Scene:
  Variables: {P: 20}
  Sections: {rod: {Inextensible: true, Shear Rigid: true, GIt: 1, EI2: 1, EI3: 1, Mass: 1}}
  Points: {foot: [0, 0, 0], head: [0, 0, 1]}
  Members: {rod: {Start: foot, End: head, Section: rod, Order: 4, Elements: 4, Second Axis: [0, 1, 0]}}
  Supports: {foot: {Point: foot}}
  Point Loads: {thrust: {Point: head, Force: ["=-P", 0, 0], Frame: follower, Member: rod}}
Analysis: {Modes: {Number: 2, In Plane: true}}
Batch: {Vary: {thrust: {Parameter: Variables/P, First: 20, Last: 20.1, Count: 2}}}
""")
        self.assertEqual(self.column("stable"), ["true", "false"])

    def test_what_is_wrong_is_named(self):
        for table, *parts in ((f"{FORCE},Sections/strip/EI4\n1,1\n", "elastica_sweep.csv:1:29: ", "EI4", 'did you mean "EI2"?'),
                              ("Point Load/weight/Force[1]\n1\n", "elastica_sweep.csv:1:1: ", 'did you mean "Point Loads"?'),
                              ("Point Loads/weight/Force\n1\n", "an array of 3 numbers"),
                              ("Point Loads/weight/Force[3]\n1\n", "[0] to [2]"),
                              ("Sections/strip/EI2[-1]\n1\n", "a single number"),
                              ("Point Loads/weight/Point\n1\n", "not a number"),
                              ("Members/strip/Elements\n2.5\n", "elastica_sweep.csv:2: case 1", "a whole number"),
                              ("Sections/strip/EI2\n1\n-1\n", "elastica_sweep.csv:3: case 2", "value -1"),
                              ("Sections/strip/EI2\nsoft\n", "elastica_sweep.csv:2:1: ", "soft"),
                              ("Sections/strip/EI2,Sections/strip/EI3\n1\n", "elastica_sweep.csv:2", "1 cells; allowed: 2"),
                              ("Expected/tip turn/Value\n1\n", 'did you mean "tip turns"?'),
                              ("Sections/strip/EI2\n", "no case")):
            self.expect(self.solve(sweep(), table, code=BAD_INPUT), *parts)
        self.expect(self.solve(with_batch(""), code=BAD_INPUT), 'neither of "Table" and "Vary"')
        self.expect(self.solve(with_batch("Tabel: x.csv"), code=BAD_INPUT), 'did you mean "Table"?')


class Structures(BatchCase):
    def test_a_folder_gives_a_row_for_each_structure_and_load_case(self):
        designs = self.folder / "designs"
        designs.mkdir()
        for name in ("elastica.xml", "portal_frame.xml", "follower_cantilever.xml"):
            shutil.copy(ROOT / "apps/gallery" / name, designs)
        batch, table, sway = ("batch", "designs/", "--quiet"), "designs/designs-batch", "sway of the eaves"
        self.mixbeam(*batch)
        whole = self.found(table)
        self.assertEqual(len(whole), 6)  # the portal has four load cases
        # the portal alone asks for its sway
        self.assertEqual((whole[0]["structure"], whole[3]["load case"], whole[0][sway]), ("elastica.xml", "wind", "nan"))
        self.mixbeam("run", "designs/portal_frame.xml", "--case", "wind")
        last = self.found("portal_frame/portal_frame-wind-monitor")[-1]
        self.assertEqual(whole[3][sway], last[sway])
        self.assertNotEqual(whole[2][sway], last[sway])  # under snow
        self.mixbeam("plot", f"results/{table}.h5")
        self.assertTrue((self.folder / f"results/{table}.png").exists())
        self.mixbeam(*batch, "--rows", "4:5")
        self.assertEqual(self.found(f"{table}-4-5")[0], whole[3])
        ended = self.ended(*MPIRUN, "2", PROGRAM, "batch", "designs", "--output", "ranks", executable="/usr/bin/env")
        self.assertEqual(ended.returncode, 0, ended.stderr)
        self.assertEqual(self.text("ranks/designs-batch.csv"), self.text(f"results/{table}.csv"))
        # ranks that share a structure tell its mesh once
        (self.folder / "shared").mkdir()
        self.write("shared/rod.yaml", """Scene:
  Load Cases: [down, side]
  Sections: {rod: {EA: 1000, GA2: 300, GA3: 300, GIt: 1, EI2: 1, EI3: 1}}
  Points: {wall: [0, 0, 0], tip: [1, 0, 0]}
  Members: {rod: {Start: wall, End: tip, Section: rod}}
  Supports: {clamp: {Point: wall}}
  Point Loads: {down: {Point: tip, Force: [0, 0, -1], Case: down}, side: {Point: tip, Force: [0, 1, 0], Case: side}}
""")
        self.ended(*MPIRUN, "2", PROGRAM, "batch", "shared", "--output", "ranks", "--summary", "ranks.json", executable="/usr/bin/env")
        self.assertEqual(self.text("ranks.json").count('"wanted"'), 1)
        self.write("designs/slip.yaml", with_lists(scene_of("apps/gallery/elastica.xml"), "Scene: {Members: {strip: {Order: 99}}}"))
        self.expect(self.mixbeam(*batch, code=BAD_INPUT), "slip.yaml", "99")
        (self.folder / "empty").mkdir()
        self.expect(self.mixbeam("batch", "empty", code=BAD_INPUT), "holds no scene (*.xml, *.yaml, *.yml)")


if __name__ == "__main__":
    unittest.main()
