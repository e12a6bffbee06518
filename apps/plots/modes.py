"""Figure of the study of natural modes."""

import convergence
import style
from tables import read_table

SHOWN = (("cantilever", "bending 1"), ("cantilever", "bending 3"))


def convergence_figure(folder):
    """Relative error of the squared frequency over the number of elements."""
    table = read_table(folder / "convergence.csv", ["case", "mode", "order", "elements", "error"])
    canvas, axes = style.figure(9.5, 4.6, 1, len(SHOWN), sharey=True)
    for panel, (case, mode) in zip(axes, SHOWN):
        rows = table.where(case=case, mode=mode)
        convergence.panel(panel, rows, f"{case}, {mode}", "error")
        convergence.slope_triangles(panel, rows, "error", rate=lambda order: 2 * order)
        panel.tick_params(axis="y", labelleft=True)
    axes[0].set_ylabel(r"relative error of $\omega^2$, rate $2k$")
    axes[1].legend(ncol=2, loc="lower left")
    return canvas


FIGURES = {"convergence": (["convergence.csv"], convergence_figure)}
