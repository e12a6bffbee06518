#!/usr/bin/python3
"""What a run takes of the machine is known before, threads that wait leave their cores to others, signals end a run in time, and what is unusual
is said.

usage: room_test.py MIXBEAM [CLASS]...
"""

import os
import re
import shutil
import signal
import subprocess
import time
import unittest

from support import BAD_INPUT, INTERRUPTED, PROGRAM, InFolder, changed, complete_steps

IN_SPACE, IN_PLANE, BUCKLING = "[0.3, 1, 0.7]", "[0, 1, 0]", "[-5, 0, 0]"  # forces; the last one is beyond the critical load: eigenvalues are wanted


def cantilever(elements, order, force, lists=""):
    return f"""Scene:
  Sections: {{s: {{Inextensible: true, Shear Rigid: true, GIt: 1, EI2: 1, EI3: 1}}}}
  Points: {{wall: [0, 0, 0], tip: [1, 0, 0]}}
  Supports: {{c: {{Point: wall}}}}
  Members: {{rod: {{Start: wall, End: tip, Section: s, Order: {order}, Elements: {elements}}}}}
  Point Loads: {{f: {{Point: tip, Force: {force}}}}}
{lists}
"""


class RoomCase(InFolder):
    RUN = "run", "scene.yaml", "--output", "."

    def cost(self, text, *words, environment=()):
        """What a run took: peak of its memory [byte], how often its threads went to sleep, its number."""
        self.write_scene(text)
        process = subprocess.Popen(["/usr/bin/env", *environment, PROGRAM, *self.RUN, *words], cwd=self.folder, stdout=subprocess.DEVNULL)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        self.assertEqual(process.returncode, 0)
        return 1024 * usage.ru_maxrss, usage.ru_nvcsw, process.pid

    def limited(self, limit, words):
        """In this many kB of addresses."""
        return self.ended("-c", f"ulimit -v {limit}; exec {words}", executable="/bin/bash")


class Memory(RoomCase):
    def test_it_is_estimated_within_thirty_per_cent(self):
        """Growth on top of a run of four elements."""
        base, _, _ = self.cost(cantilever(4, 2, IN_PLANE))

        def ratio(text, run=None):
            number, unit = re.search(r"memory of a run about (\S+) (.B)", self.check_scene(text)).groups()
            growth = self.cost(run or text)[0] - base
            return float(number) * {"GB": 1e9, "MB": 1e6, "kB": 1e3}[unit] / growth
        planar = cantilever(20_000, 4, IN_PLANE)
        for text in (cantilever(20_000, 2, IN_SPACE), planar):
            self.assertAlmostEqual(ratio(text), 1, delta=0.3)
        self.assertGreater(abs(ratio(cantilever(20_000, 8, IN_PLANE), planar) - 1), 0.3, "other order")

    def test_what_does_not_fit_is_refused_at_once(self):
        self.write_scene(cantilever(10_000_000, 8, IN_PLANE))  # 200 GB
        run = f"{PROGRAM} run scene.yaml --output ."
        for words in (f"{PROGRAM} check scene.yaml", run):
            begin = time.monotonic()
            ended = self.limited(3_000_000, words)
            self.assertLess(time.monotonic() - begin, 10, "a second, and the wait for a busy machine")
            self.assertEqual(ended.returncode, BAD_INPUT)
            self.expect(ended.stderr, 'scene.yaml:1:1: YAML path "Scene"', "GB of memory", "available", "allowed: ", "--force")
        forced = self.limited(3_000_000, f"{run} --force")
        self.assertNotEqual(forced.returncode, 0)
        self.expect(forced.stderr, without=["needs about"])

    def test_a_limit_without_room_for_openblas_ends_the_run(self):
        """134 MB of addresses, which it waited for for ever."""
        self.write_scene(cantilever(4, 2, BUCKLING))
        for limit, code in ((280_000, BAD_INPUT), (3_000_000, 0)):
            ended = self.limited(limit, f"env OMP_NUM_THREADS=1 timeout -s KILL 30 {PROGRAM} run scene.yaml --output .")
            self.assertEqual((ended.returncode, "OpenBLAS" in ended.stderr), (code, code == BAD_INPUT), ended.stderr)

    def test_steps_do_not_grow_the_program(self):
        """The description of all steps was held as one text: 12 kB a step."""
        few, many = 50, 450
        peaks = [self.cost(cantilever(2, 1, IN_PLANE, f"Solver: {{Load Path: {{Method: fixed, Steps: {steps}}}}}"), "--quiet", "--threads", "1")[0]
                 for steps in (few, many)]
        self.assertLess(peaks[1] - peaks[0], 3000 * (many - few))  # what is kept of each takes 450, and heaps grow in blocks


class Start(RoomCase):
    def test_mpi_starts_where_something_needs_it(self):
        """Its start takes longer than a small run. What buckles takes MUMPS for its modes."""
        for force, starts in ((IN_PLANE, False), (BUCKLING, True)):
            log = self.folder / "loaded"
            *_, process = self.cost(cantilever(20, 2, force), "--quiet", environment=["LD_DEBUG=files", f"LD_DEBUG_OUTPUT={log}"])
            self.assertEqual("mca_pml" in self.text(f"loaded.{process}"), starts)

    @unittest.skipIf(os.cpu_count() < 2, "OpenMP does not spin on one processor")
    def test_threads_that_wait_leave_the_processor_to_others(self):
        """They go to sleep: unlike times, how often is the same on a busy machine and an idle one."""
        asleep, spinning = (self.cost(cantilever(10_000, 2, IN_SPACE), "--threads", "2", "--quiet",
                                      environment=["-u", "OMP_WAIT_POLICY", "-u", "OMP_NUM_THREADS", variable])[1]
                            for variable in ("NOTHING=", "GOMP_SPINCOUNT=infinite"))  # 1,400 loops; reading and writing alone
        self.assertGreater(asleep, 4 * spinning)  # 14 to 60 times as often was seen, beside four other jobs too

    def test_many_threads_are_limited_and_said_so(self):
        self.write_scene(cantilever(4, 2, IN_PLANE))
        self.expect(self.mixbeam(*self.RUN, "--threads", "1024", "--quiet"), "warning: 1024 threads on ")
        self.expect(self.mixbeam(*self.RUN, "--threads", "2", "--quiet"), without=["threads on"])

    def test_run_warns_of_the_scene_as_check_does(self):
        coarse = cantilever(2, 1, IN_PLANE)
        for text in (self.check_scene(coarse), self.run_scene(coarse, "--quiet"), self.text("summary.json")):
            self.expect(text, "Members / rod: 2 element(s) of order 1 are coarse")
        self.expect(self.run_scene(cantilever(8, 2, IN_PLANE), "--quiet"), without=["are coarse"])

    def test_errors_of_elements_have_file_line_and_path(self):
        """A member that turns too far in its elements shows when these are made."""
        def wave(formula):
            return changed(cantilever(4, 2, IN_PLANE), "Order", f"Curve: {{Shape: parametric, Formula: [t, '{formula}', 0]}}, Order")
        many = wave("sin(300*t) - t*sin(300)")
        for message in (self.check_scene(many, BAD_INPUT), self.run_scene(many, code=BAD_INPUT)):
            self.expect(message, 'scene.yaml:5:13: YAML path "Scene / Members / rod"', "turns too far", "more elements are needed")
        self.check_scene(wave("sin(pi*t)"))


def problem_of_end(code, out, number, seconds):
    """What is wrong with the end of a run that was asked to stop: 2 s are promised, and a busy machine takes its own."""
    if seconds > 2.0 + 3.0:
        return f"took {seconds} s"
    # a signal before main() has begun has its usual effect
    return None if code == INTERRUPTED or (code == -number and not out) else f"exit code {code}"


class Signals(RoomCase):
    def test_they_end_a_run_in_every_phase(self):
        """At as many moments as the environment variable MIXBEAM_SIGNALS says."""
        self.write_scene(cantilever(20_000, 3, IN_SPACE, "Analysis: {Buckling Modes: 2}"))
        moments, longest = int(os.environ.get("MIXBEAM_SIGNALS", "10")), 3.0
        for i in range(moments):
            shutil.rmtree(self.folder / "results", ignore_errors=True)
            number = (signal.SIGINT, signal.SIGTERM)[i % 2]
            process = self.start("run", "scene.yaml", "--output", "results")
            time.sleep(longest * (i + 0.5) / moments)
            process.send_signal(number)
            begin = time.monotonic()
            out, err = process.communicate()
            if process.returncode == 0:  # it had arrived
                continue
            self.assertIsNone(problem_of_end(process.returncode, out, number, time.monotonic() - begin), f"moment {i}: {err}")
            if (self.folder / "results/scene.h5").exists():
                complete_steps(self.contents())
        self.assertIsNotNone(problem_of_end(0, "", signal.SIGINT, 0.1))
        self.assertIsNotNone(problem_of_end(INTERRUPTED, "", signal.SIGINT, 60.0))


if __name__ == "__main__":
    unittest.main()
