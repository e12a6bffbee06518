"""Structures as smooth, coloured line pieces, in space or in a plane, for one member or ten thousand."""

import numpy as np
from matplotlib.collections import LineCollection
from mpl_toolkits.mplot3d.art3d import Line3DCollection

import style

MOST_PIECES = 12000      # more are thinned out: a picture shows no more, and a figure should take seconds
RASTER_PIECES = 4000     # above this an SVG holds the lines as pixels, else it would take minutes to open
SMOOTH_ANGLE = 0.06      # radians between neighbouring pieces, too small to see
SMOOTH_COLORS = 150      # pieces with which steps of colour are too small to see
MOST_PARTS = 12          # of one piece
FEW_SAMPLES = 20000      # larger structures are not refined by cubics


class Structure:
    """Line pieces between neighbouring samples of all members; sample numbers refer to the fields of a step."""

    def __init__(self, run):
        starts = np.array([member.samples.start for member in run.members])
        ends = np.array([member.samples.stop for member in run.members])
        self.run = run
        self.reference = run.reference()
        self.starts, self.ends = starts, ends
        first = np.arange(len(self.reference) - 1)
        first = first[~np.isin(first + 1, starts)]
        owner = np.searchsorted(starts, first, side="right") - 1
        stride = max(1, int(np.ceil(len(first) / MOST_PIECES)))  # thinned out, but with the first piece of every member
        kept = (first - starts[owner]) % stride == 0
        self.first, owner = first[kept], owner[kept]
        last = np.append(np.diff(owner) > 0, True)
        self.second = np.where(last, ends[owner] - 1, np.append(self.first[1:], 0))
        spread = self.reference.max(axis=0) - self.reference.min(axis=0)
        self.size = float(np.linalg.norm(spread)) or 1.0

    def nodes(self, points, slopes=None, *levels):
        """Divides the pieces finely. Returns nodes (m, p, dimension), tangents, `levels` (m, p), owner (m,) of each piece.

        `points` (n, dimension) are joined by cubics if unit tangents `slopes` (n, dimension) are given, else by
        lines; `levels` (n,) vary linearly in each piece.
        """
        first, second = self.first, self.second
        apart = np.linalg.norm(points[second] - points[first], axis=1) > 1e-12 * self.size
        first, second = first[apart], second[apart]
        owner = np.searchsorted(self.starts, first, side="right") - 1
        parts = 1
        if slopes is not None and len(points) <= FEW_SAMPLES and len(first):
            turn = np.arccos(np.clip(np.einsum("ij,ij->i", slopes[first], slopes[second]), -1.0, 1.0))
            wanted = max(turn.max() / SMOOTH_ANGLE, SMOOTH_COLORS / len(first))
            parts = int(np.clip(np.ceil(wanted), 1, MOST_PARTS))
        t = np.linspace(0.0, 1.0, parts + 1)[None, :]
        between = [(1 - t) * level[first, None] + t * level[second, None] for level in levels]
        t = t[..., None]
        ends = points[first, None], points[second, None]
        if slopes is None:
            return ends[0] + t * (ends[1] - ends[0]), None, between, owner
        directions = slopes[first, None], slopes[second, None]
        tangent = (1 - t) * directions[0] + t * directions[1]
        tangent /= np.maximum(np.linalg.norm(tangent, axis=2, keepdims=True), 1e-30)
        return _hermite(ends, directions, t) if parts > 1 else ends[0] + t * (ends[1] - ends[0]), tangent, between, owner

    def pieces(self, points, values=None, slopes=None):
        """Returns line pieces (m, 2, dimension) through `points`, and the mean of `values` (n,) on each."""
        nodes, _, levels, _ = self.nodes(points, slopes, *(() if values is None else (values,)))
        lines = np.stack([nodes[:, :-1], nodes[:, 1:]], axis=2).reshape(-1, 2, points.shape[1])
        return lines, ((levels[0][:, :-1] + levels[0][:, 1:]) / 2).reshape(-1) if levels else None


def _hermite(ends, directions, t):
    """Evaluates cubics through both ends with the given directions; the tangent length is that of an arc."""
    cosine = np.clip((directions[0] * directions[1]).sum(axis=2, keepdims=True), -1.0, 1.0)
    length = np.linalg.norm(ends[1] - ends[0], axis=2, keepdims=True) * 2 / np.maximum(1 + np.sqrt((1 + cosine) / 2), 1.0)
    return ((1 + 2 * t) * (1 - t) ** 2 * ends[0] + t * (1 - t) ** 2 * length * directions[0]
            + t * t * (3 - 2 * t) * ends[1] + t * t * (t - 1) * length * directions[1])


def tangents(points, breaks):
    """Returns unit tangents (n, dimension) of curves through `points`, from parabolas through three neighbours.

    A new curve begins at every sample in `breaks`, and where a point repeats the one before, as at element ends.
    Section triads would be no better: they jump there, and shear inclines them.
    """
    chord = np.diff(points, axis=0)
    length = np.linalg.norm(chord, axis=1)
    joined = length > 1e-12 * (np.ptp(points, axis=0).max() or 1.0)
    joined[np.asarray(breaks[1:], dtype=int) - 1] = False
    chord = np.where(joined[:, None], chord / np.where(joined, length, 1.0)[:, None], 0.0)
    before, after = np.vstack([chord[:1] * 0, chord]), np.vstack([chord, chord[:1] * 0])
    h_before, h_after = np.append(0.0, length * joined), np.append(length * joined, 0.0)
    inner = (h_before > 0) & (h_after > 0)
    total = np.where(inner, h_before + h_after, 1.0)[:, None]
    slope = np.where(inner[:, None], (h_after[:, None] * before + h_before[:, None] * after) / total, before + after)
    first, last = (h_before == 0) & (h_after > 0), (h_before > 0) & (h_after == 0)
    for ends, shift in ((np.flatnonzero(first), 1), (np.flatnonzero(last), -1)):
        ends = ends[inner[ends + shift]]
        slope[ends] = 2 * slope[ends] - slope[ends + shift]
    return slope / np.maximum(np.linalg.norm(slope, axis=1, keepdims=True), 1e-30)


def add_lines(axes, lines, values=None, scale=None, width=2.0, color=style.GREY, zorder=2):
    """Draws pieces in 2-D or 3-D axes in one colour, or coloured by `values` with `scale` = (colour map, norm)."""
    kind = Line3DCollection if axes.name == "3d" else LineCollection
    options = {"linewidth": width, "capstyle": "round", "zorder": zorder, "rasterized": len(lines) > RASTER_PIECES}
    if values is None:
        pieces = kind(lines, colors=color, **options)
    else:
        pieces = kind(lines, cmap=scale[0], norm=scale[1], **options)
        pieces.set_array(values)
    axes.add_collection(pieces)
    return pieces


def line_width(structure):
    """Returns the line width: thick for a rod, thin for a lattice."""
    return float(np.clip(3.2 - 0.65 * np.log10(max(len(structure.starts), 1)), 0.7, 3.2))


def best_plane(points):
    """Returns two orthonormal directions of the plane in which `points` spread most, coordinate directions if as good."""
    centered = points - points.mean(axis=0)
    _, spread, directions = np.linalg.svd(centered, full_matrices=False)
    best = (spread[:2] ** 2).sum()
    flat = spread[1] < 1e-9 * spread[0]
    for axes in ((0, 1), (0, 2), (1, 2)):  # a picture along the axes is easier to read than a slightly rotated one
        shown = np.linalg.svd(centered[:, axes], compute_uv=False)
        if (shown ** 2).sum() > 0.97 * best and (flat or shown[1] > 0.85 * spread[1]):
            return np.eye(3)[list(axes)]
    if flat:  # a straight line: any second direction will do
        return np.array([_mostly_positive(directions[0]), _across(directions[0])])
    return np.array([_mostly_positive(direction) for direction in directions[:2]])


def _across(direction):
    other = np.eye(3)[int(np.argmin(np.abs(direction)))]
    other = other - direction * (direction @ other)
    return _mostly_positive(other / np.linalg.norm(other))


def _mostly_positive(direction):
    return direction * np.copysign(1.0, direction[np.argmax(np.abs(direction))])


def axis_name(direction):
    """Returns "$x$", "$y$" or "$z$" for a coordinate direction, its components otherwise."""
    nearest = int(np.argmax(np.abs(direction)))
    if direction[nearest] > 1 - 1e-9:
        return f"${'xyz'[nearest]}$"
    return "(" + ", ".join(f"{component:.2f}" for component in direction) + r")$\cdot\mathbf{x}$"


def plane_of(camera):
    """Returns the directions to the right and upwards in the picture; `camera`: elevation and azimuth in degrees."""
    elevation, azimuth = np.radians(camera)
    right = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    toward = np.array([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)])
    return np.array([right, np.cross(toward, right)])


def best_view(points):
    """Returns the elevation and azimuth (degrees) under which `points` cover most of the picture."""
    centered = points - points.mean(axis=0)

    def covered(view):
        spread = np.linalg.svd(centered @ plane_of(view).T, compute_uv=False)
        return spread[0] * spread[-1]

    views = [(elevation, azimuth) for elevation in (24, 38, 52) for azimuth in (-60, -35, -120)]
    best = max(views, key=covered)
    usual = (24, -60)
    spread = np.linalg.svd(centered, compute_uv=False)
    slim = len(spread) < 2 or spread[1] < 0.15 * spread[0]  # a nearly straight rod looks best in the usual view
    return usual if slim or covered(usual) > 0.7 * covered(best) else best
