#!/usr/bin/python3
"""The list "Quantities" as a user meets it: monitor, result file, summary, limits, checks, batch, resuming.

usage: quantities_test.py MIXBEAM [CLASS]...
"""

import math
import unittest

from support import BAD_INPUT, CHECK_FAILED, InFolder, changed, scene_of, with_lists

TIP = "sag: {Quantity: displacement, Point: tip}"
MOMENT = "M: {Quantity: material moment, Member: '*', Component: 3, Take: largest size}"
BOTH = f"{TIP}, {MOMENT}"
# Elliptic integrals, F L^2 / EI = 10: M = EI sqrt(2 F / EI) sqrt(sin theta) at the clamp.
AT_CLAMP, ALONG, DOWN = math.sqrt(20 * math.sin(1.4302855388039)), -0.5549955977538, -0.8106090249


def elastica(lists, removed=()):
    """The gallery's (EI = 1, force 10 across the tip, 1 long) with more lists."""
    return with_lists(scene_of("apps/gallery/elastica.xml"), lists, removed)


def asking(quantities, more=""):
    return elastica(f"Quantities: {{{quantities}}}\n{more}")


class QuantitiesCase(InFolder):
    def solve(self, text, *words, code=0):
        return self.run_scene(text, "--quiet", *words, code=code)

    def last(self, table="results/scene-monitor"):
        return self.rows(f"{table}.csv")[-1]

    def refused(self, text, *parts):
        self.expect(self.solve(text, code=BAD_INPUT), *parts)


class Values(QuantitiesCase):
    def test_they_stand_in_monitor_file_and_summary(self):
        self.expect(self.solve(asking(BOTH)), "sag.y", "largest size")
        row = self.last()
        self.assertEqual([row["sag.x"], row["sag.y"]], [row["tip.displacement.x"], row["tip.displacement.y"]])
        self.assertAlmostEqual(abs(float(row["M"])), AT_CLAMP, delta=1e-9)
        self.assertEqual(float(row["M.arc_length"]), 0)
        self.assertFalse(row["M.member"].isdigit())
        found = self.contents()
        self.assertIn("monitor/quantities", found)
        self.expect(str(found["quantities"]), "sag.y\\n", "M.arc_length\\n")
        self.expect(self.text("summary.json"), '"quantities"', '"sag.y"', '"at_largest_size"', '"arc_length"')

    def test_they_have_the_units_of_the_scene(self):
        without = asking(BOTH + """,
    turn: {Quantity: rotation, Point: tip, Component: z}, wall: {Quantity: reaction force, Point: wall, Component: norm},
    kappa: {Quantity: spatial curvature, Point: tip, Component: z}, strain: {Quantity: material strain, Point: tip, Component: '1'},
    work: {Quantity: strain energy}, factor: {Quantity: load factor},
    long: {Quantity: length, Member: '*', Take: sum}, twice: {Quantity: formula, Formula: 2*long}""")
        self.solve(with_lists(without, "Scene: {Units: 'mm , kN'}"))
        found = self.contents()
        self.assertEqual(found["quantities"][1], b"sag.x\nsag.y\nsag.z\nM\nM.member\nM.arc_length\nM.side\nturn\nwall\nkappa\nstrain\nwork\n"
                                                 b"factor\nlong\ntwice\n")
        self.assertEqual(found["quantity_units"][1], b"mm\nmm\nmm\nkN mm\n\nmm\n\nrad\nkN\n1/mm\n\nkN mm\n\nmm\n\n")
        self.mixbeam("resume", "results/scene.h5", "--from", "1")
        self.assertEqual(self.contents()["quantity_units"], found["quantity_units"])
        self.solve(without)
        self.assertNotIn("quantity_units", self.contents(), "the twin: nothing is said")

    def test_the_largest_of_several_places_has_a_place(self):
        """0.0175, 0.02 and 0.03 at the ends of the bars, in the storm."""
        self.write("scene.yaml", BARS + """}
  far: {Quantity: displacement, Point: 'end *', Component: norm, Take: largest, Limit: 1}
  half: {Quantity: displacement, Point: 'bar [12]@50%', Component: norm, Take: smallest}
""")
        self.expect(self.mixbeam("run", "scene.yaml", "--case", "storm", "--output", "results", "--summary", "summary.json"),
                    "at the end: end 3\n", "at the end: bar 1@50%\n")
        self.expect(self.text("summary.json"), '"place": "end 3"', '"place": "bar 1@50%"')
        self.mixbeam("report", "results/scene-storm.h5")
        page, place = self.text("results/scene-storm-report.html"), "<td class=words>end 3</td>"
        limits, rest = page.split("size of far", 1)[1].split("</table>", 1)
        self.expect(limits, place)  # beside the limit,
        self.expect(rest, place)    # and the quantity
        self.expect(page, "<td class=words>bar 1@50%</td>")

    def test_they_may_be_expected(self):
        def expecting(name, value, code):
            check = f"{{Quantity: {name}, Value: {value}, Absolute Tolerance: 1e-6, Source: elliptic integrals}}"
            return self.solve(asking(TIP, f"Expected: {{check: {check}}}"), code=code)
        expecting("sag.x", "-0.555500", CHECK_FAILED)
        expecting("sag.x", "-0.554996", 0)
        self.expect(expecting("sgg.x", "0", BAD_INPUT), "Expected / check / Quantity", '"sgg.x"', 'did you mean "sag.x"?')

    def test_they_are_the_same_when_a_run_is_resumed(self):
        self.solve(asking(BOTH))
        before = self.text("results/scene-monitor.csv")
        self.mixbeam("resume", "results/scene.h5", "--quiet")
        self.assertEqual(self.text("results/scene-monitor.csv"), before)

    def test_envelopes_are_renewed_by_runs_of_one_case(self):
        """From the files of the others; where they cannot, they say so. The moment at the clamp is not linear in the two loads."""
        def two_cases(other):
            return elastica(f"""Quantities: {{{BOTH}}}
Scene: {{Load Cases: [down, other], Point Loads: {{more: {{Point: tip, Force: [0, 0, {other}], Case: other}}}}}}""", ["Expected"])
        def envelope():
            return self.text("results/scene-envelope.csv")
        self.solve(two_cases("3"), "--case", "down")
        self.assertFalse((self.folder / "results/scene.h5").exists())
        self.solve(two_cases("3"), "--case", "other")
        one_by_one = envelope()
        self.solve(two_cases("3"))
        self.assertEqual(envelope(), one_by_one)
        (self.folder / "results/scene-envelope.csv").unlink()
        self.mixbeam("resume", "results/scene-other.h5", "--quiet")
        self.assertEqual(envelope(), one_by_one)
        self.expect(self.solve(two_cases("4"), "--case", "other"), "results/scene.h5: the envelope is that of an earlier run",
                    "scene-down.h5 is of another scene")
        self.assertEqual(envelope(), one_by_one)
        self.solve(two_cases("4"), "--case", "down")
        self.assertNotEqual(envelope(), one_by_one)
        self.expect(self.mixbeam("resume", "results/scene.h5", "--quiet", code=BAD_INPUT), "the envelope of 2 runs",
                    '"results/scene-down.h5", "results/scene-other.h5"')

    def test_stress_points_of_sections_given_by_stiffnesses(self):
        """E = 1 / I: M c / I at c = 0.02."""
        points = "{E: 50, Area: 1e12, Points: {outer: [0.02, 0], inner: [-0.01, 0]}}"
        self.expect(self.solve(asking(f"stress: {{Quantity: normal stress, Member: '*', Take: largest size}}, {MOMENT}",
                                      f"Scene: {{Sections: {{strip: {{Stress Points: {points}}}}}}}")), "largest stress in")
        row = self.last()
        self.assertAlmostEqual(abs(float(row["stress"])), abs(float(row["M"])) * 0.02 * 50, delta=1e-9)

    def test_formulas_without_a_finite_value_are_warned_of(self):
        self.solve(asking(TIP + ", none: {Quantity: formula, Formula: 0 / (sag_y - sag_y)}"))
        self.expect(self.text("summary.json"), "formulas without a finite value at the end", '\\"none\\"')
        self.solve(asking("none: {Quantity: angle, Point: tip, Corner: tip, Other Point: wall}"))
        self.expect(self.text("summary.json"), 'angles with a side of no length: \\"none\\"')
        self.solve(asking(TIP + ", twice: {Quantity: formula, Formula: 2 * sag_y}"))
        self.expect(self.text("summary.json"), without=["without a finite value"])

    def test_formulas_know_variables(self):
        """As numbers; a name that is that of a quantity too would be one of the two."""
        def asked(variable):
            return asking(f'{TIP}, share: {{Quantity: formula, Formula: "sag_y / ({variable}/8)"}}', f"Scene: {{Variables: {{{variable}: 4}}}}")
        self.solve(asked("span"))
        row = self.last()
        self.assertAlmostEqual(float(row["share"]), float(row["sag.y"]) * 2, delta=1e-12)
        self.refused(asked("sag_y"), "share / Formula", '"sag_y" names a variable and a quantity')

    def test_refusals(self):
        twice, moment = "twice: {Quantity: formula, Formula: 2 * sag_y}", "M: {Quantity: material moment, Member: '*'"
        self.solve(asking(f"{TIP}, {twice}"))  # formulas refer to what stands above them
        self.refused(asking(f"{twice}, {TIP}"), "Quantities / twice / Formula", '"sag_y"', "allowed: a formula of numbers with")
        self.refused(asking(moment + ", Take: largest}"), '"Quantities / M / Component": missing')
        self.refused(asking(moment + "}"), '"Quantities / M / Position": missing')  # neither an extreme nor a place
        self.solve(asking(moment + ", Take: largest, Component: norm}"))
        self.refused(asking("tip.displacement: {Quantity: displacement, Point: tip, Component: x}"), "scene.yaml:", "tip.displacement",
                     "something else")


BARS = """Scene:
  Sections: {bar: {EA: 100, Shear Rigid: true, GIt: 1, EI2: 1, EI3: 1}}
  Points: {A: [0, 0, 0], end 1: [1, 0, 0], end 2: [0, 2, 0], end 3: [-3, 0, 0]}
  Members: {bar 1: {Start: A, End: end 1}, bar 2: {Start: A, End: end 2}, bar 3: {Start: A, End: end 3}}
  Load Cases: [calm, storm]
  Supports: {clamp: {Point: A}}
  Point Loads:
    dead: {Point: end 1, Force: [1, 0, 0]}
    live: {Point: end 1, Force: [0.5, 0, 0], Stage: 2}
    gust: {Point: end 1, Force: [0.25, 0, 0], Stage: 2, Case: storm}
    across: {Point: end 2, Force: [0, 1, 0]}
    back: {Point: end 3, Force: [-1, 0, 0]}
Quantities:
  u: {Quantity: displacement, Point: end 1, Component: x, """
"""Bars of EA = 100 and length 1, 2, 3 pulled by 1 in stage 1 and by 0.5 more in stage 2, where a case adds 0.25: an end moves by N L / EA,
which is exact however large it is."""


class Limits(QuantitiesCase):
    def test_they_fail_the_run_where_they_are_exceeded(self):
        def limited(limit, code):
            return self.solve(asking(f"sag: {{Quantity: displacement, Point: tip, Component: norm, Limit: {limit}}}"), code=code)
        limited("1.0", 0)
        self.expect(limited("0.9", CHECK_FAILED), "FAIL", "size of sag", "at most 0.9")

    def test_of_cases_and_stages_and_of_changes(self):
        def ended(limit, code):
            return self.solve(f"{BARS}{limit}}}\n", code=code)
        for within, beyond in (("Limit: 0.0176", "Limit: 0.0174"),
                               ("Limit: 0.0151, Case: calm", "Limit: 0.0149, Case: calm"),
                               ("Limit: 0.0151, Case: 'c*'", "Limit: 0.0151, Case: '[cs]*'"),
                               ("Limit: 0.0101, Stage: 1", "Limit: 0.0101, Stage: 2"),
                               ("Limit: 0.0076, Relative To: 1", "Limit: 0.0074, Relative To: 1"),
                               ("Limit: 0.0051, Relative To: 1, Case: calm", "Limit: 0.0149, Relative To: 0, Case: calm"),
                               ("Span: \"=x('end 1')*3.5\", Span Ratio: 198, Relative To: 0", "Span: 3.5, Span Ratio: 202")):
            ended(within, 0)
            ended(beyond, CHECK_FAILED)
        self.expect(ended("Limit: 0.0074, Relative To: 1", CHECK_FAILED), "FAIL", "size of u since the end of stage 1", "storm", "at most 0.0074")
        self.mixbeam("resume", "results/scene-storm.h5", "--from", "1", code=CHECK_FAILED)
        for limit, *parts in (("Limit: 1, Case: strom", "scene.yaml:", "Quantities / u / Case", 'did you mean "storm"?'),
                              ("Limit: 1, Stage: 3", "u / Stage", "value 3", "up to 2"),
                              ("Limit: 1, Relative To: 2", "u / Relative To", "up to 1"),
                              ("Limit: 1, Relative To: 1, Stage: 1", "u / Relative To", "a stage before"),
                              ("Relative To: 1", "u / Relative To", "without a limit"),
                              ("Span Ratio: 300", "u / Span", "missing"),
                              ("Span: 3, Span Ratio: 300, Limit: 1", "u / Span Ratio", "one of the two")):
            self.expect(ended(limit, BAD_INPUT), *parts)

    def test_of_a_batch_may_be_of_changes_and_follow_variables(self):
        """Since stage 1 the bar is longer by 0.01 times the live load, and by 0.0025: 0.0075 and 0.0125."""
        bars = changed(changed(BARS, "Scene:\n", "Scene:\n  Variables: {live: 0.5}\n"), "Force: [0.5, 0, 0]", 'Force: ["=live", 0, 0]')
        vary = "Vary: {live: {Parameter: Variables/live, First: 0.5, Last: 1, Count: 2}}"

        def expect_failed(limit, *cases, trace="false"):
            self.write("scene.yaml", f"{bars}{limit}, Relative To: 1}}\nAnalysis: {{Trace: {trace}}}\nBatch: {{Output: quantities, {vary}}}\n")
            ended = self.ended("batch", "scene.yaml", "--case", "storm", "--output", "many")
            self.assertEqual((ended.returncode, ended.stderr), (CHECK_FAILED if cases else 0, ""))
            self.assertEqual([case for case in (1, 2) if f"case {case}: size of u" in ended.stdout], list(cases))
        for trace in ("false", "true"):  # side by side, and each alone
            expect_failed("Limit: 0.0126", trace=trace)
            expect_failed("Limit: 0.0124", 2, trace=trace)
        expect_failed('Limit: "=0.0026+0.01*live"')
        expect_failed('Limit: "=0.0074+0.0001*(live > 0.7)"', 1, 2)
        expect_failed('Span: "=live", Span Ratio: 70', 1)


class OfABatch(QuantitiesCase):
    def batch(self, text, count=2, output="quantities", code=0):
        """The elastica under 5 to 10."""
        self.write("scene.yaml", with_lists(text, f"""Batch: {{Output: {output}, Vary: {{force: {{Parameter: 'Point Loads/weight/Force[1]',
            First: -5, Last: -10, Count: {count}}}}}}}"""))
        return self.mixbeam("batch", "scene.yaml", "--output", "many", code=code)

    def test_quantities_are_columns(self):
        self.batch(asking(BOTH), count=6)
        row = self.last("many/scene-batch")
        self.assertAlmostEqual(abs(float(row["M"])), AT_CLAMP, delta=1e-8)
        self.assertAlmostEqual(float(row["sag.x"]), ALONG, delta=1e-8)
        self.assertEqual(row["M.member"], "strip")

    def test_limits_are_checks_of_each_case(self):
        """The tip goes down by 0.7137 and 0.8106."""
        def beyond(limit, output, code):
            out = self.batch(asking(f"sag: {{Quantity: displacement, Point: tip, Component: y, Limit: {limit}}}"), output=output, code=code)
            return self.last("many/scene-batch")["beyond limits"], out
        for output in ("quantities", "followed", "expected"):
            names, out = beyond("0.8", output, CHECK_FAILED)
            self.expect(out, "case 2: size of sag", "1 of 2 checks passed, 1 FAILED")
            self.assertEqual((names, beyond("0.9", output, 0)[0]), ("sag", ""))

    def test_expected_values_may_name_them(self):
        value = f"{{Quantity: sag.y, Value: {DOWN}, Absolute Tolerance: 1e-6, Source: x}}"
        self.batch(asking(TIP, f"Expected: {{sag of each: {value}}}"), output="expected")
        row = self.last("many/scene-batch")
        self.assertAlmostEqual(float(row["sag of each"]), DOWN, delta=1e-9)
        self.assertEqual(row["sag of each"], row["tip moves down"])  # the scene's own, of common quantities


ROD = """Scene:
  Sections: {rod: {EA: 1000, GA2: 500, GA3: 500, GIt: 20, EI2: 20, EI3: 20}}
  Points: {foot: [0, 0, 0], tip: [0, 4, 0]}
  Members: {rod: {Start: foot, End: tip, Order: 4, Elements: 4}}
  Supports: {clamp: {Point: foot}}
  Point Loads: {load: {Point: tip, %s}}
Expected:
"""
FOOT, END = "Point: foot", "Point: tip"


class Expected(QuantitiesCase):
    """Every quantity that a scene may expect, of a rod along y whose answer is exact."""

    def expect_values(self, load, values, tolerance=1e-9):  # of values of order one
        """What is expected of them, and the twin: each of them changed, and none is right."""
        for change in (0, 3 * tolerance):
            lines = [f"  {i}: {{Quantity: {what}, Value: {value + change!r}, Absolute Tolerance: {tolerance}, Source: exact}}\n"
                     for i, (what, value) in enumerate(values)]
            out = self.solve(ROD % load + "".join(lines), code=CHECK_FAILED if change else 0)
            self.expect(out, f"{2 + (0 if change else len(values))} of {2 + len(values)} checks passed")  # forces and moments balance

    def test_of_a_rod_under_tension(self):
        along = [(f"material force, Member: rod, Position: {position}, Component: '{i}'", 3.0 * (i == 1))
                 for position in (0, 0.25, 0.3, 1) for i in (1, 2)]
        self.expect_values("Force: [0, 3, 0]", [
            (f"displacement, {END}, Component: y", 3 * 4 / 1000), (f"position, {END}, Component: norm", 4 * (1 + 3 / 1000)),
            (f"reaction force, {FOOT}, Component: y", -3.0), (f"reaction force, {FOOT}, Component: norm", 3.0),
            ("strain energy", 0.5 * 9 * 4 / 1000), *along])

    def test_of_a_rod_bent_to_a_circle(self):
        self.expect_values("Moment: [0, 0, 2]", [
            (f"rotation, {END}, Component: z", 2 * 4 / 20), (f"reaction moment, {FOOT}, Component: z", -2.0),
            ("strain energy", 0.5 * 4 * 4 / 20), *((f"material moment, Member: rod, Position: 0.6, Component: {i}", 2.0) for i in ("'3'", "norm"))])

    def test_they_change_along_the_rod(self):
        """Linear for a load this small: moment F (L - s)."""
        self.expect_values("Force: [0, 0, 1e-6]", [(f"material moment, Member: rod, Position: {position}, Component: norm", 4e-6 * (1 - position))
                                                   for position in (0, 0.1, 0.5, 0.75, 1)], 4e-12)

    def test_others_are_refused(self):
        self.refused(ROD % "Force: [0, 3, 0]" + "  n: {Quantity: iterations, Value: 1, Absolute Tolerance: 1, Source: none}\n", "Expected / n / Quantity")


if __name__ == "__main__":
    unittest.main()
