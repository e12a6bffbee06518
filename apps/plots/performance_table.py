#!/usr/bin/python3 -Es
"""Writes the table of apps/docs/performance.md from the results of thread_scaling.

    performance_table.py RESULTS/thread_scaling [--update apps/docs/performance.md]
"""

import argparse
import pathlib
import sys

import numpy as np

from command import InputError, replace_part
from tables import read_table

PHASES = [
    ("residual", "residual of the elements"),
    ("element tangent", "condensed tangent of the elements"),
    ("condense chains", "condensation of the chain and its right-hand side"),
    ("solve", "solve, inside the chain"),
    ("check of the solve", "check of the solve"),
    ("recover", "interior of the elements"),
    ("update", "update"),
    ("linear solver", "**linear solver, all of it**"),
    ("linear solver, KLU2", "the same by KLU2"),
    ("whole iteration", "**whole iteration**"),
    ("run, per iteration", "run to equilibrium, per iteration (NOX and LOCA included)"),
]


def table(folder):
    machine = {row["name"]: row["value"] for row in read_table(folder / "machine.csv").rows()}
    whole = read_table(folder / "thread_scaling.csv")
    kinds, elements, (one, many) = list(dict.fromkeys(whole["kind"])), whole["elements"].max(), whole.values("threads")[[0, -1]]
    whole = whole.where(elements=elements)
    orders = whole.values("order")
    cases = read_table(folder / "cases.csv").where(kind=kinds[0], elements=elements)
    load = machine["load average before"]
    load = load if load == "unknown" else f"{float(load):.2f}"
    ceiling = read_table(folder / "ceilings.csv").where(threads=one).rows()[0]
    lines = [
        f"One Newton iteration on a {kinds[0]} chain of {elements:,.0f} elements of order k: milliseconds with {one:.0f} thread, the same",
        f"as a multiple of B, and how many times as fast {many:.0f} threads are. B is the time of LAPACK's dgbtrf and dgbtrs (reference",
        f"BLAS, one thread) for the block-tridiagonal matrix of a chain with as many vertices, {1e3 * np.median(cases['unit_seconds']):.0f} ms, measured beside",
        f"each iteration (`thread_scaling`, medians; {machine['processor']}, {machine['cores']} cores, shared: load",
        f"{load} before; {1e-9 * ceiling['flops_per_second']:.0f} GFlop/s, {1e-9 * ceiling['bytes_per_second']:.0f} GB/s on {one:.0f} core; "
        f"mixbeam {machine['version']},",
        f"{machine['compiler']}, `{machine['flags']}`):",
        "",
        "| | " + " | ".join(f"k = {k:.0f}: ms | B | {many:.0f} threads" for k in orders) + " |",
        "|---|" + "---:|---:|---:|" * len(orders),
    ]

    def add_row(label, kind, phase):
        cells = []
        for k in orders:
            first, last = (whole.where(kind=kind, order=k, threads=n, phase=phase).rows() for n in (one, many))
            cells += ["", "", ""] if not first or not last else [
                rounded(1e3 * first[0]["median_seconds"]), rounded(first[0]["ratio_to_unit"]), f"{last[0]['speed_up']:.2f}"]
        lines.append(f"| {label} | " + " | ".join(cells) + " |")

    for phase, label in PHASES:
        add_row(label, kinds[0], phase)
    for kind in kinds[1:]:
        add_row(f"whole iteration, {kind} chain", kind, "whole iteration")
    memory = ", ".join(f"{size / 1024:.1f}" for size in cases["memory_bytes_per_element"])
    lines += ["", f"Memory: {memory} kB for each element (problem, state and one iteration)."]
    return "\n".join(lines)


def rounded(number):
    """Rounds to two significant digits, or to an integer from 10 on."""
    return f"{number:.0f}" if number >= 10 else f"{number:.1f}" if number >= 1 else f"{number:.2f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=pathlib.Path, help="results of thread_scaling")
    parser.add_argument("--update", type=pathlib.Path, metavar="FILE", help="replace the table between its markers")
    arguments = parser.parse_args()
    try:
        text = table(arguments.folder)
        if arguments.update:
            replace_part(arguments.update, "performance", text)
    except (InputError, KeyError, ValueError) as error:
        sys.exit(f"performance_table.py: {error}")
    print(text)


if __name__ == "__main__":
    main()
