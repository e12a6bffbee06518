"""Figures of the helix experiment."""

import numpy as np

import convergence
import style
from results import Run
from tables import read_table

RADIUS, HEIGHT, COILS = 10.0, 50.0, 2.0  # of the exact helix, as in the paper


def exact_helix(points=400):
    angle = np.linspace(0.0, 2 * np.pi * COILS, points)
    return np.column_stack([RADIUS * np.sin(angle), -RADIUS * np.cos(angle), HEIGHT * angle / angle[-1]])


def shapes_figure(folder):
    """Draws centerlines of two very coarse meshes against the exact helix."""
    canvas, panels = style.figure_3d(8.4, 5.8, columns=2)
    exact = exact_helix()
    everything = [exact]
    for axes, order in zip(panels, (1, 3)):
        style.line_3d(axes, exact, color=style.GREY, linewidth=4, alpha=0.6, label="exact helix")
        with Run(folder / f"order{order}.h5") as run:
            elements = 0
            for member in run.members:
                position = run.steps[-1].field("position", member)
                vertices = position[member.vertices()]
                elements += len(vertices) - 1
                style.line_3d(axes, position, color=style.BLUE, linewidth=2, label="computed")
                axes.plot(*vertices.T, "o", color=style.RED, markersize=5, label="vertices")
                everything.append(position)
        axes.set_title(f"{elements} elements of order $k={order}$")
    for axes in panels:
        style.equal_axes_3d(axes, np.vstack(everything))  # the same scale in both
    style.legend_below_3d(canvas, panels[0], 0.06)
    return canvas


def convergence_figure(folder):
    """Draws the error between the vertices, and that of the vertices, over the number of elements."""
    table = read_table(folder / "convergence.csv")
    slenderness = table.values("slenderness")[0]
    table = table.where(slenderness=slenderness)
    canvas, axes = style.figure(9.5, 4.6, 1, 2, sharey=True)
    convergence.panel(axes[0], table, "centerline", rate=convergence.optimal)
    axes[0].set_ylabel(r"error $\mathrm{err}_{L^2}$ of the centerline, relative to $L$")
    convergence.panel(axes[1], table, "vertices, rate $2k$", "vertex_position")
    axes[1].set_ylabel("largest distance of a vertex, relative to $L$")
    for panel in axes:
        panel.tick_params(axis="y", labelleft=True)
    axes[0].legend(ncol=2, loc="lower left")
    canvas.suptitle(f"slenderness $\\rho={slenderness:g}$", fontsize=12)
    return canvas
