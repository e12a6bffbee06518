"""Picture of the table of `mixbeam batch`: curves over one parameter, maps over two, bars of structures."""

import csv

import numpy as np

import fields
import style
from command import inputs
from results import InputError
from tables import number_of

MOST_PANELS = 9
STRUCTURES = "structures"  # abscissa of panels with a bar for each structure
ENDING = "-batch"
OF_STRUCTURES = {"structure", "load case"}  # columns of text in a batch over the scenes of a folder
PLACES = (".member", ".arc_length", ".side")  # endings of columns with the places of extremes
OF_SOLVER = "iterations"  # first of the columns on the solution of a case


def is_batch(path):
    return path.stem.endswith(ENDING) and path.suffix in (".h5", ".csv")


class Batch:
    """Table of a batch. `parameters`, `followed`: columns that vary, {name: (cases,)}, nan if a case has no number;
    `structures`: names of the cases of a folder; empty: cases of one scene."""

    def __init__(self, path):
        table = path.with_suffix(".csv")
        inputs.add(table)
        try:
            with open(table, encoding="utf-8", errors="replace", newline="") as file:
                rows = list(csv.reader(line for line in file if not line.startswith("#")))
        except OSError as error:
            raise InputError(f"{table}: {error.strerror}") from None
        names = rows[0] if rows else []
        if len(rows) < 2 or names[0] != "case" or OF_SOLVER not in names or any(len(row) != len(names) for row in rows):
            raise InputError(f"{table}: not the table of a batch; allowed: what mixbeam batch has written")
        self.name, self.columns = table.stem.removesuffix(ENDING), {}
        self.structures = []
        if OF_STRUCTURES <= set(names):
            texts = [dict(zip(names, row)) for row in rows[1:]]
            self.structures = [", ".join(filter(None, (text[name] for name in sorted(OF_STRUCTURES, reverse=True)))) for text in texts]
        for number, name in enumerate(names[1:names.index(OF_SOLVER)], 1):
            if name not in OF_STRUCTURES:
                self.columns[name] = np.array([number_of(row[number]) for row in rows[1:]])
        varied = {name: values for name, values in self.columns.items() if len(set(values[np.isfinite(values)])) > 1}
        self.parameters = {name: values for name, values in varied.items() if "/" in name and not name.startswith("Expected/")}
        self.followed = {name: values for name, values in varied.items() if "/" not in name}

    def column(self, name):
        if name not in self.columns:
            raise InputError(f"--curve {name}: no column of the batch; allowed are {self.some_columns()}")
        return self.columns[name]

    def some_columns(self):
        few = 30
        return ", ".join(list(self.columns)[:few]) + (", ..." if len(self.columns) > few else "")


def batch_figure(path, curve=None):
    """Draws one column over another; by default all varying columns over the one or two parameters."""
    batch = Batch(path)
    if curve:
        panels = [(curve[0], curve[1], batch.column(curve[0]), batch.column(curve[1]))]
    elif batch.structures:
        panels = [(name, STRUCTURES, values, None) for name, values in batch.followed.items() if not name.endswith(PLACES)]
    elif len(batch.parameters) == 1:
        (across, x), = batch.parameters.items()
        panels = [(name, across, values, x) for name, values in batch.followed.items()]
    elif len(batch.parameters) == 2:
        panels = [(name, None, values, None) for name, values in batch.followed.items()]
    else:
        raise InputError(f"{path}: a batch over {len(batch.parameters)} parameters; allowed: one or two, or --curve with two of "
                         f"{batch.some_columns()}")
    if not panels:
        raise InputError(f"{path}: nothing that is followed changes from case to case")
    panels = panels[:MOST_PANELS]
    bars = max(np.count_nonzero(np.isfinite(panel[2])) for panel in panels) if batch.structures else 0
    canvas, all_axes = style.panels(len(panels), 3, 4.6 if len(panels) > 1 else 6.4, max(3.7, 0.5 + 0.2 * bars), (0.0, 0.5))
    for axes, (name, across, y, x) in zip(all_axes.flat, panels):
        if across is None:
            _draw_map(canvas, axes, batch, name, y)
        elif across == STRUCTURES:
            shown = np.flatnonzero(np.isfinite(y))
            axes.barh(range(len(shown)), y[shown], color=style.BLUE, gid="bars")
            axes.set_yticks(range(len(shown)), [style.literal(batch.structures[row]) for row in shown], fontsize=8)
            axes.set(xlabel=_words(name), ylim=(len(shown) - 0.5, -0.5))
            axes.locator_params(axis="x", nbins=5)
        else:
            order = np.argsort(x, kind="stable")
            axes.plot(x[order], y[order], "o-", markersize=3.5, color=style.BLUE, gid="curve")
            axes.set(xlabel=_words(across), ylabel=_words(name))
    count = len(next(iter(batch.columns.values())))
    canvas.suptitle(f"{style.literal(batch.name)}: batch of {count} cases", fontsize=13)
    return canvas


def _draw_map(canvas, axes, batch, name, values):
    """Draws a grid of cases as cells, scattered cases as points."""
    (across, x), (up, y) = batch.parameters.items()
    xs, ys = np.unique(x), np.unique(y)
    exponent, values = fields.scaled(values)
    if len(xs) * len(ys) == len(values):
        cells = np.full((len(ys), len(xs)), np.nan)
        cells[np.searchsorted(ys, y), np.searchsorted(xs, x)] = values
        drawn = axes.pcolormesh(xs, ys, cells, shading="nearest", cmap="viridis", gid="map")
    else:
        drawn = axes.scatter(x, y, c=values, cmap="viridis", gid="map")
    axes.set(xlabel=_words(across), ylabel=_words(up))
    axes.grid(False)
    canvas.colorbar(drawn, ax=axes, label=_words(name) + fields.times(exponent), pad=0.02)


def _words(name):
    """Returns the last two parts of the path of a parameter as a label."""
    return style.literal(", ".join(name.split("/")[-2:]))
