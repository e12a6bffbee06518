#!/usr/bin/python3
"""Faults in turn: every call by which mixbeam writes, and every larger allocation, fails once; it is killed before each of
them; and the power is cut behind each. After every case the promise of the page on results is checked:

- no signal but the kill; exit code 0 with all files as ever, or 2 with a message that names the file (or the memory);
- a published result file is whole: each of its steps has the bits of the undisturbed run, `mixbeam verify` agrees;
- nothing half written is left behind, but by a kill; no step that was published is lost;
- `mixbeam resume` goes on to the bits of the undisturbed run.

Standard output: the violations, and how many cases there were. Exit code: 0 no violation, 1 violations, 2 cannot be tested.
"""
import argparse
import collections
import concurrent.futures
import hashlib
import json
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import xml.etree.ElementTree

from disk import Reader, disks, recorded, same_bits, steps_of

HERE = pathlib.Path(__file__).resolve().parent
INPUTS = ["column.xml", "points.csv", "members.csv", "loads.csv"]
ONE_CASE = ["run", "column.xml", "--case", "pushed", "--output", "out", "--quiet"]
DURABLE = {"run": ["--durable"], "resume": ["--durable"], "batch": []}  # a batch writes once, and waits
PATIENCE = 120  # seconds; a case takes 0.1 s, and 2 s on two ranks, on an idle machine
KINDS = {"write": ["full", "error", "interrupt", "short"], "open": ["full", "error", "interrupt"],
         "sync": ["full", "error", "interrupt"], "rename": ["full", "error"], "truncate": ["full", "error", "interrupt"],
         "close": ["full", "error"], "read": ["error", "interrupt", "short"], "alloc": ["error"], "any": ["kill"]}

Ended = collections.namedtuple("Ended", "code out err log")
Case = collections.namedtuple("Case", "subject kind of at")


class Subject:
    """A command whose faults are tried, in a folder of its own, and the files of its undisturbed run."""

    def __init__(self, harness, name, words, results, ranks=1, start=()):
        self.harness, self.name, self.words, self.ranks, self.start = harness, name, words, ranks, dict(start)
        self.results = results
        folder = self.folder()
        ended = self.run(folder)
        if ended.code != 0:
            raise SystemExit(f"faults: {name} does not run undisturbed: {ended.err}")
        self.files = {p: (folder / p).read_bytes() for p in listing(folder)}
        self.whole = {p: harness.reader.read(folder / p)[1] for p in self.files if p.endswith(".h5")}
        self.counts = {line.split()[1]: int(line.split()[2]) for line in ended.log.splitlines() if line.startswith("count")}
        shutil.rmtree(folder)

    def folder(self):
        folder = pathlib.Path(tempfile.mkdtemp(dir=self.harness.work))
        for name in INPUTS:
            shutil.copy(HERE / name, folder)
        for name, data in self.start.items():
            (folder / name).parent.mkdir(exist_ok=True)
            (folder / name).write_bytes(data)
        return folder

    def run(self, folder, words=None, preload=True, **faults):
        """`faults`: CLASS, AT, KIND, RECORD of faults.c."""
        log = folder.with_suffix(".log")
        added = {"FAULTS_FOLDER": str(folder), "FAULTS_LOG": str(log), "FAULTS_PROGRAM": "mixbeam"}
        added.update({f"FAULTS_{name}": str(value) for name, value in faults.items()})
        added["LD_PRELOAD"] = self.harness.library
        command = [self.harness.program, *(words or self.words)]
        environment = dict(os.environ, OMP_NUM_THREADS="1", OMP_WAIT_POLICY="passive", OMPI_MCA_mpi_yield_when_idle="1")
        if self.ranks > 1:
            added.setdefault("FAULTS_RANK", "0")
            passed = [word for name, value in added.items() for word in ("-x", f"{name}={value}")] if preload else []
            command = ["mpirun", "-np", str(self.ranks), "--oversubscribe", "--bind-to", "none", "--allow-run-as-root",
                       *passed, *command]
        elif preload:
            environment.update(added)
        log.unlink(missing_ok=True)
        process = subprocess.Popen(command, cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   start_new_session=True)
        try:
            out, err = process.communicate(timeout=PATIENCE)
            code = process.returncode
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            out, err = process.communicate()
            code = None
        text = log.read_bytes() if log.exists() else b""
        log.unlink(missing_ok=True)
        return Ended(code, out, err.decode(errors="replace"), text if "RECORD" in faults else text.decode(errors="replace"))


def listing(folder):
    return sorted(str(p.relative_to(folder)) for p in folder.rglob("*") if p.is_file())


def stable_text(name, data):
    """What may be compared of a file that is a text: no times."""
    if not name.endswith(".json"):
        return data
    summary = json.loads(data)
    summary.pop("seconds", None)
    return json.dumps(summary)


class Harness:
    def __init__(self, program, library, damage):
        self.program, self.library, self.damage = os.path.abspath(program), os.path.abspath(library), damage
        self.work = pathlib.Path(tempfile.mkdtemp(prefix="mixbeam_faults_"))
        self.reader = Reader()
        self.resumed = {}  # outcome of resuming, by the bytes of the file
        self.verifies = b"verify" in subprocess.run([self.program, "--help"], capture_output=True, check=False).stdout

    def subjects(self, wanted):
        """Those that are called as `wanted`, or as its beginning is."""
        makers = {"run": self.run, "batch": self.batch, "resume": self.resume, "two ranks": self.two_ranks}
        return [make() for name, make in makers.items() if wanted.startswith(name) or name.startswith(wanted)]

    def run(self):
        return Subject(self, "run", ["run", "column.xml", "--output", "out", "--summary", "s.json", "--quiet"], "out/*.h5")

    def batch(self):
        words = ["batch", "column.xml", "--case", "pushed", "--output", "out", "--summary", "s.json", "--quiet"]
        return Subject(self, "batch", words, "")

    def resume(self):
        words = ["resume", "out/column-pushed.h5", "--summary", "s.json", "--quiet"]
        return Subject(self, "resume", words, "out/*.h5", start={"out/column-pushed.h5": self.stopped_file()})

    def two_ranks(self):
        return Subject(self, "two ranks", ONE_CASE, "out/*.h5", ranks=2)

    def stopped_file(self):
        """The result file of a run that was killed behind its first step of load."""
        run = Subject(self, "stopped run", ONE_CASE, "")
        for at in range(1, run.counts["rename"] + 1):
            folder = run.folder()
            run.run(folder, CLASS="rename", AT=at, KIND="kill")
            file = folder / "out/column-pushed.h5"
            if file.exists() and len(steps_of(self.reader.read(file)[1])) == 2:
                return file.read_bytes()
            shutil.rmtree(folder)
        raise SystemExit("faults: no run could be stopped behind its first step")

    def cases(self, subjects, most_on_ranks):
        for subject in subjects:
            for of, kinds in KINDS.items():
                number = subject.counts.get(of, 0)
                step = 1 if subject.ranks == 1 else max(1, number // most_on_ranks)
                for kind in kinds:
                    for at in range(1, number + 1, step):
                        yield Case(subject, kind, of, at)

    def check_case(self, case):
        """Problems of one case, and how many steps each result file has."""
        folder = case.subject.folder()
        try:
            ended = case.subject.run(folder, CLASS=case.of, AT=case.at, KIND=case.kind)
            if "hit" not in ended.log:
                return [], {}
            problems = self.check_end(case, ended)
            if self.damage:
                for file in folder.glob(case.subject.results):
                    os.truncate(file, file.stat().st_size // 2)
            more, steps = self.check_folder(case.subject, folder, ended.code == 0, case.kind == "kill")
            return problems + more, steps
        finally:
            shutil.rmtree(folder)

    @staticmethod
    def check_end(case, ended):
        lines = [line for line in ended.err.splitlines() if "mixbeam:" in line or "what()" in line] or [""]
        if ended.code is None:
            return ["hangs"]
        if case.kind == "kill":
            return [] if ended.code in (-signal.SIGKILL, 128 + signal.SIGKILL) else [f"exit code {ended.code} after a kill"]
        if ended.code == 0:
            return []
        if ended.code != 2:
            return [f"exit code {ended.code}: {lines[0].strip()[:160]}"]
        names = [*case.subject.files, "memory"] if case.of == "alloc" else INPUTS + ["out", *case.subject.files]
        if "unforeseen" in ended.err or "closing library" in ended.err or not any(name in ended.err for name in names):
            return [f"message: {ended.err.strip()[:160]}"]
        return []

    def check_folder(self, subject, folder, complete, killed):
        """What a fault has left. `complete`: the program said that all went well."""
        problems, steps = [], {}
        found = {name: (folder / name).read_bytes() for name in listing(folder)}  # resuming changes them
        if complete:
            problems += [f"{name} is missing" for name in subject.files if name not in found]
        for name, data in found.items():
            if name not in subject.files:
                if not killed:
                    problems.append(f"{name} is left behind")
            elif name.endswith(".h5"):
                key, content = self.reader.read(folder / name)
                difference = same_bits(content, subject.whole[name], complete or "batch" in name)
                problems += [f"{name} {difference}"] if difference else []
                steps[name] = 0 if difference else len(steps_of(content))
                if not difference and "batch" not in name:
                    problems += [f"{name} {problem}" for problem in self.check_result(subject, folder, name, key)]
            elif not killed or not name.endswith(".csv"):  # tables of a killed run are made anew by resume
                problems += self.check_text(subject, name, data, complete)
        return problems, steps

    @staticmethod
    def check_text(subject, name, data, complete):
        whole = subject.files[name]
        try:
            if complete:
                return [] if stable_text(name, data) == stable_text(name, whole) else [f"{name} differs"]
            if name.endswith(".json"):
                json.loads(data)
            elif name.endswith(".xdmf"):
                xml.etree.ElementTree.fromstring(data)
            elif not whole.startswith(data) or not data.endswith(b"\n") and data:
                return [f"{name} is half written"]
        except (ValueError, xml.etree.ElementTree.ParseError):
            return [f"{name} is half written"]
        return []

    def check_result(self, subject, folder, name, key):
        """A file whose steps are whole: verified, and resumed to the end. The same bytes are not resumed twice."""
        if (subject.name, key) in self.resumed:
            return self.resumed[subject.name, key]
        problems = []
        if self.verifies and subprocess.run([self.program, "verify", folder / name], capture_output=True, check=False).returncode:
            problems.append("is not clean by mixbeam verify")
        ended = subject.run(folder, ["resume", name, "--quiet"], preload=False)
        if ended.code != 0:
            problems.append(f"cannot be resumed (exit code {ended.code}): {ended.err.strip()[:160]}")
        else:
            difference = same_bits(self.reader.read(folder / name)[1], subject.whole[name], True)
            problems += [f"after resuming: {difference}"] if difference else []
            stem = pathlib.Path(name).stem
            problems += [f"after resuming {left} is left behind" for left in listing(folder)
                         if stem in left and left not in subject.files]
        self.resumed[subject.name, key] = problems
        return problems

    def check_cuts(self, subject):
        """The power is cut behind each recorded call of the command, which waits for the disk. Problems of each call."""
        folder = subject.folder()
        before = {name: (folder / name).read_bytes() for name in listing(folder)}
        ended = subject.run(folder, subject.words + DURABLE[subject.name], RECORD=1)
        shutil.rmtree(folder)
        calls = recorded(ended.log, folder)
        problems = {}
        for names_kept in (True, False):
            seen, most = {}, collections.Counter()
            for at, files in enumerate(disks(calls, before, names_kept)):
                state = hashlib.sha1(repr(sorted(files.items())).encode()).digest()
                if state not in seen:
                    seen[state] = self.check_disk(subject, files)
                wrong, steps = seen[state]
                wrong = wrong + [f"{name} has lost published steps" for name in most if steps.get(name, 0) < most[name]]
                most.update({name: number - most[name] for name, number in steps.items() if number > most[name]})
                problems.setdefault(at, []).extend(wrong)
        return [problems[at] for at in sorted(problems)]

    def check_disk(self, subject, files):
        folder = pathlib.Path(tempfile.mkdtemp(dir=self.work))
        try:
            for name, data in files.items():
                if name.endswith(".xdmf"):
                    continue  # not waited for: it is made anew from the result file
                (folder / name).parent.mkdir(exist_ok=True, parents=True)
                (folder / name).write_bytes(data)
            return self.check_folder(subject, folder, False, True)
        finally:
            shutil.rmtree(folder)


def lost_steps(outcomes):
    """Of the kills of one subject in their order: no later one may leave fewer steps than an earlier one."""
    most, problems = collections.Counter(), []
    for case, steps in sorted(outcomes, key=lambda outcome: outcome[0].at):
        for name in set(steps) | set(most):
            if steps.get(name, 0) < most[name]:
                problems.append((case, f"{name} has lost published steps"))
            most[name] = max(most[name], steps.get(name, 0))
    return problems


def sampled(cases, number, seed):
    """As many of each kind of fault as fit, drawn by `seed`."""
    groups = collections.defaultdict(list)
    for case in cases:
        groups[case.subject.name, case.kind, case.of].append(case)
    draw = random.Random(seed)
    for group in groups.values():
        draw.shuffle(group)
    turns = [case for turn in range(max(map(len, groups.values()), default=0)) for group in groups.values()
             if turn < len(group) for case in (group[turn],)]
    return turns[:number]


def report(violations, verbose):
    """One line for each subject, fault and problem: how often, and where first; the command that shows it again."""
    grouped = collections.OrderedDict()
    for place, at, problem in violations:
        grouped.setdefault((place, problem), []).append(at)
    for (place, problem), found in grouped.items():
        print(f"{place}: {problem} ({len(found)} times: {' '.join(map(str, found if verbose else found[:6]))})")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="mixbeam")
    parser.add_argument("library", help="faults.c as a shared library")
    chosen = parser.add_mutually_exclusive_group(required=True)
    chosen.add_argument("--all", action="store_true", help="every call (half an hour)")
    chosen.add_argument("--sample", type=int, metavar="N", help="so many cases, and all power cuts")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="", metavar="TEXT", help="cases as 'run write full 12', by their beginning")
    parser.add_argument("--ranks-sample", type=int, default=6, metavar="N", help="calls of each class on two ranks")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--damage", action="store_true", help="cut every published file in half: must be found")
    parser.add_argument("--verbose", action="store_true")
    options = parser.parse_args()
    harness = Harness(options.program, options.library, options.damage)
    violations, kills, number = [], collections.defaultdict(list), 0
    try:
        subjects = harness.subjects(options.only)
        cases = [case for case in harness.cases(subjects, options.ranks_sample)
                 if label(case, True).startswith(options.only)]
        if options.sample:
            cases = sampled(cases, options.sample, options.seed)
        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            for case, (problems, steps) in zip(cases, pool.map(harness.check_case, cases)):
                number += 1
                violations += [(label(case), case.at, problem) for problem in problems]
                if case.kind == "kill" and case.subject.ranks == 1:
                    kills[case.subject.name].append((case, steps))
        for outcomes in kills.values():
            violations += [(label(case), case.at, problem) for case, problem in lost_steps(outcomes)]
        for subject in subjects:
            name = f"{subject.name} power cut"
            if subject.ranks > 1 or not name.startswith(options.only):
                continue
            outcomes = harness.check_cuts(subject)
            number += len(outcomes)
            violations += [(name, at, problem) for at, problems in enumerate(outcomes) for problem in problems]
    finally:
        harness.reader.close()
        shutil.rmtree(harness.work)
    report(violations, options.verbose)
    print(f"faults: {number} cases, {len(violations)} violations")
    return 1 if violations else 0


def label(case, with_number=False):
    return f"{case.subject.name} {case.of} {case.kind}" + (f" {case.at}" if with_number else "")


if __name__ == "__main__":
    sys.exit(main())
