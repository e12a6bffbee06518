#!/usr/bin/python3
"""Load cases side by side (run --jobs): as if one after another, whatever happens to the processes.

usage: case_processes_test.py MIXBEAM [CLASS]...
"""

import os
import re
import shutil
import signal
import time
import unittest
from pathlib import Path

from support import BAD_INPUT, CHECK_FAILED, INTERRUPTED, NO_CONVERGENCE, PROGRAM, InFolder, complete_steps, contents, differences


def scene(steps, side="[0, 2, 0]", elements=8):
    """A cantilever under two loads and their combination. Some warnings, some checks, of which one fails."""
    return f"""Scene:
  Load Cases: [down, side]
  Combinations: {{both: {{down: 1, side: -0.5}}}}
  Points: {{root: [0, 0, 0], tip: [1, 0, 0]}}
  Sections: {{round: {{EA: 1e4, GA2: 1e4, GA3: 1e4, GIt: 1, EI2: 1, EI3: 1, Largest Strain: 1e-6}}}}
  Members: {{rod: {{Start: root, End: tip, Order: 3, Elements: {elements}}}}}
  Supports: {{wall: {{Point: root}}}}
  Point Loads:
    down: {{Point: tip, Force: [0, 0, -1], Case: down}}
    side: {{Point: tip, Case: side, Force: {side}}}
Quantities: {{sag: {{Quantity: displacement, Point: tip}}}}
Expected:
  down: {{Quantity: sag.z, Case: down, Value: -0.3, Absolute Tolerance: 1e-2, Source: a guess}}
  side: {{Quantity: sag.z, Case: side, Value: 1, Absolute Tolerance: 1e-2, Source: a guess}}
Solver: {{Load Path: {{Method: fixed, Steps: {steps}}}}}
"""


def without_times(prints, folder):
    prints = re.sub(r"(?m)  elapsed.*$|(?<=^mixbeam: )(.*?)iterations.*$", r"\1", prints)
    return prints.replace(f"{folder}/", "/")


def ends_soon(process):
    """Within two seconds."""
    for _ in range(200):
        state = Path(f"/proc/{process}/stat")
        try:
            if ") Z " in state.read_text():
                return True
        except OSError:
            return True
        time.sleep(0.01)
    return False


class SideBySide(InFolder):
    def words(self, folder, jobs):
        return "run", "scene.yaml", "--output", folder, "--jobs", str(jobs), "--summary", f"{folder}.json"

    def summary_of(self, folder):
        """Without what tells of this run alone."""
        self.write("summary.json", self.text(f"{folder}.json"))
        return {name: value for name, value in self.summary().items() if name not in ("seconds", "threads")}

    def files(self, folder):
        return {file.name: contents(file) if file.suffix == ".h5" else file.read_text() for file in (self.folder / folder).iterdir()}

    def in_the_middle(self):
        """A run of two processes at once, both in the middle of a case, and their numbers."""
        shutil.rmtree(self.folder / "cut", ignore_errors=True)
        self.write("scene.yaml", scene(2000))
        process = self.start(*self.words("cut", 2))
        for case in ("down", "side"):
            self.wait_for_steps(f"cut/scene-{case}-monitor.csv", 3)
        children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
        self.assertEqual(len(children), 2)
        return process, children

    def expect_whole_in_the_middle(self):
        for case in ("down", "side"):
            self.assertTrue(2 < complete_steps(self.contents(f"cut/scene-{case}.h5")) < 2000)

    def test_files_prints_summary_and_code_are_those_of_one_after_another(self):
        self.write("scene.yaml", scene(5))
        in_turn = self.mixbeam(*self.words("turn", 1), code=CHECK_FAILED)
        self.expect(in_turn, "warning: ", "7 of 8 checks passed, 1 FAILED", "envelope of the ends")
        for jobs in (2, 3, 7):
            folder = f"jobs{jobs}"
            out = self.mixbeam(*self.words(folder, jobs), code=CHECK_FAILED)
            self.assertEqual(without_times(out, folder), without_times(in_turn, "turn"))
            self.assertEqual(self.summary_of(folder), self.summary_of("turn"))
            self.assertEqual(differences(self.files(folder), self.files("turn")), [])
        self.write("scene.yaml", scene(5, "[0, 2.0000001, 0]"))
        self.ended(*self.words("other", 2))
        self.assertNotEqual(differences(self.files("other"), self.files("turn")), [], "the twin")
        self.assertNotEqual(self.summary_of("other"), self.summary_of("turn"))

    def test_a_failure_is_told_as_one_after_another(self):
        self.write("scene.yaml", scene(2, "[0, 1e200, 0]"))
        in_turn, ended = self.ended(*self.words("turn", 1)), self.ended(*self.words("jobs", 2))
        self.assertEqual([in_turn.returncode, ended.returncode], [NO_CONVERGENCE] * 2)
        self.assertEqual(without_times(ended.stderr, "jobs"), without_times(in_turn.stderr, "turn"))
        self.expect(ended.stdout, "scene-down: 2 steps")
        self.expect(self.text("jobs.json"), '"failure": "scene-side: no equilibrium', '"all_passed": false')
        self.assertFalse((self.folder / "jobs/scene-envelope.csv").exists())

    def test_ctrl_c_stops_every_case_behind_a_whole_step(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            process, children = self.in_the_middle()
            begin = time.monotonic()
            process.send_signal(number)
            out, err = process.communicate()
            self.assertEqual(process.returncode, INTERRUPTED, err)
            self.assertLess(time.monotonic() - begin, 3)
            self.assertTrue(all(map(ends_soon, children)))
            self.expect(out, "mixbeam resume cut/scene-down.h5", "mixbeam resume cut/scene-side.h5")
            self.expect_whole_in_the_middle()
            self.assertFalse((self.folder / "cut/scene-both.h5").exists())

    def test_killed_processes_are_named_and_leave_whole_files(self):
        process, children = self.in_the_middle()
        os.kill(int(children[1]), signal.SIGKILL)
        time.sleep(0.2)
        process.send_signal(signal.SIGINT)  # who waits for the other case ends too
        _, err = process.communicate()
        self.assertEqual(process.returncode, CHECK_FAILED)
        self.expect(err, 'case "side"', "Killed")
        self.expect_whole_in_the_middle()

    def test_no_process_outlives_the_program(self):
        process, children = self.in_the_middle()
        process.kill()
        process.wait()
        self.assertTrue(all(map(ends_soon, children)))
        self.expect_whole_in_the_middle()

    def test_it_is_refused_as_a_whole(self):
        self.write("scene.yaml", scene(2000))
        other = self.start("run", "scene.yaml", "--case", "both", "--output", "cut", "--quiet")
        self.wait_for_steps("cut/scene-both-monitor.csv", 0)
        other.send_signal(signal.SIGSTOP)
        self.expect(self.mixbeam("run", "scene.yaml", "--output", "cut", "--jobs", "3", code=BAD_INPUT), "scene-both.h5",
                    f"process {other.pid} on ")
        self.expect(os.listdir(self.folder / "cut"), without=["scene-down.h5", "scene-side.h5"])

    def test_the_memory_of_all_that_run_at_once_is_needed(self):
        self.write("scene.yaml", scene(1, elements=300000))  # 2 GB each

        def in_limit(words):
            return self.ended("-c", f"ulimit -v 5000000; exec {PROGRAM} {words}", executable="/bin/bash")
        refused = in_limit("run scene.yaml --output out --jobs 3")
        self.assertEqual(refused.returncode, BAD_INPUT)
        self.expect(refused.stderr, "of memory for 3 cases side by side (--jobs)", "fewer cases")
        self.assertEqual(os.listdir(self.folder / "out"), [])
        self.assertEqual(in_limit("check scene.yaml").returncode, 0, "one fits")

    def test_bad_options_are_named(self):
        self.write("scene.yaml", scene(1))
        for jobs in (0, 1025):
            self.expect(self.mixbeam(*self.words("out", jobs), code=BAD_INPUT), f'option --jobs: value "{jobs}"', "from 1 to 1024")
        ended = self.ended("OMPI_COMM_WORLD_SIZE=1", PROGRAM, "run", "scene.yaml", "--jobs", "2", executable="/usr/bin/env")
        self.assertEqual(ended.returncode, BAD_INPUT)
        self.expect(ended.stderr, 'option --jobs: value "2" under mpirun', "allowed: 1")


if __name__ == "__main__":
    unittest.main()
