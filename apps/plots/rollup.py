"""Figures of the rod bent to a circle."""

import numpy as np

import convergence
import style
from results import InputError, Run
from tables import read_table

FULL_SLENDERNESS = (10, 100, 1000)
REDUCED_SLENDERNESS = 1000
REDUCED = (("axial reduced", "axial strain reduced"), ("shear reduced", "shear strains reduced"),
           ("both reduced", "all force strains reduced"))


def convergence_figure(folder):
    """Draws full integration at three slendernesses (above), reduced integration at the largest one (below)."""
    table = read_table(folder / "convergence.csv")
    canvas, axes = style.figure(11, 7.6, 2, 3, sharey=True)
    panels = [({"integration": "full", "slenderness": rho}, f"full integration, $\\rho={rho}$")
              for rho in FULL_SLENDERNESS]
    panels += [({"integration": name, "slenderness": REDUCED_SLENDERNESS}, f"{title}, $\\rho={REDUCED_SLENDERNESS}$")
               for name, title in REDUCED]
    for panel, (conditions, title) in zip(axes.flat, panels):
        rows = table.where(**conditions)
        if len(rows) == 0:
            raise InputError(f"{folder / 'convergence.csv'}: no rows with {conditions}")
        convergence.panel(panel, rows, title, rate=convergence.optimal if panel is axes[1, 2] else None)
    axes[0, 0].legend(*axes[1, 2].get_legend_handles_labels(), ncol=2, loc="lower left")
    for row in axes:
        row[0].set_ylabel(r"error $\mathrm{err}_{L^2}$ of the centerline, relative to $L$")
    return canvas


def shape_figure(folder):
    """Draws the undeformed rod and the double circle."""
    with Run(folder / "single.h5") as run:
        canvas, axes = style.figure(7.5, 2.9)
        reference, last = run.reference(), run.steps[-1]
        axes.plot(reference[:, 0], reference[:, 1], color=style.GREY, linewidth=3, label="undeformed")
        for member in run.members:
            position = last.field("position", member)
            vertices = position[member.vertices()]
            axes.plot(position[:, 0], position[:, 1], color=style.BLUE, linewidth=2.5, label="deformed")
            axes.plot(vertices[:, 0], vertices[:, 1], "o", color=style.BLUE, markerfacecolor="white",
                      label="vertices of the elements")
        axes.set_aspect("equal")
        low, high = np.vstack([reference, last.field("position")])[:, 1].min(), last.field("position")[:, 1].max()
        axes.set_ylim(low - 0.35 * (high - low), high + 0.45 * (high - low))
        axes.set(xlabel="$x_1$", ylabel="$x_2$")
        axes.legend(loc="upper right")
        return canvas
