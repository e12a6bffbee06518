"""Parameter lists as objects. Names and types of their entries come from the declarations of the program."""

import copy
import json
import operator
import re
from collections.abc import Mapping, MutableMapping
from functools import cache
from types import SimpleNamespace
from xml.sax.saxutils import quoteattr

import numpy as np

from . import _core
from .errors import InputError, unknown

KINDS_OF_XML = {bool: "bool", int: "int", float: "double", str: "string"}


class Declaration:
    """Declaration of one list: its parameters, sublists and free names, by the names of the program and of Python."""

    def __init__(self, data):
        self.name = data.get("name", "")
        self.path = " / ".join(data.get("path", []))
        self.meaning = data.get("meaning", "")
        self.unchecked = data.get("unchecked", False)
        self.parameters = {one["name"]: one for one in data.get("parameters", [])}
        self.lists = {one["name"]: Declaration(one) for one in data.get("lists", [])}
        free = data.get("free_names", {})
        self.placeholder = free.get("placeholder")
        self.free_parameter = free.get("parameter")
        self.free_list = Declaration(free["list"]) if "list" in free else None
        fixed = [*data.get("parameters", []), *data.get("lists", [])]
        self.xml_names = {one["program_name"]: one["name"] for one in fixed}
        self.words = data.get("forms", {})

    def xml_name(self, name):
        """Returns the XML name of `name`, which may be given as in Python or as in XML; None if it is not declared."""
        return self.xml_names.get(name) or (name if name in self.parameters or name in self.lists else None)

    def parameter(self, xml_name):
        """Returns the declaration of the parameter of this name, fixed or free, or None."""
        return self.parameters.get(xml_name) or (self.free_parameter if xml_name not in self.lists else None)

    def inner(self, xml_name):
        """Returns the Declaration of the list of this name, fixed or free, or None."""
        return self.lists.get(xml_name) or (self.free_list if xml_name not in self.parameters else None)

    def contents(self):
        return ", ".join(self.xml_names) or f"one entry per {self.placeholder}"

    def places(self, name):
        """Returns the paths of the fixed lists, this one or below it, that have `name`."""
        if self.xml_name(name):
            return [()]
        return [(xml, *rest) for xml, inner in self.lists.items() for rest in inner.places(name)]

    def is_array(self, name):
        """Returns whether the parameter `name`, of this list or of the first one below that has it, is an array."""
        within = self
        for xml in next(iter(self.places(name)), ()):
            within = within.lists[xml]
        return within.parameters.get(within.xml_name(name), {}).get("type", "").startswith("Array")

    def class_name(self, inside):
        """Returns the class name of the entries of the list `inside`: PointLoad for `Point Loads`."""
        words = inside.name.split()
        last = words[-1]
        singular = self.name.strip("<>")
        for ending, of_one in ("ies", "y"), ("sses", "ss"), ("s", ""):
            if last.endswith(ending):
                singular = last[:-len(ending)] + of_one
                break
        return "".join(word.capitalize() for word in [*words[:-1], singular])


@cache
def root():
    """Returns the Declaration of a whole scene file."""
    return Declaration(json.loads(_core.declarations()))


class Parameters(MutableMapping):
    """A parameter list: fixed names are attributes, names of your own are keys.

    `scene.members["beam"].elements = 20`. Numbers, texts, sequences and arrays are converted to the declared type; an
    undeclared name raises UnknownName, with the nearest one. Reading a parameter that was not given returns its default,
    or None; setting one to None removes it. Arrays of doubles are NumPy arrays, whose entries may be changed. A text
    that begins with = replaces a number by a formula of `scene.variables`: "=2*L"; it reads back as given, and
    an array that contains formulas as a list.
    """

    __slots__ = ("_declaration", "_parent", "_key", "_entries", "_kinds")

    def __init__(self, declaration, parent=None, key=None, **given):
        for name, value in zip(Parameters.__slots__, (declaration, parent, key, {}, {})):
            object.__setattr__(self, name, value)
        self.update_by_name(given)

    # --- by attributes -------------------------------------------------------------------------------------------------
    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        declaration = self._declaration
        xml = declaration.xml_name(name)
        if xml is None:
            raise unknown(self._place(), name, list(declaration.xml_names))
        if xml in self._entries:
            return self[xml]
        if xml in declaration.lists:
            return Parameters(declaration.lists[xml], self, xml)  # joins this list with its first entry
        default = declaration.parameters[xml].get("default")
        return tuple(default) if isinstance(default, list) else default

    def __setattr__(self, name, value):
        xml = self._declaration.xml_name(name)
        if xml is None:
            raise unknown(self._place(), name, list(self._declaration.xml_names))
        self[xml] = value

    def __delattr__(self, name):
        del self[self._declaration.xml_name(name) or name]

    def __dir__(self):
        return [*super().__dir__(), *self._declaration.xml_names]

    def update_by_name(self, given):
        """Sets the parameters in `given` {name: value}; a name of a sublist sets the first one that has it: E of Material."""
        for name, value in given.items():
            places = self._declaration.places(name)
            if not places and not self._takes(name):
                known = [*self._declaration.xml_names]
                for inner in self._declaration.lists.values():
                    known += inner.xml_names
                raise unknown(self._place(), name, known)
            target = self
            for xml in places[0] if places else ():
                target = getattr(target, xml)
            if target._takes(name):
                target[name] = value
            else:
                setattr(target, name, value)

    # --- by keys -------------------------------------------------------------------------------------------------------
    def __getitem__(self, name):
        xml = self._declaration.xml_name(name) or name
        if xml not in self._entries:
            raise unknown(self._place(), name, list(self._entries))
        return self._entries[xml]

    def __setitem__(self, name, value):
        if not isinstance(name, str):
            raise InputError(f"{self._place()}: {name!r}; allowed: a text as a name")
        if not name.strip() or not is_text(name):
            raise InputError(f"{self._place()}: name {name!r}; allowed: names with letters in them, of one line")
        declaration = self._declaration
        xml = declaration.xml_name(name) or name
        inner, parameter = declaration.inner(xml), declaration.parameter(xml)
        if not (inner or parameter or declaration.unchecked):
            raise unknown(self._place(), name, list(declaration.xml_names))
        if value is None:
            self._entries.pop(xml, None)
            self._kinds.pop(xml, None)
            return
        if isinstance(value, Mapping) and (inner or declaration.unchecked):
            child = Parameters(inner or Declaration({"unchecked": True}), None, f"{self._place()} / {xml}")
            if isinstance(value, Parameters):
                child._copy(value)
            else:
                child.update_by_name(value)
            object.__setattr__(child, "_parent", self)  # only now: an error above leaves this list unchanged
            object.__setattr__(child, "_key", xml)
            self._kinds.pop(xml, None)
            self._entries[xml] = child
        elif parameter or declaration.unchecked:
            kind, converted = convert(value, parameter, f"{self._place()} / {xml}")
            self._kinds[xml], self._entries[xml] = kind, converted
        else:
            raise InputError(f"{self._place()} / {xml}: {value!r}; allowed: an object or a dict, with {inner.contents()}")
        self._join()

    def __delitem__(self, name):
        xml = self._declaration.xml_name(name) or name
        if xml not in self._entries:
            raise unknown(self._place(), name, list(self._entries))
        del self._entries[xml]
        self._kinds.pop(xml, None)

    def __iter__(self):
        return iter(self._entries)

    def __len__(self):
        return len(self._entries)

    def __eq__(self, other):
        """Compares entries, their types and their order."""
        if not isinstance(other, Parameters):
            return NotImplemented
        return list(self._entries) == list(other._entries) and self._kinds == other._kinds and all(
            same(value, other._entries[name]) for name, value in self._entries.items())

    __hash__ = None

    def __repr__(self):
        return f"<{self._place()}: " + ", ".join(f"{name}={value!r}" for name, value in self._entries.items()) + ">"

    def __reduce__(self):  # copies and pickles the list without those above it, like one of its class
        return _copied, (self._declaration, self._place(), self._entries, self._kinds)

    # --- inside --------------------------------------------------------------------------------------------------------
    def _takes(self, name):
        """Returns whether `name` may be a key without being an attribute."""
        free = self._declaration.placeholder is not None or self._declaration.unchecked
        return free and self._declaration.xml_name(name) is None

    def _place(self):
        if self._parent is None:
            return self._key or "scene"
        before = self._parent._place()
        return self._key if before == "scene" else f"{before} / {self._key}"

    def _join(self):
        """Adds this list, which now has an entry, to the lists above it."""
        if self._parent is not None and self._parent._entries.get(self._key) is not self:
            self._parent._entries[self._key] = self
            self._parent._join()

    def _copy(self, other):
        for name, value in other._entries.items():
            if isinstance(value, Parameters):
                child = Parameters(self._declaration.inner(name) or value._declaration, self, name)
                child._copy(value)
                self._entries[name] = child
            else:
                self._entries[name] = value if isinstance(value, str) else copy.copy(value)
                self._kinds[name] = other._kinds[name]

    def _fill(self, entries):
        """Fills the list from the library's {name: (type, value), or the dict of a list}."""
        for name, entry in entries.items():
            if isinstance(entry, dict):
                child = Parameters(self._declaration.inner(name) or Declaration({"unchecked": True}), self, name)
                child._fill(entry)
                self._entries[name] = child
            else:
                kind, value = entry
                self._kinds[name] = kind
                if kind == "Array(double)":
                    value = _read_numbers(value, float) if any(isinstance(one, str) for one in value) else np.array(value, float)
                elif kind == "Array(int)":
                    value = _read_numbers(value, int)
                self._entries[name] = value
        return self

    def _xml(self, name, indent=""):
        """Returns the XML text of this list under the name `name`."""
        inside = indent + "  "
        parts = [f"{indent}<ParameterList name={quoted(name)}>\n"]
        for key, value in self._entries.items():
            if isinstance(value, Parameters):
                parts.append(value._xml(key, inside))
            else:
                kind = self._kinds[key]
                parts.append(f'{inside}<Parameter name={quoted(key)} type="{kind}" value={quoted(text_of(value, kind))}/>\n')
        return "".join((*parts, f"{indent}</ParameterList>\n"))


def _copied(declaration, place, entries, kinds):
    made = Parameters(declaration, None, place)
    made._copy(SimpleNamespace(_entries=entries, _kinds=kinds))
    return made


def same(one, other):
    """Compares two values, arrays or lists."""
    return np.array_equal(one, other) if isinstance(one, np.ndarray) else one == other


def convert(value, parameter, place):
    """Returns (XML type, converted value) for a declared parameter; `parameter` is None for an undeclared one."""
    kind = parameter["type"] if parameter else undeclared_kind(value)
    for one in _entries(value) or [value]:
        if isinstance(one, str) and not is_text(one):
            raise InputError(f"{place}: {one!r}; allowed: a text without control characters")
    if parameter and parameter.get("words") and isinstance(value, (str, bool)):
        return "string", str(value).lower() if isinstance(value, bool) else value
    if parameter and is_formula(value, parameter):
        return "string" if isinstance(value, str) and not value.lstrip().startswith("=") else kind, value
    if kind in ("Array(double)", "Array(int)") and any(isinstance(one, str) for one in _entries(value)):
        return kind, _with_formulas(value, kind, place)
    try:
        return kind, CONVERSIONS[kind](value)
    except (TypeError, ValueError, OverflowError):
        hint = _core.number_hint(value) if isinstance(value, str) and kind in ("int", "double") else ""
        hint = ", like (0, 0, 1)" if kind == "Array(double)" else hint
        raise InputError(f"{place}: {value!r}; allowed: {kind}{hint}") from None


NOT_IN_FILES = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")
ESCAPED = re.compile("[&<>\"\n\t\r]")


def is_text(value):
    """Returns whether a scene file can hold this text."""
    return NOT_IN_FILES.search(value) is None


def is_formula(value, parameter):
    """Returns whether `value` is a formula in place of a number: "=2*L"; variables need no =."""
    return isinstance(value, str) and parameter["type"] in ("double", "int") and (
        value.lstrip().startswith("=") or "or_other" in parameter)


def _read_numbers(texts, number):
    """Converts the entries of an array to numbers, except formulas, which stay texts."""
    return [one if isinstance(one, str) and one.lstrip().startswith("=") else number(one) for one in texts]


def _entries(value):
    return value if isinstance(value, (list, tuple)) else ()


def _with_formulas(value, kind, place):
    """Returns the numbers and formulas of an array as a list."""
    try:
        return _read_numbers(value, CONVERSIONS[kind[6:-1]])
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{place}: {value!r}; allowed: {kind}, and formulas like \"=2*L\"") from None


def undeclared_kind(value):
    if isinstance(value, (list, tuple, np.ndarray)):
        kind = np.asarray(value).dtype.kind
        return {"i": "Array(int)", "f": "Array(double)"}.get(kind, "Array(string)")
    return KINDS_OF_XML.get(type(value), "string")


def _only(value, *types):
    if not isinstance(value, types):
        raise TypeError
    return types[0](value)


def _real(value):
    if isinstance(value, (bool, np.bool_)) or isinstance(value, str) and value.strip() not in ("inf", "-inf"):
        raise TypeError
    return float(value)


def _integer(value):
    if isinstance(value, (bool, np.bool_)):
        raise TypeError
    whole = int(value) if isinstance(value, float) and value.is_integer() else operator.index(value)
    if not -(2**31) <= whole < 2**31:
        raise OverflowError
    return whole


def _texts(value):
    words = [_only(word, str) for word in ([value] if isinstance(value, str) else value)]
    if any(not word.strip() or "{" in word or "}" in word or "," in word and "(" not in word for word in words):
        raise ValueError
    return words


CONVERSIONS = {"bool": lambda value: _only(value, bool, np.bool_), "int": _integer, "double": _real,
               "string": lambda value: _only(value, str), "Array(int)": lambda value: [_integer(number) for number in value],
               "Array(double)": lambda value: np.array(value, dtype=float).ravel(), "Array(string)": _texts}


def text_of(value, kind):
    """Returns the XML text of a value; numbers have the fewest digits that give the same bits."""
    if isinstance(value, np.ndarray):  # of real numbers
        return "{" + ", ".join(map(repr, value.tolist())) + "}"
    if kind.startswith("Array"):
        return "{" + ", ".join(text_of(one, kind[6:-1]) for one in value) + "}"
    if isinstance(value, str):  # includes formulas in place of numbers
        return value
    return str(value).lower() if kind == "bool" else repr(value) if kind == "double" else str(value)


def quoted(text):
    """Returns `text` as a quoted attribute value that keeps its white space."""
    if ESCAPED.search(text) is None:
        return f'"{text}"'
    return quoteattr(text, {"\n": "&#10;", "\t": "&#9;", "\r": "&#13;"})
