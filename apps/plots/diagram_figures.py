"""Diagrams of section forces and moments: over the arc length of each member, and on the structure."""

import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.patheffects import withStroke

import fields
import style
from structure import RASTER_PIECES, add_lines, line_width, tangents

NAMED_MEMBERS = 8       # lines that a legend can distinguish
LEGEND_COLUMNS = 5
LETTERS_PER_INCH = 12  # of a title
FRAME = 0.05, 0.15, 4   # margin and least half of a side, over the extent; ticks
HEDGEHOG_SHARE = 0.14   # height of the highest diagram over the size of the structure
MEMBER_SHARE = 0.35     # and at most over the length of a typical member
NEARLY_ALONG_VIEW = 0.2  # below this projected length a tangent has no "side" in the picture
SAME_SPOT = 0.09         # of the extent: two values nearer to each other share a label
BESIDE = 0.5             # sideways component of a unit spine from which on its value is written beside the tip
SAME_DIGITS = 5e-4       # of the largest value
ROUND_OFF = 1e-6         # share of the largest value that is zero in four digits
COLORS = (style.BLUE, style.RED, style.GREEN, style.ORANGE, style.PURPLE, style.SKY, style.BLACK, "#7F6000")
DASHES = ("-", (0, (6, 2)), (0, (2, 1.5)), "-.")


def over_arc_length_figure(view, step):
    """Draws six panels N, T, Q2, M2, Q3, M3 over the arc length; of many members only the most loaded are named."""
    members = view.run.members
    values = {name: field.values(step, view.size) for name, field in fields.SECTION_FORCES.items()}
    named = _most_loaded(members, values)
    legend = -(-(len(named) + (len(named) < len(members))) // LEGEND_COLUMNS) if len(members) > 1 else 0
    canvas, panels = style.figure_as_is(12.4, 7.6, 3, 2, sharex=True, left=0.07, right=0.985, top=0.9, bottom=0.075 + 0.045 * legend,
                                        wspace=0.17, hspace=0.28)
    others = [i for i in range(len(members)) if i not in named]
    others = others[::max(1, len(others) // 400)]  # enough for a grey cloud
    long = fields.power_of_ten(max(members[j].arc_length[-1] for j in named))
    across = "arc length $s$ of the undeformed member" + fields.times(long, view.run.units[0])
    for axes, level in force_panels(view, panels, values, across):
        if others:
            axes.add_collection(LineCollection(
                [np.column_stack([members[j].arc_length / 10.0 ** long, level[members[j].samples]]) for j in others],
                colors="#C4C4C4", linewidth=0.7, rasterized=len(others) > 100))
        for rank, j in enumerate(named):
            axes.plot(members[j].arc_length / 10.0 ** long, level[members[j].samples], color=COLORS[rank % len(COLORS)],
                      linestyle=DASHES[(rank // 2) % len(DASHES)] if len(named) > 1 else "-", label=style.literal(members[j].name))
        for j in named[:1] if len(named) == 1 else ():
            name_extremes(axes, members[j].arc_length / 10.0 ** long, level[members[j].samples])
    if legend:
        _legend(canvas, panels[0, 0], len(members) - len(named))
    title = f"{view.title(step)}: section forces and moments"
    canvas.suptitle("\n".join(style.wrapped(title, int(LETTERS_PER_INCH * 12.4))), fontsize=13, y=0.985)
    return canvas


def force_panels(view, panels, values, across):
    """Yields (axes, values over their power of ten) of the six section forces; `across`: label below the lowest panels."""
    for i, (name, field) in enumerate(fields.SECTION_FORCES.items()):
        axes = panels[i % 3, i // 3]
        exponent, level = fields.scaled(values[name])
        words, symbol = field.label.rsplit(" ", 1)
        axes.set_ylabel(symbol + fields.times(exponent, field.unit(view.run.units)))
        axes.set_title(words, fontsize=11)
        axes.axhline(0.0, color=style.BLACK, linewidth=0.7, zorder=1)
        limits(axes, level)
        axes.set_xlabel(across if i % 3 == 2 else "")
        yield axes, level


def name_extremes(axes, places, values):
    """Writes the largest and the smallest value at their places; only one if all are equal or the other is zero."""
    largest = np.abs(values).max(initial=0.0)
    if not largest > 0.0:
        return
    highest = int(np.argmax(values))
    for at in {highest, int(np.argmin(values))}:
        if abs(values[at]) < ROUND_OFF * largest or values.max() - values.min() < ROUND_OFF * largest and at > 0:
            continue
        axes.plot([places[at]], [values[at]], "o", color=style.BLACK, markersize=3.5, zorder=6, gid="extreme")
        axes.annotate(fields.number_text(values[at]), (places[at], values[at]), xytext=(0, 4 if at == highest else -11),
                      textcoords="offset points", fontsize=9, zorder=7, gid="value",
                      ha="left" if places[at] < np.mean([places[0], places[-1]]) else "right")


def limits(axes, level):
    low, high = min(level.min(), 0.0), max(level.max(), 0.0)
    if low == high:
        axes.set_ylim(-1.0, 1.0)
        axes.set_yticks([0.0])
        axes.text(0.5, 0.72, "zero everywhere", transform=axes.transAxes, ha="center", color="#666666", fontsize=11)
        return
    spread = high - low
    flat = abs(level.max() - level.min()) < 1e-6 * spread  # a constant needs no ticks that differ in the tenth digit only
    axes.set_ylim(low - (0.25 if flat else 0.16) * spread, high + (0.25 if flat else 0.16) * spread)
    axes.locator_params(axis="y", nbins=5)


def _legend(canvas, axes, unnamed):
    handles, labels = axes.get_legend_handles_labels()
    labels = [label if len(label) <= 18 else label[:15] + "..." for label in labels]
    if unnamed:
        handles.append(style.plt.Line2D([], [], color="#C4C4C4", linewidth=1.5))
        labels.append(f"{unnamed} others, less loaded")
    canvas.legend(handles, labels, loc="lower center", ncol=min(LEGEND_COLUMNS, len(labels)))


def _most_loaded(members, values):
    """Returns the members with the largest force or moment, each relative to the largest of its kind, in scene order."""
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
    """Draws each section force that does not vanish as filled diagram along the deformed members, in the plane of the structure
    or, if it has none, in space.

    In a plane positive values are plotted to the left of the direction of arc length, bending moments on the side chosen
    by --moments if the picture shows it. In space forces and moments are plotted along the axes of the section.
    """
    values = {name: field.values(step, view.size) for name, field in fields.SECTION_FORCES.items()}
    shown = [name for name in values if np.any(values[name])] or ["bending_3"]
    position = view.position(step) @ view.projection.T / view.unit
    low, high = position.min(axis=0), position.max(axis=0)
    aspect = np.clip((high[1] - low[1]) / ((high[0] - low[0]) or 1.0), 0.35, 1.5)
    canvas, panels = style.panels(len(shown), 2 if len(shown) == 4 else 3, 4.5, 3.9 * aspect + 0.7, (0.0, 0.4))
    for axes, name in zip(panels.flat, shown):
        _hedgehog(axes, view, step, values[name], side_of(view, step, name), None if view.is_plane else _axis_of(view, step, name))
        unit = fields.SECTION_FORCES[name].unit(view.run.units)
        axes.set_title(fields.SECTION_FORCES[name].label + _range(values[name]) + f" {style.literal(unit)}".rstrip(), fontsize=11.5)
    if not view.is_plane:
        where = "Q2 and M3 stand along section axis 2, Q3 and M2 along axis 3, N and T along the one that is seen best"
    else:
        where = "positive forces stand left of the direction of $s$"
    moments = "moments too" if view.look.moments == "left" else f"moments on the {view.look.moments} side"
    caption = (f"blue: positive, orange: negative; {where}, {moments}; "
               f"{view.scale_words()}")
    caption = "\n".join(style.wrapped(caption, int(LETTERS_PER_INCH * canvas.get_size_inches()[0])))
    canvas.suptitle(f"{view.title(step)}\n{caption}", fontsize=12)
    return canvas


def side_of(view, step, name):
    """Returns (n,): 1 if positive values are plotted to the left of the direction of s in the picture, -1 if to the right.

    A moment M2 stretches the side of axis 3, M3 that against axis 2: the strain of a fibre is y3 kappa2 - y2 kappa3.
    """
    position = view.position(step)
    if name not in ("bending_2", "bending_3") or view.look.moments == "left":
        return np.ones(len(position))
    stretched = step.field("triad_3") if name == "bending_2" else -step.field("triad_2")
    if view.look.moments == "compression":
        stretched = -stretched
    if not view.is_plane:
        return np.ones(len(position))
    tangent = tangents(position, view.structure.starts) @ view.plane.T
    shown = stretched @ view.plane.T
    left = tangent[:, 0] * shown[:, 1] - tangent[:, 1] * shown[:, 0]
    return np.where(left < -NEARLY_ALONG_VIEW * np.linalg.norm(tangent, axis=1), -1.0, 1.0)


def _range(values):
    if not np.any(values):
        return ": zero everywhere"
    largest = np.abs(values).max()
    low, high = (0.0 if abs(value) < ROUND_OFF * largest else value for value in (values.min(), values.max()))
    low, high, is_one = fields.number_text(low), fields.number_text(high), high - low < ROUND_OFF * largest
    return f": {high}" if is_one else f": {low} to {high}"


def _axis_of(view, step, name):
    """Returns the directions (n, 3) of positive values in space; bending moments on the tension or the compression side."""
    second, third = (step.field(f"triad_{i}") for i in (2, 3))
    if name in ("bending_2", "bending_3"):
        stretched = third if name == "bending_2" else -second
        return -stretched if view.look.moments == "compression" else stretched
    if name in ("shear_2", "shear_3"):
        return second if name == "shear_2" else third
    seen = [np.linalg.norm(axis @ view.projection.T, axis=1) for axis in (second, third)]
    return np.where((seen[0] >= seen[1])[:, None], second, third)


def _hedgehog(axes, view, step, values, sides, directions=None):
    """Draws one diagram; `directions` (n, 3) of positive values, for a structure in space."""
    largest = np.abs(values).max(initial=0.0) or 1.0
    position = view.position(step)
    across = np.zeros_like(position) if directions is None else directions
    nodes, tangent, (level, turned, *across), owner = view.structure.nodes(position, tangents(position, view.structure.starts),
                                                                           values / largest, sides, *across.T)
    nodes, tangent = nodes @ view.projection.T / view.unit, tangent @ view.projection.T
    if directions is None:
        along = np.linalg.norm(tangent, axis=2)
        side = np.stack([-tangent[..., 1], tangent[..., 0]], axis=2) / np.maximum(along, 1e-30)[..., None]
        level = np.where((along.min(axis=1) > NEARLY_ALONG_VIEW)[:, None], level, 0.0)
    else:
        side = np.stack(across, axis=2) @ view.projection.T
    side = side * np.where(turned < 0.0, -1.0, 1.0)[..., None]
    spine = _height(view, position @ view.projection.T / view.unit) * side
    for sign, color in ((1, style.BLUE), (-1, style.RED)):
        part = np.maximum(sign * level, 0.0)
        areas = _areas(nodes, nodes + sign * part[..., None] * spine, part, owner)
        axes.add_collection(PolyCollection(areas, facecolors=(*style.rgb(color), 0.28), edgecolors=color, linewidth=0.9,
                                           rasterized=len(level) > RASTER_PIECES, gid="positive" if sign > 0 else "negative"))
    add_lines(axes, np.stack([nodes[:, :-1], nodes[:, 1:]], axis=2).reshape(-1, 2, 2), color=style.BLACK,
              width=0.5 * line_width(view.structure), zorder=4)
    _name_values(axes, nodes, nodes + level[..., None] * spine, level, largest, (values.min() / largest, values.max() / largest))
    view.frame(axes, np.concatenate([nodes, nodes + level[..., None] * spine]).reshape(-1, 2), *FRAME)


def _name_values(axes, nodes, tips, level, largest, extremes):
    """Writes the largest and the smallest value at the tips of their spines, unless the view hides them."""
    if not np.any(level):
        return
    ends = {np.unravel_index(choose(level), level.shape) for choose in (np.argmax, np.argmin)}
    flat = level.max() - level.min() < ROUND_OFF
    named = [at for at in (sorted(ends)[:1] if flat else sorted(ends)) if abs(level[at]) >= ROUND_OFF]
    named = [at for at in named if np.abs(level[at] - extremes).min() < SAME_DIGITS]
    words = [fields.number_text(largest * level[at]) for at in named]
    if len(named) == 2 and np.linalg.norm(tips[named[0]] - tips[named[1]]) < SAME_SPOT * np.ptp(nodes.reshape(-1, 2), axis=0).max():
        named, words = named[:1], [", ".join(words)]
    for at, word in zip(named, words):
        away = tips[at] - nodes[at]
        away = away / (np.linalg.norm(away) or 1.0)
        beside = "center" if abs(away[0]) < BESIDE else "left" if away[0] > 0 else "right"
        name = axes.annotate(word, tips[at], xytext=(5 if beside != "center" else 8) * away, textcoords="offset points", fontsize=9.5,
                             ha=beside, va="center", zorder=7, annotation_clip=False, gid="value")
        name.set_path_effects([withStroke(linewidth=2.5, foreground="white", alpha=0.85)])


def _areas(axis, tips, part, owner):
    """Returns closed polygons between axis and tips, one for each run of pieces of a member with nonzero values."""
    some = part.max(axis=1, initial=0.0) > 0
    numbers = np.flatnonzero(some)
    breaks = np.flatnonzero((np.diff(numbers) > 1) | (np.diff(owner[numbers]) != 0)) + 1
    runs = np.split(numbers, breaks) if len(numbers) else []
    return [np.vstack([axis[run].reshape(-1, 2), tips[run].reshape(-1, 2)[::-1]]) for run in runs]


def _height(view, position):
    """Returns the length of the longest spine, chosen such that diagrams of neighbouring members do not overlap."""
    starts, ends = view.structure.starts, view.structure.ends
    spread = np.ptp(position, axis=0).max() or 1.0
    lengths = np.linalg.norm(position[ends - 1] - position[starts], axis=1)
    lengths = lengths[lengths > 1e-3 * spread]
    typical = np.median(lengths) if len(starts) > 3 and len(lengths) else spread
    return min(HEDGEHOG_SHARE * spread, MEMBER_SHARE * typical)
