"""Figures of the arc segment under an out-of-plane force."""

import numpy as np

import convergence
import style
from results import Run
from tables import read_table

SLENDERNESS = (10, 100, 1000)


def convergence_figure(folder):
    """Draws the error against the finest solution for three slendernesses."""
    table = read_table(folder / "convergence.csv")
    chosen = table.values("slenderness")
    canvas, axes = style.figure(3.7 * len(chosen) + 0.4, 4.2, 1, len(chosen), sharey=True, squeeze=False)
    for panel, rho in zip(axes[0], chosen):
        rows = table.where(slenderness=rho)
        convergence.panel(panel, rows, f"$\\rho={rho:g}$", rate=convergence.optimal)
    axes[0, 0].set_ylabel(r"error $\mathrm{err}_{L^2}$ of the displacement, relative to $R$")
    axes[0, 0].legend(loc="lower left")
    return canvas


def shapes_figure(folder):
    """Draws the undeformed and deformed configuration for three slendernesses."""
    canvas, panels = style.figure_3d(12, 4.6, columns=len(SLENDERNESS))
    for axes, rho in zip(panels, SLENDERNESS):
        with Run(folder / f"single_rho{rho}.h5") as run:
            reference, position = run.reference(), run.steps[-1].field("position")
        style.line_3d(axes, reference, color=style.GREY, linewidth=2.5, label="undeformed")
        style.line_3d(axes, position, color=style.BLUE, linewidth=2.5, label="deformed")
        axes.plot(*reference[0], "s", color=style.BLACK, markersize=6, label="clamped end")
        style.equal_axes_3d(axes, np.vstack([reference, position]), ticks=4)
        axes.set_title(f"$\\rho={rho}$")
    style.legend_below_3d(canvas, panels[0], 0.08)
    return canvas
