"""Pictures of the deformed structure: one step with its sections, coloured by a field, and several steps."""

import numpy as np
from matplotlib.patheffects import withStroke

import fields
import style
from preview import parts_of
from scene_marks import MARK_SHARE, Marks, draw_marks
from solid import draw_solid
from structure import add_lines, line_width, tangents

MOST_TRIADS = 24
STRIP_STEPS = 6
CAPTION_WIDTH = 11.0  # letters per inch
WIDTH, LEAST_HEIGHT = 9.0, 3.6  # of a picture [inch]
MOST_LETTERS = 400   # of a message
FRAME = 0.06, 0.12, 5  # margin and least half of a side, over the extent; ticks
MOTION_SHARE = 0.1   # of a mechanism, over the size of the structure
PART_COLORS = (style.BLUE, style.ORANGE, style.GREEN, style.PURPLE, style.SKY, "#7F6000", style.GREY)


def shape_figure(view, step, field, triads=False, said=None):
    """Draws the members with their sections like the page of `mixbeam view`; grey: undeformed. `said`: messages on an unsolved
    scene (preview.Said), whose connected parts are coloured instead of a field."""
    projection, position = view.projection, view.position(step)
    shown = np.vstack([view.everything, position]) @ projection.T
    aspect = np.clip(np.ptp(shown[:, 1]) / (np.ptp(shown[:, 0]) or 1.0), 0.25, 1.4)
    canvas, axes = style.figure(WIDTH, np.clip(WIDTH * aspect, LEAST_HEIGHT, WIDTH))
    axes.set_axis_off()
    grey, _ = view.lines(view.structure.reference)
    directions = _directions(view, step, position)
    if said:
        words = _draw_parts(axes, view, position, directions, said)
    else:
        exponent, values = fields.scaled(field.values(step, view.size))
        add_lines(axes, grey @ projection.T, width=1.0, zorder=1)
        colors, corners = draw_solid(axes, view, position, directions, projection, values, fields.color_scale(field, values))
        label = view.field_label(field, exponent) + ("" if np.any(values) else ": zero everywhere")
        canvas.colorbar(colors, ax=axes, shrink=0.8, pad=0.02, aspect=28, label=label)
        words = ["grey: undeformed"], corners
    marks = Marks(view.run, step, view.structure.reference, is_whole=bool(said))
    length = MARK_SHARE * np.ptp(shown, axis=0).max() / view.unit
    marked, tips = draw_marks(axes, marks, position @ projection.T / view.unit, projection, length)
    if triads:
        _draw_triads(view, axes, step, position, projection)
    _frame_without_axes(axes, view, np.vstack([words[1], grey.reshape(-1, 3) @ projection.T, *tips]))
    lines = style.wrapped("; ".join([*words[0], *marked, view.scale_words()]), int(CAPTION_WIDTH * WIDTH))
    title = f"{view.scene_words}: not solved" if said else view.title(step)
    canvas.suptitle("\n".join([title, *lines]), fontsize=11.5)
    return canvas


def _directions(view, step, position):
    """Returns section axes 2 and 3 at all samples, made normal to the line if displacements are scaled."""
    second, third = (step.field(f"triad_{i}") for i in (2, 3))
    if view.look.scale == 1.0:
        return second, third
    along = tangents(position, view.structure.starts)
    second = second - along * np.einsum("ij,ij->i", second, along)[:, None]
    second = second / np.maximum(np.linalg.norm(second, axis=1, keepdims=True), 1e-30)
    return second, np.cross(along, second)


def _draw_parts(axes, view, position, directions, said):
    """Draws connected parts in colours, and marks the members named in messages. Returns (words, corners)."""
    members, parts = view.run.members, parts_of(view.run)
    palette = [style.rgb(color) for color in PART_COLORS]
    colors = [palette[parts[member.index] % len(palette)] if parts else palette[0] for member in members]
    _, corners = draw_solid(axes, view, position, directions, view.projection, colors=colors)
    for number in said.names(members):
        line = position[members[number].samples] @ view.projection.T / view.unit
        axes.plot(*line.T, color=style.RED, linewidth=9, alpha=0.3, zorder=4, solid_capstyle="round", gid="named")
        name = axes.annotate(style.literal(members[number].name), line[len(line) // 2], xytext=(7, 7), textcoords="offset points",
                             color=style.RED, zorder=7)
        name.set_path_effects([withStroke(linewidth=2.5, foreground="white")])
    for motion in [mode for _, mode in view.run.buckling_modes()][:1]:
        largest = np.linalg.norm(motion, axis=1).max(initial=0.0) or 1.0
        moved, speed = view.lines(position + MOTION_SHARE * view.size / largest * motion, np.linalg.norm(motion, axis=1) / largest)
        moved = moved[speed > fields.NOISE]
        add_lines(axes, moved @ view.projection.T, width=1.4, color=style.RED, zorder=4).set(gid="motion", linestyle=(0, (5, 2)))
    count = len(set(parts))
    words = [f"colours: the {count} parts that are not connected"] if count > 1 else []
    words += ["red, dashed: moves without strain"] if view.run.buckling_modes() else []
    words += [view.run.properties()["drawn"].rstrip(".")] if view.run.properties().get("drawn") else []
    refusal = style.wrapped(style.literal(said.refusal if len(said.refusal) <= MOST_LETTERS else said.refusal[:MOST_LETTERS] + " ..."), int(CAPTION_WIDTH * WIDTH))
    axes.set_title("\n".join(refusal) if said.refusal else "", fontsize=10.5, color=style.RED)
    return words, corners


def _frame_without_axes(axes, view, points):
    """Sets equal limits around all points, and draws directions of x, y, z and a scale bar instead of axes."""
    low, high = points.min(axis=0), points.max(axis=0)
    span = (high - low).max() or 1.0
    low, high = low - 0.04 * span, high + 0.04 * span
    low[1] -= 0.17 * span  # room for the directions below the supports
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    axes.set_aspect("equal")
    corner = low + 0.07 * span
    for name, direction in zip("xyz", view.projection.T):
        if np.linalg.norm(direction) > 0.1:
            tip = corner + 0.055 * span * direction
            axes.annotate("", tip, corner, arrowprops={"arrowstyle": "-|>", "color": style.BLACK, "linewidth": 1, "shrinkA": 0, "shrinkB": 0})
            axes.annotate(f"${name}$", corner + 0.075 * span * direction, ha="center", va="center", fontsize=11, gid="axis")
    bar = round_length(0.2 * (high[0] - low[0]) * view.unit)
    start = np.array([high[0] - bar / view.unit - 0.03 * span, corner[1]])
    axes.plot(start[0] + np.array([0, bar / view.unit]), [start[1]] * 2, color=style.BLACK, linewidth=2, gid="length")
    axes.annotate(f"{bar:.4g} {style.literal(view.run.units[0])}".strip(), start + (bar / view.unit / 2, 0), xytext=(0, 5),
                  textcoords="offset points", ha="center", fontsize=10)


def round_length(most):
    """Returns the largest of 1, 2, 5 times a power of ten that does not exceed a length."""
    power = 10.0 ** np.floor(np.log10(most))
    return float(max(factor * power for factor in (1, 2, 5) if factor * power <= most * (1 + 1e-12)))


def overview_figure(view, step):
    """Draws the most important fields side by side in the best plane; those that vanish are left out."""
    position = view.position(step)
    overview = fields.STRESS_OVERVIEW if step.has("von_mises_stress") else fields.OVERVIEW
    shown = [(field, field.values(step, view.size)) for field in (fields.FIELDS[name] for name in overview)]
    shown = [entry for entry in shown if np.any(entry[1])] or shown[:1]
    shown_points = position if view.has_shrunk(position) else view.everything
    projected = shown_points @ view.projection.T
    aspect = np.clip(np.ptp(projected[:, 1]) / (np.ptp(projected[:, 0]) or 1.0), 0.3, 1.4)
    canvas, panels = style.panels(len(shown), 3, 4.6, 3.5 * aspect + 0.75)
    for axes, (field, values) in zip(panels.flat, shown):
        exponent, values = fields.scaled(values)
        pieces = _draw_lines(axes, view, position, values, fields.color_scale(field, values))
        view.frame(axes, shown_points @ view.projection.T / view.unit, *FRAME)
        axes.set_title(view.field_label(field, exponent) + ("" if np.any(values) else ": zero everywhere"))
        axes.label_outer()
        canvas.colorbar(pieces, ax=axes, shrink=0.8, pad=0.02, aspect=22)
    canvas.suptitle(view.title(step), fontsize=13)
    return canvas


def strip_figure(view, steps, field):
    """Draws some steps of the path side by side, with common scale and colour scale."""
    position = [view.position(step) for step in steps]
    values = [field.values(step, view.size) for step in steps]
    exponent = fields.power_of_ten(max(np.nanmax(np.abs(value), initial=0.0) for value in values))
    values = [value / 10.0 ** exponent for value in values]
    scale = fields.color_scale(field, np.concatenate(values))
    projected = view.everything @ view.projection.T
    wide = np.ptp(projected[:, 0]) > 1.6 * np.ptp(projected[:, 1])
    most = 3 if wide else 6
    aspect = np.clip(np.ptp(projected[:, 1]) / (np.ptp(projected[:, 0]) or 1.0), 0.25, 2.2)
    panel = 13.0 / max(min(most, len(steps)), 3)
    canvas, panels = style.panels(len(steps), most, panel, panel * aspect + 0.5, (0.8, 0.4), sharex=True, sharey=True)
    canvas.get_layout_engine().set(h_pad=0.1)  # inches; the height of a root in the title is underestimated
    for axes, step, points, value in zip(panels.flat, steps, position, values):
        pieces = _draw_lines(axes, view, points, value, scale)
        view.frame(axes, projected / view.unit, *FRAME)
        axes.label_outer()
        axes.set_title(f"load factor {step.load_factor:.4g}")
    canvas.colorbar(pieces, ax=list(panels.flat), shrink=0.9, pad=0.01, aspect=12 * len(panels))
    canvas.suptitle(f"{view.scene_words}: {view.field_label(field, exponent)}"
                    + ("" if any(np.any(value) for value in values) else ": zero everywhere"), fontsize=13)
    return canvas


def strip_steps(steps):
    """Returns at most STRIP_STEPS steps, evenly spread over the path, including the last one."""
    numbers = np.unique(np.linspace(0, len(steps) - 1, min(STRIP_STEPS, len(steps))).round().astype(int))
    return [steps[i] for i in numbers]


def _draw_triads(view, axes, step, position, projection):
    count = min(MOST_TRIADS, len(position))
    chosen = np.unique(np.linspace(0, len(position) - 1, count).round().astype(int))
    for i, color in enumerate(style.COMPONENT_COLORS, start=1):
        tips = position[chosen] + 0.06 * view.size * step.field(f"triad_{i}")[chosen]
        add_lines(axes, np.stack([position[chosen], tips], axis=1) @ projection.T / view.unit, color=color, width=1.2, zorder=4)


def _draw_lines(axes, view, points, values, scale):
    """Draws the structure as lines coloured by values; grey: undeformed. Returns the collection for a colour bar."""
    width = 0.8 * line_width(view.structure)
    lines, colors = view.lines(points, values, tangents(points, view.structure.starts))
    add_lines(axes, view.lines(view.structure.reference)[0] @ view.projection.T, width=max(0.35 * width, 0.4), zorder=1)
    return add_lines(axes, lines @ view.projection.T, colors, scale, width, zorder=3)
