#!/usr/bin/python3 -Es
"""Makes the verification table: quantities checked by benchmarks and scenes, their references and agreement. It reads the
summaries RESULTS/<benchmark>/summary.json, RESULTS/verification/<scene>/summary.json and those of the gallery, and prints
text or Markdown, or writes between the two marker lines of a file: apps/docs/verification.md."""

import argparse
import json
import math
import re
import sys
from decimal import ROUND_HALF_UP, Decimal
from pathlib import Path

from command import InputError, replace_part
from plot_all import BENCHMARKS

NOT_VERIFICATION = ("thread_scaling",)  # times, not values
WHEN_NAMED = ("trade",)  # computed by run.sh only when named
SCENE_GROUPS = ("verification", "gallery")  # folders of scenes, run by mixbeam
NUMBER = re.compile(r"\d+(?:\.\d+)?(?:e[+-]?\d+)?")
HEADINGS = ("level", "benchmark", "quantity", "values", "worst", "allowed", "pass", "source")
TEXT_HEADINGS = HEADINGS[:-1]  # sources are too long for a terminal
LONGEST_QUANTITY = 84  # in a terminal
# Kinds of references: (name, pattern of the source, error of the reference); the first match counts.
LEVELS = (
    ("closed form", r"closed form|elastica|elliptic|Bessel|^pure bending|Frenet|Eq\.|pi\^2|K\(|sqrt\(EI/m\)|Fletcher|polygon|"
     "twice the error", "that of the printed digits"),
    ("shooting", r"shooting|Runge-Kutta", "1e-10, by steps of half the length, or as the source says"),
    ("other program", r"^other program:|prototype", "as the source says"),
    ("paper", r"^Humer, Steinbrecher, Pechstein", "half a unit of the last digit; the same element"),
    ("experiment", r"^experiment:", "unknown; how far other programs are from it stands in the source"),
    ("relation", "", "none: equilibrium, symmetry, independence of the path, rates, statics by hand, goals"))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", type=Path, help="folder that holds one folder for each benchmark and group of scenes")
    parser.add_argument("--markdown", action="store_true", help="print Markdown, with sources, instead of plain text")
    parser.add_argument("--update", type=Path, metavar="FILE", help="replace the table in FILE; needs what run.sh computes")
    options = parser.parse_args()
    try:
        summaries = read_summaries(options.results)
        rows = all_rows(summaries)
        if options.update:
            update(options.update, summaries, rows)
        elif options.markdown:
            print(markdown(summaries, rows))
        else:
            print(plain_text(summaries, rows))
    except InputError as error:
        return str(error)
    return None


def read_summaries(results):
    """Reads the summaries in the order of the paper, then those of scenes; benchmarks without a summary are left out."""
    if not results.is_dir():
        raise InputError(f"{results}: no such folder")
    benchmarks = [name for name in BENCHMARKS if name not in NOT_VERIFICATION]
    files = [results / name / "summary.json" for name in benchmarks]
    summaries = [read_summary(file) for file in files if file.is_file()]
    for group in SCENE_GROUPS:
        for file in sorted((results / group).glob("*/summary.json")):
            summaries.append({**read_summary(file), "program": f"{group}/{file.parent.name}", "group": group})
    if not summaries:
        raise InputError(f"{results}: no <benchmark>/summary.json found; the programs write one with --summary")
    return summaries


def read_summary(file):
    try:
        summary = json.loads(file.read_text(encoding="utf-8"))
        for key in ("program", "version", "compiler", "threads", "ranks", "checks", "all_passed"):
            summary[key]
        return summary
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError(f"{file}: not a summary of a benchmark ({type(error).__name__}: {error})") from None


def all_rows(summaries):
    """Returns the rows by level, in each level in the order of the summaries."""
    rows = [row for summary in summaries if "group" not in summary for row in rows_of(summary)]
    for group in SCENE_GROUPS:
        rows += rows_of_scenes(group, [summary for summary in summaries if summary.get("group") == group])
    return [(name, *row) for name, _, _ in LEVELS for row in rows if level_of(row[-1]) == name]


def level_of(source):
    return next(name for name, words, _ in LEVELS if re.search(words, source))


def level_rows(summaries):
    """Returns for each level the number of values, of those that agree, and the error of the references."""
    checks = [(level_of(check["source"]), check["pass"]) for summary in summaries for check in summary["checks"]]
    counts = [(name, [passed for level, passed in checks if level == name], error) for name, _, error in LEVELS]
    return [(name, str(len(found)), str(sum(found)), error) for name, found, error in counts if found]


def rows_of_scenes(group, summaries):
    """Returns a row for each scene, source and tolerance, and one for the balance of forces that every run checks."""
    groups, rows = {}, []
    for summary in summaries:
        for check in summary["checks"]:
            if check["comparison"] == "upper bound":
                key = group, check["source"]  # the bound of a balance grows with the number of elements
            else:
                key = summary["program"], check["source"], check["comparison"], check["tolerance"]
            groups.setdefault(key, []).append(check)
        if "failure" in summary:
            rows.append(row_of_failure(summary))
    last = [key for key in groups if key[0] == group]
    for key in [key for key in groups if key not in last] + last:
        names = dict.fromkeys(short_name(check["name"]) for check in groups[key])
        rows.append((key[0], list_of(names), *row_of("", groups[key])[2:]))
    return rows


def list_of(names):
    """Joins names: "balance, forces" and "balance, moments" become "balance: forces, moments"."""
    heads = {name.rpartition(", ")[0] for name in names}
    if len(names) < 2 or len(heads) > 1 or heads == {""}:
        return ", ".join(names)
    return f"{heads.pop()}: {', '.join(name.rpartition(', ')[2] for name in names)}"


def short_name(name):
    """Removes the case from a name: from "elastica: loads and reactions, sum of forces" or "u_x, force 600"."""
    quantity = quantity_of(name)
    return quantity if quantity != name else name.partition(", ")[0]


def rows_of(summary):
    """Returns a row for each group of checks with the same source, tolerance and kind of quantity."""
    groups = {}
    for check in summary["checks"]:
        groups.setdefault(group_of(check), []).append(check)
    rows = [row_of(summary["program"], checks) for checks in groups.values()]
    if "failure" in summary:
        rows.append(row_of_failure(summary))
    return rows


def row_of_failure(summary):
    return summary["program"], "the run ended early", "", "", "", "**NO**", summary["failure"]


def group_of(check):
    bound = rounded(check["printed_reference"]) if check["comparison"] == "upper bound" else check["tolerance"]
    return check["source"], check["comparison"], bound, NUMBER.sub("#", quantity_of(check["name"]))


def quantity_of(name):
    """Returns the quantity of a name: u1 of "k=3, 8 elements: u1"."""
    return name.rpartition(": ")[2]


def row_of(program, checks):
    worst = max(checks, key=lambda check: (not check["pass"], difference(check)))
    passed = all(check["pass"] for check in checks)
    return (program, common_name([check["name"] for check in checks]), str(len(checks)),
            difference_text(worst["comparison"], difference(worst)), allowed_text(checks), "yes" if passed else "**NO**",
            worst["source"])


def common_name(names):
    """Returns one text for all names: different numbers become a range; cases without a common form are left out."""
    for texts in (names, [quantity_of(name) for name in names]):
        if len({NUMBER.sub("#", text) for text in texts}) == 1:
            return with_ranges(texts)
    return with_ranges([quantity_of(names[0])])


def with_ranges(texts):
    columns = [sorted(set(column), key=float) for column in zip(*(NUMBER.findall(text) for text in texts))]
    ranges = iter([" and ".join(column) if len(column) < 3 else f"{rounded(column[0])}..{rounded(column[-1])}"
                   for column in columns])
    return NUMBER.sub(lambda _: next(ranges), texts[0])


def rounded(printed):
    """Rounds a bound or the end of a range to three significant digits; integers keep all digits."""
    return printed if float(printed).is_integer() else f"{float(printed):.3g}"


def difference(check):
    """Returns the distance of a value from its reference, in the unit of the tolerance; infinite if it is not a number."""
    value, reference, comparison = check["value"], check["reference"], check["comparison"]
    if comparison == "word":
        return 0.0 if check["pass"] else math.inf
    if not isinstance(value, (int, float)) or not math.isfinite(value):
        return math.inf
    if comparison == "printed digits":
        return units_in_last_place(value, check["printed_reference"])
    if comparison == "upper bound":
        return value
    if comparison == "relative":
        return abs(value - reference) / abs(reference) if reference else math.inf
    return abs(value - reference)


def units_in_last_place(value, printed):
    reference = Decimal(printed)
    unit = Decimal(1).scaleb(reference.as_tuple().exponent)
    return int(abs(Decimal(value).quantize(unit, ROUND_HALF_UP) - reference) / unit)


def difference_text(comparison, value):
    if comparison == "word":
        return "none" if value == 0.0 else "another word, or none"
    if not math.isfinite(value):
        return "not a number"
    if comparison == "printed digits":
        return f"{value} in the last digit" if value else "none in any digit"
    if comparison == "upper bound" and value == int(value):
        return str(int(value))
    return f"{value:.2g}"


def allowed_text(checks):
    comparison, tolerance = checks[0]["comparison"], checks[0]["tolerance"]
    if comparison == "printed digits":
        return f"{tolerance:g} in the last digit"
    if comparison == "word":
        return "the same word"
    if comparison == "upper bound":
        bounds = sorted({rounded(check["printed_reference"]) for check in checks}, key=float)
        return f"at most {bounds[0]}" + (f" to {bounds[-1]}" if len(bounds) > 1 else "")
    return f"{tolerance:.3g}" + (" of the value" if comparison == "relative" else "")


def closing_line(summaries):
    checks = [check for summary in summaries for check in summary["checks"]]
    passed = sum(check["pass"] for check in checks)
    first = summaries[0]
    versions = sorted({summary["version"] for summary in summaries})
    ended_early = [summary["program"] for summary in summaries if "failure" in summary]
    line = (f"{passed} of {len(checks)} values agree; version {', '.join(versions)}, {first['compiler']}, "
            f"threads: {first['threads']}, ranks: {first['ranks']}.")
    return line + (f" Ended early: {', '.join(ended_early)}." if ended_early else "")


def markdown(summaries, rows):
    levels = table(("level", "values", "agree", "error of the reference"), level_rows(summaries))
    return "\n".join([*levels, "", *table(HEADINGS, rows), "", closing_line(summaries)])


def table(headings, rows):
    lines = headings, ["---"] * len(headings), *rows
    return ["| " + " | ".join(cell.replace("|", r"\|") for cell in line) + " |" for line in lines]


def plain_text(summaries, rows):
    lines = [TEXT_HEADINGS] + [tuple(shortened(cell.replace("*", "")) for cell in row[:len(TEXT_HEADINGS)])
                               for row in rows]
    widths = [max(len(line[i]) for line in lines) for i in range(len(TEXT_HEADINGS))]
    aligned = ["  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip() for line in lines]
    return "\n".join(aligned + [closing_line(summaries)])


def shortened(text):
    return text if len(text) <= LONGEST_QUANTITY else text[:LONGEST_QUANTITY - 3] + "..."


def update(file, summaries, rows):
    there = {summary.get("group", summary["program"]) for summary in summaries}
    needed = [name for name in BENCHMARKS + SCENE_GROUPS if name not in NOT_VERIFICATION + WHEN_NAMED]
    missing = [name for name in needed if name not in there]
    if missing:
        raise InputError(f"{file} is left as it is: no results of {', '.join(missing)}")
    replace_part(file, "verification", markdown(summaries, rows))


if __name__ == "__main__":
    sys.exit(main())
