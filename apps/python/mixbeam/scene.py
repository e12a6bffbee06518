"""Scenes: a whole scene file as an object."""

import contextlib
import html
import os
from functools import cache
from pathlib import Path

import numpy as np

from . import _core
from .errors import InputError, UnknownName, unknown
from .parameters import Declaration, Parameters, is_text, root


class Scene(Parameters):
    """A scene: the parameter lists of a scene file, those of its list Scene as attributes like the outer ones.

    `scene.sections`, `scene.points`, `scene.members`, `scene.supports`, `scene.point_loads`, ...; `scene.analysis`,
    `scene.solver`, `scene.quantities`, `scene.expected`. What they hold: `mixbeam parameters`.
    """

    __slots__ = ("name", "file")

    def __init__(self, name="scene", **given):
        if not isinstance(name, str):
            raise InputError(f"name of a scene: {name!r}; allowed: a text")
        object.__setattr__(self, "name", name)  # of the structure, and of files
        object.__setattr__(self, "file", None)  # source file; imported tables are relative to its folder
        super().__init__(root())
        self.update_by_name(given)

    @classmethod
    def read(cls, file):
        """Reads a scene file, verbatim except for comments. Raises InputError with file, line and place."""
        return cls._of(_core.read(os.fspath(file)), Path(file))

    @classmethod
    def from_text(cls, text, file=None):
        """Reads a scene from XML or YAML text; `file`: its name in messages."""
        return cls._of(_core.parse(text, str(file or "scene")), Path(file) if file else None)

    @classmethod
    def _of(cls, parsed, file):
        name, entries = parsed
        scene = cls(name)
        object.__setattr__(scene, "file", file)
        scene._fill(entries)
        return scene

    def copy(self):
        """Returns a deep copy."""
        other = Scene(self.name)
        object.__setattr__(other, "file", self.file)
        other._copy(self)
        return other

    def to_xml(self):
        """Returns the scene as XML text, which reads back as an equal scene."""
        if not is_text(self.name):
            raise InputError(f"name of a scene: {self.name!r}; allowed: a text without control characters")
        return '<?xml version="1.0"?>\n' + self._xml(self.name)

    def write(self, file):
        """Writes a scene file: YAML if its name ends in .yaml or .yml, else XML."""
        text = self.to_xml()
        if Path(file).suffix.lower() in (".yaml", ".yml"):
            text = _core.yaml_of(text, os.fspath(file))
        Path(file).write_text(text, encoding="utf-8")

    def _repr_html_(self):
        """Returns the notebook display: name, and number of entries of each list."""
        inner = self._entries.get("Scene")
        lists = {**(inner._entries if inner is not None else {}), **{title: one for title, one in self._entries.items() if title != "Scene"}}
        counts = [(title, len(one)) for title, one in lists.items() if isinstance(one, Parameters)]
        cells = "".join(f"<tr><td>{html.escape(title)}</td><td>{count}</td></tr>" for title, count in counts)
        return f"<b>mixbeam.Scene {html.escape(self.name)}</b><table>{cells}</table>"

    def view(self, case=None):
        """Draws the scene without solving it, even if check refuses it. Returns a page that notebooks show inline, with
        save(file). Raises InputError if nothing can be drawn."""
        from .runs import view

        return view(self, case)

    def add_points(self, name, coordinates):
        """Adds points from an array (..., 3). Returns their names, name0, name1, ... or name0_0, ..., in the shape (...)."""
        coordinates = np.asarray(coordinates, dtype=float)
        if coordinates.shape[-1:] != (3,):
            raise InputError(f"coordinates of {name}: an array of shape {coordinates.shape}; allowed: (..., 3)")
        names = _new_names(name, coordinates.shape[:-1], set(self.points))
        for place in np.ndindex(names.shape):
            self.points[names[place]] = coordinates[place]
        return names

    def add_members(self, name, start, end, **parameters):
        """Adds members from arrays of point names; each parameter is one value or an array, of vectors (..., 3). Returns their
        names, name0, ..."""
        given = {"start": start, "end": end, **parameters}
        try:
            shape = np.broadcast_shapes(*(np.shape(value) for value in (start, end)))
            values = {key: _of_each(value, shape, self.members._declaration.free_list.is_array(key)) for key, value in given.items()}
        except ValueError as error:
            raise InputError(f"members {name}: arrays that do not fit ({error}); allowed: one value, or an array of one for each member") from None
        names = _new_names(name, shape, set(self.members))
        for place in np.ndindex(shape):
            self.members[names[place]] = {key: value[place] for key, value in values.items()}
        return names

    # Names of the list Scene are attributes of the whole scene.
    def __getattr__(self, name):
        return getattr(self._home(name), name) if self._is_inside(name) else super().__getattr__(name)

    def __setattr__(self, name, value):
        if name in Scene.__slots__:
            object.__setattr__(self, name, value)
        elif self._is_inside(name):
            setattr(self._home(name), name, value)
        else:
            super().__setattr__(name, value)

    def __dir__(self):
        return [*super().__dir__(), *self._declaration.lists["Scene"].xml_names]

    def __reduce__(self):  # pickles the scene as its text
        return Scene.from_text, (self.to_xml(), self.file)

    def _is_inside(self, name):
        return self._declaration.xml_name(name) is None and not name.startswith("__")

    def _home(self, name):
        declaration = self._declaration.lists["Scene"]
        if declaration.xml_name(name) is None:
            if name in ("run", "check", "view", "batch"):
                raise UnknownName(f"scene: {name} is a function of the module: mixbeam.{name}(scene)")
            raise unknown("scene", name, [*self._declaration.xml_names, *declaration.xml_names])
        return super().__getattr__("Scene")


def _of_each(value, shape, is_array):
    """Returns {place in an array of this shape: value there} of a parameter, given as one value or an array of them; `is_array`:
    each value is an array itself."""
    places = list(np.ndindex(shape))
    values = np.asarray(value, dtype=object) if isinstance(value, (list, tuple, np.ndarray)) else None
    if values is None or is_array and not (shape and values.shape[:-1] == shape):
        return dict.fromkeys(places, value)
    if is_array:
        return {place: values[place].tolist() for place in places}
    values = np.broadcast_to(values, shape)
    return {place: values[place] for place in places}


def _new_names(name, shape, there):
    names = np.empty(shape, dtype=object)
    for place in np.ndindex(shape):
        names[place] = name + "_".join(map(str, place))
        if names[place] in there:
            raise InputError(f'name "{names[place]}" for the second time; allowed: a name other than "{name}", with whose numbers names are new')
    return names


def scene_text(scene):
    """Returns (text, name in messages, whether it is a Scene) of a Scene, an XML text or the path of a file."""
    if isinstance(scene, Scene):
        return scene.to_xml(), str(scene.file or scene.name), True
    if isinstance(scene, str) and scene.lstrip().startswith("<"):
        return scene, "scene", False
    try:
        file = os.fspath(scene)
    except TypeError:
        raise InputError(f"scene: {scene!r}; allowed: a Scene, an XML text or the path of a file") from None
    if file.endswith((".xml", ".yaml", ".yml")) and os.path.isfile(file):
        with contextlib.suppress(OSError, UnicodeError):  # which the program's own reader reports
            return Path(file).read_text(encoding="utf-8"), file, False
    return scene_text(Scene.read(file))


def xml_path(path):
    """Returns the XML path of a batch parameter: "point_loads/tip/force[1]" becomes "Point Loads/tip/Force[1]"."""
    parts, declaration = [], root().lists["Scene"]
    for part in path.split("/"):
        name, bracket, component = part.partition("[")
        known = root() if not parts and declaration.xml_name(name) is None else declaration
        xml = (known.xml_name(name) if known else None) or name
        declaration = (known.inner(xml) if known else None) or Declaration({})
        parts.append(xml + bracket + component)
    return "/".join(parts)


@cache
def classes():
    """Returns {name: function that makes such a list}: Section, Member, PointLoad, ..., and shapes: Circle, Arc, ..."""
    found = {}

    def collect(declaration):
        for word in declaration.parameters.get("Shape", {}).get("choices", ()):  # takes precedence over Drawn As below
            found.setdefault(word.capitalize(), (declaration, {"Shape": word}))
        for inner in declaration.lists.values():
            if inner.free_list:
                found.setdefault(inner.free_list.class_name(inner), (inner.free_list, {}))
                collect(inner.free_list)
            collect(inner)

    collect(root())
    return {name: _maker(name, *what) for name, what in found.items()}


def _maker(name, declaration, fixed):
    def make(*values, **parameters):
        if values:
            raise InputError(f"{name}: {values[0]!r} without a name; allowed: arguments by their names, see help(mixbeam.{name})")
        return Parameters(declaration, None, declaration.path, **fixed, **parameters)

    make.__name__ = make.__qualname__ = name
    make.declaration, make.fixed = declaration, fixed
    make.__doc__ = f"{declaration.meaning}\n\nOf the list {declaration.path}: " + ", ".join(declaration.xml_names)
    return make
