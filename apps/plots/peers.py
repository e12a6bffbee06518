"""Page and figure that compare mixbeam with other programs, from the tables of the study peers."""

import page
import style
from tables import read_table

LEVELS = (1e-2, 1e-4, 1e-6, 1e-8)
SHOWN = {"roll_up_1000": "two full circles, slenderness 1000", "arc_1000": "eighth of a circle, across its plane",
         "elastica": "elastica, $F L^2 / EI = 10$"}  # figures for slenderness 100 look the same
LOOKS = {"mixbeam": (style.BLUE, "o", "-"), "mixbeam, all answers": (style.SKY, "s", "-"), "FEniCSx": (style.RED, "v", "-"),
         "FEniCSx, load steps alone": (style.RED, "v", ":"), "CalculiX": (style.PURPLE, "D", "-"),
         "CalculiX, defaults": (style.PURPLE, "D", ":")}
LOWEST = 1e-13  # errors below are those of rounding and of the references
INTRODUCTION = """The same cantilevers by mixbeam and by programs that Debian has: a straight rod wound up to two full circles by a moment and an
eighth of a circle under a force across its plane, at slenderness 100 and 1000, and the elastica. The truths are closed forms,
elliptic integrals and shooting. Time is user and system time of one thread in a process that has solved before, from the
problem in the program's words to the displacement of the tip; all programs take turns, medians."""
PROGRAMS = """FEniCSx solves the same equations, in a mixed element written for this comparison; orders, meshes and numbers of load steps are
the cheapest of those tried. "Load steps alone" leaves out its set-up: mesh, spaces, forms from the cache. CalculiX makes solid
elements of a beam of three nodes (B32R), of St. Venant's and Kirchhoff's material: another theory, which differs by the strain
at the edge of the section, so that small errors here are not errors of CalculiX. Lines are those of each program's file in
[apps/peers](../peers/peers.py) without comments: what a user writes for these problems.

"""
AS_THEY_COME = """mixbeam: no mesh named, and all answers (stability, estimated error). FEniCSx: dolfinx' own Newton's method and direct solver,
order 1, the fewest equal load steps that work, for it has no control of steps. CalculiX: its own increments, the first one a
tenth. The cheapest mesh for an error of 1e-2, or the most accurate one where none reaches it."""
BETTER = """
## What the others do better

- FEniCSx takes any equations: other materials, loads and couplings are a change of a line, where mixbeam is closed. A loop over
  loads that keeps its forms pays for the set-up once: where the row of load steps alone is below 1, it is faster than mixbeam.
- CalculiX has contact, plasticity, motion in time, shells and solids; its beams join these.
- cardillo and EXUDYN compute motion in time and contact, and install by pip; Debian has no package of them, and they are not
  measured here. On these problems, on another day (2026-11-24), cardillo's mixed rod of order 2 (git 451d581d) took 39 to 62
  times as long as mixbeam for an error of 1e-2, 95 to 134 for 1e-4, 133 to 400 for 1e-6.

## Caveats

- What a process costs before its first solution is left out: loading the module, and compiling FEniCSx' forms, which takes
  seconds for each order, once on a machine. Either takes longer than the solutions of mixbeam and FEniCSx here. CalculiX is a
  process for each solution, and counts as a whole.
- Another element in UFL may be cheaper: this one has the fields and the integration of mixbeam's, and does not lock.
- The tip of smooth problems judges one point: kinks, junctions, instability are in the [verification](verification.md), without
  peers.
"""


def solutions(folder):
    rows = read_table(folder / "peers.csv").rows()
    rows = [row for row in rows if not row["failure"]]
    return rows + [{**row, "program": "FEniCSx, load steps alone", "setting": "FEniCSx, load steps alone", "seconds": row["stepping"]}
                   for row in rows if row["setting"] == "FEniCSx"]


def cheapest(rows, level):
    return min((row for row in rows if row["error"] <= level), key=lambda row: row["seconds"], default=None)


def front(rows):
    """Returns times and errors of the Pareto front: solutions that are more accurate than all cheaper ones."""
    times, errors = [], []
    for row in sorted(rows, key=lambda row: row["seconds"]):
        error = max(row["error"], LOWEST)
        if error < min(errors, default=1.0):
            times.append(1e3 * row["seconds"])
            errors.append(error)
    return times, errors


def peers_figure(folder):
    rows = solutions(folder)
    canvas, panels = style.figure(12.0, 4.2, 1, len(SHOWN), sharey=True)
    for panel, (problem, title) in zip(panels, SHOWN.items()):
        for name, (color, marker, dashes) in LOOKS.items():
            line = front([row for row in rows if (row["setting"], row["problem"]) == (name, problem)])
            panel.loglog(*line, color=color, marker=marker, linestyle=dashes, label=name)
        panel.set(title=title, xlabel="processor time of one solution in ms")
    panels[0].set_ylabel("relative error of the tip")
    handles, labels = panels[0].get_legend_handles_labels()
    canvas.legend(handles, labels, loc="lower center", ncol=len(labels), bbox_to_anchor=(0.5, 1.0))
    return canvas


def digits(value, count):
    """Returns `count` significant digits, without an exponent where possible."""
    return f"{float(f'{value:.{count}g}'):g}"


def cell(row):
    return "-" if row is None else (f"{digits(1e3 * row['seconds'], 3)} ms ({row['order']:.0f} x {row['elements']:.0f}, "
                                    f"{row['steps']:.0f}, {row['iterations']:.0f})")


def ratios(rows, problems, others):
    """Returns the time of a program over that of mixbeam for each error level: smallest and largest over the problems."""
    lines = []
    for other in others:
        line = [other]
        for level in LEVELS:
            pairs = [[cheapest([row for row in rows if row["program"] == program and row["problem"] == problem], level)
                      for program in ("mixbeam", other)] for problem in problems]
            found = [theirs["seconds"] / ours["seconds"] for ours, theirs in pairs if ours and theirs]
            part = f" ({len(found)} of {len(pairs)})" if len(found) < len(pairs) else ""
            line.append(f"{digits(min(found), 2)} to {digits(max(found), 2)}{part}" if found else "not reached")
        lines.append(line)
    return lines


def defaults(rows, problems, names):
    """Returns rows with default settings: the cheapest solution with an error of 1e-2, or the most accurate one."""
    lines = []
    for problem in problems:
        for name in names:
            mine = [row for row in rows if (row["setting"], row["problem"]) == (name, problem)]
            row = cheapest(mine, LEVELS[0]) or min(mine, key=lambda row: row["error"], default=None)
            lines.append([problem, name.partition(",")[0], cell(row), page.error(row["error"]) if row else "no equilibrium"])
    return lines


def growth(folder):
    rows = read_table(folder / "growth.csv").rows()
    sizes = sorted({row["elements"] for row in rows})
    lines = []
    for name, order in dict.fromkeys((row["setting"], row["order"]) for row in rows):
        mine = {row["elements"]: row for row in rows if (row["setting"], row["order"]) == (name, order)}
        lines.append([name, f"{order:.0f}", *(f"{digits(mine[size]['seconds'], 2)} s ({mine[size]['iterations']:.0f})"
                                              if size in mine and not mine[size]["failure"] else "-" for size in sizes)])
    return page.table(["program", "order", *(f"{size:.0f} elements" for size in sizes)], lines, right=len(sizes))


def chapter(title, text, table):
    return f"\n## {title}\n\n{text}\n\n{table}"


def peers_page(folder):
    rows, programs = solutions(folder), read_table(folder / "programs.csv").rows()
    problems = list(dict.fromkeys(row["problem"] for row in rows))
    here = [name for name in dict.fromkeys(row["program"] for row in rows) if name != "mixbeam"]
    levels = [f"error {level:.0e}" for level in LEVELS]
    best = [[problem, program, *(cell(cheapest([row for row in rows if (row["program"], row["problem"]) == (program, problem)], level))
                                 for level in LEVELS)] for problem in problems for program in ("mixbeam", *here)]
    names = [name for name in dict.fromkeys(row["setting"] for row in rows) if name.endswith("defaults")]
    text = page.head("peers", "Beside other programs", INTRODUCTION, folder, figures=True)
    text += page.table(["program", "version", "Debian's package", "lines"],
                       [[p["program"], p["version"], p["package"], f"{p['lines']:.0f}" if p["lines"] else "-"] for p in programs], right=1)
    text += "\n" + PROGRAMS + "![Error over processor time](peers.png)\n"
    text += chapter("Time of the others over mixbeam's", "Each at its cheapest setting for the error; smallest and largest of the "
                    f"{len(problems)} problems, or of those on which it is reached.",
                    page.table(["program", *levels], ratios(rows, problems, here), right=len(levels)))
    text += chapter("The cheapest solutions", "Time (order x elements, load steps, iterations of Newton's method in all of them).",
                    page.table(["problem", "program", *levels], best))
    text += chapter("As they come", AS_THEY_COME, page.table(["problem", "program", "time (order x elements, steps, iterations)", "error"],
                                                             defaults(rows, problems, names), right=1))
    text += chapter("Growth", "A straight cantilever, F L^2 / EI = 0.3, in one load step: time (iterations). What would take longer than "
                    "a minute and a half\nwas left out or stopped.", growth(folder))
    return text + BETTER
