"""What the page of `mixbeam view` draws: samples, sections, fields, path and modes of a run, as arrays for a browser.

Positions are relative to the middle of the structure. Numbers are packed (packed.py) for drawing and reading off. A structure
of more than MOST_SAMPLES samples is thinned, and so are steps that would make the page too large (view_steps.py).
"""

import numpy as np

import fields
from fields import Field
from packed import FOR_DRAWING, FOR_PLACES, FOR_READING, Packed, deflated_text
from preview import parts_of
from scene_marks import Marks
from structure import best_view
from view import CAMERAS, PLANES
from view_steps import MOST_BYTES, STEP_ARRAYS, HeldStep, packed_steps, places_read, taken_out

MOST_SAMPLES = 100000
MOST_SERIES = 1200     # numbers followed along the path that can be chosen
FLAT = 1e-6            # a structure this thin over its size lies in a plane
DRAWN_AS = "drawn as "  # before the shape of a section that is given by stiffnesses
THIN_ROD = 1 / 110     # diameter over size of members that have no shape,
SLENDER_ROD = 1 / 10   # and at most this share of the median length of members
ROUND = {"circle", "tube", "none"}  # sections
FEW_NUMBERS = 100000   # samples times steps up to which a page has the directions of all sections
DIRECTIONS = 120       # in which the corners of the path's hull are looked for
FIELDS = {
    **fields.FIELDS,
    **{f"displacement_{axis}": Field(f"displacement {axis}", "displacement", [i]) for i, axis in enumerate("xyz")},
    **{f"shear_strain_{i + 1}": Field(rf"shear strain $\gamma_{i + 1}$", "force_strain", [i]) for i in (1, 2)},
    **{f"curvature_{i + 1}": Field(rf"bending strain $\kappa_{i + 1}$", "moment_strain", [i]) for i in (1, 2)},
    "utilisation": fields.StressField("utilisation: von Mises stress over strength", "utilisation"),
}


class ViewData:
    """`description`: what is said in words and single numbers, with the units of `arrays`; these are {name: bytes}, itself among them."""

    def __init__(self, run, said=None, room=MOST_BYTES):
        """`said`: of a scene that is not solved, preview.Said; `room`: bytes of its steps."""
        self._run, self._room = run, room
        self.scene_name, self.case, self.title = run.scene_name, run.case, run.title
        self._reference = run.reference()
        self._kept, self._members, self._firsts = _thinned(run.members)
        low, high = self._reference.min(axis=0), self._reference.max(axis=0)
        self._center, self._size = (low + high) / 2, float(np.linalg.norm(high - low)) or 1.0
        self.arrays = {}
        self.description = {"title": run.title, "units": run.units, "version": run.properties()["version"],
                            "stages": run.stages(), "center": self._center.tolist(), "notes": [], "samples": len(self._kept), "units_of": {}}
        self._describe_members()
        self._add_sections()
        self._add("rest_triad", run.steps[0].field("triad")[self._kept], FOR_DRAWING)
        self._add_modes()
        self._add_marks()
        steps = self._read_steps()
        self._add_series()
        self._add_steps(*steps)
        if said:
            self._describe_preview(said)
        self.arrays["description"] = deflated_text(self.description)

    def _describe_preview(self, said):
        """In place of fields: sections, and parts where some are not connected."""
        describe, parts = self.description, parts_of(self._run)
        parts = [parts[member.index] for member in self._members] if parts else []
        groups = [(label, known, [known.index(one) for one in of])
                  for label, of in (("connected part", parts), ("section", describe["sections"]))
                  if (known := sorted(set(of))) and (len(known) > 1 or label == "section")]
        describe["fields"] = [{"name": label, "label": label, "unit": "", "signed": False, "extremes": [[0, max(len(known) - 1, 1)]],
                               "names": [str(one) if label == "section" else f"part {one + 1}" for one in known], "of_members": of}
                              for label, known, of in groups]
        if self._run.properties().get("drawn"):
            describe["notes"].append(self._run.properties()["drawn"])
        describe["preview"] = {"refusal": said.refusal, "warnings": said.warnings, "named": said.names(self._members)}
        for mode in describe["modes"]:
            mode["kind"] = "motion without strain"

    def _describe_members(self):
        whole = len(self._reference)
        if len(self._kept) < whole:
            self.description["notes"].append(
                f"Thinned: {len(self._kept)} of {whole} samples and {len(self._members)} of {len(self._run.members)} members are "
                "drawn; the result file has all.")
        self.description["members"] = [member.name for member in self._members]
        self.description["all_members"] = len(self._run.members)
        ends = np.append(self._firsts[1:], len(self._kept)) - 1
        self.description["first_sample"] = self._firsts.tolist()
        self._add("reference", self._reference[self._kept] - self._center, FOR_PLACES)
        arc = np.concatenate([member.arc_length for member in self._members])
        self._add("arc_length", arc[_kept_of_members(self._members, self._kept)], FOR_PLACES)
        self._ends = ends

    def _add_sections(self):
        acting = self._run.acting()
        shapes = acting.get("sections")
        lengths = [float(member.arc_length[-1]) for member in self._members]
        rod = min(THIN_ROD * self._size, SLENDER_ROD * float(np.median(lengths)))
        known = [row[0] for row, shape in zip(shapes["dimensions"], shapes["shape"]) if shape != "none"] if shapes else []
        rod = min([rod, *known])  # a wire is thinner than what has a shape
        dimensions = np.tile([rod, rod, 0.0, 0.0], (len(self._kept), 1))
        strength = np.full(len(self._reference), np.nan)
        kinds, names = ["none"] * len(self._members), [""] * len(self._members)
        for at, member in enumerate(self._members if shapes else ()):
            row = int(acting["members"]["section"][member.index])
            names[at] = shapes["name"][row]
            if shapes["shape"][row] == "none":
                continue
            kinds[at] = shapes["shape"][row].removeprefix(DRAWN_AS)
            own = slice(self._firsts[at], self._ends[at] + 1)
            x = member.arc_length[self._kept[own] - member.samples.start] / member.arc_length[-1]
            dimensions[own] = _along(shapes["dimensions"][row].reshape(-1, 4), x)
            if kinds[at][0] in "TLU":
                kinds[at] = _with_centroid(kinds[at], *shapes["dimensions"][row].reshape(-1, 4)[0])
            if kinds[at] in ("circle", "tube"):
                dimensions[own, 1] = dimensions[own, 0]
            known = shapes["strength"][row]  # 0: not given
            strength[self._kept[own]] = _along(np.where(known > 0, known, np.nan).reshape(-1, 1), x)[:, 0]
        self._strength = strength
        self._add("dimensions", dimensions, FOR_READING)
        self.description.update(kinds=kinds, sections=names)
        if "none" in kinds:
            which = "Members are" if set(kinds) == {"none"} else "Members without a Shape are"
            self.description["notes"].append(
                f"{which} drawn as round rods of diameter {rod:.3g}" +
                (f" {self._run.units[0]}." if self._run.units[0] else "."))

    def _read_steps(self):
        """([what is said of a step], [its arrays]) of those that there is memory for; the path in short."""
        read = places_read(len(self._run.steps), len(self._kept))
        names = (*STEP_ARRAYS, "triad") if self._shows_directions() else STEP_ARRAYS
        described, arrays = [], []
        self._largest = np.zeros(len(self._run.steps))
        hull = [_corners(self._reference - self._center)]
        for number, step in enumerate(self._run.steps):
            held = HeldStep(step, self._strength, self._size)
            self._largest[number] = np.linalg.norm(held.field("displacement"), axis=1).max(initial=0.0)
            self._force_floors = held.force_floors
            if number not in read:
                continue
            hull.append(_corners(held.field("position") - self._center))
            described.append({"number": step.number, "factor": step.load_factor, "stable": step.stable, "place": number,
                              "extremes": [self._extremes(field, held) for field in FIELDS.values()]})
            arrays.append(held.arrays(self._kept, names))
        points = np.vstack(hull)
        self.description["hull"] = _corners(points).round(9).tolist()
        self.description["camera"] = self._camera(points)
        self.description["size"] = self._size
        return described, arrays

    def _add_steps(self, described, arrays):
        names = sorted(set(self.description["sections"]))
        counts = np.diff(np.append(self._firsts, len(self._kept)))
        groups = np.repeat([names.index(name) for name in self.description["sections"]], counts)
        self.description["compliance"] = taken_out(arrays, groups, names)
        shown, packed = packed_steps(arrays, self._room - sum(map(len, self.arrays.values())))
        for name, values in packed.items():
            self._hold(name, values)
        steps = [described[i] for i in shown]
        if len(steps) < len(self._run.steps):
            self.description["notes"].append(f"{len(steps)} of {len(self._run.steps)} steps are drawn; the load path has all.")
        extremes = list(zip(*(step.pop("extremes") for step in steps)))
        self.description["steps"] = steps
        self.description["fields"] = [self._described_field(name, field, list(own))
                                      for (name, field), own in zip(FIELDS.items(), extremes) if any(own)]

    def _shows_directions(self):
        """Whether something drawn turns with the sections: round ones follow their line, if their diagrams do not matter."""
        if len(self._kept) * len(self._run.steps) <= FEW_NUMBERS:
            return True
        arrows = [arrow[2] for kind in ("forces", "moments") for arrow in self.description[kind]]
        return not ROUND.issuperset(self.description["kinds"]) or any(arrows) or any(load[2] for load in self.description["line_loads"])

    def _add(self, name, values, bits):
        self._hold(name, Packed(values, bits))

    def _hold(self, name, packed):
        self.arrays[name] = packed.bytes
        self.description["units_of"][name] = packed.units.tolist()

    def _extremes(self, field, step):
        """Smallest and largest value, round-off being zero; nothing where the step does not have the field."""
        if not step.has(field.source):
            return None
        values = field.values(step, self._size)
        values = values[np.isfinite(values)]
        return [float(values.min()), float(values.max())] if len(values) else None

    def _described_field(self, name, field, extremes):
        return {"name": name, "label": fields.plain(field.label), "unit": field.unit(self._run.units), "source": field.source,
                "components": list(field.components) or [0], "signed": field.signed, "extremes": extremes}

    def _camera(self, points):
        """Elevation and azimuth [degrees]: upon the plane in which all lies, else where most is seen."""
        spread = np.ptp(points, axis=0)
        for plane, axes in PLANES.items():
            if all(spread[i] <= FLAT * self._size for i in range(3) if i not in axes):
                return list(CAMERAS[plane])
        return [float(angle) for angle in best_view(points)]

    def _add_modes(self):
        described = []
        for step_number, step in enumerate(self._run.steps):
            for point in step.critical_points():
                at = len(described)
                described.append({"kind": point.kind, "factor": point.load_factor, "step": step_number, "modes": point.modes,
                                  "before": point.negative_before, "after": point.negative_after})
                self._add(f"critical-displacement-{at}", point.field("displacement")[self._kept], FOR_READING)
                self._add_mode(f"mode-{at}", point.field("mode"))
        for step_number, modes in enumerate([self._run.buckling_modes(), *(step.buckling_modes() for step in self._run.steps[1:])]):
            for factor, mode in modes:
                at = len(described)
                described.append({"kind": "buckling mode", "factor": factor, "step": step_number})
                self._add_mode(f"mode-{at}", mode)
        for step_number, step in enumerate(self._run.steps):
            for mode in step.natural_modes():
                at = len(described)
                described.append({"kind": "natural mode", "factor": step.load_factor, "step": step_number, "omega": float(mode["omega"])})
                self._add_mode(f"mode-{at}", mode["mode"])
        self.description["modes"] = described

    def _add_mode(self, name, mode):
        largest = np.linalg.norm(mode, axis=1).max(initial=0.0) or 1.0
        self._add(name, mode[self._kept] / largest, FOR_DRAWING)

    def _add_series(self):
        """What can be drawn over the path: a row for each step, then one for each critical point."""
        run, points = self._run, self._run.critical_points()
        columns = {"load factor": (np.array([step.load_factor for step in run.steps]), [point.load_factor for point in points])}
        unknown = [np.nan] * len(points)
        for name, values in run.quantities().items():
            columns[name] = (values, unknown)
        vectors = {name: values for name, values in run.monitor().items() if values.ndim == 2 and len(values) == len(run.steps)}
        floors = self._floors(vectors)
        for name, values in vectors.items():
            if len(columns) > MOST_SERIES:
                break
            values = np.where(np.abs(values) > floors.get(_kind(name), 0.0), values, 0.0)
            there = [point.monitored(name) for point in points]
            there = np.array([row if row is not None else [np.nan] * 3 for row in there]).reshape(-1, 3)
            for i, axis in enumerate("xyz"):
                columns[f"{name}.{axis}"] = (values[:, i], there[:, i])
            columns[f"{name}.norm"] = (np.linalg.norm(values, axis=1), np.linalg.norm(there, axis=1))
        columns["largest displacement"] = (self._largest, unknown)
        energy = run.monitor().get("strain_energy")
        if energy is not None and len(energy) == len(run.steps):
            columns["strain energy"] = (energy, unknown)
        rows = [np.concatenate(column) for column in columns.values()]
        self._add("series", np.array(rows).T, FOR_PLACES)
        self.description["series_names"] = list(columns)
        self.description["stable"] = [step.stable for step in run.steps]
        self.description["abscissa"] = self._telling_series(columns)

    def _floors(self, vectors):
        """Round-off of what is followed, by its kind: relative to the largest of any point and step, and to section
        forces at the end."""
        largest = {}
        for name, values in vectors.items():
            largest[_kind(name)] = max(largest.get(_kind(name), 0.0), float(np.nanmax(np.abs(values), initial=0.0)))
        force, moment = largest.get("reaction_force", 0.0), largest.get("reaction_moment", 0.0)
        largest.update(reaction_force=max(force, moment / self._size), reaction_moment=max(moment, force * self._size))
        floors = {kind: fields.NOISE * value for kind, value in largest.items()}
        for kind, floor in zip(("reaction_force", "reaction_moment"), self._force_floors):
            floors[kind] = max(floors[kind], floor)
        return floors

    def _telling_series(self, columns):
        """The first quantity that the scene asks for, else of displacements the one that changes most."""
        asked = [name for name in self._run.quantities() if np.isfinite(columns[name][0]).all() and np.ptp(columns[name][0]) > 0]
        if asked:
            return asked[0]
        moved = {name: np.ptp(values) for name, (values, _) in columns.items()
                 if ".displacement." in name and not name.endswith(".norm") and np.isfinite(values).all()}
        best = max(moved, key=moved.get, default=None)
        return best if best and moved[best] > 1e-9 * self._size else "largest displacement"

    def _add_marks(self):
        run = self._run
        acting, marks = run.acting(), Marks(run, run.steps[-1], self._reference)
        place = lambda sample: int(self._nearest(sample))
        arrows = {"forces": [], "moments": [], "shifts": [], "turns": []}

        def add(kind, sample, vector, follows, begins):
            if np.any(vector):
                arrows[kind].append([place(sample), (vector / np.linalg.norm(vector)).tolist(), follows, _finite(begins)])

        for sample, force, moment, follows, begins in marks.placed_point_loads(acting.get("point_loads", {})):
            add("forces", sample, force, follows, begins)
            add("moments", sample, moment, follows, begins)
        for sample, shift, turn, begins in marks.placed_motions(acting.get("supports", {})):
            add("shifts", sample, shift, False, begins)
            add("turns", sample, turn, False, begins)
        lines = [[[place(sample) for sample in samples], forces.tolist(), follows, _finite(begins)]
                 for samples, forces, follows, begins in marks.placed_line_loads(acting.get("line_loads", {}))]
        strained = {member.name for member in marks.strained}
        self.description.update(
            supports=[[place(sample), kind] for sample, kind in marks.supports],
            joints=[[place(sample), kind] for sample, kind in marks.joints], line_loads=lines,
            strained=[number for number, member in enumerate(self._members) if member.name in strained], **arrows)

    def _nearest(self, sample):
        """Number among those drawn of the nearest one that is."""
        at = np.searchsorted(self._kept, sample)
        near = [i for i in (at - 1, at) if 0 <= i < len(self._kept)]
        return min(near, key=lambda i: abs(int(self._kept[i]) - int(sample)))


def _with_centroid(shape, width, height, wall, web):
    """Name of the drawing of a T, L or U: how it stands, and its centroid from the middle over width and height."""
    upright = width * wall, 0.0, (height - wall) / 2  # area and middle of the flange at the top, then of the web
    parts = {"T": [upright, (web * (height - wall), 0.0, -wall / 2)],
             "U": [(2 * width * wall, 0.0, 0.0), (web * (height - 2 * wall), (web - width) / 2, 0.0)],
             "L": [(upright[0], 0.0, -upright[2]), (wall * (height - wall), (wall - width) / 2, wall / 2)]}[shape[0]]
    area = sum(part[0] for part in parts)
    second, third = (sum(part[0] * part[i] for part in parts) / area for i in (1, 2))
    turned = shape.endswith("mirrored")
    return f"{shape[0]} {'mirrored' if turned else 'upright'} {second / width:.4f} {(-third if turned else third) / height:.4f}"


def _thinned(members):
    """(numbers of samples, members, number of each one's first sample among them): all, or every n-th of each member and
    its last one; where members are too many, every m-th member."""
    if 2 * len(members) > MOST_SAMPLES:
        members = members[::-(-2 * len(members) // MOST_SAMPLES)]
    counts = np.array([member.samples.stop - member.samples.start for member in members])
    stride = 1
    while (-(-(counts - 1) // stride) + 1).sum() > MOST_SAMPLES:
        stride += 1
    kept = [np.unique(np.append(np.arange(member.samples.start, member.samples.stop, stride), member.samples.stop - 1))
            for member in members]
    firsts = np.cumsum([0] + [len(own) for own in kept[:-1]])
    return np.concatenate(kept), members, firsts


def _kept_of_members(members, kept):
    """The kept samples by their places in the joined arrays of these members."""
    starts = np.array([member.samples.start for member in members])
    counts = np.array([member.samples.stop - member.samples.start for member in members])
    owner = np.searchsorted(starts, kept, side="right") - 1
    return kept - starts[owner] + (np.cumsum(counts) - counts)[owner]


def _along(values, x):
    """Rows at relative arc lengths `x` of values at evenly spread places."""
    places = np.linspace(0.0, 1.0, len(values))
    return np.stack([np.interp(x, places, column) for column in values.T], axis=1)


def _corners(points):
    """Those points that are the farthest in evenly spread directions (Fibonacci's sphere)."""
    turn = np.pi * (3 - np.sqrt(5)) * np.arange(DIRECTIONS)
    height = 1 - 2 * (np.arange(DIRECTIONS) + 0.5) / DIRECTIONS
    radius = np.sqrt(1 - height ** 2)
    directions = np.stack([radius * np.cos(turn), radius * np.sin(turn), height])
    return points[np.unique((points @ directions).argmax(axis=0))]


def _kind(name):
    """Of what is followed at a point: "displacement" of "tip.displacement"."""
    return name.rpartition(".")[2]


def _finite(begins):
    """Load factor from which something acts; before any where a formula says it."""
    return float(begins) if np.isfinite(begins) else -1e30
