"""Figure of the helix experiment."""

import numpy as np

import style
from results import Run

RADIUS, HEIGHT, COILS = 10.0, 50.0, 2.0  # of the exact helix, as the paper has it


def exact_helix(points=400):
    angle = np.linspace(0.0, 2 * np.pi * COILS, points)
    return np.column_stack([RADIUS * np.sin(angle), -RADIUS * np.cos(angle), HEIGHT * angle / angle[-1]])


def shapes_figure(folder):
    """Center lines of two very coarse meshes against the exact helix."""
    canvas, panels = style.figure_3d(8.4, 5.8, columns=2)
    for axes, order in zip(panels, (1, 3)):
        exact = exact_helix()
        style.line_3d(axes, exact, color=style.GREY, linewidth=4, alpha=0.6, label="exact helix")
        with Run(folder / f"order{order}.h5") as run:
            everything, elements = [exact], 0
            for member in run.members:
                position = run.steps[-1].field("position", member)
                vertices = position[member.vertices()]
                elements += len(vertices) - 1
                style.line_3d(axes, position, color=style.BLUE, linewidth=2, label="computed")
                axes.plot(*vertices.T, "o", color=style.RED, markersize=5, label="vertices")
                everything.append(position)
        style.equal_axes_3d(axes, np.vstack(everything))
        axes.set_title(f"{elements} elements of order $k={order}$")
    style.legend_below_3d(canvas, panels[0], 0.06)
    return canvas


FIGURES = {"shapes": (["order1.h5", "order3.h5"], shapes_figure)}
