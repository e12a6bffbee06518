#!/usr/bin/python3
"""One HTML file that shows a result in a browser: the structure to turn, colour and step through, its path and modes. It
needs no network."""

import argparse
import sys
from pathlib import Path

from html_page import Page, view_beside

BAD_INPUT = 2  # exit code, as of all programs of mixbeam
PARTS = Path(__file__).resolve().parent / "viewer"
SCRIPTS = ("numbers", "packed", "result", "camera", "shapes", "shaders", "painter", "marks", "curve", "picking", "panel", "main", "input")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("result", type=Path, help="result file (.h5)")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE.html", help="default: RESULT-view.html beside the result file")
    parser.add_argument("--case", metavar="NAME", help="load case: takes FILE-NAME.h5 beside FILE.h5")
    options = parser.parse_args()
    try:
        from results import InputError, Run
        from view_data import ViewData
    except ImportError as error:
        return _fail(f"{error}; the Debian packages python3-matplotlib and python3-h5py hold what is needed")
    try:
        with Run(options.result, options.case) as run:
            path = options.output or view_beside(run.path)
            view_page(ViewData(run)).write(path)
            print(path)
    except (InputError, OSError, ValueError, KeyError) as error:
        reason = str(error) if isinstance(error, (InputError, OSError)) else f"unexpected content ({error})"
        return _fail(reason if str(options.result) in reason else f"{options.result}: {reason}")
    return 0


def view_page(data):
    """The page of a ViewData."""
    page = Page(data.description["title"], (PARTS / "viewer.css").read_text(encoding="utf-8"), has_scripts=True)
    page.add_own(markup=(PARTS / "page.html").read_text(encoding="utf-8"))
    for name, packed in data.arrays.items():
        page.packed(name, packed)
    texts = [(PARTS / f"{name}.js").read_text(encoding="utf-8") for name in SCRIPTS]
    page.add_own(script='(() => {\n"use strict";\n' + "\n".join(texts) + "\n})();")
    return page


def _fail(text):
    print(f"view_result.py: {text}", file=sys.stderr)
    return BAD_INPUT


if __name__ == "__main__":
    sys.exit(main())
