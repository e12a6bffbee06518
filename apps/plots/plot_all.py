#!/usr/bin/python3
"""Draws the figures of every benchmark whose results are in a folder, as PNG beside the results."""

import argparse
import importlib
import sys
import time
from pathlib import Path

BENCHMARKS = ("rollup", "superimposed_rotation", "arc_segment", "helix", "helical_rod", "slope_discontinuity", "fork",
              "extremes", "trade", "thread_scaling")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", type=Path, help="folder that holds one folder for each benchmark")
    parser.add_argument("--only", nargs="+", choices=BENCHMARKS, metavar="BENCHMARK",
                        help="draw these only, and fail if one has no results: " + ", ".join(BENCHMARKS))
    parser.add_argument("--quiet", action="store_true", help="print errors only")
    options = parser.parse_args()
    if not options.results.is_dir():
        return f"{options.results}: no such folder"
    try:
        import style
        from results import InputError
    except ImportError as error:
        return f"{error}; the Debian packages python3-matplotlib and python3-h5py hold what is needed"

    start = time.perf_counter()
    drawn, failures = 0, []
    for benchmark in options.only or BENCHMARKS:
        folder = options.results / benchmark
        if not folder.is_dir():
            if options.only:
                failures.append(f"{folder}: no such folder")
            continue
        for name, (inputs, draw) in importlib.import_module(benchmark).FIGURES.items():
            missing = [str(folder / file) for file in inputs if not (folder / file).is_file()]
            if missing:
                say(options, f"left out {benchmark}/{name}: no {', '.join(missing)}")
                continue
            try:
                path = style.save(draw(folder), folder / f"{name}.png")
            except (InputError, OSError) as error:
                failures.append(f"{benchmark}/{name}: {error}")
                continue
            say(options, f"drew {path}")
            drawn += 1
    say(options, f"{drawn} figures in {time.perf_counter() - start:.1f} s")
    if drawn == 0 and not failures:
        failures.append(f"{options.results}: no results of a benchmark found")
    return "\n".join(failures) or None


def say(options, text):
    if not options.quiet:
        print(text, flush=True)


if __name__ == "__main__":
    sys.exit(main())
