"""Marks of supports, joints, point and line loads, prescribed motions and eigenstrains, from the result file."""

import numpy as np
from matplotlib.path import Path as Shape

import style
from structure import add_lines

SAME_PLACE = 1e-6   # of the extent: a sample farther from a point than this is not at the point
MARK_SHARE = 0.12   # length of an arrow over the size of the structure
LINE_SHARE = 0.08   # the same for the largest line load
MOST_ARROWS = 240   # of all line loads together
MANY_SUPPORTS = 20  # from this number on signs are small
CROWD = 300         # from this number on there are none, as they would cover the structure
ARROW_WIDTH = 0.012  # of a line load [inch]
MOST_MARKS = 20      # beyond this number of loads one represents all like ones
COLORS = {"force": style.RED, "moment": style.PURPLE, "shift": style.GREEN, "turn": style.GREEN, "line load": style.RED}
FACING = 0.2        # a unit vector shorter than this in the picture points at the reader

# Signs below the point at the origin, in marker sizes.
SIGNS = {
    "clamp": Shape([(-1, 0), (1, 0), (-1, 0), (-1.3, -0.5), (-0.3, 0), (-0.6, -0.5), (0.3, 0), (0.0, -0.5), (1, 0), (0.7, -0.5)],
                   [1, 2, 1, 2, 1, 2, 1, 2, 1, 2]),
    "hinge": Shape([(0, 0), (-0.7, -1.2), (0.7, -1.2), (0, 0)]),
    "roller": Shape([(0, 0), (-0.7, -1.1), (0.7, -1.1), (0, 0), (-1, -1.5), (1, -1.5)], [1, 2, 2, 2, 1, 2]),
    "guide": Shape([(-1, -0.2), (1, -0.2), (-1, -0.7), (1, -0.7)], [1, 2, 1, 2]),
    "spring": Shape([(0, 0), (0, -0.4), (0.5, -0.6), (-0.5, -0.9), (0.5, -1.2), (-0.5, -1.5), (0, -1.7), (0, -2)]),
}
JOINT_SIGNS = {"hinge": "o", "ball": "o", "slider": "D"}


def kind_of_support(fixed, stiffness):
    """Returns the word for `fixed` (6) displacements and rotations; "spring" if nothing is fixed."""
    displacements, rotations = int(np.sum(fixed[:3])), int(np.sum(fixed[3:]))
    if displacements + rotations == 0:
        return "spring"
    if displacements == 3:
        return "clamp" if rotations == 3 else "hinge"
    return "guide" if rotations == 3 or displacements == 0 else "roller"


class Marks:
    """Supports, joints and loads at a step, by sample numbers; vectors are spatial.

    supports [(sample, kind)]; joints [(sample, kind)]; forces, moments, and prescribed shifts and turns
    [(sample, unit vector)]; line_loads [(samples, forces per length (places, 3))]; strained: members with an
    eigenstrain.
    """

    def __init__(self, run, step, reference, is_whole=False):
        """Collects what acts at `step`; with `is_whole`, the loads of all stages."""
        self._run, self._step, self._reference, self._is_whole = run, step, reference, is_whole
        self._near = SAME_PLACE * (np.ptp(reference, axis=0).max() or 1.0)
        self.supports, self.joints, self.forces, self.moments, self.line_loads = [], [], [], [], []
        self.shifts, self.turns, self.strained = [], [], []
        self._triads = None
        acting = run.acting()
        for name, add in (("supports", self._add_supports), ("joints", self._add_joints), ("point_loads", self._add_point_loads),
                          ("line_loads", self._add_line_loads), ("eigenstrains", self._add_eigenstrains)):
            if name in acting:
                add(acting[name])

    def _add_supports(self, table):
        for sample, fixed, stiffness in self._placed(table, "fixed", "stiffness"):
            self.supports.append((sample, kind_of_support(fixed, stiffness)))
            if np.any(stiffness > 0) and np.any(fixed):
                self.supports.append((sample, "spring"))
        for sample, axes, prescribed, begins in self._placed(table, "axes", "prescribed", "begins"):
            for vector, marks in ((prescribed[:3], self.shifts), (prescribed[3:], self.turns)):
                self._mark(marks, sample, vector @ axes.reshape(3, 3), begins)

    def _add_joints(self, table):
        self.joints += self._placed(table, "kind")

    def _add_point_loads(self, table):
        for sample, force, moment, follows, begins in self._placed(table, "force", "moment", "follower", "begins"):
            for vector, marks in ((force, self.forces), (moment, self.moments)):
                self._mark(marks, sample, vector, begins, follows)

    def _mark(self, marks, sample, vector, begins, follows=False):
        if self._has_begun(begins) and np.any(vector):
            marks.append((sample, self._turned(vector / np.linalg.norm(vector), follows, [sample])[0]))

    def _add_line_loads(self, table):
        ranges = table.get("range", np.tile((0.0, 1.0), (len(table["member"]), 1)))
        for index, force, follows, begins, between in zip(*(table[name] for name in ("member", "force", "follower", "begins")), ranges):
            member = self._run.member_of_index(int(index))
            if member is not None and np.any(force) and self._has_begun(begins):
                places = np.linspace(*between * member.arc_length[-1], len(force) // 3)
                samples = [member.samples.start + int(np.argmin(np.abs(member.arc_length - s))) for s in places]
                self.line_loads.append((samples, self._turned(force.reshape(-1, 3), follows, samples)))

    def _add_eigenstrains(self, table):
        for number, begins in zip(table.get("member", []), table.get("begins", [])):
            member = self._run.member_of_index(int(number))
            if member is not None and self._has_begun(begins):
                self.strained.append(member)

    def groups(self):
        """Returns [(kind, equal marks)] of all loads; a group is usually one entry of the scene."""
        found = {}
        for kind, own in (("force", self.forces), ("moment", self.moments), ("shift", self.shifts), ("turn", self.turns), ("line load", self.line_loads)):
            for mark in own:
                found.setdefault((kind, *np.round(np.ravel(mark[1]), 9).tolist()), []).append(mark)
        return [(key[0], alike) for key, alike in found.items()]

    def _has_begun(self, begins):
        return self._is_whole or not np.isfinite(begins) or begins < abs(self._step.load_factor)

    def _placed(self, table, *names):
        """Yields (sample, entries of these columns) of the rows that are shown."""
        for place, position, *entries in zip(*(table[name] for name in ("place", "position", *names))):
            sample = self._sample(place, position)
            if sample is not None:
                yield sample, *entries

    def _sample(self, place, position):
        """Returns the sample at a place (member, arc length), or nearest to its position if that member is not shown."""
        member = self._run.member_of_index(int(place[0]))
        if member is not None and place[1] == 0.0:
            return member.samples.start
        if member is not None:
            return member.samples.start + int(np.argmin(np.abs(member.arc_length - place[1])))
        distance = np.linalg.norm(self._reference - position, axis=1)
        return int(distance.argmin()) if distance.min() <= self._near else None

    def _turned(self, vectors, follows, samples):
        """Returns spatial vectors; those of follower loads are given in the triads of the samples."""
        vectors = np.atleast_2d(vectors)
        if not follows:
            return vectors
        if self._triads is None:
            self._triads = [self._step.field(f"triad_{i}") for i in (1, 2, 3)]
        return sum(vectors[:, i:i + 1] * self._triads[i][samples] for i in range(3))


def draw_marks(axes, marks, points, projection, length):
    """Draws marks into 2-D axes; `points` (n, 2) of all samples; `length` of an arrow. Returns words for the caption and the
    ends of arrows."""
    words, tips = [], []
    _draw_supports(axes, marks.supports, points, words)
    for kind in sorted({kind for _, kind in marks.joints}):
        samples = [sample for sample, of in marks.joints if of == kind]
        axes.plot(*points[samples].T, JOINT_SIGNS[kind], color=style.BLACK, markerfacecolor="white", markersize=6,
                  zorder=6, gid=f"joint {kind}")
        words.append(f"white: {kind}s" if kind != "ball" else "white: ball joints")
    groups = marks.groups()
    if len(groups) > MOST_MARKS:
        words.append(f"{len(groups)} different loads and motions: not drawn")
        groups = []
    drawn = {kind: [] for kind in COLORS}
    is_thinned = sum(len(alike) for _, alike in groups) > MOST_MARKS
    for kind, alike in groups:
        shown = [alike[len(alike) // 2]] if is_thinned else alike
        drawn[kind] += shown
        if len(shown) < len(alike):
            at = points[np.atleast_1d(shown[0][0])]
            axes.annotate(f"\u00d7 {len(alike)}", at[len(at) // 2], xytext=(6, 8), textcoords="offset points", color=COLORS[kind], fontsize=10,
                          zorder=7, gid="count")
    for kind, draw in (("force", _arrow), ("moment", _turn), ("shift", _arrow), ("turn", _turn)):
        for sample, direction in drawn[kind]:
            draw(axes, points[sample], direction, projection, length, COLORS[kind], kind)
            tips.append(points[sample] + length * projection @ direction)
    for member in marks.strained:
        axes.plot(*points[member.samples].T, color=style.ORANGE, linewidth=8, alpha=0.35, zorder=1, solid_capstyle="butt",
                  gid="eigenstrain")
    tips += _draw_line_loads(axes, drawn["line load"], points, projection, length * LINE_SHARE / MARK_SHARE)
    words += ["arrows: directions of point forces"] if drawn["force"] else []
    words += ["purple: moments"] if drawn["moment"] else []
    words += ["combs: line loads"] if drawn["line load"] else []
    words += ["green: prescribed motions"] if drawn["shift"] or drawn["turn"] else []
    words += ["\u00d7: one of so many alike"] if is_thinned else []
    words += ["broad: members with eigenstrains"] if marks.strained else []
    return words, tips


def _draw_supports(axes, supports, points, words):
    if not supports:
        return
    small = len(supports) >= MANY_SUPPORTS
    at = sorted({sample for sample, _ in supports})
    size = 1.2 if len(at) >= CROWD else 3 if small else 4.5
    axes.plot(*points[at].T, "s", color=style.BLACK, markersize=size, linestyle="", zorder=5, gid="supports")
    for kind in SIGNS if len(at) < CROWD else ():
        samples = [sample for sample, of in supports if of == kind]
        if samples:
            axes.plot(*points[samples].T, marker=SIGNS[kind], color=style.BLACK, markerfacecolor="none", linestyle="",
                      markersize=9 if small else 16, markeredgewidth=0.8 if small else 1.2, zorder=5, gid=f"support {kind}")
    words.append("squares: supports (" + ", ".join(kind for kind in SIGNS if any(of == kind for _, of in supports)) + ")")


def _arrow(axes, point, direction, projection, length, color, gid):
    arrow = length * projection @ direction
    if np.linalg.norm(arrow) < FACING * length:
        axes.plot(*point, "o", color=color, markersize=7, markerfacecolor="none", zorder=5, gid=gid)
    else:
        axes.annotate("", point + arrow, point, annotation_clip=False, zorder=5, gid=gid,
                      arrowprops={"arrowstyle": "-|>", "color": color, "linewidth": 1.6, "shrinkA": 0})


def _turn(axes, point, direction, projection, length, color, gid):
    """Draws a moment or rotation: an arrow along its axis, a circular arrow if that points at the reader."""
    if np.linalg.norm(projection @ direction) >= FACING:
        return _arrow(axes, point, direction, projection, length, color, gid)
    toward = np.cross(projection[0], projection[1]) @ direction > 0
    axes.annotate("\u21ba" if toward else "\u21bb", point, color=color, fontsize=24, ha="center", va="center",
                  annotation_clip=False, zorder=6, gid=gid)


def _draw_line_loads(axes, line_loads, points, projection, length):
    """Draws combs of line loads behind the members. Returns the ends of the combs."""
    largest = max((np.linalg.norm(forces, axis=1).max() for _, forces in line_loads), default=0.0)
    if not largest > 0.0:
        return []
    heads = np.concatenate([points[samples] for samples, _ in line_loads])
    arrows = length / largest * np.concatenate([forces for _, forces in line_loads]) @ projection.T
    ends = np.cumsum([len(samples) for samples, _ in line_loads])[:-1]
    backs = add_lines(axes, np.split(heads - arrows, ends), width=0.9, color=style.RED, zorder=2)
    backs.set(gid="line load", clip_on=False)
    chosen = slice(None, None, max(1, -(-len(heads) // MOST_ARROWS)))
    ends_of_backs = heads - arrows
    drawn = axes.quiver(*ends_of_backs[chosen].T, *arrows[chosen].T, color=style.RED, angles="xy", scale_units="xy", scale=1, units="inches",
                        width=ARROW_WIDTH, headwidth=5, headlength=6, headaxislength=6, zorder=2, clip_on=False, gid="line load arrows")
    drawn.set_in_layout(False)  # matplotlib measures its extent wrongly; the backs of the combs reach as far
    return list(ends_of_backs)
