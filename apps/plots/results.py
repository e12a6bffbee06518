"""Reads the result files that the applications write (layout: discretization/results/result_file.hpp)."""

import difflib
import fnmatch
import math
import os
import re
import resource
import subprocess
from functools import cache, cached_property
from pathlib import Path

import h5py
import numpy as np

from command import InputError, NothingToDraw, inputs

MANY_MEMBERS = 200
# The program that has started this script, or the one beside it.
PROGRAM = Path(os.environ.get("MIXBEAM_PROGRAM") or Path(os.path.abspath(__file__)).parent.parent / "mixbeam")
SLOWEST = 5_000_000  # bytes verified in a second, at least
NUMBER, WHOLE, TEXT = h5py.h5t.IEEE_F64LE, h5py.h5t.STD_I32LE, None  # types of datasets; shapes of their rows follow
VECTORS = "position displacement mode reference_position material_force material_moment force_strain moment_strain triad_1 triad_2 triad_3"
FIELDS = {**dict.fromkeys(VECTORS.split(), (3,)), "triad": (4,), "arc_length": (), "element": (),
          **dict.fromkeys(("von_mises_stress", "largest_normal_stress", "largest_shear_stress", "utilisation"), ())}
PLACED, ALONG = {"place": (2,), "position": (3,), "point": TEXT, "begins": ()}, {"member": (), "begins": ()}
ACTING = {"supports": {**PLACED, "axes": (9,), "fixed": (6,), "stiffness": (6,), "prescribed": (6,)},
          "joints": {**PLACED, "name": TEXT, "kind": TEXT, "axis": (3,), "stiffness": ()},
          "point_loads": {**PLACED, "force": (3,), "moment": (3,), "follower": ()},
          "line_loads": {**ALONG, "force": (27,), "couple": (27,), "range": (2,), "follower": ()},
          "eigenstrains": {**ALONG, "strain": (27,), "curvature": (27,), "turns": (6,)},
          "rotating_frames": {"position": (3,), "velocity": (3,), "begins": ()},
          "sections": {"name": TEXT, "shape": TEXT, "dimensions": (36,), "strength": (9,)}, "members": {"section": ()}}
LAYOUTS = (h5py.h5d.COMPACT, h5py.h5d.CONTIGUOUS, h5py.h5d.CHUNKED)
DRAWN_AS = "drawn as "  # prefix of the shape of a section given by stiffnesses
JUMP = ("from", "to", "released", "motion", "largest", "place")


@cache
def require_whole(path, _inode, size, _changed):
    """Raises InputError if `mixbeam verify` refuses a file. It runs in a process with limits, as hostile files may crash HDF5."""
    most = lambda: resource.setrlimit(resource.RLIMIT_AS, ((4 << 30) + 2 * size,) * 2)
    if PROGRAM.is_file():
        ended = subprocess.run([PROGRAM, "verify", path.absolute()], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                               text=True, errors="replace", timeout=80 + size / SLOWEST, preexec_fn=most)
        words = ended.stderr.strip().removeprefix("mixbeam: bad input: ").replace(str(path.absolute()), str(path))
        if ended.returncode:
            raise InputError(words if ended.returncode == 2 else f"{path}: damaged: mixbeam verify ended with {ended.returncode}")


def open_file(path):
    """Verifies and opens a file, and returns its root Group. Raises InputError."""
    inputs.add(path)
    now = path.stat()
    try:
        require_whole(path, now.st_ino, now.st_size, now.st_mtime_ns)
        file = h5py.File(path, "r")
    except (OSError, subprocess.TimeoutExpired) as error:
        raise InputError(f"{path}: not a readable HDF5 file ({error})") from None
    return Group(h5py.h5g.open(file.id, b"/"), path, now.st_size, file=file)


class Group:
    """HDF5 group, the only reader of HDF5. It follows hard links only and checks a dataset before it reads it: doubles, 32-bit
    integers or texts of fixed length, of the declared shape, stored in the file itself and no larger than it."""

    def __init__(self, held, path, size, place="", file=None):
        self._held, self._path, self.size, self._place, self._file = held, path, size, place, file

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._file.close()

    def refused(self, name, reason):
        return InputError(f"{self._path}: damaged, or no result file of mixbeam: {self._place}/{name}: {reason}")

    def names(self):
        return sorted(name.decode("utf-8", "replace") for name in self._held)

    def __contains__(self, name):
        return self._held.links.exists(name.encode())

    def opened(self, name, kind=object):
        if name not in self or self._held.links.get_info(name.encode()).type != h5py.h5l.TYPE_HARD:
            raise self.refused(name, "is a link, which may leave the file" if name in self else "is not there")
        found = h5py.h5o.open(self._held, name.encode())
        if not isinstance(found, kind):
            raise self.refused(name, f"a {type(found).__name__}; allowed: a {kind.__name__}")
        return found

    def group(self, name, optional=False):
        """Returns the group of this name; None if it is optional and missing."""
        if not optional or name in self:
            return Group(self.opened(name, h5py.h5g.GroupID), self._path, self.size, f"{self._place}/{name}")

    def numbered(self, name):
        """Returns the groups 0, 1, ... in the group of that name; [] if it is missing."""
        group = self.group(name, optional=True)
        return [group.group(str(number)) for number in range(len(group.names()))] if group else []

    def read(self, name, *shapes, kind=NUMBER, rows=()):
        """Reads a dataset that has one of the shapes; None in a shape stands for any number."""
        data = self.opened(name, h5py.h5d.DatasetID)
        plan, stored, shape = data.get_create_plist(), data.get_type(), data.shape
        if plan.get_layout() not in LAYOUTS or plan.get_external_count() or plan.get_nfilters():
            raise self.refused(name, "is packed, or stored elsewhere than in the file itself")
        if not _is_of(stored, kind) or not any(len(shape) == len(one) and all(b in (None, a) for a, b in zip(shape, one)) for one in shapes):
            raise self.refused(name, f"{stored.dtype} of shape {shape}; allowed: {' or '.join(map(str, shapes))} of the declared type")
        if math.prod(shape) * stored.get_size() > min(data.get_storage_size(), self.size):
            raise self.refused(name, "is larger than what the file holds of it")
        return h5py.Dataset(data)[rows]

    def text(self, name):
        return _text(self.read(name, (), kind=TEXT))

    def attribute(self, name, kind=float, default=None):
        """Reads an attribute: one float, int or str."""
        if default is not None and not h5py.h5a.exists(self._held, name.encode()):
            return default
        found = h5py.h5a.open(self._held, name.encode())
        value, is_one = np.empty((), found.get_type().dtype), found.get_space().get_simple_extent_type() == h5py.h5s.SCALAR
        if not is_one or not _is_of(found.get_type(), {float: NUMBER, int: WHOLE, str: TEXT}[kind]):
            raise self.refused(name, f"no single {kind.__name__}")
        found.read(value)
        return _text(value[()]) if kind is str else kind(value)

    def attributes(self):
        """Returns all attributes, which are texts, as {name: text}."""
        count = h5py.h5a.get_num_attrs(self._held)
        return {name: self.attribute(name, str) for name in (h5py.h5a.open(self._held, index=i).name.decode() for i in range(count))}


def _refusing(method):
    """Decorates a method: errors of the HDF5 library become an InputError that names the object."""
    def refusing(group, *arguments, **options):
        try:
            return method(group, *arguments, **options)
        except InputError:
            raise
        except Exception as error:
            raise group.refused(arguments[0] if arguments else "", error) from None
    return refusing


for _name in ("names", "__contains__", "opened", "group", "numbered", "read", "attribute", "attributes"):
    setattr(Group, _name, _refusing(getattr(Group, _name)))


def _is_of(stored, kind):
    return isinstance(stored, h5py.h5t.TypeStringID) and not stored.is_variable_str() if kind is TEXT else stored.equal(kind)


def lines(text):
    """Splits a text into lines; the last one may lack its newline."""
    return text.removesuffix("\n").split("\n") if text else []


def _text(value):
    return bytes(value).decode("utf-8", "replace")


class Member:
    """Samples of a member in the fields of a step, and its undeformed shape, read at first use."""

    def __init__(self, name, index, first, count, read):
        self.index = index  # in the scene
        self.first_in_file = first
        self.name = name
        self.samples = slice(first, first + count)
        self._read = read

    arc_length, element, reference_position = (cached_property(lambda self, name=name: self._read(name))
                                               for name in ("arc_length", "element", "reference_position"))

    def vertices(self):
        """Numbers of the member's samples at element ends."""
        ends = np.flatnonzero(np.diff(self.element))
        return np.concatenate(([0], ends + 1, [len(self.element) - 1]))


def _members(group):
    """Reads the members of a result file, in the order of the scene."""
    old = "names" not in group or isinstance(group.opened("names"), h5py.h5g.GroupID)  # a group for each before format 4
    if old:
        groups = sorted(((name, group.group(name)) for name in group.names()), key=lambda one: one[1].attribute("index", int))
        names = [name for name, _ in groups]
        firsts, counts = (np.array([one.attribute(what, int) for _, one in groups]) for what in ("first_sample", "samples"))
    else:
        counts = group.read("samples", (None,), kind=WHOLE).astype(int)
        firsts = group.read("first_sample", counts.shape, kind=WHOLE).astype(int)
        names = [_text(name) for name in group.read("names", counts.shape, kind=TEXT)]
    if not len(counts) or counts.min() < 2 or 8 * counts.sum() > group.size or (firsts != np.cumsum(counts) - counts).any():
        raise group.refused("", "numbers of samples that do not fit one another or the file")

    @cache  # fields are read whole, since members may be many and short
    def whole(name):
        parts = [(one, count) for (_, one), count in zip(groups, counts)] if old else [(group, counts.sum())]
        kind = WHOLE if name == "element" else NUMBER
        return np.concatenate([one.read(name, (count, *FIELDS[name]), kind=kind) for one, count in parts])

    return [Member(name, index, first, count, lambda field, own=slice(first, first + count): whole(field)[own])
            for index, (name, first, count) in enumerate(zip(names, firsts.tolist(), counts.tolist()))]


def _per_length(members, rows):
    """Returns rows of the elements (of the whole mesh) at all samples, divided by the lengths of the elements."""
    found, first = [], 0
    for member in members:
        number, s = member.element, member.arc_length
        ends = np.flatnonzero(np.diff(number))
        lengths = s[np.append(ends, len(s) - 1)] - s[np.append(0, ends + 1)]
        found.append(rows[first + number] / lengths[number, None])
        first += len(lengths)
    return np.concatenate(found)


class Selection:
    """Rows of the fields for the members of a run: all of them, or those of chosen members."""

    def __init__(self, samples, members=None):
        """Renumbers the samples of the chosen members; `samples`: number in the whole file."""
        self._rows, self.samples = None, samples
        if members is None:
            return
        self._rows, first = [], 0
        for member in members:
            count = member.samples.stop - member.samples.start
            self._rows.append(np.arange(member.first_in_file, member.first_in_file + count))
            member.samples = slice(first, first + count)
            first += count
        self._rows = np.concatenate(self._rows)

    def of(self, group, name):
        """Reads a field of the group."""
        return self.chosen(group.read(name, (self.samples, *FIELDS[name])))

    def chosen(self, values):
        return values if self._rows is None else values[self._rows]

    def numbers(self, numbers):
        return numbers if self._rows is None else self._rows[numbers]


class CriticalPoint:
    """Limit point, bifurcation or flutter point between two steps; fields like those of a step, and the critical mode."""

    def __init__(self, group, selection):
        self.kind = group.attribute("kind", str)
        self.load_factor = group.attribute("load_factor")
        self.load_factor_error = group.attribute("load_factor_error", default=np.nan)
        self.negative_before = group.attribute("negative_before", int)
        self.negative_after = group.attribute("negative_after", int)
        self.modes = group.attribute("modes", int)
        self.omega = group.attribute("omega", default=np.nan)  # of flutter
        self._group, self._selection = group, selection

    def field(self, name):
        return self._selection.of(self._group, name)

    def monitored(self, name):
        """Returns the components of a monitored quantity, None if the file has none of that name."""
        group = self._group.group("monitor", optional=True)
        return group.read(name, (None,)) if group and name in group else None


class Step:
    """One converged state; `field(name)` has a row for each sample of all members."""

    def __init__(self, group, selection, units=("", "")):
        self.units = units  # of length and force
        self.number = group.attribute("step", int)
        self.load_factor = group.attribute("load_factor")
        self.newton_iterations = group.attribute("newton_iterations", int, 0)
        self.negative = group.attribute("negative_eigenvalues", int, -1)  # -1: not counted
        told = {-1: "unknown", 0: "true"}.get(self.negative, "false")  # for old files without the attribute `stable`
        self.stable = group.attribute("stable", str, told)
        self._group, self._selection = group, selection

    def critical_points(self):
        """Returns the critical points on the path since the step before."""
        return [CriticalPoint(point, self._selection) for point in self._group.numbered("critical_points")]

    def buckling_modes(self):
        """Returns [(factor of the loads of the next stage, displacements (n, 3))] about this state, at the end of a stage."""
        return [(mode.attribute("load_factor"), self._selection.of(mode, "mode")) for mode in self._group.numbered("buckling")]

    def natural_modes(self):
        """Returns [{"eigenvalue": omega^2, "omega", "growth", "track", "mode": displacements (n, 3)}] of vibrations about this
        state, if the run computed them; modes of one track (from 1 on; 0: unknown) are the same motion along the path."""
        return [{"mode": self._selection.of(mode, "mode"), "growth": mode.attribute("growth", default=0.0),
                 "track": mode.attribute("track", int, default=0),
                 **{name: mode.attribute(name) for name in ("eigenvalue", "omega")}} for mode in self._group.numbered("vibration")]

    @property
    def jump(self):
        """Jump that the step made, {"from", "to", "released", "motion", "largest", "place"}; None if it made none."""
        group = self._group.group("jump", optional=True)
        return {name: group.attribute(name, str if name == "place" else float) for name in JUMP} if group else None

    def field(self, name, member=None):
        values = self._selection.of(self._group, name)
        return values[member.samples] if member is not None else values

    def has(self, name):
        """Returns whether the step has a field: not every step has stresses."""
        return name in self._group

    def gradients(self):
        """Returns [(quantity, C dq/dC (elements, 6))] if the run computed them, from the derivatives by C and by 1 / C."""
        group = self._group.group("gradients", optional=True)
        own = [group.group(str(number)) for number in range(len(group.names()) - 1)] if group else []
        pairs = [(one, *(one.read(name, (None, 6)) for name in ("stiffness", "compliance"))) for one in own if "stiffness" in one]
        return [(one.attribute("quantity", str), np.copysign(np.sqrt(np.abs(by * inverse)), by)) for one, by, inverse in pairs]

    def rows(self, name, numbers):
        """Reads some rows of a field only; `numbers` ascending."""
        return self._group.read(name, (self._selection.samples, *FIELDS[name]), rows=self._selection.numbers(numbers))

    def errors(self, kind):
        """Returns estimated errors of "quantities" or "sections": {name: (value, error, or the reason for none)}."""
        estimate = self._group.group("error_estimate", optional=True)
        group = estimate and estimate.group(kind, optional=True)
        if not group:
            return {}
        names, reasons = (lines(group.text(name)) for name in ("names", "not_estimated"))
        if len(names) != len(reasons):
            raise group.refused("not_estimated", f"{len(reasons)} lines; allowed: {len(names)}")
        values, errors = (group.read(name, (len(names),)).tolist() for name in ("value", "error"))
        return dict(zip(names, zip(values, [reason or error for reason, error in zip(reasons, errors)])))

    def balance_errors(self):
        """Returns the balance errors of forces and moments of loads and reactions, over the largest of them."""
        return [self._group.attribute(f"{kind}_balance_error", default=np.nan) for kind in ("force", "moment")]

    def reactions(self, supports):
        """Returns reaction forces and moments, (supports, 6)."""
        return self._group.read("reactions", (supports, 6))

    def residual_histories(self):
        """Returns the scaled residuals of every attempt at the step, the successful one last; [] if the file has none."""
        if "residual_history" not in self._group:
            return []
        rows = self._group.read("residual_history", (None, 3), (None,))
        if rows.ndim == 1:
            return [rows]
        return [rows[rows[:, 0] == attempt, -1] for attempt in np.unique(rows[:, 0])]


def file_of_case(path, case):
    """Returns the result file of a load case; `path`: that of the scene."""
    return path.with_name(f"{path.stem}-{case}{path.suffix}")


class Run:
    """An open result file: its members in the order of the scene, and its steps in the order of the path.

    `members`: patterns of member names, * for any characters, ? for one, [abc] for one of these; None: all members.
    """

    def __init__(self, path, case=None, members=None):
        path = Path(path)
        if case and file_of_case(path, case).is_file():
            path = file_of_case(path, case)
        if not path.is_file():
            beside = ", ".join(sorted(file.name for file in path.parent.glob(f"{path.stem}-*{path.suffix}"))[:6])
            raise NothingToDraw(f"{path}: no such file" + (f"; of load cases there are {beside}" if beside else ""))
        self.path = path
        self._file = open_file(path)
        if self._file.attribute("format", str, "") != "mixbeam results":
            if "envelope" not in self._file:
                raise InputError(f"{path}: HDF5, but not a result file of mixbeam")
            cases = ", ".join(name[len(path.stem) + 1:] for name in lines(self._file.text("runs")))
            raise InputError(f"{path}: the envelope of several load cases, of which --case names one ({cases})"
                             + (f"; there is no {case}" if case else ""))
        properties, acting = (self._file.group(name, optional=True) for name in ("properties", "acting"))
        self.case = properties.attribute("load_case", str, "") if properties else ""
        if case and case != self.case:
            what = f"of load case {self.case}" if self.case else "of a scene without load cases"
            raise InputError(f"{path}: the file is {what}, and there is no {file_of_case(path, case).name} beside it")
        self._by_index = None
        self._units = acting.attribute("units", str, "") if acting else ""
        self.scene_name = self._file.attribute("scene_name", str, path.stem)
        self.members = _members(self._file.group("members"))
        samples, self._members_in_file = self.members[-1].samples.stop, len(self.members)
        self._everywhere = self.members
        if members is not None:
            self.members = self.members_meant(members)
        self._selection = Selection(samples, members and self.members)
        steps = self._file.group("steps")
        self.steps = [Step(steps.group(name), self._selection, self.units) for name in sorted(steps.names(), key=lambda name: (len(name), name))]
        if not self.steps:
            raise InputError(f"{path}: holds no steps")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._file.__exit__()

    def members_meant(self, patterns, option="--members"):
        """Returns the members whose names match one of the patterns; each pattern must match some."""
        names = {member.name: member for member in self.members}
        chosen = set()
        for pattern in patterns:
            matching = re.compile(fnmatch.translate(pattern))
            found = {pattern} & names.keys() or {name for name in names if matching.match(name)}
            if not found:
                near = difflib.get_close_matches(pattern, names, 3, 0.0)
                raise InputError(f"{option} {pattern}: no member of that name; the nearest are {', '.join(near)}")
            chosen |= found
        return [member for member in self.members if member.name in chosen]

    def member_of_index(self, index):
        """Returns the member with this index in the scene; None if it was not chosen."""
        if self._by_index is None:
            self._by_index = {member.index: member for member in self.members}
        return self._by_index.get(index)

    def gradients(self):
        """Returns [(quantity, (n, 6))] of the last step, per length of member, in the order EA, GA2, GA3, GIt, EI2, EI3."""
        return [(quantity, self._selection.chosen(_per_length(self._everywhere, rows))) for quantity, rows in self.steps[-1].gradients()]

    def acting(self):
        """Returns supports, joints, loads and sections as {table: {column: values}}; see ACTING."""
        group, tables = self._file.group("acting", optional=True), {}
        for name in filter(group.__contains__, ACTING) if group else ():
            held = group.group(name)
            table = tables[name] = {
                column: lines(held.text(column)) if tail is TEXT else held.read(column, (None, *tail))
                for column, tail in ACTING[name].items() if column in held}
            count = len(tables.get("sections", {}).get("name", ())) if name == "members" else self._members_in_file
            of = [np.atleast_2d(table[column].T)[0] for column in ("place", "member", "section") if column in table]
            if len(set(map(len, table.values()))) > 1 or not all(np.all((0 <= numbers) & (numbers < count)) for numbers in of):
                raise group.refused(name, "columns of different lengths, or numbers of what is not there")
        return tables

    @property
    def units(self):
        """(length, force) as named by the scene, else empty."""
        words = [word.strip() for word in self._units.split(",")]
        return tuple(words) if len(words) == 2 else ("", "")

    def stages(self):
        """Returns the largest `Stage` in the text of the scene and of all that acts, as imported tables may give it."""
        text = self.scene_text()
        found = re.findall(r'\bStage["\']?:\s*(\d+)', text)
        for parameter in re.findall(r'<Parameter\s[^>]*\bname="Stage"[^>]*>', text):
            found += re.findall(r'\svalue="\s*(\d+)', parameter)
        begins = [begin for table in self.acting().values() for begin in table.get("begins", ()) if np.isfinite(begin)]
        return max([1, *map(int, found), *(int(begin) + 1 for begin in begins)])

    @property
    def title(self):
        return self.scene_name + (f", load case {self.case}" if self.case else "")

    def step_at(self, load_factor):
        """Returns the step with the nearest load factor."""
        return min(self.steps, key=lambda step: abs(step.load_factor - load_factor))

    def critical_points(self):
        """Returns all critical points, in the order of the path."""
        return [point for step in self.steps for point in step.critical_points()]

    def buckling_modes(self):
        """Returns [(load factor, displacements (n, 3))] of the linear buckling analysis of the undeformed structure."""
        return [(mode.attribute("load_factor"), self._selection.of(mode, "mode")) for mode in self._file.numbered("buckling")]

    def reference(self):
        """Returns the undeformed positions of all samples, (n, 3)."""
        if len(self.members) > MANY_MEMBERS:  # one large read instead of one small read for each member
            return self.steps[0].field("position") - self.steps[0].field("displacement")
        return np.concatenate([member.reference_position for member in self.members])

    def monitor(self):
        """Returns the monitored quantities over the steps: {name: (steps,) or (steps, components)}."""
        group = self._file.group("monitor", optional=True)
        return {name: self._series(group, name, 1, 3) for name in group.names() if name != "quantities"} if group else {}

    def _series(self, group, name, *columns):
        """Reads a time series over the steps; a single column has the shape (steps,)."""
        values = group.read(name, *((None,) if count == 1 else (None, count) for count in columns))
        if len(values) < len(self.steps):
            raise group.refused(name, f"{len(values)} rows for {len(self.steps)} steps")
        return values[:len(self.steps)]

    def quantities(self):
        """Returns the list Quantities of the scene over the steps: {name: (steps,)}."""
        group = self._file.group("monitor", optional=True)
        names = lines(self._file.text("quantities")) if group and "quantities" in group else []
        if not names:
            return {}
        return dict(zip(names, self._series(group, "quantities", len(names)).reshape(len(self.steps), len(names)).T))

    def quantity_units(self):
        """Returns {name: unit} of the quantities, if the scene names units."""
        units = lines(self._file.text("quantity_units")) if "quantity_units" in self._file else []
        return dict(zip(self.quantities(), units))

    def series(self, name):
        """Returns over the steps: a quantity, a time series of the run, or [force:|moment:|rotation:]POINT.x, .y, .z, .norm
        (without prefix: the displacement)."""
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
        """Returns the unit of a quantity or a series of a point; empty for formulas, or if the scene names no units."""
        if name in self.quantities():
            return self.quantity_units().get(name, "")
        return self.unit_of_kind(self._component(name, self.monitor())[0].rpartition(".")[2])

    def unit_of_kind(self, kind):
        """Returns the unit of displacement, rotation, reaction_force or reaction_moment; empty if the scene names no units."""
        length, force = self.units
        kinds = {"displacement": length, "rotation": "rad", "reaction_force": force, "reaction_moment": f"{force} {length}"}
        return kinds.get(kind, "") if length else ""

    @staticmethod
    def _component(name, known):
        """Returns (vector among `known`, component) for a name; empty texts if there is none."""
        point, _, component = name.rpartition(".")
        kind, colon, rest = point.partition(":")
        kinds = {"force": "reaction_force", "moment": "reaction_moment", "rotation": "rotation"}
        of_point = f"{rest}.{kinds.get(kind, kind)}" if colon else f"{point}.displacement"
        for vector in (point, of_point):
            if vector in known and known[vector].ndim == 2 and component in ("x", "y", "z", "norm"):
                return vector, component
        return "", ""

    def properties(self):
        """Returns {name: text}: program, machine, threads, ..., version."""
        return {**self._file.group("properties").attributes(), "version": self._file.text("version")}

    def supported_points(self):
        """Returns the names of the supported points, in the order of the rows of reactions."""
        return [support.attribute("point", str) for support in self._file.numbered("supports")]

    def scene_text(self):
        """Returns the input of the run, verbatim."""
        return self._file.text("scene")
