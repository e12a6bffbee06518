"""Writes type stubs of the package from the declarations of the parameters: python3 -m mixbeam.stubs FILE.pyi."""

import inspect
import sys
from pathlib import Path

from . import scene
from .parameters import root
from .runs import Run, kinds_of_quantities

TYPES = {"bool": "bool", "int": "int", "double": "float", "string": "str", "Array(int)": "Sequence[int]",
         "Array(double)": "ArrayLike", "Array(string)": "Sequence[str]"}

HEAD = '''"""Written by mixbeam.stubs from the declarations of the parameters."""

from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from typing import Any, Literal

from numpy.typing import ArrayLike, NDArray

from .errors import ConvergenceError as ConvergenceError, InputError as InputError, UnknownName as UnknownName
from .parameters import Parameters as Parameters
from .runs import MemberResults as MemberResults, batch as batch, check as check, resume as resume, run as run
from .runs import open_results as open, Run as _Run
from .scene import Scene as _Scene

__version__: str
'''


def type_of(parameter):
    if parameter.get("choices") and parameter["type"] == "string":
        name = "Literal[" + ", ".join(map(repr, parameter["choices"])) + "]"
        name += " | str" if parameter.get("or_other") else ""
    else:
        name = TYPES[parameter["type"]]
    return name + (" | str | bool" if parameter.get("words") else "")


def given_type(parameter):
    """Returns the type of an assigned value, which includes formulas like "=2*L" in place of numbers."""
    kind = type_of(parameter)
    if parameter["type"] in ("double", "int"):
        return kind if "| str" in kind else kind + " | str"
    return kind + " | Sequence[int | str]" if parameter["type"] == "Array(int)" else kind


class Stubs:
    """Builds the text of the stub classes, one for each kind of list."""

    def __init__(self):
        self.text, self.names = [], {}

    def name_of(self, declaration):
        """Returns the class name of a list; the first call writes the class."""
        if declaration.path not in self.names:
            words = declaration.path.replace("<", "").replace(">", "").split(" / ")
            self.names[declaration.path] = "_" + "".join(w.title().replace(" ", "") for w in words)
            self.write(declaration, self.names[declaration.path])
        return self.names[declaration.path]

    def attributes(self, declaration):
        for python, xml in declaration.xml_names.items():
            if xml in declaration.lists:
                inner = declaration.lists[xml]
                yield python, self.name_of(inner), inner.meaning
            else:
                parameter = declaration.parameters[xml]
                yield python, type_of(parameter) + " | None", parameter["meaning"]

    def write(self, declaration, name):
        lines = [f"class {name}(Parameters):", f"    {declaration.meaning!r}"]
        for python, kind, meaning in self.attributes(declaration):
            lines += [f"    {python}: {kind}", f"    {meaning!r}"]
        entry = declaration.free_list or declaration.free_parameter
        if entry:
            kind = self.name_of(entry) if declaration.free_list else type_of(entry)
            given = f"{kind} | Mapping[str, Any]" if declaration.free_list else given_type(entry)
            lines += [f"    def __getitem__(self, name: str) -> {kind}: ...",
                      f"    def __setitem__(self, name: str, value: {given}) -> None: ..."]
        self.text.append("\n".join(lines))

    def maker(self, name, declaration, shape):
        """Writes a function that makes a list, with all of its names as keywords."""
        keywords = {}

        def collect(inner):
            for python, xml in inner.xml_names.items():
                if xml in inner.lists:
                    keywords.setdefault(python, "Mapping[str, Any]")
                    collect(inner.lists[xml])
                elif xml not in shape:
                    keywords.setdefault(python, given_type(inner.parameters[xml]))

        collect(declaration)
        given = ", ".join(f"{python}: {kind} | None = ..." for python, kind in keywords.items())
        self.text.append(f"def {name}({'*, ' if given else ''}{given}) -> {self.name_of(declaration)}:\n"
                         f"    {declaration.meaning!r}")


def main(file):
    stubs = Stubs()
    whole, inside = root(), root().lists["Scene"]
    attributes = {python: kind for part in (inside, whole) for python, kind, _ in stubs.attributes(part)}
    body = "\n".join(f"    {python}: {kind}" for python, kind in attributes.items())
    stubs.text.append(f"class Scene(_Scene):\n{body}\n\nread = Scene.read")
    for name, maker in scene.classes().items():
        stubs.maker(name, maker.declaration, maker.fixed)
    inspected = inspect.getdoc(Run)
    kinds = "\n".join(f"    def {name}(self, point: str | None = None, *, step: int | None = -1, **parameters: Any) "
                      "-> Any: ..." for name in kinds_of_quantities())
    stubs.text.append(f"class Run(_Run):\n    {inspected!r}\n{kinds}")
    Path(file).write_text(HEAD + "\n\n" + "\n\n\n".join(stubs.text) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1])
