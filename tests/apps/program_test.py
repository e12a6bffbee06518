#!/usr/bin/python3
"""The program `mixbeam` as a user runs it: every subcommand, exit codes, Ctrl-C, and what is left when it is killed.

usage: program_test.py MIXBEAM [CLASS]...
"""

import fcntl
import json
import os
import random
import re
import shutil
import signal
import subprocess
import time
import unittest

from support import (BAD_INPUT, CHECK_FAILED, INTERRUPTED, NO_CONVERGENCE, PROGRAM, ROOT, InFolder, changed, complete_steps, contents, differences,
                     scene_of, with_lists)

FORK, FRAME = "apps/fork/fork.xml", "apps/verification/lee_frame.xml"


def fork(more):
    return with_lists(scene_of(FORK), more)


def one_element(load, more, members=""):
    """One rod of one element from a clamp to "tip", which a load acts on; `more` entries of the scene."""
    return f"""Analysis: {{Stability: false}}
Scene:
  Sections: {{rod: {{EA: 1e6, Shear Rigid: true, GIt: 1, EI2: 1, EI3: 1}}}}
  Members: {{beam: {{Start: wall, End: tip, Section: rod, Order: 1, Elements: 1}}{members}}}
  Point Loads: {{load: {{Point: tip, {load}}}}}
  {more}
"""


def rolled_up(share):
    """By a tip moment to this share of the angle at which the ends of its element stand at pi."""
    return one_element(f"Moment: [0, 0, {share * 6.283185307179586!r}]", """Points: {wall: [0, 0, 0], tip: [1, 0, 0]}
  Supports: {clamp: {Point: wall}}""")


def pushed_bar(stiffness):
    """A bar between two walls, pushed in the middle along its axis."""
    bar = one_element("Force: [1, 0, 0]", """Points: {wall: [0, 0, 0], tip: [1, 0, 0], far: [2, 0, 0]}
  Supports: {clamp: {Point: wall}, end: {Point: far}}""", ", other: {Start: tip, End: far, Section: rod}")
    return changed(bar, "1e6", stiffness)


def column(load, lists=""):
    """A column of length one and EI = 1, its foot clamped, under the axial load P; P_cr = pi^2 / 4."""
    return f"""Scene:
  Sections: {{rod: {{EA: 1e6, Shear Rigid: true, GIt: 1, EI2: 2, EI3: 1}}}}
  Points: {{foot: [0, 0, 0], tip: [1, 0, 0]}}
  Members: {{rod: {{Start: foot, End: tip, Section: rod, Order: 5, Elements: 4}}}}
  Supports: {{foot: {{Point: foot}}}}
  Point Loads: {{weight: {{Point: tip, Force: [-{load}, 0, 0]}}}}
{lists}"""


def expecting_stable(value):
    return f"Expected: {{end: {{Quantity: stable, Value: {value}, Source: Euler}}}}\n"


def last_line(text):
    return text.splitlines()[-1]


class Runs(InFolder):
    def test_a_run_writes_everything_and_checks_it(self):
        out = self.run_scene((ROOT / FORK).read_text())
        self.expect(out, '"Study" belongs to a benchmark program', "step   2", "displacement of", "reaction at", "strain energy",
                    "estimated discretization error", "displacement, any vertex", "loads and reactions balance", "8 of 8 checks passed", "scene.h5")
        found = self.contents()
        self.expect(found, "scene", "version", "supports/0@point", "members/points_per_element", "steps/000002/residual_history",
                    "steps/000002/reactions", "steps/000002/balance", "steps/000002/state/interior", "steps/000002/error_estimate@energy_error",
                    "steps/000002/error_estimate/vertex_displacement", "steps/000002/error_estimate/points/P1", "monitor/moment_energy",
                    "monitor/clamp.reaction_moment", without=["steps/000001/error_estimate"])  # of the state at the end only
        self.assertEqual(complete_steps(found), 3)
        table = self.text("results/scene-monitor.csv")
        self.expect(table, "step,load_factor,", "P1.displacement.x", "clamp.reaction_force.z")
        self.assertEqual(table.count("\n"), 4)  # the head and three steps
        self.expect(self.text("results/scene.xdmf"), "/steps/000002/position")

    def test_error_estimate_on_request_only(self):
        self.run_scene(fork("Analysis: {Error Estimate: 'on'}"))
        self.expect(self.text("summary.json"), '"estimated_errors"', '"strain energy"', '"displacement of P1"', '"relative"')
        self.expect(self.run_scene(fork("Analysis: {Error Estimate: 'off'}")), without=["discretization error"])
        self.expect(self.text("summary.json"), without=["estimated_errors"])
        self.run_scene(fork("Analysis: {Error Estimate: maybe}"), code=BAD_INPUT)

    def test_exit_codes(self):
        self.run_scene(changed(scene_of(FORK), "-1.088614", "-1.088624"), code=CHECK_FAILED)
        self.expect(self.run_scene(fork("Solver: {Newton: {Maximum Iterations: 1}}"), code=NO_CONVERGENCE), "no convergence",
                    "The last converged state is the last step in", "scene.h5")
        self.contents()

    def test_an_element_that_reaches_pi_at_the_end_leaves_the_page_of_a_failure(self):
        page, words = self.folder / "results/scene_failure.txt", "turns by pi against its vertices"
        self.run_scene(rolled_up(1 - 1e-6))
        self.assertFalse(page.exists())
        self.expect(self.run_scene(rolled_up(1 - 1e-11), code=NO_CONVERGENCE), "no convergence", words, "What to try")
        self.expect(page.read_text(), words, '"Elements"')

    def test_warns_of_forces_that_rounding_errors_share(self):
        self.expect(self.run_scene(pushed_bar("1e6")), without=["rounding errors"])
        self.expect(self.text("summary.json"), without=["rounding errors"])
        self.expect(self.run_scene(pushed_bar("1e15")), "warning: member", "rounding errors")
        self.expect(self.text("summary.json"), '"warnings"', "rounding errors")

    def test_values_of_a_load_case_that_no_step_compares_are_an_error(self):
        self.write_scene(with_lists(scene_of("apps/verification/elastica.xml"), "Expected: {'deflection, alpha 10': {Load Factor: 0.123}}"))
        words = "run", "scene.yaml", "--quiet", "--output", "results"
        self.expect(self.mixbeam(*words, code=BAD_INPUT), "deflection, alpha 10", "0.123", "no load step ended there")
        self.mixbeam(*words, "--case", "alpha 1")

    def test_critical_points_that_are_expected_must_be_there(self):
        frame = scene_of(FRAME)
        missed = with_lists(frame, "Expected: {'load, first limit point': {Critical Point: 7}}")
        self.expect(self.run_scene(missed, "--quiet", code=CHECK_FAILED), "FAIL",
                    "critical point 7 did not come; critical points on the path: 3", "FAILED")
        self.expect(self.text("summary.json"), '"pass": false', "critical point 7 did not come", '"all_passed": false')
        self.expect(self.check_scene(with_lists(frame, "Analysis: {Stability: false}"), BAD_INPUT), "Critical Point", '"Stability" = false')

    def test_the_last_word_is_whether_the_end_is_stable(self):
        """Euler: the straight column is stable up to pi^2 / 4 = 2.467."""
        falls = "a real structure does not stay there"
        below = self.run_scene(column("2.4", expecting_stable("true")), "--quiet")
        self.assertEqual(last_line(below), "scene: stable: true")
        self.expect(self.text("summary.json"), '"stable": "true"', without=["warnings"])
        self.expect(last_line(self.text("results/scene-monitor.csv")), ",true")

        above = self.run_scene(column("2.5"), "--quiet")
        self.assertEqual(last_line(above), f"scene: stable: false (1 negative eigenvalue): {falls}")
        self.expect(above, "checks passed, 1 warning.")
        self.expect(self.text("summary.json"), '"stable": "false"', '"warnings"', falls)
        head, *_, last = self.text("results/scene-monitor.csv").splitlines()
        self.expect(head, ",stable")
        self.expect(last, ",false")
        self.expect(str(self.contents()["steps/000001@stable"]), "false")

        self.expect(last_line(self.run_scene(column("2.5", "Analysis: {Stability: false}"), "--quiet")), "scene: stable: unknown")
        self.expect(self.text("summary.json"), without=["warnings"])

    def test_stable_may_be_expected(self):
        for load, value, code in (("2.5", '"false"', 0), ("2.5", "false", 0), ("2.5", "true", CHECK_FAILED), ("2.4", "unknown", CHECK_FAILED),
                                  ("2.4", "maybe", BAD_INPUT)):
            self.run_scene(column(load, expecting_stable(value)), "--quiet", code=code)

    def test_structures_far_from_the_origin_balance(self):
        """Coordinates of 1e8 have 1e-8 of the length left."""
        def bent_at(start, end):
            text = changed(changed(column("1"), "[1, 0, 0]", end), "[0, 0, 0]", start)
            return self.run_scene(changed(text, "[-1, 0, 0]", "[0.1, 0.3, 0.2]"), "--quiet")
        bent_at("[1e8, 2e8, 1e8]", "[100000000.6, 200000000.48, 100000000.64]")
        self.expect(bent_at("[0, 0, 0]", "[0.6, 0.48, 0.64]"), "allowed 1e-10")

    def test_a_bar_that_is_only_stretched_balances(self):
        """A slanted bar is stretched along itself: no moment is at work but those that its forces have about its middle, and the rows of
        3000 elements leave 1e-8 of the little that rounding leaves of its bending moments."""
        def stretched(lists, code):
            text = column("1", lists)
            for old, new in (("[1, 0, 0]", "[0.6, 0.48, 0.64]"), ("[-1, 0, 0]", "[0.6, 0.48, 0.64]"), ("Order: 5", "Order: 1"),
                             ("Elements: 4", "Elements: 3000")):
                text = changed(text, old, new)
            return self.run_scene(text, "--quiet", code=code)
        self.expect(stretched("", 0), "loads and reactions balance: ")
        # the twin: the undeformed bar is taken for the equilibrium (by fixed steps, which do not start from a prediction)
        loose = "Solver: {Load Path: {Method: fixed}, Status Tests: {Test Type: NormF, Tolerance: 2.0}}"
        self.expect(stretched(loose, CHECK_FAILED), "DO NOT BALANCE: forces 1.0e+00")

    def test_errors_of_a_structure_without_loads_are_not_relative(self):
        """Without loads nothing moves, and errors are rounding: none is relative, none is warned of."""
        bow = "  Imperfection: {Bows: {bow: {Member: rod, Share: 0.01, Direction: [0, 1, 0.5]}}}\n"
        self.expect(self.run_scene(column("0", bow)), "displacement, any vertex", "        -\n",
                    without=["1.0e+00", "estimated error of displacements is"])
        loaded = self.run_scene(column("1", bow))  # the twin
        self.assertRegex(loaded, r"displacement, any vertex.*[^-]\n")

    def test_ends_that_are_pushed_past_each_other_bend_the_member(self):
        """A strip of length one whose hinged ends are pushed past each other bends into a loop: 29.38 EI at the end, by elliptic integrals. It
        used to end straight and turned inside out, in one step that was stable by its numbers."""
        for value, code in (("29.38259871", 0), ("1.2e8", CHECK_FAILED)):
            self.run_scene(f"""Scene:
  Sections: {{rod: {{EA: 1e8, Shear Rigid: true, GIt: 1, EI2: 1, EI3: 5}}}}
  Points: {{a: [0, 0, 0], b: [0, 0, 1]}}
  Members: {{rod: {{Start: a, End: b, Order: 5, Elements: 8, Second Axis: [0, 1, 0]}}}}
  Supports:
    a: {{Point: a, Fixed Rotation: [x, z]}}
    b: {{Point: b, Fixed Rotation: [x, z], Prescribed Displacement: [0, 0, -1.2]}}
Analysis: {{Branch: positive}}
Expected: {{push: {{Quantity: reaction force, Point: b, Component: z, Value: -{value}, Relative Tolerance: 1e-5, Source: elastica}}}}
""", code=code)

    def test_load_factors_where_no_step_ends_are_refused_before_the_run(self):
        """By `check` as by `run`."""
        def asked(command, load_factor, lists, code=BAD_INPUT):
            text = column("2.4", changed(expecting_stable("true"), "Value", f"Load Factor: {load_factor}, Value") + lists)
            return self.run_scene(text, "--quiet", code=code) if command == "run" else self.check_scene(text, code)
        fixed, quarters = "Solver: {Load Path: {Method: fixed, Steps: 4}}\n", "Solver: {Load Path: {Maximum Step: 0.25}}\n"
        for command in ("check", "run"):
            self.expect(asked(command, "0.5", ""), '"Expected / end / Load Factor"', "value 0.5", "no load step ended there", '"Steps"')
            self.assertFalse((self.folder / "results/scene.h5").exists())
        for load_factor, lists, code in (("1", "", 0), ("0.5", quarters, 0), ("0.6", quarters, BAD_INPUT), ("0.6", fixed, BAD_INPUT),
                                         ("0.5", fixed, 0)):
            asked("check", load_factor, lists, code)
        asked("run", "0.5", fixed, 0)


class Checks(InFolder):
    def test_check_measures_and_solves_nothing(self):
        xml = (ROOT / FORK).read_text()
        # 31 vertices of 6 unknowns; shaft 1 and two quarter circles of radius 1; forces of 200 in z, then -200 on top
        self.expect(self.check_scene(xml), "members 3, elements 30, vertices 31", "equations to solve 186", "total length 4.14159265",
                    "box (0, -1, 0) to (2, 1, 0)", "stage 1: force (0, 0, 200)", "stage 2: force (0, 0, 0)", "in order", without=["fast path"])
        self.assertFalse((self.folder / "results").exists())
        self.expect(self.check_scene(changed(xml, 'name="EA"', 'name="EB"'), BAD_INPUT), "scene.xml:", 'did you mean "EA"?')

    def test_parameters_as_text_and_markdown(self):
        self.expect(self.mixbeam("parameters"), "[Scene] required", "Maximum Iterations: int", "[Expected]")
        markdown = self.mixbeam("parameters", "--markdown")
        self.expect(markdown, "# Parameters of a scene file", "- [Scene](#scene): [Variables](#scene--variables), ",
                    "\n## Scene\n\nRequired. ", "\n### Scene / Members\n\nOptional. ", "| Maximum Iterations | int", "| --- |", "\\<member>")
        self.assertEqual((ROOT / "apps/docs/parameters.md").read_text(), markdown,
                         "to bring it up to date: mixbeam parameters --markdown > apps/docs/parameters.md")

    def test_command_line(self):
        self.expect(self.mixbeam("--version"), "mixbeam ")
        self.expect(self.mixbeam("--help"), "run SCENE.xml", "resume RESULTS.h5", "exit code: 0")
        for command in ("run", "check", "parameters", "resume", "plot"):
            self.expect(self.mixbeam(command, "--help"), f"usage: mixbeam {command}", "exit code: 0")
        self.expect(self.mixbeam("view", "results.h5", "--help"), "usage: mixbeam view")
        self.write_scene(scene_of(FORK))
        self.write("a.xml", "<a/>")
        for words, *parts in (((), "a command is missing", '"check"'),
                              (("resmue",), 'did you mean "resume"?'),
                              (("beam.xml",), 'did you mean "mixbeam run beam.xml"?'),
                              (("run",), "a scene file is missing"),
                              (("run", "x.xml", "--qiet"), 'did you mean "--quiet"?'),
                              (("run", "scene.yaml", "--case", "wind"), '"wind" is not a load case', "has none"),
                              (("resume", "none.h5"), "none.h5: no such file"),
                              (("resume", "a.xml"), "a.xml: not an HDF5 file"),
                              (("plot",), "a result file is missing")):
            self.expect(self.mixbeam(*words, code=BAD_INPUT), "mixbeam: bad input: ", *parts)

    def test_lost_output_is_noticed(self):
        def code_of(to):
            return subprocess.run(["bash", "-c", f"'{PROGRAM}' --help 2> err {to}"], cwd=self.folder, check=False).returncode
        self.assertEqual(code_of("> /dev/full"), BAD_INPUT)
        self.expect(self.text("err"), "standard output cannot be written: No space left")
        self.assertEqual(code_of("> >(exec true); exit $?"), 0, "a reader that has gone")
        self.assertEqual(code_of(">&-"), 0)
        self.assertEqual(code_of("> /dev/null"), 0)

    def test_warns_of_an_origin_far_away(self):
        """Coordinates of 1e8 have eight digits of a length of one, those of 1e6 ten."""
        def checked(place):
            return self.check_scene(changed(changed(column("1"), "[0, 0, 0]", f"[0, {place}, 0]"), "[1, 0, 0]", f"[1, {place}, 0]"))
        self.expect(checked("1e8"), "coordinates up to 1e+08 are rounded to about 2.2e-08 of the size of the structure")
        self.expect(checked("1e6"), without=["are rounded to about"])

    def test_members_off_the_fast_path_are_named(self):
        """Their elements or chains take longer; plain ones under dead loads are not among them."""
        self.expect(self.check_scene("""
Scene:
  Sections:
    even: {EA: 1e4, GA2: 5e3, GA3: 5e3, GIt: 1, EI2: 1, EI3: 1}
    coupled: {Matrix: [1e4,0,0,0,1,0, 0,5e3,0,0,0,0, 0,0,5e3,0,0,0, 0,0,0,1,0,0, 1,0,0,0,1,0, 0,0,0,0,0,1]}
  Points: {a: [0, 0, 0], b: [1, 0, 0], c: [2, 0, 0], d: [3, 0, 0], e: [4, 0, 0]}
  Members:
    plain: {Start: a, End: b, Section: even, Order: 2, Elements: 2, Inner Points: {inside: 0.5}}
    tapered: {Start: b, End: c, Section: even, End Section: even, Order: 2, Elements: 2}
    matrix: {Start: c, End: d, Section: coupled, Order: 2, Elements: 2}
    pushed: {Start: d, End: e, Section: even, Order: 2, Elements: 2, Inner Points: {middle: 0.5}}
  Supports: {clamp: {Point: a}}
  Distributed Loads:
    weight: {Member: plain, Force: [0, 0, -1]}
    wind: {Member: pushed, Frame: follower, Force: [0, 1, 0]}
  Point Loads:
    dead: {Point: inside, Force: [0, 0, 1]}
    couple: {Point: middle, Moment: [0, 0, 1]}
"""), 'off the fast path by a taper: "tapered"\n', 'by a 6 x 6 matrix: "matrix"\n', 'by line loads without potential: "pushed"\n',
                    'by moments or followers at inner points: "pushed"\n')

    def controlled(self, component, point="tip", load="1", code=0):
        control = f"Analysis: {{Control: {{Point: {point}, Component: {component}, Target: -0.1}}}}\n"
        return self.check_scene(column(load, control), code)

    def test_a_controlled_displacement_that_the_load_does_not_move_is_told(self):
        """An axial load does not move the tip sideways at first; along the axis, or with a lateral force, it does."""
        self.expect(self.controlled("y"), 'does not move point "tip" along y at first', '"Branch"', "small load along y")
        self.expect(self.controlled("x"), without=["warning"])
        self.expect(self.controlled("y", load="1, 1e-3, 0]}, none: {Point: tip, Force: [0"), without=["warning"])

    def test_a_controlled_displacement_is_free(self):
        """What a support fixes cannot grow to a target."""
        self.expect(self.controlled("x", "foot", code=BAD_INPUT),
                    '"Analysis / Control / Component": value "x", but a support fixes it at "foot"')
        self.controlled("x")  # the twin

    def test_a_controlled_displacement_needs_a_load(self):
        """Nothing grows with the load factor, which is the unknown."""
        loaded = column("1", "Analysis: {Control: {Point: tip, Component: x, Target: -0.1}}\n")
        self.write_scene(changed(loaded, "  Point Loads: {weight: {Point: tip, Force: [-1, 0, 0]}}\n", ""))
        for command in ("check", "run"):
            self.expect(self.mixbeam(command, "scene.yaml", code=BAD_INPUT), '"Analysis / Control": given, but nothing acts',
                        "Prescribed Displacement")
        self.check_scene(loaded)


TABLES = """Scene:
  Sections: {rod: {EA: 50, GA2: 50, GA3: 50, GIt: 50, EI2: 50, EI3: 50}}
  Import: {Points File: points.csv, Members File: members.csv, Section: rod}
  Supports: {clamp: {Point: A}}
  Point Loads: {pull: {Point: C, Force: [0, 20, 5]}}
Solver: {Load Path: {Method: fixed, Steps: 100}}
"""  # a cantilever from two tables, bent in a hundred steps


class Resumed(InFolder):
    def cut(self, steps):
        """What a run leaves that is killed after these steps."""
        shutil.rmtree(self.folder / "cut", ignore_errors=True)
        process = self.start("run", "scene.yaml", "--output", "cut")
        self.wait_for_steps("cut/scene-monitor.csv", steps)
        process.kill()
        process.wait()
        return self.contents("cut/scene.h5")

    def write_tables(self, end):
        self.write("points.csv", f"A,0,0,0\nB,1,0,0\nC,{end},0.5,0\n")
        self.write("members.csv", "name,start,end,elements\nm,A,B,10\nn,B,C,10\n")

    def test_without_the_imported_files(self):
        """The result file keeps the tables: deleted or changed, they do not matter to a run that goes on."""
        self.write_scene(TABLES)
        self.write_tables("2")
        self.mixbeam("run", "scene.yaml", "--output", "whole", "--quiet")
        whole = self.contents("whole/scene.h5")
        self.expect(whole, "imported/0/text", "imported/1/text")
        for deleted in (True, False):
            self.write_tables("2")
            left = complete_steps(self.cut(3))
            self.assertTrue(2 <= left < complete_steps(whole), left)
            self.write_tables("3")
            if deleted:
                (self.folder / "points.csv").unlink()
                (self.folder / "members.csv").unlink()
            self.mixbeam("resume", "cut/scene.h5", "--quiet")
            self.assertEqual(differences(whole, self.contents("cut/scene.h5")), [])
            self.mixbeam("run", "scene.yaml", "--output", "other", "--quiet", code=BAD_INPUT if deleted else 0)  # it does need them
        self.assertNotEqual(differences(whole, self.contents("other/scene.h5")), [])  # the change does matter to a run

    def test_no_output_replaces_an_imported_table(self):
        self.write_tables("2")
        table = self.text("points.csv")
        self.write("scene-monitor.csv", table)
        self.write_scene(changed(TABLES, "points.csv", "scene-monitor.csv"))
        self.expect(self.mixbeam("run", "scene.yaml", "--output", ".", "--quiet", code=BAD_INPUT),
                    "scene-monitor.csv: cannot be written: it is the input")
        self.assertEqual(self.text("scene-monitor.csv"), table)
        self.mixbeam("run", "scene.yaml", "--output", "results", "--quiet")
        self.assertEqual(self.text("scene-monitor.csv"), table)

    def test_a_path_through_limit_points(self):
        """It goes on with the same bits, and values at critical points before the stop are compared."""
        self.write_scene(scene_of(FRAME))
        self.expect(self.mixbeam("run", "scene.yaml", "--output", "whole"), "critical point 2: limit point at load factor 0.618557")
        for steps in (3, 8):
            self.cut(steps + 1)
            self.expect(self.mixbeam("resume", "cut/scene.h5"), "critical point 1: bifurcation",
                        "collapse: bifurcation at load factor 0.3540823256", "8 of 8 checks passed")
            self.assertEqual(differences(self.contents("whole/scene.h5"), self.contents("cut/scene.h5")), [])

    def test_at_the_end_it_tells_the_same(self):
        """A value that was compared when the file was written is compared again from it, without solving anything."""
        first = self.run_scene(column("2.5", expecting_stable("false")), "--quiet")
        again = self.mixbeam("resume", "results/scene.h5", "--quiet", "--summary", "again.json")
        self.assertEqual(last_line(again), last_line(first))
        self.assertEqual(json.loads(self.text("again.json"))["ends"][0]["load_factor"], 1)

    def test_what_remembers_more_is_refused(self):
        self.run_scene(fork("Solver: {LOCA: {Predictor: {Method: Secant}}}"))
        self.expect(self.mixbeam("resume", "results/scene.h5", code=BAD_INPUT), "cannot be resumed",
                    "extrapolates from steps before the last one")


class Disturbed(InFolder):
    """A run of many steps and what it writes when nobody disturbs it: the fork's two stages."""

    def setUp(self):
        super().setUp()
        self.write_scene(fork("Solver: {Load Path: {Initial Step: 0.05, Maximum Step: 0.05}}"))
        begin = time.monotonic()
        self.mixbeam("run", "scene.yaml", "--output", "whole", "--threads", "2")
        self.seconds = time.monotonic() - begin
        self.whole = self.contents("whole/scene.h5")
        self.steps = complete_steps(self.whole)
        self.assertGreaterEqual(self.steps, 30)

    def start_run(self):
        shutil.rmtree(self.folder / "cut", ignore_errors=True)
        return self.start("run", "scene.yaml", "--output", "cut")

    def expect_resumes_to_the_same_bits(self, threads):
        self.mixbeam("resume", "cut/scene.h5", "--threads", threads, "--quiet")
        self.assertEqual(differences(self.whole, self.contents("cut/scene.h5")), [])
        for name in ("scene-monitor.csv", "scene.xdmf"):
            self.assertEqual(self.text(f"cut/{name}"), self.text(f"whole/{name}"), name)
        self.assertEqual(len(os.listdir(self.folder / "cut")), 3)

    def test_killed_at_any_moment_it_leaves_every_completed_step_and_resumes(self):
        """As many kills between the first and the last step as the environment variable MIXBEAM_KILLS says."""
        seed = 20261121
        moments = random.Random(seed)
        wanted = int(os.environ.get("MIXBEAM_KILLS", "8"))
        kills = in_the_middle = 0
        longest_wait = self.seconds  # follows the speed of the machine, which other programs share
        while in_the_middle < wanted and kills < 6 * wanted:
            with self.subTest(kill=kills, seed=seed):
                process = self.start_run()
                kills += 1
                time.sleep(moments.uniform(0.05, 1.0) * longest_wait)
                process.kill()
                process.wait()
                if not (self.folder / "cut/scene.h5").exists():  # killed before there was anything to keep
                    longest_wait *= 1.05
                    continue
                left = self.contents("cut/scene.h5")
                steps = complete_steps(left)
                self.assertEqual([name for name in left if name.startswith("steps/") and left[name] != self.whole[name]], [])
                if 0 < steps < self.steps:
                    in_the_middle += 1
                elif steps > 0:
                    longest_wait *= 0.9  # too late
                self.expect_resumes_to_the_same_bits(str(kills % 2 + 1))
        self.assertGreaterEqual(in_the_middle, wanted / 2, "most kills missed the run")

    def test_a_second_run_is_refused_and_touches_nothing(self):
        first = self.start_run()
        self.wait_for_steps("cut/scene-monitor.csv", 2)
        first.send_signal(signal.SIGSTOP)
        result = self.folder / "cut/scene.h5"
        before = result.read_bytes()
        for words in (("run", "scene.yaml", "--output", "cut"), ("resume", "cut/scene.h5")):
            self.expect(self.mixbeam(*words, code=BAD_INPUT), "scene.h5", f"process {first.pid} on ")
        self.assertEqual(result.read_bytes(), before)
        first.send_signal(signal.SIGCONT)
        first.communicate()
        self.assertEqual(first.returncode, 0)
        self.assertEqual(differences(self.whole, contents(result)), [])

    def test_damaged_files_are_refused_by_name_and_go_on_from_a_whole_step(self):
        file = self.folder / "whole/scene.h5"
        damaged = bytearray(file.read_bytes())
        damaged[len(damaged) * 9 // 10] ^= 1  # among the last steps
        file.write_bytes(damaged)
        for command in ("verify", "resume", "plot"):
            refusal = self.mixbeam(command, "whole/scene.h5", code=BAD_INPUT)
            self.expect(refusal, "whole/scene.h5: damaged: bytes ", "; in them /steps/", "--from ")
        # what a run that goes on rewrites looks damaged as well: who resumes it is told of the run
        with open(file.with_name(".scene.h5.lock"), "w", encoding="utf-8") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            print(f"process {os.getpid()} on a host", file=lock, flush=True)
            self.expect(self.mixbeam("resume", "whole/scene.h5", code=BAD_INPUT), "scene.h5", f"process {os.getpid()} on ", without=["damaged"])
        step = re.search(r"--from (\d+)", refusal)[1]
        self.mixbeam("verify", "whole/scene.h5", "--from", step)
        self.expect(self.mixbeam("resume", "whole/scene.h5", "--from", step, "--quiet"), f"Resuming after step {step},")
        self.assertEqual(differences(self.whole, contents(file)), [])
        self.mixbeam("verify", "whole/scene.h5")
        self.mixbeam("resume", "whole/scene.h5", "--from", "9999", code=BAD_INPUT)

    def test_damaged_time_series_lose_no_step(self):
        """The series of a run are made anew from its steps, unless the same block holds what all steps need."""
        file, rows = self.folder / "whole/scene.h5", self.text("whole/scene-monitor.csv")
        whole, made_anew = file.read_bytes(), 0
        for name, series in self.whole.items():
            if not name.startswith("monitor/") or "@" in name or series == "group":
                continue
            damaged = bytearray(whole)
            begin = series[1][:24]  # three numbers: they follow each other nowhere else
            damaged[whole.index(begin) + 23] ^= 1
            file.write_bytes(damaged)
            refusal = self.mixbeam("resume", "whole/scene.h5", code=BAD_INPUT)
            self.expect(refusal, "damaged: bytes ")
            step = re.search(r"--from (\d+)", refusal)
            if "in them /monitor" not in refusal or not step:
                continue
            made_anew += 1
            self.mixbeam("resume", "whole/scene.h5", "--from", step[1], "--quiet")
            self.assertEqual(differences(self.whole, contents(file)), [], name)
            self.assertEqual(self.text("whole/scene-monitor.csv"), rows, name)
        self.assertGreater(made_anew, 0)

    def test_ctrl_c_finishes_the_step_and_says_how_to_resume(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            process = self.start_run()
            self.wait_for_steps("cut/scene-monitor.csv", 3)
            process.send_signal(number)
            out, err = process.communicate()
            self.assertEqual(process.returncode, INTERRUPTED, err)
            self.expect(err, "once more to end at once")
            # what was not reached is not checked, nor is its end
            self.expect(out, "Stopped after step", "mixbeam resume", "cut/scene.h5", without=["FAIL", ": stable: "])
            left = complete_steps(self.contents("cut/scene.h5"))
            self.assertTrue(2 < left < self.steps, left)
            self.expect_resumes_to_the_same_bits("2")

    def test_resuming_a_finished_run_changes_nothing(self):
        shutil.copytree(self.folder / "whole", self.folder / "cut")
        self.expect_resumes_to_the_same_bits("1")


if __name__ == "__main__":
    unittest.main()
