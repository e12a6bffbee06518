"""Figure of the sweeps to the limits."""

import numpy as np

import style
from results import read_table

COLUMNS = 4
LOWEST_ERROR = 1e-17  # where an error of zero is drawn
LINEAR = ("order", "element_turn", "element_turn_k1", "thrust")  # sweeps that do not span decades
LABELS = {
    "slenderness": "slenderness $L/a$", "stiffness_ratio": r"$EI/GI_t$", "unit_of_length": "unit of length",
    "unit_of_force": "unit of force", "elements": "elements, $k=2$", "length_ratio": "longest / shortest element",
    "turns": "turns of the rod", "load_steps": "load steps", "element_turn_k1": "radians per element, $k=1$",
    "element_turn": "radians per element", "angle": "angle in radians", "tip_force": "$FL^2/EI$", "order": "order $k$",
    "imperfection": "force across / thrust", "thrust": "thrust / Euler's load"}


def limits_figure(folder):
    """A panel for each sweep: error, what is promised, condition number times rounding, iterations (right)."""
    table = read_table(folder / "extremes.csv", ["sweep", "value", "converged", "iterations", "error", "allowed",
                                                 "condition"])
    sweeps = list(dict.fromkeys(table["sweep"]))  # in the order of the file
    rows = -(-len(sweeps) // COLUMNS)
    canvas, axes = style.figure(3.4 * COLUMNS, 2.7 * rows + 0.5, rows, COLUMNS, squeeze=False)
    for panel, sweep in zip(axes.flat, sweeps):
        counts = _panel(panel, table.where(sweep=sweep), sweep)
    for panel in axes.flat[len(sweeps):]:
        panel.axis("off")
    handles, labels = axes.flat[0].get_legend_handles_labels()
    more, names = counts.get_legend_handles_labels()
    free = axes.flat[len(sweeps)] if len(sweeps) < axes.size else axes.flat[-1]
    legend = free.legend(handles + more, labels + names, loc="upper left")
    legend.set_in_layout(False)  # it may reach over the free panels beside it
    return canvas


def _panel(axes, table, sweep):
    value, labels = _places(table["value"], sweep)
    good = table["converged"] == 1
    axes.semilogy(value, np.maximum(table["error"], LOWEST_ERROR), "o-", color=style.BLUE, label="error of the tip")
    axes.semilogy(value, table["allowed"], color=style.GREY, linestyle=(0, (4, 2)), label="promised")
    axes.semilogy(value[good], table["condition"][good] * np.finfo(float).eps / 2, color=style.GREEN, linewidth=1.0,
                  label="condition number x rounding")
    axes.plot(value[~good], np.full(np.count_nonzero(~good), 1.0), "X", color=style.RED, markersize=8,
              label="no equilibrium found")
    axes.set_ylim(LOWEST_ERROR / 3, 10)
    axes.set_yticks([1e-16, 1e-12, 1e-8, 1e-4, 1])
    if labels:
        axes.set_xticks(*labels)
    elif sweep not in LINEAR:
        axes.set_xscale("log")
    axes.set_title(LABELS.get(sweep, sweep))
    counts = axes.twinx()
    counts.plot(value[good], table["iterations"][good], ".", color=style.ORANGE, label="Newton iterations (right)")
    counts.set_yscale("log")
    counts.set_ylim(0.8, 5000)
    counts.grid(False)
    counts.spines["right"].set_visible(True)
    counts.tick_params(colors=style.ORANGE, labelsize=8.5)
    axes.set_zorder(counts.get_zorder() + 1)
    axes.patch.set_visible(False)
    return counts


def _places(values, sweep):
    """Where values are drawn, and ticks with labels where the axis is not one of plain numbers: infinity stands one
    decade beyond the largest value, and an angle of zero or 1e-300 would leave no room for the others."""
    if sweep == "angle":
        places = np.arange(len(values), dtype=float)
        return places, (places[::2], [f"{value:.0e}" if 0 < value < 0.01 else f"{value:.2g}" for value in values[::2]])
    if not np.isinf(values).any():
        return values, None
    finite = np.log10(values[np.isfinite(values)])
    places = np.append(finite, finite.max() + 1)
    shown = places[:-1:3]
    return places, (np.append(shown, places[-1]), [f"$10^{{{place:.0f}}}$" for place in shown] + [r"$\infty$"])


FIGURES = {"extremes": (["extremes.csv"], limits_figure)}
