#!/usr/bin/python3 -Es
"""Draws the figures and writes the pages of every benchmark whose results are in a folder, beside the results."""

import argparse
import importlib
import sys
import time
from pathlib import Path

BENCHMARKS = ("rollup", "superimposed_rotation", "arc_segment", "helix", "helical_rod", "slope_discontinuity", "fork",
              "modes", "sensitivity", "extremes", "trade", "thread_scaling")
NAMES = (*BENCHMARKS, "economies", "peers")  # the last two have no reference values of the paper


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", type=Path, help="folder that holds one folder for each benchmark")
    parser.add_argument("--only", nargs="+", choices=NAMES, metavar="BENCHMARK",
                        help="these only, and fail if one has no results: " + ", ".join(NAMES))
    parser.add_argument("--pages", action="store_true", help="write the pages, draw nothing")
    parser.add_argument("--quiet", action="store_true", help="print errors only")
    options = parser.parse_args()
    if not options.results.is_dir():
        return f"{options.results}: no such folder"
    try:
        import style
        from tables import InputError, NothingToDraw
    except ImportError as error:
        return f"{error}; the Debian packages python3-matplotlib and python3-h5py hold what is needed"

    start = time.perf_counter()
    drawn, failures = 0, []
    for benchmark in options.only or NAMES:
        folder = options.results / benchmark
        if not folder.is_dir():
            if options.only:
                failures.append(f"{folder}: no such folder")
            continue
        module = importlib.import_module(benchmark)
        for name, make in works_of(module, "_page" if options.pages else ("_figure", "_page")):
            try:
                made = make(folder)
                path = folder / f"{name}.{'md' if isinstance(made, str) else 'png'}"
                if isinstance(made, str):
                    path.write_text(made, encoding="utf-8")
                else:
                    style.save(made, path)
                say(options, f"drew {path}")
            except NothingToDraw as reason:
                say(options, f"left out {benchmark}/{name}: {reason}")
                continue
            except (InputError, OSError) as error:
                failures.append(f"{benchmark}/{name}: {error}")
                continue
            drawn += 1
    say(options, f"{drawn} figures and pages in {time.perf_counter() - start:.1f} s")
    if drawn == 0 and not failures:
        failures.append(f"{options.results}: no results of a benchmark found")
    return "\n".join(failures) or None


def works_of(module, endings):
    """Returns (name, function from folder to figure or page) of a module's functions with these endings."""
    return [(name.rpartition("_")[0], make) for name, make in vars(module).items() if name.endswith(endings) and not name.startswith("_")]


def say(options, text):
    if not options.quiet:
        print(text, flush=True)


if __name__ == "__main__":
    sys.exit(main())
