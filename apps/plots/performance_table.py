#!/usr/bin/python3 -Es
"""The performance table of apps/docs/performance.md from the results of thread_scaling.

    performance_table.py RESULTS/thread_scaling [--update apps/docs/performance.md]
"""

import argparse
import csv
import pathlib
import statistics
import sys

BEGIN, END = "<!-- performance:begin -->", "<!-- performance:end -->"
PHASES = [
    ("residual", "residual of the elements"),
    ("element tangent", "condensed tangent of the elements"),
    ("condense chains", "condensation of the chain"),
    ("solve", "solve"),
    ("check of the solve", "check of the solve"),
    ("recover", "interior of the elements"),
    ("update", "update"),
    ("linear solver", "**linear solver, all of it**"),
    ("linear solver, KLU2", "the same by KLU2"),
    ("whole iteration", "**whole iteration**"),
    ("run, per iteration", "run to equilibrium, per iteration (NOX and LOCA included)"),
]


def read_rows(path):
    with open(path, newline="") as stream:
        return list(csv.DictReader(stream))


def table(folder):
    machine = {row["name"]: row["value"] for row in read_rows(folder / "machine.csv")}
    ceilings = {int(row["threads"]): row for row in read_rows(folder / "ceilings.csv")}
    figures = {(r["kind"], int(r["elements"]), int(r["order"]), int(r["threads"]), r["phase"]): r
               for r in read_rows(folder / "thread_scaling.csv")}
    kinds = list(dict.fromkeys(key[0] for key in figures))
    elements = max(key[1] for key in figures)
    orders = sorted({key[2] for key in figures if key[1] == elements})
    one, many = (pick(key[3] for key in figures) for pick in (min, max))
    cases = [r for r in read_rows(folder / "cases.csv") if r["kind"] == kinds[0] and int(r["elements"]) == elements]
    unit = statistics.median(float(r["unit_seconds"]) for r in cases)
    load = machine["load average before"]
    load = load if load == "unknown" else f"{float(load):.2f}"
    peak, bandwidth = (1e-9 * float(ceilings[one][name]) for name in ("flops_per_second", "bytes_per_second"))
    lines = [
        f"One Newton iteration on a {kinds[0]} chain of {elements:,} elements of order k: milliseconds with {one} thread, the same",
        f"as a multiple of B, and how many times as fast {many} threads are. B is the time of LAPACK's dgbtrf and dgbtrs (reference",
        f"BLAS, one thread) for the block-tridiagonal matrix of a chain with as many vertices, {1e3 * unit:.0f} ms, measured beside",
        f"each iteration (`thread_scaling`, medians; {machine['processor']}, {machine['cores']} cores, shared: load",
        f"{load} before; {peak:.0f} GFlop/s, {bandwidth:.0f} GB/s on {one} core; mixbeam {machine['version']},",
        f"{machine['compiler']}, `{machine['flags']}`):",
        "",
        "| | " + " | ".join(f"k = {k}: ms | B | {many} threads" for k in orders) + " |",
        "|---|" + "---:|---:|---:|" * len(orders),
    ]

    def add_row(label, kind, phase):
        cells = []
        for k in orders:
            first, last = (figures.get((kind, elements, k, n, phase)) for n in (one, many))
            cells += ["", "", ""] if first is None or last is None else [
                rounded(1e3 * float(first["median_seconds"])), rounded(float(first["ratio_to_unit"])),
                f"{float(last['speed_up']):.2f}"]
        lines.append(f"| {label} | " + " | ".join(cells) + " |")

    for phase, label in PHASES:
        add_row(label, kinds[0], phase)
    for kind in kinds[1:]:
        add_row(f"whole iteration, {kind} chain", kind, "whole iteration")
    memory = ", ".join(f"{float(r['memory_bytes_per_element']) / 1024:.1f}" for r in cases)
    lines += ["", f"Memory: {memory} kB for each element (problem, state and one iteration)."]
    return "\n".join(lines)


def rounded(number):
    """Two significant digits at least, no more decimals than they need."""
    return f"{number:.0f}" if number >= 10 else f"{number:.1f}" if number >= 1 else f"{number:.2f}"


def update(page, text):
    content = page.read_text()
    if BEGIN not in content or END not in content:
        sys.exit(f"{page}: the markers {BEGIN} and {END} are missing")
    head, tail = content.split(BEGIN)[0], content.split(END)[1]
    page.write_text(f"{head}{BEGIN}\n{text}\n{END}{tail}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=pathlib.Path, help="results of thread_scaling")
    parser.add_argument("--update", type=pathlib.Path, metavar="FILE", help="replace the table between its markers")
    arguments = parser.parse_args()
    try:
        text = table(arguments.folder)
    except (OSError, KeyError, ValueError) as error:
        sys.exit(f"performance_table.py: {error}")
    if arguments.update:
        update(arguments.update, text)
    print(text)


if __name__ == "__main__":
    main()
