"""Pictures of the deformed structure: one step in space and in its best plane, coloured by a field, and several steps."""

import numpy as np

import fields
import style
from scene_marks import MARK_SHARE, Marks, draw_marks
from structure import add_lines, line_width, tangents

MOST_TRIADS = 24
STRIP_STEPS = 6
CAPTION_WIDTH = 12.0  # letters to an inch
WIDTH, HEIGHT, FLAT_WIDTH = 12.4, 5.4, 4.7  # of a picture, and of its right panel for a structure wider than tall [inch]
SPACE_WIDTH = 5.6  # of what the picture in space takes; none where a plane is asked for [inch]
MARGIN_OF_TALL = 1.3  # empty to both sides of a mast in the square of the picture in space [inch]
SMALL_WIDTH = 5.0  # letters of the caption need it [inch]
TALL = 1.6  # of a box in space, height over width: its labels need to be kept off its edge


def shape_figure(view, step, field, triads=False):
    """Left in space, right in the best plane, or in the plane that was asked for alone; grey: undeformed."""
    canvas, space, flat, inch = _panels(view)
    position = view.position(step)
    values = field.values(step, view.size)
    exponent = fields.power_of_ten(np.nanmax(np.abs(values), initial=0.0))
    values = values / 10.0 ** exponent
    scale = fields.color_scale(field, values)
    width = line_width(view.structure)
    lines, colors = view.lines(position, values, tangents(position, view.structure.starts))
    grey, _ = view.lines(view.structure.reference)
    shrunk = view.has_shrunk(position)
    for axes, projection in ((space, np.eye(3)), (flat, view.plane)):
        if axes is not None and (axes is flat or not shrunk):
            add_lines(axes, grey @ projection.T, width=max(0.35 * width, 0.4), zorder=1)
        if axes is not None:
            pieces = add_lines(axes, lines @ projection.T, colors, scale, width, zorder=3)
    marked, tips = _draw_marks(view, (space, flat), position, step, shrunk)
    if space is not None:
        if triads:
            _draw_triads(view, space, step, position)
        style.equal_axes_3d(space, (position if shrunk else view.everything) / view.unit, ticks=4)
        space.view_init(*(view.camera_of(position / view.unit) if shrunk else view.camera))
        _name_axes_3d(space, view)
    _finish_plane(flat, view, tips=tips)
    label = view.field_label(field, exponent) + ("" if np.any(values) else ": zero everywhere")
    canvas.colorbar(pieces, ax=flat, shrink=0.85, pad=0.03, aspect=28, label=label)
    on_the_right = shrunk and space is not None
    caption = ["grey: undeformed, on the right only" if on_the_right else "grey: undeformed", *marked, view.scale_words()]
    words = style.wrapped("; ".join(caption), int(CAPTION_WIDTH / inch))
    raised = 0.045 * (len(words) - 1)  # a second line must not meet the box in space
    canvas.suptitle(view.title(step), y=0.985 + raised, fontsize=13)
    canvas.text(0.5, 0.925 + raised, "\n".join(words), ha="center", va="top", fontsize=11, color="#444444")
    return canvas


def _panels(view):
    """Canvas, axes in space (None where a plane of the axes was asked for) and in the plane, and an inch as a share of the width."""
    projected = np.ptp(view.everything @ view.plane.T, axis=0)
    flat_width = FLAT_WIDTH * np.clip(projected[0] / (projected[1] or 1.0), 0.5, 1.0)
    alone = view.look.in_plane
    width = WIDTH - FLAT_WIDTH + flat_width
    if alone:
        flat_width = FLAT_WIDTH * np.clip(projected[0] / (projected[1] or 1.0), 0.25, 1.8)
        width = max(WIDTH - FLAT_WIDTH + flat_width - SPACE_WIDTH, SMALL_WIDTH)
    depth, height = np.hypot(*np.ptp(view.everything[:, :2], axis=0)), np.ptp(view.everything[:, 2])
    margin = 0.0 if alone else MARGIN_OF_TALL * (1.0 - np.clip(depth / (height or 1.0), 0.0, 1.0))
    width -= 2.0 * margin
    with style.plt.rc_context({"figure.constrained_layout.use": False}):
        canvas = style.plt.figure(figsize=(width, HEIGHT))
    inch = 1.0 / width
    space = None if alone else canvas.add_axes((-margin * inch, 0.02, 5.46 * inch, 0.82), projection="3d", facecolor="none")
    left = (0.5 if alone else 1.0) * (1.0 - (flat_width + 1.13) * inch) + (0.35 * inch if alone else 0.0)  # labels stand left
    return canvas, space, canvas.add_axes((left, 0.13, (flat_width + 0.88) * inch, 0.74)), inch


def overview_figure(view, step):
    """The fields an engineer looks at first, side by side in the best plane; those that vanish are left out."""
    position = view.position(step)
    slopes = tangents(position, view.structure.starts)
    overview = fields.STRESS_OVERVIEW if step.has("von_mises_stress") else fields.OVERVIEW
    shown = [(field, field.values(step, view.size)) for field in (fields.FIELDS[name] for name in overview)]
    shown = [entry for entry in shown if np.any(entry[1])] or shown[:1]
    shown_points = position if view.has_shrunk(position) else view.everything
    projected = shown_points @ view.plane.T
    aspect = np.clip(np.ptp(projected[:, 1]) / (np.ptp(projected[:, 0]) or 1.0), 0.3, 1.4)
    columns = min(3, len(shown))
    rows = -(-len(shown) // columns)
    canvas, panels = style.figure(4.6 * columns, (3.5 * aspect + 0.75) * rows, rows, columns, squeeze=False)
    for axes in panels.flat[len(shown):]:
        axes.set_visible(False)
    grey, _ = view.lines(view.structure.reference)
    for axes, (field, values) in zip(panels.flat, shown):
        exponent = fields.power_of_ten(np.nanmax(np.abs(values), initial=0.0))
        values = values / 10.0 ** exponent
        lines, colors = view.lines(position, values, slopes)
        width = 0.8 * line_width(view.structure)
        add_lines(axes, grey @ view.plane.T, width=max(0.35 * width, 0.4), zorder=1)
        pieces = add_lines(axes, lines @ view.plane.T, colors, fields.color_scale(field, values), width, zorder=3)
        _finish_plane(axes, view, shown_points)
        axes.set_title(view.field_label(field, exponent) + ("" if np.any(values) else ": zero everywhere"))
        axes.label_outer()
        canvas.colorbar(pieces, ax=axes, shrink=0.8, pad=0.02, aspect=22)
    canvas.suptitle(view.title(step), fontsize=13)
    return canvas


def strip_figure(view, steps, field):
    """Some steps of the path side by side, all in one scale and one colour scale."""
    position = [view.position(step) for step in steps]
    values = [field.values(step, view.size) for step in steps]
    exponent = fields.power_of_ten(max(np.nanmax(np.abs(value), initial=0.0) for value in values))
    values = [value / 10.0 ** exponent for value in values]
    scale = fields.color_scale(field, np.concatenate(values))
    projected = view.everything @ view.plane.T
    wide = np.ptp(projected[:, 0]) > 1.6 * np.ptp(projected[:, 1])
    columns = min(3 if wide else 6, len(steps))
    rows = -(-len(steps) // columns)
    aspect = np.clip(np.ptp(projected[:, 1]) / (np.ptp(projected[:, 0]) or 1.0), 0.25, 2.2)
    panel = 13.0 / max(columns, 3)
    canvas, panels = style.figure(panel * columns + 0.8, (panel * aspect + 0.5) * rows + 0.4, rows, columns,
                                  squeeze=False, sharex=True, sharey=True)
    canvas.get_layout_engine().set(h_pad=0.1)  # inches; the title has a root, which is measured too low
    for axes in panels.flat[len(steps):]:
        axes.set_visible(False)
    grey, _ = view.lines(view.structure.reference)
    for axes, step, points, value in zip(panels.flat, steps, position, values):
        lines, colors = view.lines(points, value, tangents(points, view.structure.starts))
        width = 0.8 * line_width(view.structure)
        add_lines(axes, grey @ view.plane.T, width=max(0.35 * width, 0.4), zorder=1)
        pieces = add_lines(axes, lines @ view.plane.T, colors, scale, width, zorder=3)
        _finish_plane(axes, view)
        axes.label_outer()
        axes.set_title(f"load factor {step.load_factor:.4g}")
    canvas.colorbar(pieces, ax=list(panels.flat), shrink=0.9, pad=0.01, aspect=12 * rows)
    canvas.suptitle(f"{view.scene_words}: {view.field_label(field, exponent)}"
                    + ("" if any(np.any(value) for value in values) else ": zero everywhere"), fontsize=13)
    return canvas


def strip_steps(steps):
    """At most STRIP_STEPS steps, evenly spread over the path, the last one among them."""
    numbers = np.unique(np.linspace(0, len(steps) - 1, min(STRIP_STEPS, len(steps))).round().astype(int))
    return [steps[i] for i in numbers]


def _draw_marks(view, panels, position, step, shrunk):
    """What acts, in both panels; returns the words for the caption and where marks end in the plane."""
    marks = Marks(view.run, step, view.structure.reference)
    for axes, projection in zip(panels, (np.eye(3), view.plane)):
        if axes is None:
            continue
        size = np.linalg.norm(np.ptp(position, axis=0)) if shrunk and axes.name == "3d" else view.size
        words, tips = draw_marks(axes, marks, position @ projection.T / view.unit, projection, MARK_SHARE * size / view.unit)
    return words, tips


def _draw_triads(view, axes, step, position):
    count = min(MOST_TRIADS, len(position))
    chosen = np.unique(np.linspace(0, len(position) - 1, count).round().astype(int))
    length = 0.06 * view.size / view.unit
    for i, color in enumerate(style.COMPONENT_COLORS, start=1):
        direction = step.field(f"triad_{i}")[chosen]
        start = position[chosen] / view.unit
        add_lines(axes, np.stack([start, start + length * direction], axis=1), color=color, width=1.2, zorder=4)


def _name_axes_3d(axes, view):
    width, depth, height = axes.get_xlim3d(), axes.get_ylim3d(), axes.get_zlim3d()
    is_tall = np.ptp(height) > TALL * max(np.ptp(width), np.ptp(depth))
    if is_tall:
        axes.tick_params(axis="z", pad=8)
    for i, name in enumerate("xyz"):
        getattr(axes, f"set_{name}label")(f"${name}$" + fields.times(view.exponent, view.run.units[0]), labelpad=(9, 9, 34 if is_tall else 4)[i])


def _finish_plane(axes, view, points=None, tips=()):
    projected = (view.everything if points is None else points) @ view.plane.T / view.unit
    projected = np.vstack([projected, *tips])
    low, high = projected.min(axis=0), projected.max(axis=0)
    extent = high - low
    margin = 0.06 * (extent.max() or 1.0)
    half = np.maximum(extent / 2 + margin, 0.12 * (extent.max() or 1.0))
    center = (low + high) / 2
    axes.set(xlim=(center[0] - half[0], center[0] + half[0]), ylim=(center[1] - half[1], center[1] + half[1]))
    axes.set_aspect("equal")
    axes.locator_params(axis="x", nbins=5)
    axes.locator_params(axis="y", nbins=5)
    axes.set(xlabel=view.axis_label(view.plane[0]), ylabel=view.axis_label(view.plane[1]))
    if view.look.from_camera:  # neither direction is one of the scene
        axes.set(xticks=[], yticks=[])
