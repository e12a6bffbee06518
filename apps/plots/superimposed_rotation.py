"""Figures of the superimposed rotation of a deformed cantilever."""

import numpy as np

import style
from results import Run
from tables import read_table

BENT = 1.0  # load factor at which the cantilever is bent and the rotation begins


def deviation_figure(folder):
    """Draws the deviation of the tip displacement and of the energy from the state before the rotation."""
    table = read_table(folder / "deviation.csv").sorted_by("rotation")
    canvas, axes = style.figure(8.5, 4.8, 2, 1, sharex=True)
    turns = table["rotation"] / (2 * np.pi)
    labels = (r"$\Delta u_3 \, / \, L$", r"$\Delta\overline{\Phi}_\kappa \, / \, \overline{\Phi}_\kappa$")
    for panel, name, label, color in zip(axes, ("relative_u3", "relative_energy"), labels, (style.BLUE, style.RED)):
        panel.plot(turns, table[name], "o-", color=color, markersize=3.5, linewidth=1)
        panel.axhline(0.0, color=style.BLACK, linewidth=0.8)
        panel.set_ylabel(label)
        panel.ticklabel_format(axis="y", style="sci", scilimits=(0, 0), useMathText=True)
        largest = np.abs(table[name]).max()
        panel.set_title(f"largest deviation {largest:.1e}", loc="right", fontsize=11)
    axes[-1].set_xlabel(r"prescribed rotation $\psi_3 \, / \, 2\pi$")
    axes[-1].set_xticks(np.arange(0, np.floor(turns.max() + 0.5) + 1))
    return canvas


def snapshots_figure(folder):
    """Draws the bent cantilever before the rotation (left) and at all its increments (right)."""
    with Run(folder / "single.h5") as run:
        canvas, (before, during) = style.figure_3d(11, 4.8, columns=2)
        bent = run.step_at(BENT)
        turning = [step for step in run.steps if step.load_factor >= BENT]
        reference = run.reference()
        style.line_3d(before, reference, color=style.GREY, linewidth=2.5, label="undeformed")
        style.line_3d(before, bent.field("position"), color=style.BLUE, linewidth=2.5, label="bent by the tip moment")
        before.set_title("before the rotation")
        style.legend_below_3d(canvas, before, 0.08)
        everything = [reference]
        for i, step in enumerate(turning):
            everything.append(step.field("position"))
            style.line_3d(during, everything[-1], color=style.blend(i / max(1, len(turning) - 1)), linewidth=1.1)
        tips = np.array([points[-1] for points in everything[1:]])
        during.plot(*tips.T, "o", color=style.BLACK, markersize=2.5, label="tip")
        during.set_title(f"{len(turning) - 1} increments of rotation, from red to blue; dots: tip")
        style.equal_axes_3d(before, np.vstack([reference, bent.field("position")]), ticks=4)
        style.equal_axes_3d(during, np.vstack(everything), ticks=4)
        return canvas
