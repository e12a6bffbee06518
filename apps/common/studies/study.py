"""What programs with a study in Python share. Command line, scene file, tables, checks, summary and exit code are those of
the other programs (apps/python/study.cpp); the steps of the study are Python."""

import os
import signal
import sys

from mixbeam._core import Follow, run_study, shortest
from mixbeam.errors import ConvergenceError
from mixbeam.scene import Scene

__all__ = ["ConvergenceError", "Follow", "main", "new_scene", "scene_of", "shortest", "solve"]


def main(file, purpose, meaning, parameters, run):
    """The program of this file. `parameters` of its list Study: (name, default, least, most, meaning); `run(app)` computes."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # ends it at once, in the library too
    file = os.path.realpath(file)
    sys.exit(run_study([file, *sys.argv[1:]], os.path.basename(file), purpose, meaning, parameters, run))


def scene_of(app):
    """A copy of the scene as its file gives it, to be changed: without study and expected values."""
    scene = Scene._of(app.scene(), None)
    for name in ("Study", "Expected"):
        scene.pop(name, None)
    return scene


def new_scene(name, given):
    """An empty one with the solver's parameters of another."""
    scene = Scene(name)
    for part in ("Solver", "Analysis"):
        if part in given:
            scene[part] = given[part]
    return scene


def solve(app, scene, way=Follow.counted, estimates=False):
    """The Trial of a scene: its end, its costs, and times that the solver has taken."""
    return app.solve(scene.to_xml(), way, estimates)
