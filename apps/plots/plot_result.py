#!/usr/bin/python3 -Es
"""Draws pictures of a result file, of the table of a batch, or of an unsolved scene."""

import argparse
import sys
from pathlib import Path

from command import finish

KINDS = {"shape": "members with their sections, deformed and undeformed, coloured by --field",
         "fields": "bending, torsion, axial force, shear and strains in the best plane",
         "section_forces": "N, Q2, Q3, T, M2, M3 over the arc length of the members",
         "diagrams": "the same drawn on the structure",
         "along": "with --along: N, Q2, Q3, T, M2, M3 of members in a row over their running length",
         "curve": "with --curve: one followed number over another",
         "envelope": "of SCENE.h5 beside those of its load cases: quantities over all of them; with --along their diagrams",
         "load_path": "monitored quantities over the load factor; with critical points: load factor over them",
         "critical_modes": "structure and mode at limit points, bifurcations and flutter points",
         "frequencies": "of natural modes in every step, over the load factor",
         "iterations": "Newton iterations and residuals",
         "steps": "several steps side by side"}
BY_DEFAULT = ("shape", "diagrams", "load_path")
TELLING = ("von_mises", "bending", "axial_force", "torsion", "displacement")  # the first field that does not vanish is shown
OF_ONE_STEP = ("shape", "fields", "section_forces", "diagrams", "along")
FEW_STEPS = 5   # a curve of at most so many points, including the origin, gets a note


def main():
    words = sys.argv[1:]
    for i, word in enumerate(words[:-1]):  # argparse would read a negative azimuth as an option
        if word == "--view":
            words[i:i + 2] = ["", f"--view={words[i + 1]}"]
    options = options_of([word for word in words if word])
    return finish("plot", options.result, lambda: _draw(options))


def options_of(words):
    """Parses a command line."""
    kinds = "; ".join(f"{name}: {text}" for name, text in KINDS.items())
    parser = argparse.ArgumentParser("mixbeam plot", description=__doc__, epilog=f"Pictures: {kinds}.")
    parser.add_argument("result", type=Path, help="result file (.h5), or a scene, of which the shape is drawn")
    parser.add_argument("-o", "--output", type=Path, metavar="FOLDER", help="default: beside the result file")
    parser.add_argument("--format", default="png", help="png, svg, pdf, separated by commas (default: png)")
    parser.add_argument("--step", default="last", metavar="N", help="number of a step, last (default) or all")
    parser.add_argument("--field", metavar="NAME", help="colour of shape and steps (default: von_mises where the step has it, else bending)")
    parser.add_argument("--case", metavar="NAME", help="load case: takes FILE-NAME.h5 beside FILE.h5")
    parser.add_argument("--picture", nargs="+", choices=KINDS, metavar="PICTURE", help=f"these only: {', '.join(KINDS)} (default: {', '.join(BY_DEFAULT)})")
    parser.add_argument("--triads", action="store_true", help="draw axes 1, 2, 3 of some sections in space")
    parser.add_argument("--view", metavar="VIEW", help="xy, xz, yz, iso or azimuth/elevation [degrees]; default: the best")
    parser.add_argument("--members", nargs="+", metavar="PATTERN", help="these members only; * stands for any characters, ? for one, [abc] for one of these")
    parser.add_argument("--scale", type=float, default=1.0, metavar="FACTOR", help="of displacements (default: 1)")
    parser.add_argument("--moments", choices=("tension", "compression", "left"), default="tension",
                        help="side on which diagrams of bending moments stand (default: tension)")
    parser.add_argument("--along", nargs="+", metavar="PATTERN", help="one diagram along these members, which form a path")
    parser.add_argument("--curve", nargs=2, metavar=("ORDINATE", "ABSCISSA"),
                        help="one followed number over another: names of Quantities, POINT.z of a followed point, "
                             "force:POINT.x, moment:, rotation:, load_factor")
    parser.add_argument("--dots", type=int, metavar="N", help="dots per inch of a PNG")
    return parser.parse_args(words)


def _draw(options):
    """Draws the requested pictures, and yields the paths of the files."""
    import style
    from results import InputError

    formats = [name.strip() for name in options.format.split(",") if name.strip()]
    if not formats or set(formats) - {"png", "svg", "pdf"}:
        raise InputError(f"--format {options.format}: allowed are png, svg, pdf, separated by commas")
    if options.dots:
        style.plt.rcParams["savefig.dpi"] = options.dots
    folder = options.output or options.result.parent
    for name, canvas in _pictures(options):
        folder.mkdir(parents=True, exist_ok=True)
        yield from style.save_all(canvas, folder / name, formats)


def _pictures(options):
    """Yields (name of its files, figure) of all requested pictures."""
    import batch_figures
    import envelope_figures
    from preview import is_scene, undeformed
    from results import Run

    if is_scene(options.result):
        with undeformed(options.result, options.case) as (files, said):
            for file in files:
                with Run(file, members=options.members) as run:
                    yield f"{file.stem}-shape", preview_figure(run, options, said)
    elif batch_figures.is_batch(options.result):
        yield options.result.stem, batch_figures.batch_figure(options.result, options.curve)
    elif not options.case and envelope_figures.is_envelope(options.result):
        for name, canvas in envelope_pictures(options):
            yield f"{options.result.stem}-{name}", canvas
    else:
        with Run(options.result, options.case, options.members) as run:
            for name, canvas in figures(run, options):
                yield f"{run.path.stem}-{name.replace('_', '-')}", canvas


def preview_figure(run, options, said):
    """Draws the shape of an unsolved scene."""
    import shape_figures
    from view import Look, View

    view = View(run, run.steps, Look(options.view))
    return shape_figures.shape_figure(view, run.steps[0], None, options.triads, said)


def envelope_pictures(options):
    """Yields (name, figure) of the requested pictures of an envelope file."""
    import envelope_figures
    from results import InputError
    from view import Look

    envelope = envelope_figures.Envelope(options.result)
    if options.picture and not set(options.picture) & {"envelope", "along"} or options.curve:
        cases = ", ".join(envelope.case(i) for i in range(len(envelope.runs)))
        raise InputError(f"{options.result}: holds the envelope of several runs; --case takes one of them ({cases}); "
                         "allowed without: --picture envelope, --along")
    if options.along:
        yield "along", envelope_figures.along_figure(envelope, options.along, Look())
    else:
        yield "envelope", envelope_figures.ranges_figure(envelope)


def figures(run, options):
    """Yields (name, figure) of every requested picture of an open run."""
    import numpy as np

    import fields
    from results import InputError
    from view import Look, View

    if options.field is not None and options.field not in fields.fields_of(run):
        raise InputError(f"--field {options.field}: allowed are " + ", ".join(fields.fields_of(run)))
    if not (np.isfinite(options.scale) and options.scale >= 0.0):
        raise InputError(f"--scale {options.scale:g}: allowed are numbers from 0 on; 1 is the true scale")
    if options.picture and "along" in options.picture and not options.along:
        raise InputError("--picture along: needs --along with the names of members")
    if options.picture and "curve" in options.picture and not options.curve:
        raise InputError("--picture curve: needs --curve with two names")
    chosen = _chosen_steps(run, options.step, run.path)
    view = View(run, chosen, Look(options.view, options.scale, options.moments))
    wanted = [kind for kind in ("along", "curve") if getattr(options, kind)]
    if options.picture == ["envelope"]:
        raise InputError(f"{run.path}: of one run; an envelope is in the file SCENE.h5 beside those of several load cases")
    for kind in options.picture or wanted or BY_DEFAULT:
        drawn = list(_figures(kind, run, view, chosen, options))
        if options.picture and not drawn:
            _note(f"--picture {kind}: nothing to show{_why_nothing(kind, run, options)}")
        yield from drawn
    if options.curve and len(run.steps) <= FEW_STEPS:
        _note(f"a curve of {len(run.steps)} points: a run takes as few load steps as it can; \"Maximum Step\" in "
              "\"Solver\" / \"Load Path\" of the scene, 0.05 say, gives more")


def _why_nothing(kind, run, options):
    if kind == "steps" and len(run.steps) > 1:
        return f" of {options.field or 'the field'} in every step; for stresses: \"Stresses\" = \"every step\" in \"Analysis\" of the scene"
    return {"critical_modes": ", no critical point was met", "frequencies": "; \"Modes\" with \"At\" = \"every step\" gives them", "load_path": " of a single step",
            "steps": " of a single step"}.get(kind, "")


def _figures(kind, run, view, chosen, options):
    """Yields (name, figure) of every picture of a kind; none if the file has no data for it."""
    import along_figures
    import critical_figures
    import diagram_figures
    import fields
    import path_figures
    import shape_figures
    from view import View

    field = fields.fields_of(run)[options.field or _telling_field(view, chosen[-1])]
    if kind in OF_ONE_STEP:
        draw = {"shape": lambda step: shape_figures.shape_figure(view, step, field, options.triads),
                "fields": lambda step: shape_figures.overview_figure(view, step),
                "section_forces": lambda step: diagram_figures.over_arc_length_figure(view, step),
                "diagrams": lambda step: diagram_figures.on_structure_figure(view, step),
                "along": lambda step: along_figures.along_figure(view, step, options.along)}[kind]
        for step in chosen:
            yield kind if options.step == "last" else f"{kind}-{step.number:06d}", draw(step)
    elif kind == "critical_modes":
        points = run.critical_points()
        if points:
            yield kind, critical_figures.modes_figure(view, points)
    elif kind == "frequencies":
        vibrating = [step for step in run.steps if step.natural_modes()]
        if len(vibrating) > 1:
            yield kind, path_figures.frequencies_figure(view, vibrating)
    elif kind == "curve" and options.curve:
        yield kind, path_figures.curve_figure(view, *options.curve)
    elif kind == "iterations":
        yield kind, path_figures.iteration_figure(view)
    elif len(run.steps) > 1 and kind == "load_path":
        yield kind, path_figures.load_displacement_figure(view)
    elif kind == "steps" and len(run.steps) > 1 and all(step.has(field.source) for step in shape_figures.strip_steps(run.steps)):
        shown = shape_figures.strip_steps(run.steps)
        yield kind, shape_figures.strip_figure(View(run, shown, view.look), shown, field)


def _telling_field(view, step):
    import fields

    of_step = [name for name in TELLING if step.has(fields.FIELDS[name].source)]
    return next((name for name in of_step if fields.FIELDS[name].values(step, view.size).any()), "bending")


def _chosen_steps(run, wanted, path):
    from results import InputError

    if wanted == "all":
        return run.steps
    if wanted == "last":
        return run.steps[-1:]
    steps = {str(step.number): step for step in run.steps}
    if wanted not in steps:
        raise InputError(f"{path}: no step {wanted}; it has steps {run.steps[0].number} to {run.steps[-1].number}")
    return [steps[wanted]]


def _note(text):
    print(f"mixbeam plot: note: {text}", file=sys.stderr)


if __name__ == "__main__":
    sys.exit(main())
