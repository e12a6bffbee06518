"""Figure of the study of gradients."""

import convergence
from tables import read_table


def convergence_figure(folder):
    """Draws the error of derivatives at the end of an elastica over the number of elements."""
    table = read_table(folder / "convergence.csv")
    panels = [(table.where(alpha=alpha, by="compliance"), f"$P L^2 / EI = {alpha}$") for alpha in (1, 10)]
    return convergence.figure_of_vertices(panels, r"error of derivatives by $P L^2 / EI$, rate $2k$")
