#!/usr/bin/python3
"""Draws one result file: deformed against reference shape in space and in the best plane, coloured by bending moment."""

import argparse
import sys
from pathlib import Path

import numpy as np


def best_plane(points):
    """Two orthonormal directions that span the plane in which `points` spread most."""
    _, _, directions = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)
    first, second = (_mostly_positive(direction) for direction in directions[:2])
    return np.array([first, second])


def _mostly_positive(direction):
    return direction * np.copysign(1.0, direction[np.argmax(np.abs(direction))])


def axis_name(direction):
    """"$x_1$" for a coordinate direction, its components otherwise."""
    nearest = int(np.argmax(np.abs(direction)))
    if abs(direction[nearest]) > 1 - 1e-9:
        return f"$x_{nearest + 1}$"
    return "(" + ", ".join(f"{component:.2f}" for component in direction) + r")$\cdot\mathbf{x}$"


def result_figure(run, step):
    """Left in space, right in the best plane of undeformed and deformed shape together."""
    import matplotlib
    from mpl_toolkits.mplot3d.art3d import Line3DCollection

    import style

    points = np.vstack([run.reference(), step.field("position")])
    plane = best_plane(points)
    canvas, (space, flat) = _panels(style)
    bending = np.linalg.norm(step.field("material_moment")[:, 1:], axis=1)
    scale = matplotlib.colors.Normalize(0.0, max(bending.max(), 1e-300))
    for member in run.members:
        reference, position = member.reference_position, step.field("position", member)
        style.line_3d(space, reference, color=style.GREY, linewidth=1.2)
        flat.plot(*(plane @ reference.T), color=style.GREY, linewidth=1.2)
        options = {"cmap": "viridis", "norm": scale, "linewidth": 3, "capstyle": "round"}
        values = bending[member.samples]
        values = (values[1:] + values[:-1]) / 2
        for axes, curve, kind in ((space, position, Line3DCollection),
                                  (flat, position @ plane.T, matplotlib.collections.LineCollection)):
            pieces = kind(np.stack([curve[:-1], curve[1:]], axis=1), **options)
            pieces.set_array(values)
            axes.add_collection(pieces)
    style.equal_axes_3d(space, points)
    _finish_plane(flat, points @ plane.T, plane)
    canvas.colorbar(pieces, ax=flat, shrink=0.8, pad=0.03, label=r"bending moment $\sqrt{M_2^2+M_3^2}$")
    flat.set_title(f"{run.scene_name}, step {step.number}, load factor {step.load_factor:g}; grey: undeformed")
    return canvas


def _panels(style):
    canvas = style.plt.figure(figsize=(12, 5.2), constrained_layout=False)
    space = canvas.add_axes((0.0, 0.04, 0.44, 0.86), projection="3d")
    return canvas, (space, canvas.add_axes((0.54, 0.14, 0.44, 0.74)))


def _finish_plane(flat, projected, plane):
    center = (projected.max(axis=0) + projected.min(axis=0)) / 2
    extent = projected.max(axis=0) - projected.min(axis=0)
    half = 0.54 * np.maximum(extent, 0.25 * (extent.max() or 1.0))
    flat.set(xlim=(center[0] - half[0], center[0] + half[0]), ylim=(center[1] - half[1], center[1] + half[1]))
    flat.set_aspect("equal")
    flat.set(xlabel=axis_name(plane[0]), ylabel=axis_name(plane[1]))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("result", type=Path, help="result file (.h5)")
    parser.add_argument("--step", type=int, help="number of the step; default: the last one")
    parser.add_argument("--output", type=Path, help="picture (.png, .svg, .pdf); default: beside the result file")
    options = parser.parse_args()
    try:
        import style
        from results import InputError, Run
    except ImportError as error:
        return f"{error}; the Debian packages python3-matplotlib and python3-h5py hold what is needed"
    try:
        with Run(options.result) as run:
            steps = {step.number: step for step in run.steps}
            number = run.steps[-1].number if options.step is None else options.step
            if number not in steps:
                return f"{options.result}: no step {number}; it has {min(steps)} to {max(steps)}"
            print(style.save(result_figure(run, steps[number]), options.output or options.result.with_suffix(".png")))
    except (InputError, OSError, ValueError) as error:
        return str(error)
    return None


if __name__ == "__main__":
    sys.exit(main())
