#!/usr/bin/python3
"""The README's performance table from the results of thread_scaling.

    performance_table.py RESULTS/thread_scaling [--update README.md]
"""

import argparse
import csv
import pathlib
import sys

BEGIN, END = "<!-- performance:begin -->", "<!-- performance:end -->"
PHASES = [
    ("element work", "element kernels"),
    ("assemble", "assembly"),
    ("numeric factorisation", "factorisation (KLU2, one thread)"),
    ("solve", "solve (KLU2, one thread)"),
    ("whole iteration", "whole iteration"),
    ("run, per iteration", "run to equilibrium, per iteration (NOX and LOCA included)"),
]


def read_rows(path):
    with open(path, newline="") as stream:
        return list(csv.DictReader(stream))


def table(folder):
    machine = {row["name"]: row["value"] for row in read_rows(folder / "machine.csv")}
    rows = read_rows(folder / "thread_scaling.csv")
    seconds = {(int(r["elements"]), int(r["order"]), int(r["threads"]), r["phase"]): float(r["median_seconds"]) for r in rows}
    elements = max(key[0] for key in seconds)
    orders = sorted({key[1] for key in seconds if key[0] == elements})
    threads = sorted({key[2] for key in seconds})
    lines = [
        f"Milliseconds for one Newton iteration on a chain of {elements:,} elements, medians, and how many times as fast",
        f"{threads[-1]} threads are as {threads[0]} (`thread_scaling`; {machine['processor']}, {machine['cores']} cores, shared;",
        f"mixbeam {machine['version']}, {machine['compiler']}, `{machine['flags']}`):",
        "",
        "| | " + " | ".join(f"k = {k}: {threads[0]} thread | {threads[-1]} threads | ratio" for k in orders) + " |",
        "|---|" + "---:|---:|---:|" * len(orders),
    ]
    for phase, label in PHASES:
        cells = []
        for k in orders:
            one, many = (seconds.get((elements, k, n, phase)) for n in (threads[0], threads[-1]))
            cells += ["", "", ""] if one is None or many is None else [f"{1e3 * one:.0f}", f"{1e3 * many:.0f}", f"{one / many:.2f}"]
        lines.append(f"| {label} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def update(readme, text):
    content = readme.read_text()
    if BEGIN not in content or END not in content:
        sys.exit(f"{readme}: the markers {BEGIN} and {END} are missing")
    head, tail = content.split(BEGIN)[0], content.split(END)[1]
    readme.write_text(f"{head}{BEGIN}\n{text}\n{END}{tail}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=pathlib.Path, help="results of thread_scaling")
    parser.add_argument("--update", type=pathlib.Path, metavar="README.md", help="replace the table between its markers")
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
