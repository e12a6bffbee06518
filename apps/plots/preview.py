"""Unsolved scenes: the undeformed structure, as written by `mixbeam check`, and its messages."""

import re
import subprocess
import tempfile
from contextlib import contextmanager
from pathlib import Path

from command import InputError, inputs
from results import PROGRAM

ENDINGS = (".xml", ".yaml", ".yml")
SLOWEST = 600  # seconds for reading a scene


class Said:
    """Messages of the program on a scene: why a run would refuse it (empty: it would not), and warnings."""

    def __init__(self, refusal="", warnings=()):
        self.refusal, self.warnings = refusal, list(warnings)

    def names(self, members):
        """Returns the numbers of the members that messages name, in quotes or in the path of an entry."""
        text = " ".join([self.refusal, *self.warnings])
        named = {*re.findall(r'"([^"]+)"', text), *re.findall(r"/ Members / ([^/\"]+?) /", text)}
        return [number for number, member in enumerate(members) if member.name in named]


def is_scene(path):
    return path.suffix.lower() in ENDINGS


@contextmanager
def undeformed(scene, case=None):
    """Yields (result files of the undeformed structure, one for each load case; Said). Raises InputError if there are none."""
    inputs.add(scene)
    with tempfile.TemporaryDirectory() as folder:
        words = [PROGRAM, "check", scene, "--output", folder, *(["--case", case] if case else [])]
        ended = subprocess.run(words, capture_output=True, text=True, errors="replace", timeout=SLOWEST, check=False)
        files = sorted(Path(folder).glob("*.h5"), key=lambda file: file.stat().st_mtime_ns)
        refusal = ended.stderr.strip().removeprefix("mixbeam: bad input: ")
        if not files:
            raise InputError(refusal or f"{scene}: mixbeam check ended with {ended.returncode}")
        warnings = [line.removeprefix("warning: ") for line in ended.stdout.splitlines() if line.startswith("warning: ")]
        yield files, Said(refusal if ended.returncode else "", warnings)


def parts_of(run):
    """Returns the number of the connected part of each member; [] if the file does not have them."""
    text = run.properties().get("connected_parts", "")
    pairs = [word.split("*") for word in text.split()]
    return [int(number) for number, count in pairs for _ in range(int(count))]
