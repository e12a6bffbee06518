"""Figures of the rod bent to a helical shape."""

import numpy as np

import style
from tables import read_table

ORDERS = (1, 2, 3, 4)
STRAIN_ORDERS = (1, 4)


def load_displacement_figure(folder):
    """Draws the tip position over the load factor."""
    table = read_table(folder / "load_displacement.csv")
    return style.components_figure(table, "load_factor", r"load factor $\lambda$", "r", "$r_{}(L)$", "tip position", "upper right")


def strains_figure(folder):
    """Draws force and moment strains along the axis for the lowest and the highest order."""
    canvas, axes = style.figure(10.5, 6.4, 2, 2, sharex=True, sharey="row")
    for column, order in enumerate(STRAIN_ORDERS):
        table = read_table(folder / f"strains_k{order}.csv")
        for row, (name, symbol) in enumerate((("gamma", r"\gamma"), ("kappa", r"\kappa"))):
            for i, (color, dashes) in enumerate(zip(style.COMPONENT_COLORS, style.COMPONENT_DASHES), start=1):
                axes[row, column].plot(table["s"], table[f"{name}{i}"], color=color, linestyle=dashes, linewidth=1.3,
                                       label=f"${symbol}_{i}$")
        axes[0, column].set_title(f"order $k={order}$")
        axes[1, column].set_xlabel("arc length $s$")
    axes[0, 0].set_ylabel("force strains")
    axes[1, 0].set_ylabel("moment strains (1/length)")
    for row in axes:
        low, high = row[1].get_ylim()
        row[1].set_ylim(low, high + 0.22 * (high - low))  # room for the legend
        row[1].legend(loc="upper right", ncol=3)
    return canvas


def shapes_figure(folder):
    """Draws the final centerlines for the four orders."""
    lines = {}
    for order in ORDERS:
        table = read_table(folder / f"shape_k{order}.csv")
        lines[order] = np.column_stack([table["x"], table["y"], table["z"]])
    canvas, panels = style.figure_3d(10, 8.4, columns=2, rows=2)
    for axes, order in zip(panels, ORDERS):
        style.line_3d(axes, lines[order], color=style.ORDER_COLORS[order], linewidth=1.2)
        style.equal_axes_3d(axes, np.vstack(list(lines.values())), ticks=4)
        axes.plot(*lines[order][0], "s", color=style.BLACK, markersize=5, label="clamped end")
        axes.plot(*lines[order][-1], "o", color=style.BLACK, markersize=5, label="loaded tip")
        axes.set_title(f"order $k={order}$")
    style.legend_below_3d(canvas, panels[0], 0.08)
    return canvas
