#!/usr/bin/python3
"""What a user can get wrong, tried on a real application: exit code 2 and a message with file, line, place in the file, what was seen, what is
allowed and the nearest name; 3 and the last converged state when there is no equilibrium; 1 for a missed expectation. A crash fails the test.

usage: bad_input_test.py MIXBEAM [CLASS]...
"""

import os
import unittest
from pathlib import Path

import h5py
from support import BAD_INPUT, CHECK_FAILED, NO_CONVERGENCE, PROGRAM, ROOT, InFolder, changed, program, scene_of, with_lists

APPLICATION = "slope_discontinuity"
FILE = f"apps/{APPLICATION}/{APPLICATION}.xml"
XML = (ROOT / FILE).read_text()


def with_solver(inside):
    return with_lists(scene_of(FILE), f"Solver: {{{inside}}}")


class BadInputCase(InFolder):
    def solve(self, *words, code=0):
        return program(*words, folder=self.folder, code=code, name=APPLICATION)

    def run_scene(self, text, *words, code=0):
        return self.solve(self.write_scene(text), "--single", "--output", "results", *words, code=code)

    def refused(self, *words, parts):
        self.expect(self.solve(*words, code=BAD_INPUT), f"{APPLICATION}: bad input: ", *parts)

    def scene_refused(self, text, *parts):
        self.expect(self.run_scene(text, code=BAD_INPUT), f"{APPLICATION}: bad input: ", "scene.", "ML path \"", *parts)


class Scenes(BadInputCase):
    def test_a_scene_that_is_in_order(self):
        """The twin of all tests below: the unchanged scene passes."""
        self.write_scene(XML)
        ended = self.ended("scene.xml", "--single", "--output", "results", executable=Path(PROGRAM).with_name(APPLICATION))
        self.assertEqual((ended.returncode, ended.stderr), (0, ""))
        self.expect(ended.stdout, "3 of 3 checks passed", without=["warning"])

    def test_scenes_with_one_change(self):
        """Misspelt names, structures that cannot be solved, expectations that are never compared."""
        for old, new, *parts in (
                ('name="Elements"', 'name="Elments"', '"Scene / Members / first / Elments"', "unknown name", '"Force Integration"',
                 'did you mean "Elements"?', "scene.xml:"),
                ('name="Orders"', 'name="Odrers"', '"Study / Odrers"', 'did you mean "Orders"?'),
                ("{1, 0, 0}", "{0, 0, 0}", '"Scene / Members / first"', "no length", '"clamp" (0, 0, 0)', '"first kink" (0, 0, 0)'),
                ('value="displacement"', 'value="dispalcement"', 'did you mean "displacement"?')):
            self.scene_refused(changed(XML, old, new), *parts)
        for entry, *parts in (("Point: tpi", "Point\"", '"tpi" is not a point', 'did you mean "tip"?'),
                              ("Load Factor: 1.5", "Load Factor\"", "value 1.5", "allowed: at most 1"),
                              ("Load Factor: 0.3", "Load Factor\"", "value 0.3", "no load step ended there", '"Steps"')):
            self.scene_refused(with_lists(scene_of(FILE), f"Expected: {{u1 of the tip: {{{entry}}}}}"), '"Expected / u1 of the tip / ' + parts[0],
                               *parts[1:])
        self.scene_refused(with_lists(scene_of(FILE), "Scene: {Supports: {clamp: {Fixed Rotation: [x, y]}}}"), '"Scene / Supports"',
                           "can move without strain in 1 way", "rotation about (0, 0, 1)", "allowed: supports that block")

    def test_paths_that_steps_of_the_load_factor_do_not_follow(self):
        for method in ("fixed", "adaptive"):
            for name, asked in (("Trace", "true"), ("Branch", "positive"), ("Control", "{Point: tip, Component: z, Target: 1}")):
                text = with_lists(with_solver(f"Load Path: {{Method: {method}}}"), f"Analysis: {{{name}: {asked}}}")
                self.scene_refused(text, f'"Analysis / {name}"', '"automatic"')

    def test_what_of_nox_is_offered(self):
        """It runs; what NOX has and this program's groups cannot serve is not offered."""
        search = "\"Solver / NOX / Line Search"
        for solver, *parts in (("Status Tests: {Test Type: NormG}", '"Solver / Status Tests"', "NormG"),
                               ("NOX: {Line Search: {Method: Bactrack}}", f'{search} / Method"', 'did you mean "Backtrack"?'),
                               ("NOX: {Line Search: {Method: Polynomial}}", f'{search} / Method"', '"Rotation Limited", "Full Step", "Backtrack"'),
                               ("NOX: {Line Search: {Full Step: {Full Step: 0.9}}}", f'{search} / Full Step"', "unknown name"),
                               ("NOX: {Line Search: {Polynomial: {}}}", f'{search} / Polynomial"', "allowed", "Backtrack"),
                               ("NOX: {Solver Options: {Status Test Check Type: None}}", "Status Test Check Type", '"Complete", "Minimal"')):
            self.scene_refused(with_solver(solver), *parts)
        for method in ("Rotation Limited", "Full Step", "Backtrack"):
            self.expect(self.run_scene(with_solver(f"NOX: {{Line Search: {{Method: {method}}}}}")), "3 of 3 checks passed")

    def test_removed_parameters_are_warned_of(self):
        text = with_solver("Newton: {Tangent Reuse: 2}, Linear Solver: {Precision: single}, Symmetric Tangent: true")
        self.expect(self.run_scene(text, "--summary", "summary.json"), "3 of 3 checks passed", "warning: scene.yaml:",
                    'YAML path "Solver / Newton / Tangent Reuse": this parameter was removed', 'YAML path "Solver / Linear Solver / Precision"',
                    'YAML path "Solver / Symmetric Tangent"')
        self.assertEqual(len(self.summary()["warnings"]), 3)
        self.scene_refused(with_solver("Newton: {Tangent Reus: 2}"), '"Solver / Newton / Tangent Reus"', "unknown name")


class Words(BadInputCase):
    def test_files_and_options(self):
        here = str(self.folder)
        self.write("empty.xml", "")
        self.write("half.xml", XML[:len(XML) // 2])
        for *words, parts in (("missing.xml", ["missing.xml: no such file"]),
                              (here, [f"{here}: is a directory"]),
                              ("empty.xml", ["empty.xml:1", "empty"]),
                              ("half.xml", ["half.xml:", "not well-formed"]),
                              ("a.xml", "b.xml", ["two scene files", '"a.xml"', '"b.xml"', "allowed: one"]),
                              ("--singel", ['"--singel"', 'did you mean "--single"?', '"--print-parameters"']),
                              ("-x", ['"-x"', 'allowed: "--help"']),
                              ("--output", ["--output needs a value"]),
                              ("--output", "--single", ["--output needs a value", '"--single" follows']),
                              *(("--threads", threads, [f'--threads: value "{threads}"', "from 1 to"])
                                for threads in ("0", "-1", "two", "2x", "100000"))):
            self.refused(*words, parts=parts)

    def test_places_that_cannot_be_written_to(self):
        self.write("file", "")
        for option, place, *parts in (("--output", "file/below", "cannot be created", "Not a directory"), ("--output", "file"),
                                      ("--summary", str(self.folder), "is a folder"),
                                      ("--summary", "file/below/summary.json", "cannot be created")):
            self.refused(option, place, parts=[place.removesuffix("/summary.json"), *parts])

    def test_a_summary_never_replaces_the_scene(self):
        self.write_scene(XML)
        os.link(self.folder / "scene.xml", self.folder / "same")
        os.symlink("scene.xml", self.folder / "link")
        for name in ("scene.xml", "same", "link"):
            self.refused("scene.xml", "--single", "--summary", name, "--output", "results",
                         parts=[name, f"cannot be written: it is the input {self.folder}/scene.xml"])
            self.assertEqual(self.text("scene.xml"), XML, name)


class Failures(BadInputCase):
    def test_missed_expectations_fail_the_run(self):
        self.expect(self.run_scene(changed(XML, 'value="-1.535072"', 'value="-1.535082"'), code=CHECK_FAILED), "FAIL  u1 of the tip = -1.53507",
                    "reference -1.535082", "from Humer", "1 FAILED")

    def test_no_convergence_leaves_the_last_converged_state(self):
        """The first step takes 5 iterations, the second one 6 and may not be shortened: the path ends half way."""
        text = with_solver("Newton: {Maximum Iterations: 5}, Load Path: {Method: adaptive, Initial Step: 0.1, Minimum Step: 0.1}")
        self.expect(self.run_scene(text, "--summary", "summary.json", code=NO_CONVERGENCE), "no convergence: ", "beyond load factor ",
                    "minimum of 0.1", "What to try", '"Minimum Step"', '"Maximum Iterations"', '"Maximum Rotation"', "results/single.h5")
        self.expect(self.text("results/single_failure.txt"), "beyond load factor", "What to try")
        found = self.summary()
        self.assertIs(found["all_passed"], False)
        self.expect(found["failure"], "beyond load factor")
        self.assertGreater(found["newton_iterations"], 0)
        with h5py.File(self.folder / "results/single.h5") as file:
            self.assertTrue(0 < file["steps/000001"].attrs["load_factor"] < 1)

    def test_a_state_that_is_not_a_number_is_no_solution(self):
        """The force is so large that its squares overflow."""
        self.expect(self.run_scene(changed(XML, "{-10, 0, -10}", "{-1e308, 0, -1e308}"), code=NO_CONVERGENCE), "no convergence",
                    "does not solve the equations", "allowed 1e-08")

    def test_a_failed_run_does_not_leave_the_summary_of_an_earlier_one(self):
        self.write("summary.json", '{"all_passed": true}')
        self.run_scene(changed(XML, 'value="1e4"', 'value="abc"'), "--summary", "summary.json", code=BAD_INPUT)
        self.assertFalse((self.folder / "summary.json").exists())


if __name__ == "__main__":
    unittest.main()
