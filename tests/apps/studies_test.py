#!/usr/bin/python3
"""The benchmarks as a user runs them: each study passes and leaves what its figures and pages need, small changes are noticed, and scenes
that do not fit are refused.

usage: studies_test.py MIXBEAM [CLASS]...
"""

import math
import os
import sys
import unittest
from pathlib import Path

from support import BAD_INPUT, CHECK_FAILED, PROGRAM, InFolder, program, scene_of, with_lists


class StudyCase(InFolder):
    def study(self, name, more="{}", *words, code=0, scene=None):
        """What it prints on one thread, quietly."""
        self.write("scene.yaml", with_lists(scene or scene_of(f"apps/{name}/{name}.xml"), more))
        ended = self.ended("scene.yaml", "--quiet", "--threads", "1", "--output", ".", "--summary", "summary.json", *words,
                           executable=Path(PROGRAM).with_name(name))
        self.assertEqual(ended.returncode, code, ended.stdout + ended.stderr)
        return ended.stdout + ended.stderr

    def page_of(self, name):
        """The page that the scripts write of what a benchmark has written."""
        (self.folder / "results").mkdir()
        (self.folder / "results" / name).symlink_to(self.folder)
        script = Path(PROGRAM).with_name("plots") / "plot_all.py"
        ended = self.ended(script, "results", "--only", name, "--pages", executable=sys.executable)
        self.assertEqual(ended.returncode, 0, ended.stdout + ended.stderr)
        return self.text(f"{name}.md")


def load(entry):
    return f"Scene: {{Point Loads: {{{entry}}}}}"


class Studies(StudyCase):
    def test_they_pass_and_leave_files(self):
        """With at least so many checks; of arc_segment 36 rows of the paper's tables, three components each."""
        for name, least, files in (
                ("arc_segment", 125, "convergence.csv table.csv single_rho10.h5 single_rho100.h5 single_rho1000.h5"),
                ("fork", 70, "table.csv convergence.csv load_displacement.csv single.h5"),
                ("helical_rod", 36, "load_displacement.csv single.h5 strains_k1.csv strains_k4.csv shape_k1.csv shape_k2.csv shape_k3.csv shape_k4.csv"),
                ("helix", 101, "convergence.csv order1.h5 order3.h5"),
                ("rollup", 1, "convergence.csv single.h5"),
                ("modes", 200, "convergence.csv"),
                ("sensitivity", 48, "convergence.csv costs.csv"),
                ("slope_discontinuity", 45, "table.csv load_displacement.csv single.h5"),
                ("superimposed_rotation", 1, "single.h5 deviation.csv")):
            with self.subTest(name):
                for file in self.folder.iterdir():
                    file.unlink()
                self.study(name)
                self.assertGreaterEqual(len(self.summary()["checks"]), least)
                self.expect(os.listdir(self.folder), *files.split())
        self.assertEqual(self.text("deviation.csv").count("\n"), 1 + 1 + 71)  # header, bent state, increments

    def test_small_changes_are_noticed(self):
        for name, more, *parts in (
                ("arc_segment", load("force: {Force: [0, 0, 600.01]}"), "<- differs"),
                # forces that are no couple are not mirrored
                ("fork", load("force at P2: {Force: [0, 0, -200.001]}"), "FAIL  loads in reverse order: one path and the mirror image"),
                ("modes", "Scene: {Sections: {strip: {Mass: 1.001}}}", "FAIL  cantilever, k=4, 8 elements, bending 1"),
                ("sensitivity", "Scene: {Sections: {strip: {EI3: 1.000001}}}", "FAIL  alpha 1 by force, k=4, 16 elements"),
                ("slope_discontinuity", load("tip force: {Force: [-10, 0, -10.001]}"), "<- differs"),
                ("slope_discontinuity", "Study: {Most Iterations: 5}", "FAIL  k=1, 3 elements: Newton iterations = 1", ", at most 5")):
            with self.subTest(name):
                self.expect(self.study(name, more, code=CHECK_FAILED), *parts)

    def test_small_changes_of_a_single_run_are_noticed(self):
        for name, more, *parts in (
                ("helical_rod", load("tip: {Force: [0, 0, 50.05]}")),  # a thousandth
                ("helix", load("tip moment: {Moment: [56.41517396, 0, 141.78679683929983]}")),  # the tenth digit
                ("rollup", load("moment: {Moment: [0, 0, 12.566370615]}")),
                # a small force that keeps its direction does not turn with the rod
                ("superimposed_rotation", load("weight: {Point: tip, Force: [1e-6, 0, 0]}"), "FAIL  scene: change of u3(L) / L",
                 "FAIL  scene: farthest vertex after turning back")):
            with self.subTest(name):
                self.expect(self.study(name, more, "--single", code=CHECK_FAILED), *parts)

    def test_what_does_not_fit_is_refused(self):
        for name, more, *parts in (
                ("arc_segment", "Study: {Reference Elements: 100}", "Reference Elements"),
                ("fork", load("force at P2: {Stage: 1}"), "bad input"),
                ("fork", "Study: {Convergence Elements per Member: [3, 5]}", "value 5; allowed: divisors of 384"),
                ("helix", "Scene: {Members: {second: {Start: clamp, End: tip, Section: circle}}}", "one member"),
                ("economies", load("more: {Point: tip, Force: [0, 0, 1]}"), "1 members and 2 point loads", "Scene"),
                ("extremes", "Scene: {Sections: {rod: {EI3: 2}}}", "EI2 = EI3"),
                ("thread_scaling", "Study: {Orders: [9]}", "Orders", "9")):
            with self.subTest(name):
                self.expect(self.study(name, more, code=BAD_INPUT), *parts)
        for name, old, new, words in (("rollup", "Moment", "Force", "moment about z"), ("slope_discontinuity", "tip", "end", 'no point "tip"')):
            renamed = scene_of(f"apps/{name}/{name}.xml").replace(f"{old}:", f"{new}:").replace(f": {old}", f": {new}")
            self.expect(self.study(name, scene=renamed, code=BAD_INPUT), words)


class Economies(StudyCase):
    """What a scene does not use: both ways of every row lead to the same answer."""

    SMALL = "Study: {Rounds: 1}\nScene: {Members: {rod: {Elements: 40}}}\n"

    def test_both_ways_give_the_same(self):
        self.study("economies", self.SMALL)
        self.expect(self.page_of("economies"), "# Only what the scene requires", "A rod of 40 elements of order 2", "processor", "| ratio |",
                    "| one section | taper to the same section |", "- free end: ")

    def test_different_answers_are_seen(self):
        """Twin: states that are far from converged are not the same."""
        loose = "Solver: {Newton: {Residual Tolerance: 1e-2}}"
        self.expect(self.study("economies", self.SMALL + loose, code=CHECK_FAILED), "FAIL", "difference of the two ways")


class Extremes(StudyCase):
    """A few values of the sweeps; the whole study belongs to run.sh."""

    def few(self, values, more="{}", code=0):
        sweeps = "[slenderness, stiffness_ratio, unit_of_length, unit_of_force, elements, element_turn, angle, tip_force, order]"
        scene = with_lists(scene_of("apps/extremes/extremes.xml"), f"""Study: {{Most Elements: 100, Critical Loads: false, Random Structures: 1,
            Reference Step: 0.1, Sweeps: {sweeps}, Most Values: {values}}}""")
        return self.study("extremes", more, scene=scene, code=code)

    def test_ends_of_the_sweeps_keep_their_promise(self):
        self.few(2)
        self.expect(self.text("extremes.csv"), "\nslenderness,1,1,", "\nslenderness,inf,1,", "\nunit_of_length,1e-09,1,", "\ntip_force,1e+08,1,",
                    "\nangle,0,1,", "\norder,8,1,")
        self.expect(self.page_of("extremes"), "# Extremes", "compiler", "| [slenderness](#slenderness) | 1 to inf | 2 of 2 |",
                    "## Where it ends", "  - 1: error 2.6e-03, 1e-06 is allowed elsewhere", "## Random imperfect structures", "| column | 1 |")
        self.expect(self.text("random_paths.csv"), "\ncolumn,0,")

    def test_critical_loads_are_those_of_the_closed_forms(self):
        self.few(2, """Study: {Critical Loads: true, Random Structures: 0,
            Sweeps: [stiffness_ratio, unit_of_length, unit_of_force, elements, element_turn, angle, tip_force, order]}""")
        self.expect(self.text("extremes.csv"), "\ntruss_rise,0.01,1,", "\nrail_stiffness,1e+08,1,")
        self.expect(self.page_of("extremes"), "| 2 of 2 | 0 |", "| 1 of 1 | 0 |")

    def test_random_paths_are_right_or_refused(self):
        """Random imperfect structures alone, from a series of which some paths pass several critical points."""
        self.few(1, "Study: {Random Structures: 60, Reference Step: 0.03, Sweeps: [order]}")
        self.assertGreater(self.text("random_paths.csv").count(",right,"), 30)

    def test_mistakes_are_noticed(self):
        for more, words in (("Study: {Critical Loads: true}\nAnalysis: {Stability: false}", "FAIL  truss_rise 0.01: critical load factors"),
                            ("Scene: {Members: {rod: {Order: 1}}}", "FAIL  slenderness 1: error of the tip")):
            self.expect(self.few(1, more, code=CHECK_FAILED), words)
        self.study("extremes", "{}", "--single")
        self.study("extremes", "Expected: {tip moves back: {Value: -0.5549955978638}}", "--single", code=CHECK_FAILED)


class Trade(StudyCase):
    """A few cells of the matrix; the whole study belongs to run.sh."""

    def few(self, more="{}", code=0):
        scene = with_lists(scene_of("apps/trade/trade.xml"), """Study: {Benchmarks: [thick_cantilever, rollup, slope_discontinuity],
            Gallery: [gripper], Orders: [1, 2, 3], Elements: [4, 8, 16, 32], Reference: [8, 24], Confirmation: [6, 32],
            Accuracies: [1e-3, 1e-5], Threads: [1, 2], Repetitions: 1}""")
        return self.study("trade", more, scene=scene, code=code)

    def test_tiny_size_converges_as_theory_says(self):
        self.few()
        self.expect(self.text("trade.csv"), "\nthick_cantilever,both reduced,1,4,converged,matrix,",
                    "\nthick_cantilever,both reduced,3,32,converged,matrix,", "\nrollup,full,2,16,converged,matrix,",
                    "\nslope_discontinuity,both reduced,3,16,converged,matrix,", "\ngripper,both reduced,3,2,converged,",
                    "seconds_1,setup_seconds_1,processor_seconds_1,seconds_2", without=["elastica"])  # a benchmark that was not asked for
        self.expect(self.text("accuracy.csv"), "\nthick_cantilever,0.001,reached,", "\nrollup,1e-05,reached,", "\ngripper,0.001,reached,",
                    "\ngripper,1e-05,reached,")
        self.expect(self.page_of("trade"), "# The trade", "compiler", "## Which order to take", "| thick_cantilever |",
                    "## Asking for an accuracy", "| rollup | 1e-05 |", "### Scenes of the gallery", "| gripper | 1e-05 |")
        self.expect(self.text("orders.csv"), "\nlargest,seconds,0.01,1.0,3,3,", "\ndisplacement,flops,0.01,1.0,3,3,")

    def test_the_cheapest_cell_reaches_the_accuracy(self):
        """The twin: on the elements of the file no order up to 1 reaches what is asked for."""
        self.few("Study: {Benchmarks: [], Orders: [1], Threads: [1]}")
        self.expect(self.page_of("trade"), "2 of 2 true errors", "| gripper | 1e-05 |", " | - | - |")

    def test_mistakes_are_noticed(self):
        """Meshes too coarse for a rate, references that disagree, one beside the closed form."""
        for study, more, words in (("Elements: [1, 2], ", "", "FAIL  thick_cantilever"), ("Confirmation: [6, 4], ", "", "FAIL  thick_cantilever"),
                                   ("", "Expected: {tip moves up: {Value: 0.9106090249803}}", "FAIL  tip moves up")):
            self.expect(self.few(f"Study: {{{study}Threads: [1], Gallery: []}}\n{more}", code=CHECK_FAILED), words)


class ThreadScaling(StudyCase):
    """The measurement in a tiny size, so that it cannot rot; its times are not judged."""

    def measured(self, more=""):
        """{(kind, elements, order, threads, phase): row}"""
        tiny = with_lists(scene_of("apps/thread_scaling/thread_scaling.xml"), """Study: {Elements: [40], Orders: [1, 3], Threads: [1, 2],
            Repetitions: 1, Repetitions of Runs: 1, Seconds: 0}""")
        self.study("thread_scaling", f"Study: {{{more}}}", scene=tiny)
        return {tuple(row.values())[:5]: row for row in self.rows("thread_scaling.csv")}

    def test_klu_is_timed_and_not_the_chains(self):
        """Elements in a row by KLU2 take several times as long as condensed ones. The column named KLU2 held the latter."""
        rows = self.measured("Elements: [2000], Orders: [1]")
        klu, chains = (float(rows["spatial", "2000", "1", "1", solver]["median_seconds"]) for solver in ("linear solver, KLU2", "linear solver"))
        self.assertGreater(klu, 2 * chains)  # 4 to 9 on machines at rest; 0.9 to 1.1 were the same solver twice

    def test_tiny_size_writes_every_phase(self):
        rows, elements = self.measured(), 40
        for phase in ("residual", "element tangent", "condense chains", "assemble", "numeric factorisation", "solve", "check of the solve",
                      "recover", "update", "element work", "linear solver", "linear solver, KLU2", "whole iteration", "run, per iteration"):
            for kind in ("spatial", "planar"):
                self.expect(rows, (kind, "40", "1", "1", phase), (kind, "40", "3", "2", phase))
        self.assertNotIn(("spatial", "40", "2", "1", "solve"), rows)  # an order that was not asked for
        with_costs = 0  # ratios, costs and shares are numbers that fit together
        for row in rows.values():
            seconds, ratio, flops, rate, of_peak, of_bandwidth = (float(row[name]) for name in (
                "median_seconds", "ratio_to_unit", "flops_per_element", "flops_per_second", "share_of_flop_peak", "share_of_bandwidth"))
            self.assertGreater(ratio, 0)
            if math.isnan(flops):
                continue
            with_costs += 1
            self.assertAlmostEqual(flops * elements / seconds, rate, delta=1e-9 * rate)
            self.assertGreater(of_peak, 0)
            self.assertGreater(of_bandwidth, 0)
        self.assertGreater(with_costs, 0)
        self.assertGreater(float(list(self.rows("cases.csv")[0].values())[7]), 0)
        for file in ("machine.csv", "ceilings.csv", "cases.csv"):
            self.assertGreater(len(self.rows(file)), 1)
        self.expect(self.text("machine.csv"), "processor", "compiler", "flags", "version", "BLAS of the unit")

    def test_lattices_have_the_elements_asked_for(self):
        """Cubes of 3 points a side have 54 struts, less 12 between clamps; octets of 14 points 36, less 4; a sheet of 36 points 60, less 5."""
        rows = self.measured("Elements: [160], Orders: [2], Kinds: [cubic, octet, sheet]")
        for kind, elements in (("cubic", "84"), ("octet", "64"), ("sheet", "110")):
            for phase in ("numeric factorisation", "whole iteration", "run, per iteration"):
                self.assertIn((kind, elements, "2", "2", phase), rows)
        self.assertNotIn("spatial", {key[0] for key in rows})


APPLICATIONS = "rollup", "superimposed_rotation", "arc_segment", "helix", "helical_rod", "slope_discontinuity", "fork", "extremes", "trade"


class CommandLine(StudyCase):
    """What all applications share, and what a script reads of a run."""

    def test_help_and_parameters(self):
        for name in APPLICATIONS:
            with self.subTest(name):
                ended = self.ended("--help", executable=Path(PROGRAM).with_name(name))
                self.assertEqual((ended.returncode, ended.stderr), (0, ""))
                self.expect(ended.stdout, f"{name}: ", "usage: ", "--single", "--output", "--summary", "--threads", "--quiet",
                            "--print-parameters", "exit code: 0 ", "mpirun")
                self.expect(program("--print-parameters", folder=self.folder, name=name), "[Scene] required", "[Sections]", "[Points]", "[Members]",
                            "[Curve]", "[Supports]", "[Point Loads]", "[Distributed Loads]", "[Solver]", "[Load Path]", "[Newton]",
                            "[Linear Solver]", "[NOX] optional", "[Status Tests] optional", "[LOCA] optional", "[Study]", "[Expected]",
                            "Maximum Iterations: int", "Load Factor: double", "Source: string", "Stage: int")
        self.expect(program("--print-parameters", folder=self.folder, name="fork"),
                    "Orders: Array(int), 1 <= value <= 8; default {1, 2, 3, 4}", "Elements per Member", "Most Iterations")

    def test_the_summary_holds_what_a_script_wants(self):
        self.study("fork", "{}", "--single", "--summary", "new folder/summary.json")
        summary = self.text("new folder/summary.json")
        self.write("summary.json", summary)
        found = self.summary()
        self.assertEqual([found[name] for name in ("program", "threads", "ranks", "load_steps", "all_passed")], ["fork", 1, 1, 2, True])
        self.assertTrue(found["version"] and found["compiler"])
        self.assertTrue(2 < found["newton_iterations"] <= 24)  # both stages, one load step each
        for phase in ("total", "residual", "element tangent", "solve"):
            self.assertGreater(found["seconds"][phase], 0, phase)
        self.assertEqual(len(found["checks"]), 6)  # both configurations: expected values at load factor 1 and 2
        for check in found["checks"]:
            self.assertIs(check["pass"], True)
            self.assertTrue(all(isinstance(check[name], (int, float)) for name in ("value", "reference", "tolerance")))
            self.assertNotEqual(check["value"], check["reference"])  # the paper's digits, not our own
            self.expect(check["source"], "Humer, Steinbrecher, Pechstein")

    def test_quiet_means_no_progress(self):
        self.expect(program("--single", "--output", ".", folder=self.folder, name="fork"), "fork single: step   2", "load factor", "elapsed")
        quiet = program("--single", "--output", ".", "--quiet", folder=self.folder, name="fork")
        self.assertEqual(quiet.find("step"), quiet.find("steps,"))  # only in the closing line


if __name__ == "__main__":
    unittest.main()
