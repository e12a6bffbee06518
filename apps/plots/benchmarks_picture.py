#!/usr/bin/python3 -Es
"""The picture of apps/docs/verification.md: four figures of the benchmarks, two in a row.

    benchmarks_picture.py RESULTS OUTPUT.png
"""

import argparse
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (after the back end is chosen)

ROWS = [
    [("superimposed_rotation/snapshots.png", "objectivity: a bent rod turned ten times"),
     ("helix/shapes.png", "helix: exact tip with 5 and 3 elements")],
    [("slope_discontinuity/configurations.png", "kinked frame under growing load"),
     ("fork/shapes.png", "fork under one force and under a couple")],
]
WIDTH, TITLE = 14.0, 0.5  # inches


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("results", type=pathlib.Path)
    parser.add_argument("output", type=pathlib.Path)
    arguments = parser.parse_args()
    try:
        rows = [[(plt.imread(arguments.results / name), title) for name, title in row] for row in ROWS]
    except OSError as error:
        sys.exit(f"benchmarks_picture.py: {error}")
    # the figures of a row have one height, and fill the width together
    aspects = [[image.shape[1] / image.shape[0] for image, _ in row] for row in rows]
    heights = [WIDTH / sum(row) + TITLE for row in aspects]
    canvas = plt.figure(figsize=(WIDTH, sum(heights)))
    bottom = 1.0
    for row, widths, height in zip(rows, aspects, heights):
        bottom -= height / sum(heights)
        left = 0.0
        for (image, title), width in zip(row, widths):
            share = width / sum(widths)
            panel = canvas.add_axes([left, bottom, share, (height - TITLE) / sum(heights)])
            panel.imshow(image, interpolation="lanczos")
            panel.set_title(title, fontsize=13)
            panel.axis("off")
            left += share
    canvas.savefig(arguments.output, dpi=80)


if __name__ == "__main__":
    main()
