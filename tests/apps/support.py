"""What tests of the programs share: the program, a folder for each test, scenes as texts in YAML, and what a run leaves."""

import csv
import functools
import json
import re
import subprocess
import sys
import tempfile
import textwrap
import time
import unittest
from pathlib import Path

import h5py
import numpy as np
import yaml

PROGRAM = str(Path(sys.argv.pop(1)).resolve())  # the first word of every test
ROOT = Path(__file__).resolve().parents[2]
SECONDS = 500  # for what must not hang
CHECK_FAILED, BAD_INPUT, NO_CONVERGENCE, INTERRUPTED = 1, 2, 3, 130  # exit codes


def program(*words, folder, code=0, name="mixbeam"):
    """What a program prints: its output, or its complaint where it refuses."""
    ended = subprocess.run([Path(PROGRAM).with_name(name), *words], cwd=folder, capture_output=True, text=True, timeout=SECONDS, check=False)
    assert ended.returncode == code, f"{words} ended with {ended.returncode}\n{ended.stdout}{ended.stderr}"
    return ended.stderr if code > 1 else ended.stdout


class InFolder(unittest.TestCase):
    """Each test works in an empty folder of its own."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def mixbeam(self, *words, code=0):
        return program(*words, folder=self.folder, code=code)

    def ended(self, *words, folder=None, executable=PROGRAM):
        """A process with its code and both of its outputs."""
        return subprocess.run([executable, *words], cwd=folder or self.folder, capture_output=True, text=True, timeout=SECONDS, check=False)

    def start(self, *words):
        process = subprocess.Popen([PROGRAM, *words], cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        return process

    def write(self, name, text):
        (self.folder / name).write_text(text, encoding="utf-8")

    def text(self, name):
        return (self.folder / name).read_text(encoding="utf-8")

    def write_scene(self, text):
        name = "scene.xml" if text.startswith("<") else "scene.yaml"
        self.write(name, text)
        return name

    def run_scene(self, text, *words, code=0):
        """With its results in the folder "results"."""
        return self.mixbeam("run", self.write_scene(text), "--output", "results", "--summary", "summary.json", *words, code=code)

    def check_scene(self, text, code=0):
        return self.mixbeam("check", self.write_scene(text), code=code)

    def summary(self):
        return json.loads(self.text("summary.json"))

    def rows(self, name):
        return list(csv.DictReader(self.text(name).splitlines()))

    def contents(self, name="results/scene.h5"):
        return contents(self.folder / name)

    def wait_for_steps(self, table, steps):
        """Until the running program has completed these steps."""
        for _ in range(5000):
            if (self.folder / table).exists() and self.text(table).count("\n") > steps:
                return
            time.sleep(0.002)
        self.fail(f"{table} has no {steps} steps")

    def expect(self, text, *parts, without=()):
        for part in parts:
            self.assertIn(part, text)
        for part in without:
            self.assertNotIn(part, text)


class YamlLoader(yaml.SafeLoader):
    """Takes 1e-6 and inf for numbers, as mixbeam does."""


YamlLoader.add_implicit_resolver("tag:yaml.org,2002:float", re.compile(r"^[-+]?(\d+\.?\d*|\.\d+)[eE][-+]?\d+$|^inf$"), list("-+.0123456789i"))


def merged(lists, more):
    for name, value in more.items():
        lists[name] = merged(lists[name], value) if isinstance(value, dict) and isinstance(lists.get(name), dict) else value
    return lists


def with_lists(scene, more, removed=()):
    """A scene with more in it: entries of `more` are added or take the place of those of the same name, after the lists `removed` have gone."""
    lists = yaml.load(scene, YamlLoader)
    for name in removed:
        del lists[name]
    return json.dumps(merged(lists, yaml.load(more, YamlLoader))).replace("Infinity", "inf")


@functools.cache
def scene_of(path):
    """A scene of the repository in YAML; its name is that of the file."""
    with tempfile.TemporaryDirectory() as folder:
        program("convert", ROOT / path, "scene.yaml", folder=folder)
        return (Path(folder) / "scene.yaml").read_text(encoding="utf-8")


def changed(text, old, new, after=""):
    """A text with the first `old` behind the first `after` replaced; a test that changes nothing would prove nothing."""
    begin, end = text[:text.index(after)], text[text.index(after):]
    assert old in end, f"{after} ... {old} is not in {text}"
    return begin + end.replace(old, new, 1)


def contents(file):
    """Shape and bytes of every dataset, bytes of every attribute of a result file, but for what tells how it came about."""
    found = {}

    def bits(value):
        array = np.asarray(value)
        return array.shape, array.tolist() if array.dtype.hasobject else array.tobytes()

    def visit(name, thing):
        if name != "properties":
            found[name] = bits(thing[()]) if isinstance(thing, h5py.Dataset) else "group"
            found.update({f"{name}@{key}": bits(value) for key, value in thing.attrs.items()})

    with h5py.File(file) as opened:
        visit(".", opened)
        opened.visititems(visit)
    return found


def differences(one, other):
    """Names of what differs between the contents of two files."""
    return sorted(name for name in one.keys() | other.keys() if one.get(name) != other.get(name))


def complete_steps(found):
    """Number of completed steps that a file holds in full: those in the time series, every one with its fields and state."""
    steps = sum(re.fullmatch(r"steps/\d+/state/interior", name) is not None for name in found)
    assert steps == (found["monitor/step"][0][0] if "monitor/step" in found else 0), "a step is incomplete"
    return steps


def scene(lists, after="", name="portal"):
    """A scene of members whose section has stiffnesses of one; `lists` of Scene, and what comes after it."""
    section = "{EA: 1e4, Shear Rigid: true, GIt: 1, EI2: 1, EI3: 1}"
    return f"""Name: {name}
Scene:
  Units: "m, kN"
  Sections: {{s: {section}}}
{textwrap.indent(textwrap.dedent(lists).strip(), "  ")}
{textwrap.dedent(after)}"""


CANTILEVER = scene("""
    Points: {a: [0, 0, 0], b: [1, 0, 0]}
    Members: {m: {Start: a, End: b, Elements: 4, Order: 3}}
    Supports: {clamp: {Point: a}}
    Point Loads: {f: {Point: b, Force: [0, -1, 0]}}
    """)


def solve(folder, name, text):
    """Runs a scene of this name; the result file."""
    (folder / f"{name}.yaml").write_text(text, encoding="utf-8")
    program("run", f"{name}.yaml", "--output", ".", "--quiet", folder=folder)
    return folder / f"{name}.h5"
