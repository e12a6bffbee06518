"""Figures of the fork structure."""

import numpy as np

import convergence
import style
from results import Run
from tables import read_table

POINTS = (("p1", "$P_1$"), ("p2", "$P_2$"), ("pb", "$P_B$"))
TIPS = (np.array([2.0, 1.0, 0.0]), np.array([2.0, -1.0, 0.0]))  # P1 and P2 undeformed
FORCES = (1.0, -1.0)  # signs of the forces along x3
STAGES = ((0, "(0) unloaded"), (1, "(1) force at $P_1$"), (2, "(2) force couple"))


def load_displacement_figure(folder):
    """Draws displacements of both tines and of the branching point, for both orders of loading."""
    table = read_table(folder / "load_displacement.csv")
    canvas, axes = style.figure(12, 4.4, 1, 3, sharey=True)
    for panel, (point, title) in zip(axes, POINTS):
        for path, dashes, width in (("forward", "-", 2.0), ("reverse", (0, (3, 2)), 1.6)):
            rows = table.where(path=path).sorted_by("load_factor")
            for i, color in enumerate(style.COMPONENT_COLORS, start=1):
                panel.plot(rows["load_factor"], rows[f"{point}_u{i}"], color=color, linestyle=dashes, linewidth=width,
                           label=f"$u_{i}$" + (", reversed" if path == "reverse" else ""))
        panel.set(title=title, xlabel=r"load factor (1: first force, 2: both)")
        panel.axvline(1.0, color=style.GREY, linewidth=0.8)
    axes[0].set_ylabel("displacement $u_i \\, / \\, L$")
    handles, labels = axes[0].get_legend_handles_labels()
    axes[-1].legend(handles, labels, ncol=2, loc="upper left")
    low, high = axes[0].get_ylim()
    axes[0].set_ylim(low, high + 0.1 * (high - low))
    return canvas


def shapes_figure(folder):
    """Draws the undeformed structure, one force, the force couple; arrows are the forces."""
    with Run(folder / "single.h5") as run:
        reference = [member.reference_position for member in run.members]
        shapes = [reference] + [[run.step_at(stage).field("position", member) for member in run.members]
                                for stage in (1, 2)]
    ends = np.vstack(reference)
    tips = [int(np.argmin(np.linalg.norm(ends - tip, axis=1))) for tip in TIPS]
    canvas, panels = style.figure_3d(13, 4.9, columns=3)
    limits = np.vstack([np.vstack(shape) for shape in shapes])
    for axes, shape, (stage, title) in zip(panels, shapes, STAGES):
        for lines, options in ((reference, {"color": style.GREY, "linewidth": 1.2}),
                               (shape, {"color": style.BLUE, "linewidth": 2.6})):
            for line in lines:
                style.line_3d(axes, line, **options)
        positions = np.vstack(shape)
        for tip, sign in list(zip(tips, FORCES))[:stage]:
            axes.quiver(*positions[tip], 0, 0, sign * 0.8, color=style.RED, linewidth=2, arrow_length_ratio=0.3)
        style.equal_axes_3d(axes, np.vstack([limits, limits + [0, 0, 0.4], limits - [0, 0, 0.4]]), ticks=4, zoom=1.0)
        axes.view_init(elev=24, azim=-52)
        axes.set_title(title)
    return canvas


def convergence_figure(folder):
    """Draws the mean error over the fork for each representation of the semicircle, and that of a vertex for the exact one."""
    table = read_table(folder / "convergence.csv")
    exact, polygon = (table.where(representation=name) for name in ("exact arc", "polygon"))
    panels = ((exact, "error", "exact semicircle, mean over the fork", convergence.optimal),
              (polygon, "error", "polygon, mean over the fork: slope 2", lambda order: 2),
              (exact, "p1_error", "exact semicircle, at $P_1$", lambda order: 2 * order))
    canvas, axes = style.figure(13, 4.4, 1, len(panels), sharey=True)
    for panel, (rows, error, title, rate) in zip(axes, panels):
        convergence.panel(panel, rows, title, error, rate)
    axes[0].set_ylabel("error of the displacement, relative to $L$")
    axes[0].legend(loc="lower left")
    return canvas
