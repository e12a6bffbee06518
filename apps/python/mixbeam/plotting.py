"""Pictures of runs, by the code of `mixbeam plot` (apps/plots), whose modules stand beside this one in the folder plots."""

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
_loaded = {}  # modules of the folder, which nobody else sees: their names are those of scripts ("style", "view")


class _Plots:
    """The modules, while they are in reach."""

    @staticmethod
    def load(name):
        return importlib.import_module(name)

    @staticmethod
    def call(function, *arguments):
        """Errors of input as those of this package."""
        try:
            return function(*arguments)
        except sys.modules["results"].InputError as error:
            raise InputError(str(error)) from None
        except (KeyError, IndexError, TypeError, ValueError, AttributeError, ArithmeticError) as error:
            raise InputError(f"options that do not fit, or unexpected content of the result file ({error!r})") from None


@contextlib.contextmanager
def modules():
    """Puts the folder in reach, and its style; that of the host is back afterwards."""
    import matplotlib.pyplot  # before the modules: they leave the back end alone then

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
    """A figure of matplotlib that notebooks show."""

    def __init__(self, name, figure):
        self.name, self.figure = name, figure

    def save(self, file):
        """Writes it in the format that the ending says: .png, .svg, .pdf."""
        file = Path(file)
        with modules() as plots:
            plots.call(plots.load("style").save_all, self.figure, file.with_suffix(""), [file.suffix[1:]])

    def _repr_png_(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "picture.png"
            self.save(file)
            return file.read_bytes()


def picture(results, kind, given):
    """One Picture of an open result file, or {name: Picture} where it takes several."""
    with modules() as plots:
        script = plots.load("plot_result")
        if kind not in script.KINDS:
            raise unknown("pictures", kind, list(script.KINDS))
        options = script.options_of([str(results.path)])
        for name, value in given.items():
            if name not in vars(options) or name in ("result", "output", "format", "picture", "case", "members"):
                raise unknown("options of a picture", name, list(vars(options)))
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
    """A page to turn and to ask, shown inline by notebooks."""

    def __init__(self, page):
        self._page = page

    def save(self, file):
        """Writes the HTML file, which needs no network."""
        _core.write_page(str(file), self._page)

    def _repr_html_(self):
        return f'<iframe style="border:0" width="100%" height="{VIEW_HEIGHT}" srcdoc="{html.escape(self._page, quote=True)}"></iframe>'


def view(files, refusal="", warnings=None):
    """The View of result files; of a scene that is not solved with what is said of it."""
    return View(_core.view_page([str(file) for file in files], str(FOLDER / "viewer"), refusal, warnings))
