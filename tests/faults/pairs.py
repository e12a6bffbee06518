#!/usr/bin/python3
"""Two programs that want one result at the same time: run, batch and resume, on one rank and two, begun in the same
moment or while the first is at work. One of them ends with 0 and leaves what it leaves alone, bit for bit; the other is
refused within a second (exit 2, a message with the file and the process that holds it), and nothing of it is left behind.

Standard output: what was wrong, the slowest refusals, how many pairs. Exit code: 0 nothing wrong, 1 something was,
2 cannot be tested."""
import argparse
import os
import pathlib
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

from disk import Reader, same_bits

HERE = pathlib.Path(__file__).resolve().parent
LAUNCH = ["mpirun", "--oversubscribe", "--bind-to", "none", "--allow-run-as-root", "-np"]
# Long enough that the second one comes while the first is at work, also where Open MPI starts up for half a second.
STEPS, CASES = 400, 4000
REFUSED_WITHIN = 1.0  # seconds behind the start of the program, without what mpirun takes for nothing
PATIENCE = 120
COMMANDS = {"run": ["run", "rod.yaml", "--output", "out", "--quiet"], "resume": ["resume", "out/rod.h5", "--quiet"],
            "batch": ["batch", "rods.yaml", "--output", "out", "--quiet"]}
RESULT = {"run": "out/rod.h5", "resume": "out/rod.h5", "batch": "out/rods-batch.h5"}

SCENE = """Scene:
  Sections: {{s: {{Inextensible: true, Shear Rigid: true, GIt: 1, EI2: 1, EI3: 1}}}}
  Points: {{wall: [0, 0, 0], tip: [1, 0, 0]}}
  Members: {{rod: {{Start: wall, End: tip, Order: 3, Elements: 8}}}}
  Supports: {{c: {{Point: wall}}}}
  Point Loads: {{f: {{Point: tip, Force: [0, 10, 0]}}}}
Solver: {{Load Path: {{Method: fixed, Steps: {steps}}}}}
"""


class Started:
    """A program in a process group of its own, and when each thing happened."""

    def __init__(self, words, folder, ranks):
        self.began = time.monotonic()
        command = [*LAUNCH, str(ranks), *words] if ranks > 1 else words
        self.own = tempfile.TemporaryDirectory(prefix="mixbeam_mpi_")  # two mpirun get in each other's way in one folder
        environment = dict(os.environ, OMP_NUM_THREADS="1", OMP_WAIT_POLICY="passive", OMPI_MCA_mpi_yield_when_idle="1",
                           TMPDIR=self.own.name)
        self.messages = tempfile.TemporaryFile()
        self.process = subprocess.Popen(command, cwd=folder, env=environment, stdout=subprocess.DEVNULL, stderr=self.messages,
                                        start_new_session=True)
        self.told = self.ended = None

    def look(self):
        """Notes when the first word came and when it ended."""
        if self.told is None and os.fstat(self.messages.fileno()).st_size:
            self.told = time.monotonic() - self.began
        if self.ended is None and self.process.poll() is not None:
            self.ended = time.monotonic() - self.began
        return self.ended is None

    def words(self):
        self.messages.seek(0)
        return self.messages.read().decode(errors="replace")


class Pairs:
    def __init__(self, program):
        self.program, self.reader = os.path.abspath(program), Reader()
        self.work = pathlib.Path(tempfile.mkdtemp(prefix="mixbeam_pairs_"))
        loads = "".join(f"{1 + 0.002 * i}\n" for i in range(CASES))
        self.scenes = {"rod.yaml": SCENE.format(steps=STEPS), "rods.yaml": SCENE.format(steps=1) + "Batch: {Table: loads.csv}\n",
                       "loads.csv": "Point Loads/f/Force[1]\n" + loads}
        self.refusals, self.alone, self.seconds = [], {}, {}
        self.launched = min(self.seconds_to_say_nothing() for _ in range(3))
        for name, ranks in (("run", 1), ("run", 2), ("batch", 1)):
            folder = self.folder()
            ended = self.wait([self.start(name, folder, ranks)])[0]
            if ended.process.returncode:
                raise SystemExit(f"pairs: {name} alone: {ended.words()}")
            self.alone[RESULT[name], ranks] = self.reader.read(folder / RESULT[name])[1]
            self.seconds[name, ranks] = ended.ended

    def folder(self):
        folder = pathlib.Path(tempfile.mkdtemp(dir=self.work))
        for name, text in self.scenes.items():
            (folder / name).write_text(text)
        return folder

    def seconds_to_say_nothing(self):
        """What mpirun itself takes to start and end two programs."""
        began = time.monotonic()
        subprocess.run([*LAUNCH, "2", "true"], check=True, capture_output=True)
        return time.monotonic() - began

    def start(self, command, folder, ranks):
        return Started([self.program, *COMMANDS[command]], folder, ranks)

    @staticmethod
    def wait(started):
        limit = time.monotonic() + PATIENCE
        while any([one.look() for one in started]) and time.monotonic() < limit:
            time.sleep(0.005)
        for one in started:
            if one.ended is None:
                os.killpg(one.process.pid, signal.SIGKILL)
                one.process.wait()
        return started

    def stopped(self, folder, ranks):
        """A result that `resume` goes on with: a run that was interrupted at work."""
        run = self.start("run", folder, ranks)
        time.sleep(0.6 * self.seconds["run", ranks])
        run.process.send_signal(signal.SIGINT)
        self.wait([run])

    def check(self, first, second, ranks, staggered, part):
        folder = self.folder()
        if first == "resume":
            self.stopped(folder, ranks)
            (folder / "out/.rod.h5.lock").unlink(missing_ok=True)  # mpirun may have left it; the next one is awaited
        pair = [self.start(first, folder, ranks)]
        if staggered:  # what is resumed must be there, too
            awaited = folder / RESULT[first]
            if (first, second) != ("run", "resume"):
                awaited = awaited.with_name(f".{awaited.name}.lock")
            while pair[0].look() and not awaited.exists():
                time.sleep(0.002)
            share = 0.2 if first == "resume" else 0.4  # less than half of what it has to do
            time.sleep(part * share * self.seconds["batch" if first == "batch" else "run", ranks])
        pair.append(self.start(second, folder, ranks))
        self.wait(pair)
        problems = self.judge(pair, folder, (RESULT[first], ranks), staggered)
        shutil.rmtree(folder)
        return problems

    def judge(self, pair, folder, kind, staggered):
        result = kind[0]
        codes = [one.process.returncode for one in pair]
        launched = 0.2 + (self.launched if kind[1] > 1 else 0.0)  # what the second one takes to get as far as the lock
        if codes == [0, 0] and staggered and pair[0].ended + pair[0].began < pair[1].began + launched:
            return None  # the first one was done: no pair
        if sorted(map(abs, codes)) != [0, 2]:
            return [f"exit codes {codes}: {' | '.join(one.words().strip()[:300] for one in pair)}"]
        problems = []
        if staggered and codes[0] != 0:
            problems.append(f"the first one was refused: {pair[0].words().strip()[:200]}")
        refused, other = (pair[0], pair[1]) if codes[0] else (pair[1], pair[0])
        self.refusals.append((refused.told or refused.ended) - (self.launched if kind[1] > 1 else 0.0))
        words = refused.words()
        if pathlib.Path(result).name not in words or not re.search(r"process \d+", words):
            problems.append(f"message: {words.strip()[:200]}")
        difference = same_bits(self.reader.read(folder / result)[1], self.alone[kind], True)
        if difference:
            problems.append(f"{result} {difference}")
        problems += [f"{path.name} is left behind" for path in (folder / "out").glob(".*.h5.*")]
        return problems


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="mixbeam")
    parser.add_argument("--pairs", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    pairs, draw = Pairs(options.program), random.Random(options.seed)
    kinds = [(first, second, ranks, staggered)
             for first, second in (("run", "run"), ("run", "resume"), ("batch", "batch"), ("resume", "resume"), ("resume", "run"))
             for ranks in ((1,) if first == "batch" else (1, 2))  # a batch refuses ranks
             for staggered in (False, True) if staggered or (first, second) != ("run", "resume")]
    wrong = missed = 0
    try:
        for number in range(options.pairs):
            kind = kinds[number % len(kinds)]
            problems = pairs.check(*kind, draw.random())
            missed += problems is None
            wrong += bool(problems)
            for problem in problems or []:
                print(f"{number} {kind}: {problem}", flush=True)
    finally:
        pairs.reader.close()
        shutil.rmtree(pairs.work)
    slow = sorted(pairs.refusals)[::-1]
    late = sum(seconds > REFUSED_WITHIN for seconds in slow)
    print(f"pairs: {options.pairs - missed} pairs, {wrong} wrong; refused after {slow[len(slow) // 2]:.2f} s (median), "
          f"{slow[0]:.2f} s at most, {late} later than {REFUSED_WITHIN} s; {missed} first ones were done too early")
    return 1 if wrong or late else 0


if __name__ == "__main__":
    sys.exit(main())
