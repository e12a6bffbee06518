"""Reads the result files that the applications write (layout: discretization/results/result_file.hpp)."""

import difflib
import re
from functools import cached_property
from pathlib import Path

import h5py
import numpy as np

from tables import InputError


MANY_MEMBERS = 200


class Member:
    """Where a member's samples stand in the fields of a step, and its undeformed shape, read when first asked for."""

    def __init__(self, name, index, first, count, read):
        self.index = index  # in the scene
        self.first_in_file = first
        self.name = name
        self.samples = slice(first, first + count)
        self._read = read

    @cached_property
    def arc_length(self):
        return self._read("arc_length")

    @cached_property
    def element(self):
        return self._read("element")

    @cached_property
    def reference_position(self):
        return self._read("reference_position")

    def vertices(self):
        """Numbers of the member's samples at element ends."""
        ends = np.flatnonzero(np.diff(self.element))
        return np.concatenate(([0], ends + 1, [len(self.element) - 1]))


def _members(group):
    """Of a result file, in the order of the scene."""
    if not isinstance(group.get("names"), h5py.Dataset):  # before format 4 a group for each
        ordered = sorted(group, key=lambda name: group[name].attrs["index"])
        return [Member(name, index, int(group[name].attrs["first_sample"]), int(group[name].attrs["samples"]),
                       lambda field, name=name: group[name][field][:]) for index, name in enumerate(ordered)]
    whole = {}  # each field is read at once: members are many and short

    def part(field, first, end):
        if field not in whole:
            whole[field] = group[field][:]
        return whole[field][first:end]

    places = zip(group["names"][:], group["first_sample"][:].tolist(), group["samples"][:].tolist())
    return [Member(_text(name), index, first, count, lambda field, first=first, end=first + count: part(field, first, end))
            for index, (name, first, count) in enumerate(places)]


class Selection:
    """The rows of the fields that belong to the members of a run: all of them, or those of chosen members."""

    def __init__(self, members=None):
        """Gives the chosen members their places among each other."""
        self._rows = None
        if members is None:
            return
        self._rows, first = [], 0
        for member in members:
            count = member.samples.stop - member.samples.start
            self._rows.append(np.arange(member.first_in_file, member.first_in_file + count))
            member.samples = slice(first, first + count)
            first += count
        self._rows = np.concatenate(self._rows)

    def of(self, values):
        return values[:] if self._rows is None else values[:][self._rows]

    def numbers(self, numbers):
        return numbers if self._rows is None else self._rows[numbers]


class CriticalPoint:
    """A limit point or bifurcation between two steps; fields as those of a step, and the critical mode."""

    def __init__(self, group, selection):
        self.kind = _text(group.attrs["kind"])
        self.load_factor = float(group.attrs["load_factor"])
        self.negative_before = int(group.attrs["negative_before"])
        self.negative_after = int(group.attrs["negative_after"])
        self.modes = int(group.attrs["modes"])
        self._group, self._selection = group, selection

    def field(self, name):
        return self._selection.of(self._group[name])

    def monitored(self, name):
        """Components of a monitored quantity, None where the file has none of that name."""
        group = self._group.get("monitor", {})
        return group[name][:] if name in group else None


class Step:
    """One converged configuration; `fields[name]` holds a row per sample of all members."""

    def __init__(self, group, selection):
        self.number = int(group.attrs["step"])
        self.load_factor = float(group.attrs["load_factor"])
        self.newton_iterations = int(group.attrs.get("newton_iterations", 0))
        self.negative = int(group.attrs.get("negative_eigenvalues", -1))  # -1: not counted
        told = {-1: "unknown", 0: "true"}.get(self.negative, "false")  # files of versions that only counted
        self.stable = _text(group.attrs["stable"]) if "stable" in group.attrs else told
        self._group, self._selection = group, selection

    def critical_points(self):
        """Those that the path passed since the step before."""
        group = self._group.get("critical_points", {})
        return [CriticalPoint(group[name], self._selection) for name in sorted(group, key=int)]

    @property
    def jump(self):
        """With which the step was made: {"from", "to", "released", "motion", "largest", "place", ...}; None where it was not."""
        attributes = self._group["jump"].attrs if "jump" in self._group else {}
        return {**attributes, "place": _text(attributes["place"])} if attributes else None

    def field(self, name, member=None):
        values = self._selection.of(self._group[name])
        return values[member.samples] if member is not None else values

    def has(self, name):
        """Whether a field is there: stresses are not in every step."""
        return name in self._group

    def rows(self, name, numbers):
        """Some rows of a field without reading the others; `numbers` ascending."""
        return self._group[name][self._selection.numbers(numbers)]

    def residual_histories(self):
        """Scale-free residuals of every attempt at the step, the successful one last; empty where the file has none."""
        if "residual_history" not in self._group:
            return []
        rows = self._group["residual_history"][:]
        if rows.ndim == 1:
            return [rows]
        return [rows[rows[:, 0] == attempt, -1] for attempt in np.unique(rows[:, 0])]


def file_of_case(path, case):
    """Where `mixbeam run` puts the results of a load case, `path` being those of the scene."""
    return path.with_name(f"{path.stem}-{case}{path.suffix}")


class Run:
    """An open result file: its members in the order of the scene, and its steps in the order of the path.

    `members`: patterns of the names of those to look at, * for any characters; None: all.
    """

    def __init__(self, path, case=None, members=None):
        path = Path(path)
        if case and file_of_case(path, case).is_file():
            path = file_of_case(path, case)
        if not path.is_file():
            beside = ", ".join(sorted(file.name for file in path.parent.glob(f"{path.stem}-*{path.suffix}"))[:6])
            raise InputError(f"{path}: no such file" + (f"; of load cases there are {beside}" if beside else ""))
        self.path = path
        try:
            self._file = h5py.File(path, "r")
        except OSError as error:
            raise InputError(f"{path}: not a readable HDF5 file ({error})") from None
        if self._file.attrs.get("format", b"") not in ("mixbeam results", b"mixbeam results"):
            if "envelope" not in self._file:
                raise InputError(f"{path}: HDF5, but not a result file of mixbeam")
            cases = ", ".join(name[len(path.stem) + 1:] for name in _text(self._file["runs"][()]).splitlines())
            raise InputError(f"{path}: the envelope of several load cases, of which --case names one ({cases})"
                             + (f"; there is no {case}" if case else ""))
        properties = self._file["properties"].attrs if "properties" in self._file else {}
        self.case = _text(properties.get("load_case", ""))
        if case and case != self.case:
            what = f"of load case {self.case}" if self.case else "of a scene without load cases"
            raise InputError(f"{path}: the file is {what}, and there is no {file_of_case(path, case).name} beside it")
        self._by_index = None
        self._units = _text(self._file["acting"].attrs.get("units", "")) if "acting" in self._file else ""
        self.scene_name = _text(self._file.attrs.get("scene_name", path.stem))
        try:
            self.members = _members(self._file["members"])
            if members is not None:
                self.members = self.members_meant(members)
            self._selection = Selection(members and self.members)
            self.steps = [Step(self._file["steps"][name], self._selection) for name in sorted(self._file["steps"])]
        except KeyError as error:
            raise InputError(f"{path}: a result file of mixbeam, but incomplete ({error.args[0]})") from None
        if not self.steps:
            raise InputError(f"{path}: holds no steps")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._file.close()

    def members_meant(self, patterns, option="--members"):
        """Those of the run whose names match one of the patterns; each pattern must match some."""
        names = {member.name: member for member in self.members}
        chosen = set()
        for pattern in patterns:
            matching = re.compile(".*".join(re.escape(part) for part in pattern.split("*")), re.DOTALL)
            found = {name for name in names if matching.fullmatch(name)}
            if not found:
                near = difflib.get_close_matches(pattern, names, 3, 0.0)
                raise InputError(f"{option} {pattern}: no member of that name; the nearest are {', '.join(near)}")
            chosen |= found
        return [member for member in self.members if member.name in chosen]

    def member_of_index(self, index):
        """Of the scene; None where it is not looked at."""
        if self._by_index is None:
            self._by_index = {member.index: member for member in self.members}
        return self._by_index.get(index)

    def acting(self):
        """What acts on the structure, {"supports", "joints", "point_loads", "line_loads"}: tables by their columns."""
        group = self._file.get("acting", {})
        return {name: {column: _column_of(group[name][column]) for column in group[name]} for name in group}

    @property
    def units(self):
        """(length, force) as the scene names them, empty where it does not."""
        words = [word.strip() for word in self._units.split(",")]
        return tuple(words) if len(words) == 2 else ("", "")

    @property
    def title(self):
        return self.scene_name + (f", load case {self.case}" if self.case else "")

    def step_at(self, load_factor):
        """The step whose load factor is nearest."""
        return min(self.steps, key=lambda step: abs(step.load_factor - load_factor))

    def critical_points(self):
        """All on the path, in its order."""
        return [point for step in self.steps for point in step.critical_points()]

    def buckling_modes(self):
        """[(load factor, displacements (n, 3))] of the linear buckling analysis of the undeformed structure."""
        group = self._file.get("buckling", {})
        return [(float(group[name].attrs["load_factor"]), self._selection.of(group[name]["mode"])) for name in sorted(group, key=int)]

    def reference(self):
        """Undeformed positions of all samples, (n, 3)."""
        if len(self.members) > MANY_MEMBERS:  # one large read in place of one small read for each member
            return self.steps[0].field("position") - self.steps[0].field("displacement")
        return np.concatenate([member.reference_position for member in self.members])

    def monitor(self):
        """The monitored quantities over the steps: {name: (steps,) or (steps, components)}."""
        group = self._file.get("monitor", {})
        return {name: group[name][:] for name in group if name != "quantities"}

    def quantities(self):
        """What the list Quantities of the scene asks for, over the steps: {name: (steps,)}."""
        asked = self._file.get("monitor/quantities")
        names = _text(self._file["quantities"][()]).split("\n") if asked is not None else []
        return {name: asked[:, i] for i, name in enumerate(names) if name}

    def quantity_units(self):
        """{name: unit} of those that have one, where the scene names units."""
        lines = _text(self._file["quantity_units"][()]).split("\n") if "quantity_units" in self._file else []
        return dict(zip(self.quantities(), lines))

    def series(self, name):
        """Over the steps: a quantity, a time series of the run, or [force:|moment:|rotation:]POINT.x, .y, .z, .norm
        (without a word before it: the displacement)."""
        known = {**self.monitor(), **self.quantities()}
        if name in known and known[name].ndim == 1:
            return known[name]
        vector, component = self._component(name, known)
        if vector:
            values = known[vector]
            return np.linalg.norm(values, axis=1) if component == "norm" else values[:, "xyz".index(component)]
        names = [other for other in known if known[other].ndim == 1]
        names += [f"{other}.{axis}" for other in known if known[other].ndim == 2 for axis in "xyz"]
        near = difflib.get_close_matches(name, names, 4, 0.0)
        raise InputError(f"{self.path}: nothing is followed as {name}; the nearest are {', '.join(near)}")

    def unit_of(self, name):
        """Of a quantity or a series of a point; empty where the scene names no units, and for formulas."""
        if name in self.quantities():
            return self.quantity_units().get(name, "")
        return self.unit_of_kind(self._component(name, self.monitor())[0].rpartition(".")[2])

    def unit_of_kind(self, kind):
        """Of displacement, rotation, reaction_force, reaction_moment of points, where the scene names units."""
        length, force = self.units
        kinds = {"displacement": length, "rotation": "rad", "reaction_force": force, "reaction_moment": f"{force} {length}"}
        return kinds.get(kind, "") if length else ""

    @staticmethod
    def _component(name, known):
        """(vector among `known`, component) that a name means; empty where there is none."""
        point, _, component = name.rpartition(".")
        kind, colon, rest = point.partition(":")
        kinds = {"force": "reaction_force", "moment": "reaction_moment", "rotation": "rotation"}
        of_point = f"{rest}.{kinds.get(kind, kind)}" if colon else f"{point}.displacement"
        for vector in (point, of_point):
            if vector in known and known[vector].ndim == 2 and component in ("x", "y", "z", "norm"):
                return vector, component
        return "", ""

    def properties(self):
        """Program, machine, threads, ...: {name: text}, with the version."""
        words = {name: _text(value) for name, value in self._file["properties"].attrs.items()}
        return {**words, "version": _text(self._file["version"][()])}

    def supported_points(self):
        """Names, in the order of the rows of reactions."""
        group = self._file.get("supports", {})
        return [_text(group[str(i)].attrs["point"]) for i in range(len(group))]

    def scene_text(self):
        """The input of the run, word for word."""
        return _text(self._file["scene"][()])


def _column_of(dataset):
    """Numbers, or the lines of a text, each of which ends in a new line."""
    return dataset[:] if dataset.shape else _text(dataset[()]).split("\n")[:-1]


def _text(value):
    return value.decode() if isinstance(value, bytes) else str(value)
