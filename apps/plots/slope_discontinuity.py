"""Figures of the structure with a slope discontinuity."""

import numpy as np

import style
from results import Run
from tables import read_table

SHAPES = 6  # at 0, 0.2, ..., 1 of the full load
PLANES = ((0, 2), (1, 2))  # of the side views: x1 x3 and x2 x3


def load_displacement_figure(folder):
    """Draws components of the tip displacement over the force."""
    table = read_table(folder / "load_displacement.csv").sorted_by("force")
    return style.components_figure(table, "force", "force $F$", "u", "$u_{}$", "tip displacement $u_i(3L) \\, / \\, L$", "lower left")


def configurations_figure(folder):
    """Draws configurations under growing load from three sides, with the path of the free end in finer steps."""
    with Run(folder / "single.h5") as run:
        last = run.steps[-1].load_factor
        shares = np.linspace(0.0, 1.0, SHAPES)
        shapes = [run.reference()] + [run.step_at(share * last).field("position") for share in shares[1:]]
        tip = run.reference()[-1]
    table = read_table(folder / "load_displacement.csv").sorted_by("force")
    path = tip + np.column_stack([table[f"u{i}"] for i in (1, 2, 3)])
    full = table["force"].max()
    canvas = style.plt.figure(figsize=(13, 4.6), constrained_layout=False)
    space = canvas.add_axes((0.0, 0.02, 0.32, 0.94), projection="3d")
    for share, shape in zip(shares, shapes):
        style.line_3d(space, shape, color=style.blend(share), linewidth=2, label=f"$F={full * share:g}$")
    style.line_3d(space, path, color=style.GREEN, linewidth=2, linestyle="--", label="path of the tip")
    style.equal_axes_3d(space, np.vstack(shapes), ticks=4)
    space.view_init(elev=22, azim=-60)
    for left, (first, second) in zip((0.405, 0.665), PLANES):
        flat = canvas.add_axes((left, 0.12, 0.21, 0.8))
        for share, shape in zip(shares, shapes):
            flat.plot(shape[:, first], shape[:, second], color=style.blend(share), linewidth=2)
        flat.plot(path[:, first], path[:, second], color=style.GREEN, linewidth=2, linestyle="--")
        flat.set_aspect("equal")
        flat.set(xlabel=f"$x_{first + 1}$", ylabel=f"$x_{second + 1}$")
    canvas.legend(*space.get_legend_handles_labels(), loc="center left", bbox_to_anchor=(0.87, 0.5))
    return canvas
