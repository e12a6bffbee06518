"""Pictures of runs, by the modules of `mixbeam plot` (apps/plots), which are installed in the folder plots beside this one."""

import contextlib
import html
import importlib
import sys
import tempfile
import threading
from pathlib import Path

from . import _core
from .errors import InputError, unknown

FOLDER = Path(__file__).parent / "plots"
VIEW_HEIGHT = 620  # pixels
_lock = threading.RLock()
_loaded = {}  # modules of the folder, hidden from the host: their names ("style", "view") could clash with its own


class _Plots:
    """Access to the modules while they can be imported."""

    @staticmethod
    def load(name):
        return importlib.import_module(name)

    @staticmethod
    def call(function, *arguments):
        """Calls a function of the modules; converts its errors to InputError of this package."""
        try:
            return function(*arguments)
        except sys.modules["results"].InputError as error:
            raise InputError(str(error)) from None
        except (KeyError, IndexError, TypeError, ValueError, AttributeError, ArithmeticError) as error:
            raise InputError(f"options that do not fit, or unexpected content of the result file ({error!r})") from None


@contextlib.contextmanager
def modules():
    """Makes the modules importable and sets their style; restores modules and style of the host on exit. Raises InputError
    without matplotlib or h5py."""
    try:
        import h5py  # noqa: F401
        import matplotlib.pyplot  # before the modules, which then keep the host's back end
    except ImportError as error:
        raise InputError(f"{error}; the Debian packages python3-matplotlib and python3-h5py hold what is needed") from None

    names = {file.stem for file in FOLDER.glob("*.py")}
    with _lock:
        others = {name: sys.modules.pop(name) for name in names if name in sys.modules}
        sys.modules.update(_loaded)
        sys.path.insert(0, str(FOLDER))
        try:
            with matplotlib.rc_context():
                matplotlib.rcParams.update(importlib.import_module("style").SETTINGS)
                importlib.import_module("results").require_whole = lambda file, *_: _core.verify(str(file))
                yield _Plots
        finally:
            sys.path.remove(str(FOLDER))
            _loaded.update({name: sys.modules.pop(name) for name in names if name in sys.modules})
            sys.modules.update(others)


class Picture:
    """A matplotlib figure that notebooks show."""

    def __init__(self, name, figure):
        self.name, self.figure = name, figure

    def save(self, file):
        """Writes the figure in the format of the file name: .png, .svg or .pdf."""
        file = Path(file)
        with modules() as plots:
            plots.call(plots.load("style").save_all, self.figure, file.with_suffix(""), [file.suffix[1:]])

    def _repr_png_(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "picture.png"
            self.save(file)
            return file.read_bytes()


def picture(results, kind, given):
    """Returns the Picture of an open result file, or {name: Picture} if there are several."""
    with modules() as plots:
        script = plots.load("plot_result")
        if kind not in script.KINDS:
            raise unknown("pictures", kind, list(script.KINDS))
        options = script.options_of([str(results.path)])
        for name, value in given.items():
            if name not in vars(options) or name in ("result", "output", "format", "picture", "case", "members"):
                raise unknown("options of a picture", name, list(vars(options)))
            value = [value] if name == "along" and isinstance(value, str) else value
            setattr(options, name, str(value) if name == "step" else value)
        options.picture = [kind]
        pictures = {name: Picture(name, figure)
                    for name, figure in plots.call(lambda: list(script.figures(results, options)))}
        for one in pictures.values():
            plots.load("style").plt.close(one.figure)  # a notebook would show it a second time
    if not pictures:
        raise InputError(f"{results.path}: nothing to show in a picture {kind!r}")
    return pictures if len(pictures) > 1 else next(iter(pictures.values()))


class View:
    """An interactive page of mixbeam view, shown inline by notebooks."""

    def __init__(self, page):
        self._page = page

    def save(self, file):
        """Writes a self-contained HTML file."""
        _core.write_page(str(file), self._page)

    def _repr_html_(self):
        return f'<iframe style="border:0" width="100%" height="{VIEW_HEIGHT}" srcdoc="{html.escape(self._page, quote=True)}"></iframe>'


def view(files, refusal="", warnings=None):
    """Returns the View of result files; for an unsolved scene with its refusal and warnings."""
    return View(_core.view_page([str(file) for file in files], str(FOLDER / "viewer"), refusal, warnings))
