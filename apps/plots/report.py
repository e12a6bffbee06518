#!/usr/bin/python3 -Es
"""One page about a run, to attach to a project: answers, inputs in words and tables, path, pictures, versions. The HTML file
is self-contained and printable; it links to the page of mixbeam view if that exists."""

import argparse
import csv
import hashlib
import json
import time
import sys
from pathlib import Path

import numpy as np

from command import finish, inputs
from html_page import MOST_ROWS, Page, bar, cell_text, page_beside
from report_inputs import write_inputs, write_sections
from tables import number_of

NOISE, ROUNDING = 1e-9, 1e-12  # of the largest: forces below count as zero, as in pictures; other values below are rounding
REPORT = "report / "  # prefix of the names of the list Report in the properties of a run


def main():
    parser = argparse.ArgumentParser("mixbeam report", description=__doc__)
    parser.add_argument("result", type=Path, help="result file (.h5)")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE.html", help="or a folder; default: beside the result file")
    parser.add_argument("--summary", type=Path, metavar="FILE.json", help="of mixbeam run --summary: adds its checks")
    options = parser.parse_args()
    return finish("report", options.result, lambda: _write(options))


def _write(options):
    """Writes the page, and yields its path."""
    from envelope_figures import envelope_beside, is_envelope
    from results import Run

    if options.summary:
        inputs.add(options.summary)
    if is_envelope(options.result):
        yield _write_envelope_page(options)
        return
    with Run(options.result) as run:
        page = _begun_page(run, run.title)
        _write_limits(page, [run.path])
        page.heading("Result")
        _write_answers(page, run)
        envelope = envelope_beside(run)
        if envelope:
            _write_envelope(page, envelope)
        _write_structure(page, run)
        page.heading("Inputs")
        write_inputs(page, run)
        if options.summary:
            _write_checks(page, json.loads(options.summary.read_text()))
        _write_pictures(page, run)
        page.heading("Scene and versions")
        page.table(("", ""), [(name, words) for name, words in sorted(run.properties().items())
                             if words and not name.startswith(REPORT)])
        page.folded("The scene, word for word", run.scene_text())
        path = _page_path(options)
        view = page_beside(path.parent / options.result.name, "view")
        if view.exists():
            page.link("The structure in the browser, to turn and to ask", view.name)
        page.write(path)
        yield path


def _begun_page(run, title):
    """Begins a page: title, project, author and date of the list Report; version and hash of the scene; contents."""
    words = {name[len(REPORT):]: text for name, text in run.properties().items() if name.startswith(REPORT) and text}
    page = Page(words.get("Title", title))
    page.title(words.get("Title", title))
    written = time.strftime("%Y-%m-%d %H:%M", time.localtime(run.path.stat().st_mtime))
    rows = [(name, words[name]) for name in ("Project", "Author", "Checked By", "Date", "Remarks") if name in words]
    if rows:
        page.table(("", ""), [("Scene", title), *rows])
    page.text(f"Results of {written}; mixbeam {run.properties()['version'].split()[0]}; SHA-256 of the scene "
              f"{hashlib.sha256(run.scene_text().encode()).hexdigest()[:16]}.")
    page.contents()
    return page


def _rows_beside(file, name):
    """Returns the rows of a table that a run has written beside its result file; [] if there is none."""
    path = file.with_name(f"{file.stem}-{name}.csv")
    if not path.exists():
        return []
    inputs.add(path)
    with path.open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def _places(file):
    """Returns {extreme: its place at the end}."""
    return {row["quantity"]: row["place at the end"] for row in _rows_beside(file, "places")}


def _write_limits(page, files):
    """Writes the limits from the tables beside the result files: failed ones first, then by decreasing share."""
    rows = []
    for file in files:
        places = sorted(_places(file).items(), key=lambda one: -len(one[0]))
        for row in _rows_beside(file, "limits"):
            of = row["limit"].partition(": size of ")[2]
            place = next((place for quantity, place in places if of.startswith(quantity)), "")
            rows.append((row["limit"], row["value"], row["allowed"], row["passed"], place))

    def used(row):
        share = number_of(row[1]) / (number_of(row[2]) or np.nan)
        return share if np.isfinite(share) else np.inf  # unknown

    if rows:
        rows.sort(key=lambda row: (row[3] == "yes", -used(row)))
        page.heading("Limits")
        failed = sum(row[3] != "yes" for row in rows)
        page.text(f"{failed} of {len(rows)} limits are exceeded." if failed else f"All {len(rows)} limits are kept.", bad=failed > 0)
        page.table(("limit", "value", "allowed", "place at the end", "share", "kept"),
                   [(name, cell_text(number_of(value)), cell_text(number_of(allowed)), place, bar(used((name, value, allowed)), kept != "yes"), kept)
                    for name, value, allowed, kept, place in rows])


def _page_path(options):
    own = page_beside(options.result, "report")
    path = options.output or own
    return path / own.name if path.is_dir() else path


def _write_envelope_page(options):
    """Writes the page of all load cases and combinations of a scene, and returns its path."""
    from envelope_figures import Envelope
    from results import Run

    envelope = Envelope(options.result)
    path, files = _page_path(options), envelope.files()
    with Run(files[0]) as run:
        page = _begun_page(run, f"{options.result.stem}: load cases and combinations")
    _write_limits(page, files)
    _write_envelope(page, envelope)
    page.heading("Runs")
    rows = []
    for file in files:
        with Run(file) as run:
            last = run.steps[-1]
            rows.append((run.case, run.properties().get("combination", ""), last.load_factor, {"false": "NO"}.get(last.stable, last.stable),
                         len(run.critical_points())))
    page.table(("run", "combination of", "load factor at its end", "stable", "critical points on the way"), rows)
    for file in files:
        if page_beside(path.parent / file.name, "report").exists():
            page.link(f"Report of {file.stem}", page_beside(file, "report").name)
    _write_worst(page, envelope)
    with Run(files[0]) as run:
        _write_structure(page, run)
        write_sections(page, run)
    for file in files:
        with Run(file) as run:
            page.heading(f"Case {run.case}")
            _write_case(page, run)
    if options.summary:
        _write_checks(page, json.loads(options.summary.read_text()))
    page.write(path)
    return path


def _write_case(page, run):
    """Writes one of several cases: answers, loads and the diagrams along its members."""
    import diagram_figures
    import style
    from view import Look, View

    _write_answers(page, run)
    write_inputs(page, run, of_case=True)
    page.picture(diagram_figures.over_arc_length_figure(View(run, [run.steps[-1]], Look()), run.steps[-1]),
                 "section forces and moments along members", style)


def _write_envelope(page, envelope):
    import envelope_figures
    import style

    page.heading("Envelope")
    page.text(f"Quantities at the ends of {len(envelope.runs)} runs: the smallest and the largest value, and where each is.")
    units = envelope.units()
    page.table(("quantity", "smallest", "in", "largest", "in", "unit"),
               [(*row, units.get(row[0], "")) for row in envelope.rows()])
    page.picture(envelope_figures.ranges_figure(envelope), "ranges of the quantities over all runs", style)


def _write_worst(page, envelope):
    """Draws the structure in the run in which the first quantity is largest."""
    from results import Run

    if not envelope.names:
        return
    worst = int(np.argmax(np.abs(envelope.values[:, 0])))
    page.heading(f"Worst case for {envelope.names[0]}: {envelope.case(worst)}")
    with Run(envelope.files()[worst]) as run:
        _write_shape(page, run)


def _write_answers(page, run):
    last = run.steps[-1]
    if run.properties().get("combination"):
        page.text(f"Combination {run.case} = {run.properties()['combination']}.")
    words = {"true": "stable", "false": "NOT STABLE: a real structure does not stay there", "neutral": "neutral",
             "unknown": "of unknown stability"}[last.stable]
    count = len(run.steps) - 1
    page.text(f"{count} load step{'s' * (count != 1)} to load factor {last.load_factor:.6g}; the last state is {words}.",
              bad=last.stable == "false")
    points = run.critical_points()
    if points:
        page.table(("critical point", "load factor", "negative eigenvalues before", "after"),
                   [(point.kind, point.load_factor, point.negative_before, point.negative_after) for point in points])
    factors = [factor for factor, _ in run.buckling_modes()]
    if factors:
        page.table(("linear buckling mode of the undeformed structure", "load factor"), list(enumerate(factors, 1)))
    for step in run.steps[1:]:
        factors = [factor for factor, _ in step.buckling_modes()]
        if factors:
            page.table((f"linear buckling mode about the end of stage {step.load_factor:.4g}", "factor of the loads of the next stage"),
                       list(enumerate(factors, 1)))
    for step in run.steps:
        roots = [mode["omega"] for mode in step.natural_modes()]
        if roots:
            page.table((f"natural mode about load factor {step.load_factor:.4g}", "omega", "omega / (2 pi)"),
                       [(number, root, root / (2 * np.pi)) for number, root in enumerate(roots, 1)])
    jumps = [(step.number, step.jump) for step in run.steps if step.jump]
    if jumps:
        page.text(f"{len(jumps)} jump{'s' * (len(jumps) > 1)} from a stable state to the next:")
        page.table(("jump in step", "load factor from", "to", "energy released", "mean motion over length",
                    "largest displacement", "at"),
                   [(number, *(float(jump[name]) for name in ("from", "to", "released", "motion", "largest")),
                     jump["place"]) for number, jump in jumps])
    sizes = [(float(size.max()), member, int(size.argmax())) for member in run.members
             for size in [np.linalg.norm(last.field("displacement", member), axis=1)] if size.size]
    if sizes:
        size, member, at = max(sizes, key=lambda one: one[0])
        page.text(f"Largest displacement {size:.4g} {run.units[0]} in member {member.name} at s = {member.arc_length[at]:.4g}.")
    quantities = run.quantities()
    members = [member.name for member in run.members]
    shown = [name for name in quantities if name.rpartition(".")[2] not in ("member", "arc_length", "side") or
             name.rpartition(".")[0] not in quantities]
    if shown:
        places = _places(run.path)

        def place(name):
            if f"{name}.member" not in quantities:
                return places.get(name, "")
            number = quantities[f"{name}.member"][-1]
            if not 0 <= number < len(members):
                return ""
            return f"{members[int(number)]} at s = {quantities[f'{name}.arc_length'][-1]:.4g}"

        def extremes(series):
            """Returns smallest and largest, ignoring the state before any load if undefined there, like a ratio of zeros."""
            known = series if np.isfinite(series[0]) or len(series) < 2 else series[1:]
            known = np.where(np.abs(known) < ROUNDING * np.abs(known).max(), 0.0, known)
            return float(known.min()), float(known.max())

        units, errors = run.quantity_units(), last.errors("quantities")
        page.table(("quantity", "at the end", "estimated error", "smallest", "largest", "unit", "where, at the end"),
                   [(name, float(quantities[name][-1]), errors.get(name, ("", "unknown"))[1], *extremes(quantities[name]),
                     units.get(name, ""), place(name)) for name in shown])
    moved = [(name[:-len(".displacement")], *map(float, values[-1])) for name, values in run.monitor().items()
             if name.endswith(".displacement") and values[-1].any()]
    if moved:
        page.table(("displacement of", "x", "y", "z"), moved)
    _write_reactions(page, run, last)
    _write_stresses(page, run, last)
    sections = last.errors("sections")
    if sections:
        page.table(("along all members", "value", "estimated error"), [(name, *one) for name, one in sections.items()])


def _write_reactions(page, run, step):
    points = run.supported_points()
    rows = step.reactions(len(points))
    for part in (rows[:, :3], rows[:, 3:]):
        part[np.abs(part) < NOISE * np.abs(part).max(initial=0.0)] = 0.0
    table = [(point, *map(float, row)) for point, row in zip(points, rows)]
    if len(table) > 1:
        total = rows[:, :3].sum(axis=0)
        total[np.abs(total) < NOISE * np.abs(rows[:, :3]).max()] = 0.0
        table.insert(0, ("all together", *map(float, total), "", "", ""))
    units = [f" [{unit}]" if unit else "" for unit in map(run.unit_of_kind, ("reaction_force", "reaction_moment"))]
    page.table(("reaction at", f"force x{units[0]}", "y", "z", f"moment x{units[1]}", "y", "z"), table)
    errors = step.balance_errors()
    page.text(f"Loads and reactions balance to {errors[0]:.1e} of the largest force and {errors[1]:.1e} of the largest moment at work.")


def _write_stresses(page, run, step):
    if not step.has("von_mises_stress"):
        return
    rows = []
    for member in run.members:
        stress = step.field("von_mises_stress", member)
        if np.isfinite(stress).any():
            at = int(np.nanargmax(stress))
            used = float(step.field("utilisation", member)[at]) if step.has("utilisation") else np.nan
            rows.append((member.name, float(stress[at]), float(member.arc_length[at]), used if np.isfinite(used) else ""))
    if rows:
        rows.sort(key=lambda row: (row[3] if row[3] != "" else -1.0, row[1]), reverse=True)
        largest, most = max(row[1] for row in rows), max(1.0, *(row[3] or 0.0 for row in rows))
        page.table(("member", "von Mises stress", "at s", "utilisation", "of its strength, or of the largest stress"),
                   [(*row, bar(row[3] / most, row[3] > 1.0) if row[3] != "" else bar(row[1] / largest)) for row in rows])
        used = [(row[3], row[0]) for row in rows if row[3] != "" and row[3] > 1.0]
        if used:
            page.text(f"Member {max(used)[1]} is stressed beyond the strength of its material: utilisation {max(used)[0]:.3g}.",
                      bad=True)


def _write_structure(page, run):
    page.heading("Structure")
    corners = np.array([run.reference().min(axis=0), run.reference().max(axis=0)])
    low, high = np.where(np.abs(corners) < ROUNDING * np.abs(corners).max(), 0.0, corners)
    box = " to ".join("(" + ", ".join(f"{x:.6g}" for x in corner) + ")" for corner in (low, high))
    units = ", units " + ", ".join(run.units) if run.units[0] else ""
    numbers = [(len(run.members), "member"), (len(run.supported_points()), "support")]
    for kind, words in (("point_loads", "point load"), ("line_loads", "line load"), ("eigenstrains", "eigenstrain"), ("joints", "joint")):
        table = run.acting().get(kind, {})
        numbers.append((max((len(column) for column in table.values()), default=0), words))
    counted = ", ".join(f"{count} {word}{'s' * (count != 1)}" for count, word in numbers if count)
    page.text(f"{counted}; box {box}{units}.")
    if "mesh chosen" in run.properties():
        page.text(f"Mesh chosen {run.properties()['mesh chosen']}.")
    page.table(("member", "elements", "length"),
               [(member.name, len(member.vertices()) - 1, float(member.arc_length[-1])) for member in run.members[:MOST_ROWS + 1]])


def _write_checks(page, summary):
    page.heading("Checks")
    page.table(("check", "value", "reference", "passed"),
               [(check["name"], cell_text(check.get("value", "")), cell_text(check.get("reference", "")), "yes" if check["pass"] else "NO")
                for check in sorted(summary.get("checks", []), key=lambda check: check["pass"])])
    for warning in summary.get("warnings", []):
        page.text(f"warning: {warning}", bad=True)


def _write_shape(page, run):
    import fields
    import shape_figures
    import style
    from view import Look, View

    step = run.steps[-1]
    view = View(run, [step], Look())
    field = fields.FIELDS["von_mises" if step.has("von_mises_stress") else "bending"]
    page.picture(shape_figures.shape_figure(view, step, field), "deformed and undeformed shape", style)
    return view, step, style


def _write_pictures(page, run):
    import diagram_figures
    import path_figures

    page.heading("Pictures")
    view, step, style = _write_shape(page, run)
    page.picture(diagram_figures.on_structure_figure(view, step), "section forces on the structure", style)
    page.picture(diagram_figures.over_arc_length_figure(view, step), "section forces and moments along members", style)
    if len(run.steps) > 2:
        page.picture(path_figures.load_displacement_figure(view), "load path", style)


if __name__ == "__main__":
    sys.exit(main())
