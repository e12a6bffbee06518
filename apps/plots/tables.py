"""Reads the CSV tables that the applications write."""

import csv
from pathlib import Path

import numpy as np

from command import InputError, NothingToDraw


class Named(dict):
    """Columns or entries of a row by name. Raises InputError for a name that the file does not have."""

    def __missing__(self, name):
        raise InputError(f"column {name} missing; found {', '.join(self)}")


class Table:
    """Columns of a CSV file: arrays of float if every entry is a number, else arrays of str."""

    def __init__(self, columns):
        self._columns = Named(columns)

    def __getitem__(self, name):
        return self._columns[name]

    def __len__(self):
        return len(next(iter(self._columns.values())))

    def where(self, **conditions):
        """Returns the rows in which every named column equals the given value."""
        keep = np.ones(len(self), dtype=bool)
        for name, value in conditions.items():
            keep &= self[name] == value
        return Table({name: column[keep] for name, column in self._columns.items()})

    def sorted_by(self, name):
        order = np.argsort(self[name], kind="stable")
        return Table({key: column[order] for key, column in self._columns.items()})

    def names(self):
        """Returns the names of the columns, in their order."""
        return list(self._columns)

    def values(self, name):
        """Returns the distinct values of a column, ascending."""
        return np.unique(self[name])

    def rows(self):
        """Returns each row as a dictionary by column names."""
        return [Named(zip(self._columns, row)) for row in zip(*self._columns.values())]


def number_of(text):
    """Converts a text to float, nan if it is not a number."""
    try:
        return float(text)
    except ValueError:
        return np.nan


def read_table(path):
    """Reads a CSV file as a Table. Raises InputError unless it exists and has rows."""
    path = Path(path)
    if not path.is_file():
        raise NothingToDraw(f"no {path}")
    with open(path, newline="", encoding="utf-8") as stream:
        rows = list(csv.reader(stream))
    if len(rows) < 2:
        raise InputError(f"{path}: no rows")
    complete = [row for row in rows[1:] if len(row) == len(rows[0])]  # a killed run may leave a partial line
    if not complete:
        raise InputError(f"{path}: no complete rows")
    return Table({name: _column([row[i] for row in complete]) for i, name in enumerate(rows[0])})


def _column(texts):
    try:
        return np.array([float(text) for text in texts])
    except ValueError:
        return np.array(texts)
