"""mixbeam: static solver for geometrically exact beams, in this process.

    import mixbeam

    scene = mixbeam.Scene("cantilever")
    scene.sections["steel"] = mixbeam.Circle(diameter=4, E=206e3, nu=0.3)
    scene.points["wall"] = 0, 0, 0
    scene.points["tip"] = 1000, 0, 0
    scene.members["rod"] = mixbeam.Member(start="wall", end="tip", section="steel", elements=20)
    scene.supports["clamp"] = mixbeam.Support(point="wall")
    scene.point_loads["weight"] = mixbeam.PointLoad(point="tip", force=(0, 0, -10))
    run = mixbeam.run(scene)
    run.displacement("tip")

Examples: apps/docs/python.md. Calls from several threads are serialised.
"""

from . import _core, scene as _scene
from .errors import ConvergenceError, InputError, UnknownName, unknown
from .parameters import Parameters
from .runs import MemberResults, Run, batch, check, open_results as open, resume, run
from .scene import Scene

__version__ = _core.version
read = Scene.read


def __getattr__(name):
    classes = _scene.classes()
    if name.startswith("__") or name not in classes:
        raise unknown("module mixbeam", name, __dir__())
    return classes[name]


def __dir__():
    return [name for name in (*globals(), *_scene.classes()) if not name.startswith("_")] + ["__version__"]
