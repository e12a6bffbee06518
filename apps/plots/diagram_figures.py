"""Section forces and moments: over the arc length of each member, and drawn on the structure as engineers do."""

import numpy as np
from matplotlib.collections import LineCollection, PolyCollection

import fields
import style
from structure import RASTER_PIECES, add_lines, line_width, tangents

NAMED_MEMBERS = 8       # lines that a legend can still tell apart
LEGEND_COLUMNS = 5
HEDGEHOG_SHARE = 0.14   # height of the highest diagram over the size of the structure
MEMBER_SHARE = 0.35     # and at most over the length of a typical member
NEARLY_ALONG_VIEW = 0.2  # below this projected length a tangent has no "side" in the picture
ROUND_OFF = 1e-6         # share of the largest value that a title with four digits calls zero
COLORS = (style.BLUE, style.RED, style.GREEN, style.ORANGE, style.PURPLE, style.SKY, style.BLACK, "#7F6000")
DASHES = ("-", (0, (6, 2)), (0, (2, 1.5)), "-.")


def over_arc_length_figure(view, step):
    """Six panels N, T, Q2, M2, Q3, M3 over the arc length; of many members the most loaded are named."""
    members = view.run.members
    values = {name: field.values(step, view.size) for name, field in fields.SECTION_FORCES.items()}
    named = _most_loaded(members, values)
    canvas, panels = style.figure(12.4, 7.6, 3, 2, sharex=True)
    others = [i for i in range(len(members)) if i not in named]
    others = others[::max(1, len(others) // 400)]  # a grey cloud needs no more
    long = fields.power_of_ten(max(members[j].arc_length[-1] for j in named))
    for i, name in enumerate(fields.SECTION_FORCES):
        axes = panels[i % 3, i // 3]
        exponent = fields.power_of_ten(np.abs(values[name]).max(initial=0.0))
        level = values[name] / 10.0 ** exponent
        if others:
            axes.add_collection(LineCollection(
                [np.column_stack([members[j].arc_length / 10.0 ** long, level[members[j].samples]]) for j in others],
                colors="#C4C4C4", linewidth=0.7, rasterized=len(others) > 100))
        for rank, j in enumerate(named):
            axes.plot(members[j].arc_length / 10.0 ** long, level[members[j].samples], color=COLORS[rank % len(COLORS)],
                      linestyle=DASHES[(rank // 2) % len(DASHES)] if len(named) > 1 else "-", label=members[j].name)
        axes.axhline(0.0, color=style.BLACK, linewidth=0.7, zorder=1)
        axes.set_ylabel(fields.SECTION_FORCES[name].label.split(" ", 1)[1].split(" ", 1)[-1] + fields.times(exponent))
        axes.set_title(fields.SECTION_FORCES[name].label.rsplit(" ", 1)[0], fontsize=11)
        _limits(axes, level)
        if i % 3 == 2:
            axes.set_xlabel("arc length $s$ of the undeformed member" + fields.times(long))
    if len(members) > 1:
        _legend(canvas, panels[0, 0], len(members) - len(named))
    canvas.suptitle(f"{view.run.scene_name[:60]}: section forces and moments, step {step.number}, "
                    f"load factor {step.load_factor:.6g}", fontsize=13)
    return canvas


def _limits(axes, level):
    low, high = min(level.min(), 0.0), max(level.max(), 0.0)
    if low == high:
        axes.set_ylim(-1.0, 1.0)
        axes.set_yticks([0.0])
        axes.text(0.5, 0.72, "zero everywhere", transform=axes.transAxes, ha="center", color="#666666", fontsize=11)
        return
    spread = high - low
    flat = abs(level.max() - level.min()) < 1e-6 * spread  # a constant: no ticks that differ in the tenth digit only
    axes.set_ylim(low - (0.25 if flat else 0.07) * spread, high + (0.25 if flat else 0.07) * spread)
    axes.locator_params(axis="y", nbins=5)


def _legend(canvas, axes, unnamed):
    handles, labels = axes.get_legend_handles_labels()
    labels = [label if len(label) <= 18 else label[:15] + "..." for label in labels]
    if unnamed:
        handles.append(style.plt.Line2D([], [], color="#C4C4C4", linewidth=1.5))
        labels.append(f"{unnamed} others, less loaded")
    rows = -(-len(labels) // LEGEND_COLUMNS)
    canvas.get_layout_engine().set(rect=(0, 0.045 * rows, 1, 1 - 0.045 * rows))
    canvas.legend(handles, labels, loc="lower center", ncol=min(LEGEND_COLUMNS, len(labels)))


def _most_loaded(members, values):
    """Members with the largest force or moment, each relative to the largest of its kind, in the order of the scene."""
    if len(members) <= NAMED_MEMBERS:
        return list(range(len(members)))
    forces = [np.abs(values[name]) for name in ("axial_force", "shear_2", "shear_3")]
    moments = [np.abs(values[name]) for name in ("torsion", "bending_2", "bending_3")]
    load = np.zeros(len(values["torsion"]))
    for group in (forces, moments):
        largest = np.max(group, axis=0)
        load = np.maximum(load, largest / (largest.max() or 1.0))
    starts = [member.samples.start for member in members]
    return sorted(np.argsort(-np.maximum.reduceat(load, starts), kind="stable")[:NAMED_MEMBERS])


def on_structure_figure(view, step):
    """Each section force that does not vanish as filled diagram along the deformed members in the best plane.

    A positive value stands to the left of the direction of growing arc length.
    """
    values = {name: field.values(step, view.size) for name, field in fields.SECTION_FORCES.items()}
    shown = [name for name in values if np.any(values[name])] or ["bending_3"]
    position = step.field("position") @ view.plane.T / view.unit
    low, high = position.min(axis=0), position.max(axis=0)
    aspect = np.clip((high[1] - low[1]) / ((high[0] - low[0]) or 1.0), 0.35, 1.5)
    columns = min(3, len(shown)) if len(shown) != 4 else 2
    rows = -(-len(shown) // columns)
    canvas, panels = style.figure(4.5 * columns, (3.9 * aspect + 0.7) * rows + 0.4, rows, columns, squeeze=False)
    for axes in panels.flat[len(shown):]:
        axes.set_visible(False)
    for axes, name in zip(panels.flat, shown):
        _hedgehog(axes, view, step, values[name])
        axes.set_title(fields.SECTION_FORCES[name].label + _range(values[name]), fontsize=11.5)
    canvas.suptitle(f"{view.run.scene_name[:60]}: step {step.number}, load factor {step.load_factor:.6g}; positive values "
                    "stand left of the direction of $s$", fontsize=12)
    return canvas


def _range(values):
    if not np.any(values):
        return ": zero everywhere"
    largest = np.abs(values).max()
    low, high = (0.0 if abs(value) < ROUND_OFF * largest else value for value in (values.min(), values.max()))
    return f": {high:.4g}" if high - low < ROUND_OFF * largest else f": {low:.4g} to {high:.4g}"


def _hedgehog(axes, view, step, values):
    largest = np.abs(values).max(initial=0.0) or 1.0
    position = step.field("position")
    nodes, tangent, (level,), owner = view.structure.nodes(position, tangents(position, view.structure.starts),
                                                          values / largest)
    nodes, tangent = nodes @ view.plane.T / view.unit, tangent @ view.plane.T
    along = np.linalg.norm(tangent, axis=2)
    side = np.stack([-tangent[..., 1], tangent[..., 0]], axis=2) / np.maximum(along, 1e-30)[..., None]
    visible = along.min(axis=1) > NEARLY_ALONG_VIEW
    level = np.where(visible[:, None], level, 0.0)
    spine = _height(view, position @ view.plane.T / view.unit) * side
    for sign, color in ((1, style.BLUE), (-1, style.RED)):
        part = np.maximum(sign * level, 0.0)
        areas = _areas(nodes, nodes + sign * part[..., None] * spine, part, owner)
        axes.add_collection(PolyCollection(areas, facecolors=(*style.rgb(color), 0.28), edgecolors=color, linewidth=0.9,
                                           rasterized=len(level) > RASTER_PIECES))
    add_lines(axes, np.stack([nodes[:, :-1], nodes[:, 1:]], axis=2).reshape(-1, 2, 2), color=style.BLACK,
              width=0.5 * line_width(view.structure), zorder=4)
    _frame(axes, view, np.concatenate([nodes, nodes + level[..., None] * spine]).reshape(-1, 2))


def _areas(axis, tips, part, owner):
    """Closed polygons between axis and tips, one for each run of pieces of a member that have something to show."""
    some = part.max(axis=1, initial=0.0) > 0
    numbers = np.flatnonzero(some)
    breaks = np.flatnonzero((np.diff(numbers) > 1) | (np.diff(owner[numbers]) != 0)) + 1
    runs = np.split(numbers, breaks) if len(numbers) else []
    return [np.vstack([axis[run].reshape(-1, 2), tips[run].reshape(-1, 2)[::-1]]) for run in runs]


def _frame(axes, view, points):
    low, high = points.min(axis=0), points.max(axis=0)
    margin = 0.05 * ((high - low).max() or 1.0)
    half = np.maximum((high - low) / 2 + margin, 0.15 * ((high - low).max() or 1.0))
    center = (low + high) / 2
    axes.set(xlim=(center[0] - half[0], center[0] + half[0]), ylim=(center[1] - half[1], center[1] + half[1]))
    axes.set_aspect("equal")
    axes.locator_params(axis="x", nbins=4)
    axes.locator_params(axis="y", nbins=4)
    axes.set(xlabel=view.axis_label(view.plane[0]), ylabel=view.axis_label(view.plane[1]))


def _height(view, position):
    """Length of the longest spine in the picture, so that diagrams of neighbouring members stay apart."""
    starts, ends = view.structure.starts, view.structure.ends
    spread = np.ptp(position, axis=0).max() or 1.0
    lengths = np.linalg.norm(position[ends - 1] - position[starts], axis=1)
    lengths = lengths[lengths > 1e-3 * spread]
    typical = np.median(lengths) if len(starts) > 3 and len(lengths) else spread
    return min(HEDGEHOG_SHARE * spread, MEMBER_SHARE * typical)
