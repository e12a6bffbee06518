"""Figure of the study of natural modes."""

import convergence
from tables import read_table


def convergence_figure(folder):
    """Draws the relative error of the squared frequency over the number of elements."""
    table = read_table(folder / "convergence.csv")
    panels = [(table.where(case="cantilever", mode=mode), f"cantilever, {mode}") for mode in ("bending 1", "bending 3")]
    return convergence.figure_of_vertices(panels, r"relative error of $\omega^2$, rate $2k$")
