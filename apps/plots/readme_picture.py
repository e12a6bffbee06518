#!/usr/bin/python3
"""The README's picture: four figures of the benchmarks side by side.

    readme_picture.py RESULTS OUTPUT.png
"""

import argparse
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (after the back end is chosen)

FIGURES = [
    ("superimposed_rotation/snapshots.png", "objectivity: a bent rod turned ten times"),
    ("helix/shapes.png", "helix: exact tip with 5 and 3 elements"),
    ("slope_discontinuity/configurations.png", "kinked frame under growing load"),
    ("fork/shapes.png", "fork under one force and under a couple"),
]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("results", type=pathlib.Path)
    parser.add_argument("output", type=pathlib.Path)
    arguments = parser.parse_args()
    canvas, axes = plt.subplots(2, 2, figsize=(14, 9))
    for panel, (name, title) in zip(axes.flat, FIGURES):
        try:
            panel.imshow(plt.imread(arguments.results / name), interpolation="lanczos")
        except OSError as error:
            sys.exit(f"readme_picture.py: {error}")
        panel.set_title(title, fontsize=13)
        panel.axis("off")
    canvas.tight_layout()
    canvas.savefig(arguments.output, dpi=80)


if __name__ == "__main__":
    main()
