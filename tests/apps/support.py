"""What tests of the programs share: the program, a folder for each test, and scenes of a few members as texts in YAML."""

import subprocess
import sys
import tempfile
import textwrap
import unittest
from pathlib import Path

PROGRAM = str(Path(sys.argv.pop(1)).resolve())  # the first word of every test
ROOT = Path(__file__).resolve().parents[2]
SECONDS = 500  # for what must not hang


def program(*words, folder, code=0):
    """What the program prints: its output, or its complaint where it refuses."""
    ended = subprocess.run([PROGRAM, *words], cwd=folder, capture_output=True, text=True, timeout=SECONDS, check=False)
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
