#!/usr/bin/python3
"""Opens an XDMF time series with VTK's own reader and compares every point with values that the solver printed.

usage: read_with_vtk.py RESULTS.xdmf VALUES.csv

VALUES.csv: one row for each sample of each step, in their order; columns step, then x, y, z of position, displacement,
spatial_force, spatial_moment, triad_1, triad_2, triad_3. Exit code: 0 all agree, 1 they do not, 77 no reader installed.
"""

import csv
import sys

NO_READER = 77
FIELDS = ("displacement", "spatial_force", "spatial_moment", "triad_1", "triad_2", "triad_3")
# The files hold the solver's own bits; what is computed anew on the way (rotating material components) rounds.
TOLERANCE = 1e-13


def find_readers():
    """VTK's XDMF readers; Debian's python3-vtk9 is built without them, ParaView's VTK and most others have them."""
    readers = []
    for module, name in (("vtkIOXdmf2", "vtkXdmfReader"), ("vtkIOXdmf3", "vtkXdmf3Reader")):
        try:
            readers.append(getattr(__import__(f"vtkmodules.{module}", fromlist=[name]), name))
        except ImportError:
            continue
    return readers


def leaf(data):
    """The grid inside nested blocks."""
    while data is not None and data.IsA("vtkMultiBlockDataSet"):
        data = data.GetBlock(0)
    return data


def read_values(path):
    """step -> rows of numbers."""
    steps = {}
    with open(path, newline="") as file:
        rows = csv.reader(file)
        next(rows)
        for row in rows:
            steps.setdefault(float(row[0]), []).append([float(text) for text in row[1:]])
    return steps


def vectors_of(grid):
    arrays = [grid.GetPoints().GetData()] + [grid.GetPointData().GetArray(name) for name in FIELDS]
    missing = [name for name, array in zip(("points",) + FIELDS, arrays) if array is None]
    if missing:
        raise ValueError(f"point data are missing: {missing}")
    return [[x for array in arrays for x in array.GetTuple3(i)] for i in range(grid.GetNumberOfPoints())]


def largest_difference(expected, seen):
    if len(expected) != len(seen):
        raise ValueError(f"{len(seen)} points, expected {len(expected)}")
    scale = [max(1.0, max(abs(row[c]) for row in expected)) for c in range(len(expected[0]))]
    return max(abs(a - b) / s for row, other in zip(expected, seen) for a, b, s in zip(row, other, scale))


def compare(reader_class, xdmf, expected):
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline

    reader = reader_class()
    reader.SetFileName(xdmf)
    reader.UpdateInformation()
    times = reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS())
    if sorted(times or ()) != sorted(expected):
        raise ValueError(f"time steps {times}, expected {sorted(expected)}")
    worst = 0.0
    for time in times:
        reader.UpdateTimeStep(time)
        worst = max(worst, largest_difference(expected[time], vectors_of(leaf(reader.GetOutputDataObject(0)))))
    return worst


def main(xdmf, values):
    readers = find_readers()
    if not readers:
        print("no XDMF reader of VTK is installed")
        return NO_READER
    expected = read_values(values)
    worst = 0.0
    for reader in readers:
        difference = compare(reader, xdmf, expected)
        print(f"{reader.__name__}: {len(expected)} steps, largest difference {difference:.1e}")
        worst = max(worst, difference)
    return 0 if worst <= TOLERANCE else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:3]))
