#!/usr/bin/python3
"""The verification table is what the summaries say, failures included.

usage: verification_table_test.py MIXBEAM     one summary is written by the program, the others have its format
"""

import contextlib
import io
import json
import sys
import unittest
from pathlib import Path
from unittest import mock

from support import ROOT, InFolder

sys.path.insert(0, str(ROOT / "apps" / "plots"))

import verification_table  # noqa: E402

BENCHMARKS = ("rollup", "superimposed_rotation", "arc_segment", "helix", "helical_rod", "slope_discontinuity", "fork", "modes", "sensitivity",
              "extremes")
VALUES = 3 * len(BENCHMARKS) + 8  # of write_all(): those of each benchmark, and of two groups of scenes


def check(name, value, printed, comparison, tolerance, passed=True, source="a table"):
    reference = printed if comparison == "word" else float(printed)
    return {"name": name, "value": value, "reference": reference, "printed_reference": printed, "source": source,
            "comparison": comparison, "tolerance": tolerance, "pass": passed}


class VerificationTable(InFolder):
    def write(self, name, checks):
        file = self.folder / "results" / name / "summary.json"
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(json.dumps({"program": name, "version": "1.2", "compiler": "some compiler", "threads": 1, "ranks": 1,
                                    "all_passed": all(one["pass"] for one in checks), "checks": checks}))

    def write_benchmark(self, name, value=0.501, passed=True):
        """Two good values and one whose reference is 0.500, +-1 in the last digit."""
        self.write(name, [check("k=1, 4 elements: u1", 0.1004, "0.100", "printed digits", 1),
                          check("k=2, 16 elements: u2", value, "0.500", "printed digits", 1, passed),
                          check("k=2: Newton iterations", 9, "11", "upper bound", 0, source="a goal")])

    def write_scene(self, name, value=2.0, passed=True, bound="1e-10"):
        """One value in two load cases, expected 2 +-1e-8, and a balance."""
        self.write(name, [check("tip, wind", 2.0, "2", "relative", 1e-8, source="a formula"),
                          check("tip, snow", value, "2", "relative", 1e-8, passed, source="a formula")]
                   + [check(f"{Path(name).name}-snow: balance, sum of {what}", 3e-16, bound, "upper bound", 0, source="equilibrium")
                      for what in ("forces", "moments")])

    def write_all(self):
        for name in BENCHMARKS:
            self.write_benchmark(name)
        for group in ("verification", "gallery"):
            self.write_scene(f"{group}/a scene")

    def table(self, *options):
        """What is printed, and the complaint."""
        out = io.StringIO()
        with mock.patch.object(sys, "argv", ["table", str(self.folder / "results"), *options]), contextlib.redirect_stdout(out):
            complaint = verification_table.main()
        return out.getvalue(), complaint or ""

    def expect(self, *parts, options=("--markdown",)):
        out, complaint = self.table(*options)
        self.assertEqual(complaint, "")
        for part in parts:
            self.assertIn(part, out)

    def test_words_are_the_same_or_not(self):
        self.write("rollup", [check("end", "true", "true", "word", 0, source="Euler")])
        self.expect("| rollup | end | 1 | none | the same word | yes | Euler |")
        self.write("rollup", [check("end", "false", "true", "word", 0, False, source="Euler")])
        self.expect("| rollup | end | 1 | another word, or none | the same word | **NO** | Euler |")

    def test_groups_what_belongs_together(self):
        self.write_benchmark("rollup")
        self.expect("| rollup | k=1 and 2, 4 and 16 elements: u1 and 2 | 2 | 1 in the last digit | 1 in the last digit | yes | a table |",
                    "| rollup | k=2: Newton iterations | 1 | 9 | at most 11 | yes | a goal |",
                    "3 of 3 values agree; version 1.2, some compiler")

    def test_shows_what_failed(self):
        self.write_benchmark("rollup", 0.502, False)
        self.write_benchmark("fork", "nan", False)
        self.expect("u1 and 2 | 2 | 2 in the last digit | 1 in the last digit | **NO** |",
                    "u1 and 2 | 2 | not a number | 1 in the last digit | **NO** |", "4 of 6 values agree")
        self.expect("NO", "not a number", "4 of 6 values agree", options=())

    def test_sorts_by_level(self):
        sources = {"experiment: a wing": "experiment", "equilibrium": "relation", "shooting on the rod equations": "shooting",
                   "pi^2 EI/L^2, closed form": "closed form", "other program: of solids": "other program"}
        self.write("rollup", [check(source, 1.0, "1", "relative", 1e-3, source=source) for source in sources])
        lines = self.table("--markdown")[0].splitlines()
        rows = [line.split(" | ") for line in lines if "| rollup |" in line]
        order = ["closed form", "shooting", "other program", "experiment", "relation"]
        self.assertEqual([row[0].strip("| ") for row in rows], order)
        self.assertEqual([sources[row[-1].strip(" |")] for row in rows], order)
        self.assertEqual([line.split(" | ")[:3] for line in lines[2:7]], [[f"| {level}", "1", "1"] for level in order])

    def test_has_scenes_of_the_program(self):
        self.write_scene("verification/arch")
        self.write_scene("verification/column", 2.0 + 2e-7, False)
        self.expect("| verification/arch | tip | 2 | 0 | 1e-08 of the value | yes | a formula |",
                    "| verification/column | tip | 2 | 1e-07 | 1e-08 of the value | **NO** |",
                    "| verification | balance: sum of forces, sum of moments | 4 | 3e-16 | at most 1e-10 | yes | equilibrium",
                    "7 of 8 values agree")

    def test_a_balance_is_one_row(self):
        """Bounds that differ by rounding are one row; others are one too, which tells both."""
        row = "| gallery | balance: sum of forces, sum of moments |"
        self.write_scene("gallery/arch", bound="1.000035527136788e-10")
        self.write_scene("gallery/column", bound="1.000106581410364e-10")
        self.expect(f"{row} 4 | 3e-16 | at most 1e-10 |")
        self.write_scene("gallery/honeycomb", bound="1.3906e-10")
        self.expect(f"{row} 6 | 3e-16 | at most 1e-10 to 1.39e-10 |")

    def test_rounds_bounds_and_ranges_but_no_counts(self):
        self.write("rollup", [check(f"angle {angle}: error", 1e-14, "1.23456e-13", "upper bound", 0, source="a circle")
                              for angle in ("0", "0.1998335828876", "0.199833582888")]
                   + [check("iterations", 1500, "1600", "upper bound", 0, source="a goal")])
        self.expect("| rollup | angle 0..0.2: error | 3 | 1e-14 | at most 1.23e-13 |",
                    "| rollup | iterations | 1 | 1500 | at most 1600 |")

    def test_replaces_what_stands_between_its_markers(self):
        page = self.folder / "verification.md"
        before, after = "text\n<!-- verification:begin -->", "<!-- verification:end -->\nmore\n"
        page.write_text(f"{before}\nold\n{after}")
        self.write_benchmark("rollup")
        complaint = self.table("--update", str(page))[1]
        for part in ("verification.md is left as it is", "no results of superimposed_rotation, arc_segment",
                     "fork, modes, sensitivity, extremes, verification, gallery"):
            self.assertIn(part, complaint)
        self.assertEqual(page.read_text(), f"{before}\nold\n{after}")
        self.write_all()
        for _ in range(2):  # a second time changes nothing
            self.assertEqual(self.table("--update", str(page))[1], "")
            updated = page.read_text()
            self.assertTrue(updated.startswith(f"{before}\n| level | values | agree |"), updated)
            self.assertTrue(updated.endswith(f"\n{after}"))
            self.assertIn(f"{VALUES} of {VALUES} values agree", updated)
            self.assertNotIn("old", updated)

    def test_shows_studies_of_cost_where_they_were_made(self):
        """What run.sh computes only when it is named is not asked for, and shown where it is there."""
        self.write_all()
        self.assertNotIn("| trade |", self.table("--markdown")[0])
        self.write_benchmark("trade")
        self.expect("| trade |", f"{VALUES + 3} of {VALUES + 3} values agree")

    def test_says_what_it_cannot_read(self):
        self.assertIn("no such folder", self.table()[1])
        self.write_benchmark("rollup")
        (self.folder / "results/rollup/summary.json").write_text('{"program": ')
        self.assertIn("rollup/summary.json: not a summary", self.table()[1])
        self.write_all()
        (self.folder / "verification.md").write_text("no markers")
        self.assertIn("no line <!-- verification:begin -->", self.table("--update", str(self.folder / "verification.md"))[1])

    def test_reads_what_the_program_writes(self):
        summary = self.folder / "results/gallery/elastica/summary.json"
        summary.parent.mkdir(parents=True)
        self.mixbeam("run", str(ROOT / "apps/gallery/elastica.xml"), "--quiet", "--summary", str(summary))
        self.expect("| gallery/elastica | ", "| gallery | loads and reactions: sum of forces", " of the value | yes | ")


if __name__ == "__main__":
    unittest.main()
