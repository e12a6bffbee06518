"""Figure of the study of gradients."""

import convergence
import style
from tables import read_table

SHOWN = (1, 10)


def convergence_figure(folder):
    """Error of the derivatives of the end of an elastica over the number of elements."""
    table = read_table(folder / "convergence.csv", ["alpha", "by", "order", "elements", "error"])
    canvas, axes = style.figure(9.5, 4.6, 1, len(SHOWN), sharey=True)
    for panel, alpha in zip(axes, SHOWN):
        rows = table.where(alpha=alpha, by="compliance")
        convergence.panel(panel, rows, f"$P L^2 / EI = {alpha}$", "error")
        convergence.slope_triangles(panel, rows, "error", rate=lambda order: 2 * order)
        panel.tick_params(axis="y", labelleft=True)
    axes[0].set_ylabel(r"error of derivatives by $P L^2 / EI$, rate $2k$")
    axes[1].legend(ncol=2, loc="lower left")
    return canvas


FIGURES = {"convergence": (["convergence.csv"], convergence_figure)}
