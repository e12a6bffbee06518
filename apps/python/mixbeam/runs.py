"""Runs: solves scenes and evaluates their results."""

import html
import operator
import os
import shutil
import sys
import tempfile
import weakref
from collections import namedtuple
from functools import cache, cached_property, partial
from pathlib import Path
from types import SimpleNamespace

import numpy as np

from . import _core, plotting
from .errors import ConvergenceError, InputError, unknown
from .parameters import Parameters, root
from .scene import Scene, scene_text, xml_path

Check = namedtuple("Check", "name value reference source passed")
FoundNumber = namedtuple("FoundNumber", "number start value deviation covariance")
Extreme = namedtuple("Extreme", "value member arc_length side")  # member: its name
SceneCheck = namedtuple("SceneCheck", "text warnings")
MOST_THREADS = 1024  # as of the program
OF_EXTREMES = ("member", "arc_length", "side")  # columns beside the value
AT_ENDS = 1e-12  # rounding allowed in an arc length at the ends, over the length of the member


def run(scene, case=None, *, output=None, threads=None, durable=False, force=False, progress=False, on_step=None):
    """Solves a scene (a Scene, an XML text or the path of a file), in this process.

    case: name of the load case, if the scene has any; output: result file (None: nothing is written); durable: each step
    is synced to disk; force: runs even if memory seems too small; progress: prints a progress line; on_step: called
    with the Run so far after each step; returning True stops the run.

    Returns a Run. Raises InputError, ConvergenceError.
    """
    text = scene_text(scene)
    return _watched(lambda listener: _core.run(text, case, os.fspath(output or ""), _threads(threads), durable, force, listener),
                    output, progress, on_step)


def resume(file, *, threads=None, durable=False, progress=False, on_step=None):
    """Continues a result file after its last step. The result is bit-identical to that of an uninterrupted run."""
    rest = _watched(lambda listener: _core.resume(os.fspath(file), _threads(threads), durable, listener), file, progress, on_step)
    whole = open_results(file)
    whole._told = rest._core
    return whole


def check(scene, case=None):
    """Checks a scene without solving it. Returns the output of `mixbeam check` and its warnings. Raises InputError."""
    return SceneCheck(*_core.check(scene_text(scene), case))


def view(scene, case=None):
    """See Scene.view."""
    refusal, warnings = "", []
    with tempfile.TemporaryDirectory(prefix="mixbeam-") as folder:
        text, file, _ = scene_text(scene)
        _core.undeformed(text, file, case, folder)
        try:
            warnings = check(scene, case).warnings
        except InputError as error:
            refusal = str(error)
        return plotting.view(sorted(Path(folder).glob("*.h5"), key=lambda file: file.stat().st_mtime_ns), refusal, warnings)


def open_results(file):
    """Opens a result file as a Run. Raises InputError."""
    return Run(_core.open(os.fspath(file)), file)


def batch(scene, table=None, case=None, *, output="followed", threads=None, progress=False, client=None):
    """Solves a scene once for each row of a table, like cases together as one structure; or solves several scenes.

    table: {parameter: values}, or a structured array; parameters by their paths, "point_loads/tip/force[1]". output:
    "followed" (motion of supported or loaded points, reactions), "expected" or "quantities" of the scene. client: a
    Dask client whose workers, with mixbeam installed, share the rows (files named in the scene must exist there too).

    Without a table, scene is a list or a generator of scenes, which are solved one after the other and not kept.

    Returns a structured array: the columns of the table, those of the output (nan if a scene does not have one),
    and for each case iterations, residual, converged, stable and, if it did not converge, the cause.
    """
    outputs = root().lists["Batch"].parameters["Output"]["choices"]
    if output not in outputs:
        raise unknown("output of a batch", output, outputs)
    if table is None:
        return _batch_of_scenes(scene, case, output, threads, progress, client)
    try:
        table = table if isinstance(table, dict) else {name: table[name] for name in table.dtype.names}
        columns = dict(zip(table, np.broadcast_arrays(*(np.atleast_1d(np.asarray(v, float)) for v in table.values()))))
        paths = [xml_path(name) for name in columns]
    except (AttributeError, TypeError, ValueError) as error:
        raise InputError(f"table of a batch: {error}; allowed: {{parameter: numbers}}, or a structured array") from None
    if any(column.ndim != 1 for column in columns.values()):
        raise InputError("table of a batch: columns of more than one dimension; allowed: one number for each case")
    for (name, column), path in zip(columns.items(), paths):
        if not path.startswith("Expected/") and np.isnan(column).any():
            row = np.argmax(np.isnan(column))
            raise InputError(f'table of a batch: column "{name}", row {row} from 0: nan; allowed: a number')
    solve = partial(_solved_rows, scene=scene_text(scene), case=case, paths=paths, output=outputs.index(output))
    if client is not None and any(column.size for column in columns.values()):
        return _shared_batch(client, partial(solve, threads=_threads(threads or 1)), columns)
    say = (lambda done, cases: _say(f"{done} of {cases} cases")) if progress else None
    return solve(columns, 0, threads=_threads(threads), say=say)


def _solved_rows(columns, before, scene, case, paths, output, threads, say=None):
    values = np.stack(list(columns.values()), axis=1) if columns else np.empty((0, 0))
    found = _core.batch(scene, case, paths, values, before, output, threads, say)
    return _structured({**columns, **dict(zip(found["names"], found["values"].T))}, found)


def _structured(followed, found):
    """Returns the array of a batch: numbers of each case, and how it was solved."""
    numbers = {**followed, "residual": found["residual"]}
    causes = np.array(found["cause"], dtype=str)
    kinds = [(name, float) for name in numbers]
    kinds += [("iterations", int), ("converged", bool), ("stable", "U7"), ("cause", causes.dtype)]
    result = np.empty(len(causes), dtype=kinds)
    for name, column in {**numbers, **{key: found[key] for key in ("iterations", "converged", "stable")},
                         "cause": causes}.items():
        result[name] = column
    return result


def _solved_scene(text, case, output, threads):
    outputs = root().lists["Batch"].parameters["Output"]["choices"]
    return _core.batch(text, case, [], np.empty((1, 0)), 0, outputs.index(output), _threads(threads), None)


def _batch_of_scenes(scenes, case, output, threads, progress, client):
    if isinstance(scenes, (str, os.PathLike, Scene)) or not hasattr(scenes, "__iter__"):
        raise InputError("a batch without a table needs several scenes; allowed: a list or a generator of them, or one and a table")
    solve = partial(_solved_scene, case=case, output=output, threads=threads)
    if client is not None:
        found = client.gather(client.map(solve, [scene_text(scene) for scene in scenes], pure=False))
    else:
        found = []
        for number, scene in enumerate(scenes, 1):
            try:
                found.append(solve(scene_text(scene)))
            except InputError as error:
                raise InputError(f"scene {number} of the batch: {error}") from None
            if progress:
                _say(f"{number} scenes")
    names = list(dict.fromkeys(name for one in found for name in one["names"]))
    followed = {name: np.full(len(found), np.nan) for name in names}
    for row, one in enumerate(found):
        for name, value in zip(one["names"], one["values"][0]):
            followed[name][row] = value
    return _structured(followed, {key: [one[key][0] for one in found]
                                  for key in ("residual", "iterations", "converged", "stable", "cause")})


def _shared_batch(client, solve, columns):
    """Solves the rows in pieces, a few for each worker, to balance the load."""
    pieces_of_worker = 4
    rows = len(next(iter(columns.values())))
    count = min(rows, pieces_of_worker * max(1, len(client.scheduler_info()["workers"])))
    parts = np.array_split(np.arange(rows), count)
    pieces = [{name: column[part] for name, column in columns.items()} for part in parts]
    futures = client.map(solve, pieces, [int(part[0]) for part in parts], pure=False)
    try:
        return np.concatenate(client.gather(futures))
    finally:
        client.cancel(futures)  # those still pending after an interrupt or a failure


def _watched(start, output, progress, on_step):
    """Calls `start` and reports its steps to callback and progress line."""

    def listener(core):
        path = core.path()
        if progress:
            _say(f"step {path['step'][-1]}  load factor {path['load_factor'][-1]:.5f}  "
                 f"iterations {path['newton_iterations'][-1]}")
        return bool(on_step(Run(core))) if on_step else False

    core, failure = start(listener if progress or on_step else None)
    if progress:
        print(flush=True)
    if failure is not None:
        raise ConvergenceError(failure, Run(core))
    return Run(core, output)


def _threads(number):
    if number is not None and not 1 <= operator.index(number) <= MOST_THREADS:
        raise InputError(f"threads: {number}; allowed: 1 to {MOST_THREADS}")
    return number


def _say(text):
    """Rewrites one line, in a terminal or a notebook."""
    print(f"\rmixbeam: {text}   ", end="", file=sys.stdout, flush=True)


@cache
def kinds_of_quantities():
    """Returns {name in Python: name in scenes}: reaction_force, von_mises_stress, ..."""
    return {word.lower().replace(" ", "_"): word for word in root().lists["Quantities"].free_list.parameters["Quantity"]["choices"]}


class Run:
    """Results of a run. Argument `step`: counted from 0, -1 for the last one, None for all (leading axis of arrays).

    Every quantity of the list Quantities is a method: displacement("tip"), reaction_force("wall"),
    material_moment("beam@50%"), von_mises_stress(member="beam", take="largest"), strain_energy(), ... with the place as
    first argument and the other parameters of that list by name. They return numbers, arrays of three components,
    {place: ...} for a pattern, an Extreme for the largest along members.
    """

    def __init__(self, core, file=None):
        self._core = self._told = core  # sources of the states, and of the program's messages of the run
        self.file = Path(file) if file else None  # result file; None: nothing was written
        self._results = self._file = None
        for name, values in core.path().items():
            setattr(self, f"{name}s" if name == "load_factor" else name, values)  # one value for each step
        self.step_numbers = self.__dict__.pop("step")
        self.stable = np.array(self.stable)

    def __len__(self):
        """Number of steps, including the state at the start of the path."""
        return len(self.load_factors)

    def __repr__(self):
        end = f"load factor {self.load_factors[-1]:.6g}, stable: {self.stable[-1]}" if len(self) else "no steps"
        return f"<mixbeam.Run {self.scene.name}: {len(self)} steps, {end}>"

    def _repr_html_(self):
        """Returns the notebook display: the end of the run, and quantities with their estimated errors."""
        errors = self.value_errors() if len(self) else {}
        errors = {} if isinstance(errors, str) else errors
        rows = [(name, f"{value:.6g}", error if isinstance(error, str) else f"± {error:.1e}") for name, (error, value) in errors.items()]
        rows += [("failed check", check.name, "") for check in self.checks if not check.passed]
        cells = "".join("<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in row) + "</tr>" for row in rows)
        return f"<b>{html.escape(repr(self)[1:-1])}</b><table>{cells}</table>"

    def to_dataframe(self):
        """Returns the path as a pandas DataFrame: a row for each step (index `step`), with load factor, iterations, stability
        and the quantities of the scene; vectors as name.x, name.y, name.z. Raises InputError without pandas."""
        try:
            from pandas import DataFrame
        except ImportError as error:
            raise InputError(f"to_dataframe: {error}; the Debian package python3-pandas holds it") from None
        columns = {"load_factor": self.load_factors, "newton_iterations": self.newton_iterations, "stable": self.stable}
        names, rows = self._evaluate(self.scene.quantities, None) if len(self.scene.quantities) else ([], np.empty((len(self), 0)))
        members = [*self.members, ""]  # the last one: undefined, as a ratio of zeros
        for name, column in zip(names, np.asarray(rows).T):
            columns[name] = [members[int(i) if i >= 0 else -1] for i in column] if name.endswith(".member") else column
        return DataFrame(columns, index=list(self.step_numbers)).rename_axis("step")

    def __getattr__(self, name):
        kind = kinds_of_quantities().get(name)
        if kind is None or name.startswith("__"):
            raise unknown("run", name, [*dir(type(self)), *kinds_of_quantities()])
        return lambda point=None, *, step=-1, **parameters: self.quantity(kind, point, step=step, **parameters)

    def __dir__(self):
        return [*super().__dir__(), *kinds_of_quantities()]

    @cached_property
    def scene(self):
        """The Scene that was solved."""
        return Scene.from_text(self._core.scene())

    @property
    def load_case(self):
        """Name of the load case or combination; empty for a scene without any."""
        return self._core.load_case()

    @property
    def report(self):
        """Output of the program for this run."""
        return self._told.report()

    @property
    def warnings(self):
        """Warnings on scene and results, a list of texts."""
        return self._told.warnings()

    @property
    def checks(self):
        """Comparisons with expected values, limits and balances: a list of Check."""
        return [Check(*one) for one in self._told.checks()]

    @property
    def found(self):
        """Numbers found by Identification or Design, {parameter: FoundNumber}: path, start, value, standard deviation, row of
        the covariance. The scene of the run contains the values."""
        return {one[0]: FoundNumber(*one[1:]) for one in self._told.found_numbers()}

    @property
    def passed(self):
        """Whether all checks passed."""
        return all(one.passed for one in self.checks)

    @property
    def interrupted(self):
        """Whether on_step stopped the run before its end."""
        return self._told.interrupted()

    # --- quantities ----------------------------------------------------------------------------------------------------
    def quantity(self, kind, point=None, *, step=-1, **parameters):
        """Evaluates a quantity by its name in the list Quantities ("reaction force"); see Run."""
        given = {"quantity": kind, "point": point, **parameters}
        return _valued(["q"], *self._evaluate({"q": given}, step), step, self)["q"]

    def quantities(self, step=-1):
        """Returns {name: value} of the quantities of the scene."""
        asked = self.scene.quantities
        names, rows = self._evaluate(asked, step)
        return _valued(asked, names, rows, step, self)

    def places(self, step=-1):
        """Returns {name: place} of the extremes among the quantities of the scene: "deck 3@50%" or "pier 2" for several
        places, "deck at s = 1.25" along members."""
        asked = self.scene.quantities
        names, _ = self._evaluate(asked, step)
        found = dict(zip(names, self._core.places(self._as_xml(asked), operator.index(step))))
        for name, value in self.quantities(step).items():
            if isinstance(value, Extreme):
                found[name] = f"{value.member} at s = {value.arc_length:.6g}"
        return {name: place for name, place in found.items() if place}

    def _evaluate(self, entries, step):
        steps = list(range(len(self))) if step is None else [operator.index(step)]
        return self._core.evaluate(self._as_xml(entries), steps)

    @staticmethod
    def _as_xml(entries):
        wanted = Parameters(root().lists["Quantities"])
        for name, parameters in entries.items():
            wanted[name] = parameters
        return wanted._xml("quantities")

    def sections(self):
        """Returns {name: (6, 6) stiffness, order EA, GA2, GA3, GIt, EI2, EI3} of all sections, including imports and profiles."""
        return {name: np.array(stiffness) for name, stiffness in self._core.sections().items()}

    # --- along members -------------------------------------------------------------------------------------------------
    @cached_property
    def members(self):
        """MemberResults by name, in the order of the scene."""
        return {name: MemberResults(self, name, *mesh) for name, mesh in self._core.members().items()}

    def member(self, name):
        """Returns the MemberResults of a member."""
        if name not in self.members:
            raise unknown("members of the run", name, list(self.members))
        return self.members[name]

    # --- the path ------------------------------------------------------------------------------------------------------
    def limit_points(self):
        """Returns the limit points among critical_points."""
        return [point for point in self.critical_points if point.kind == "limit point"]

    @cached_property
    def critical_points(self):
        """Critical points in the order of the path: kind, load_factor, load_factor_error, modes (number of eigenvalues that
        vanish together), negative_before, negative_after; (samples, 3) arrays position, displacement, mode."""
        found = [SimpleNamespace(**one) for step in range(len(self)) for one in self._core.critical_points(step)]
        if found or not self.file or not np.any(self.critical_points_passed):
            return found
        numbers = ("kind", "load_factor", "load_factor_error", "negative_before", "negative_after", "modes")
        return [SimpleNamespace(**{name: getattr(point, name) for name in numbers},
                                **{name: point.field(name) for name in ("position", "displacement", "mode")})
                for point in self.results.critical_points()]

    def buckling_modes(self, count=1, step=0):
        """Returns the first linear buckling modes: load_factor, mode (samples, 3), residual, confirmed. By default of the
        undeformed structure; if `step` ends a stage but the last, about that state: factors of the loads of the next stage."""
        return [SimpleNamespace(**one) for one in self._core.buckling_modes(_counted("buckling modes", count), self._number(step))]

    def modes(self, count=10, step=-1, in_plane=False):
        """Returns the lowest natural modes about the state of a step: omega, frequency (omega / (2 pi)), eigenvalue (omega^2,
        negative if the state is unstable), mode (samples, 3), modal_mass, participation_x, ..._y, ..._z, residual, confirmed.
        `in_plane`: only the modes in the plane of a planar scene."""
        return [SimpleNamespace(**one) for one in self._core.natural_modes(_counted("natural modes", count), self._number(step), in_plane, None)]

    def frequencies(self, count=10, in_plane=False, follow=False):
        """Returns natural frequencies over the path: (load factors, omega (steps, columns)), NaN where there is none. `follow`:
        a column for each motion, tracked by mode shape where frequencies cross; else the lowest ones in order."""
        tracks, rows = _core.ModeTracks(), []
        for step in range(len(self)):
            modes = self._core.natural_modes(_counted("natural modes", count), step, in_plane, tracks)
            rows.append({mode["track"] - 1 if follow else i: mode["omega"] for i, mode in enumerate(modes)})
        table = np.full((len(self), max([count] + [column + 1 for row in rows for column in row])), np.nan)
        for row, found in zip(table, rows):
            row[list(found)] = list(found.values())
        return self.load_factors, table

    def gradient(self, of, by=(), step=-1, by_element=False):
        """Returns gradients of quantities in a step, at its load factor: {name: value, by, stiffness, compliance, natural, note}.
        `of`: names or patterns of the scene's quantities, or "load factor at critical point 1", wherever that is on the path;
        `by`: paths of numbers in the scene, or patterns ("Sections/*/EI2", "Points/tip[0]"); the result `by` is
        {path: derivative}. `by_element`: arrays (elements, 6) of derivatives by EA, GA2, GA3, GIt, EI2, EI3 of each element,
        by their inverses, by natural strains. If a derivative is nan, `note` gives the reason."""
        texts = [[one] if isinstance(one, str) else list(one) for one in (of, by)]
        found = self._core.gradients(*texts, by_element, self._number(step))
        names = ("value", "by", "stiffness", "compliance", "natural", "note")
        return {quantity: SimpleNamespace(**dict(zip(names, numbers))) for quantity, numbers in found.items()}

    def error_estimate(self, step=-1):
        """Returns estimated discretization errors, {name: (error, size of the quantity)}, or the reason (a text) for none."""
        return self._core.error_estimate(self._number(step))

    def value_errors(self, step=-1):
        """Returns estimated errors of the quantities of the scene and, in a step with stresses, of the largest section
        forces, stress and utilisation: {name: (error, value)}; a text in place of an error, or of all: why there is none."""
        return self._core.value_errors(self._number(step))

    def state(self, step=-1):
        """Returns the complete state of the solver: {name: array}."""
        return self._core.state(self._number(step))

    def _number(self, step):
        return range(len(self))[step] if -len(self) <= step < len(self) else step

    # --- files and pictures --------------------------------------------------------------------------------------------
    def write(self, file):
        """Writes the result file that `mixbeam run` would have written; of an opened run, without the modes of critical points
        and the residuals of all attempts."""
        self._core.write(os.fspath(file))

    @property
    def results(self):
        """The result file as read by apps/plots; without one, a temporary file that lives as long as this object. Raises
        InputError if the file no longer belongs to this run."""
        file = self._result_file()
        if self._results is None:
            with plotting.modules() as plots:
                self._results = plots.call(plots.load("results").Run, file)
        return self._results

    def _result_file(self):
        self._core.require_same_file()
        if self._file is None:
            self._file = self.file
        if self._file is None:
            folder = tempfile.mkdtemp(prefix="mixbeam-")
            weakref.finalize(self, shutil.rmtree, folder, ignore_errors=True)
            self._file = Path(folder) / f"{self.scene.name.replace('/', '_')}.h5"
            self.write(self._file)
        return self._file

    def plot(self, picture="shape", **options):
        """Draws a picture, shown by notebooks, with save(file): shape, fields, section_forces, diagrams, along, curve,
        load_path, critical_modes, frequencies, iterations, steps. Options of `mixbeam plot`: field="axial_force", view="xy"."""
        return plotting.picture(self.results, picture, options)

    def view(self):
        """Returns the page of `mixbeam view`, shown inline by notebooks, with save(file)."""
        return plotting.view([self._result_file()])


class MemberResults:
    """Results along a member; `s`: arc length of the undeformed centerline, a number or an array."""

    FIELDS = {"moment": "material_moment", "force": "material_force", "strain": "force_strain",
              "curvature": "moment_strain", "position": "position", "displacement": "displacement",
              "reference_position": "reference_position", "triad": "triad"}

    def __init__(self, run_, name, length, order, elements):
        self._run = run_
        self.name, self.length, self.order, self.elements = name, length, order, elements

    def field(self, name, s, step=-1, before_vertex=False):
        """Returns (3,) for a number s, (n, 3) for an array; triad: unit quaternions w, x, y, z. At a vertex between two
        elements the value of the following one, or of the one before if `before_vertex`."""
        s = np.asarray(s, dtype=float)
        found = self._run._core.sample(self.name, self._shares(s).tolist(), operator.index(step), before_vertex)
        return found[name].reshape(*s.shape, -1) if s.size else np.empty((*s.shape, 4 if name == "triad" else 3))

    def _shares(self, s):
        """Returns the arc lengths, flattened, over the length of the member."""
        share = s.ravel() / self.length
        if not np.all((share >= -AT_ENDS) & (share <= 1 + AT_ENDS)):
            raise InputError(f"member {self.name!r}: arc length {s}; allowed: 0 to {self.length:.10g}")
        return np.clip(share, 0.0, 1.0)

    def stress(self, s, step=-1):
        """Returns the largest von Mises stress over the section; nan for a section with neither shape nor stress points."""
        return self._along("von Mises stress", s, step)

    def utilisation(self, s, step=-1):
        """Returns the largest von Mises stress over the section, divided by the strength of the material."""
        return self._along("utilisation", s, step)

    def _along(self, kind, s, step):
        places = np.asarray(s, dtype=float)
        if places.size == 0:
            return places
        inside = self._shares(places) * self.length
        asked = {f"q{i}": {"quantity": kind, "point": f"{self.name}@{float(one)!r}"} for i, one in enumerate(inside)}
        _, rows = self._run._evaluate(asked, step)
        return np.asarray(rows[0]).reshape(places.shape)[()]

    def __getattr__(self, name):
        if name not in self.FIELDS:
            raise unknown(f"member {self.name!r}", name, [*self.FIELDS, *dir(type(self))])
        return lambda s, step=-1, before_vertex=False: self.field(self.FIELDS[name], s, step, before_vertex)

    def __dir__(self):
        return [*super().__dir__(), *self.FIELDS]


def _counted(what, count):
    if operator.index(count) < 1:
        raise InputError(f"{what}: {count}; allowed: 1, 2, ...")
    return count


def _valued(asked, names, rows, step, run):
    """Returns {quantity: value} from columns: see Run. Columns of a quantity: name, name.x, name[place], name[place].x, and of
    an extreme name.member, ...; names may contain points and brackets themselves."""
    rows = rows[0] if step is not None else rows.T
    known, held = set(asked), set(names)
    places = {name: {} for name in asked}
    for column, values in zip(names, rows):
        (name, _, component), place = column.rpartition("."), ""
        if column in known:
            name, component = column, ""
        elif name not in known or name in held and component not in OF_EXTREMES:
            name = max((name for name in asked if column.startswith(name + "[")), key=len)
            place, _, component = column[len(name):].rpartition("]")
        places[name].setdefault(place[1:], {})[component.lstrip(".")] = values
    found = {name: {place: _of_place(values, run) for place, values in own.items()} for name, own in places.items()}
    return {name: own[""] if list(own) == [""] else own for name, own in found.items()}


def _of_place(values, run):
    if "member" in values:
        members = list(run.members)
        numbers = np.asarray(values["member"])
        names = [members[int(number)] if 0 <= number < len(members) else "" for number in numbers.ravel()]
        return Extreme(values[""], names[0] if numbers.ndim == 0 else np.array(names), values["arc_length"], values["side"])
    if list(values) == [""]:
        value = values[""]
        return float(value) if np.ndim(value) == 0 else value
    return np.stack(list(values.values()), axis=-1)
