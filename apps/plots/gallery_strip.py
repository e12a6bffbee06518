#!/usr/bin/python3 -Es
"""The README's strip of the gallery: scenes of apps/gallery, deformed (blue) and undeformed (grey), without axes.

    gallery_strip.py RESULTS OUTPUT.png     reads RESULTS/gallery/<scene>/<scene>.h5, as run.sh leaves them
"""

import argparse
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (after the back end is chosen)
import numpy as np  # noqa: E402

from results import InputError, Run  # noqa: E402

# scene: the directions that point to the right and up in the picture, and the share of the load factor that is shown
OBLIQUE = ((0.8, 0.6, 0.0), (-0.25, 0.33, 0.91))
SCENES = {
    "tree": (OBLIQUE, 1.0),
    "gripper": (OBLIQUE, 1.0),
    "deployable_ring": (((1, 0, 0), (0, 1, 0)), 0.625),
    "honeycomb": (((1, 0, 0), (0, 1, 0)), 1.0),
    "coil_spring": (OBLIQUE, 1.0),
    "star_dome": (OBLIQUE, 1.0),
    "lees_frame": (((1, 0, 0), (0, 1, 0)), 1.0),
}


def lines_of(run, share, plane):
    """For each member its undeformed and its deformed points in the plane, (samples, 2)."""
    step = run.step_at(share * run.steps[-1].load_factor)
    axes = np.array(plane).T
    for member in run.members:
        yield member.reference_position @ axes, step.field("position", member) @ axes


def draw(panel, path, plane, share):
    with Run(path) as run:
        for undeformed, deformed in lines_of(run, share, plane):
            panel.plot(*undeformed.T, color="0.8", linewidth=0.7, zorder=1)
            panel.plot(*deformed.T, color="tab:blue", linewidth=1.3, zorder=2)
    panel.set_aspect("equal")
    panel.axis("off")
    panel.set_title(path.stem.replace("_", " "), fontsize=9, color="0.3")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("results", type=pathlib.Path)
    parser.add_argument("output", type=pathlib.Path)
    arguments = parser.parse_args()
    canvas, panels = plt.subplots(1, len(SCENES), figsize=(13, 2.4))
    for panel, (name, (plane, share)) in zip(panels, SCENES.items()):
        try:
            draw(panel, arguments.results / "gallery" / name / f"{name}.h5", plane, share)
        except (InputError, KeyError) as error:
            sys.exit(f"gallery_strip.py: {name}: {error}")
    canvas.tight_layout()
    canvas.savefig(arguments.output, dpi=90)


if __name__ == "__main__":
    main()
