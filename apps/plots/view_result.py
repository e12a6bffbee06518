#!/usr/bin/python3 -Es
"""One HTML file that shows a result in a browser: the structure to turn, colour and step through, its path and modes. It
needs no network."""

import argparse
import sys
from pathlib import Path

from command import finish
from html_page import Page, view_beside

PARTS = Path(__file__).resolve().parent / "viewer"
SCRIPTS = ("numbers", "packed", "result", "camera", "shapes", "shaders", "painter", "marks", "curve", "picking", "panel", "main", "input")


def main():
    parser = argparse.ArgumentParser("mixbeam view", description=__doc__)
    parser.add_argument("result", type=Path, help="result file (.h5)")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE.html", help="default: RESULT-view.html beside the result file")
    parser.add_argument("--case", metavar="NAME", help="load case: takes FILE-NAME.h5 beside FILE.h5")
    options = parser.parse_args()
    return finish("view", options.result, lambda: _write(options))


def _write(options):
    """Writes the page, and yields its path."""
    from results import Run
    from view_data import ViewData

    with Run(options.result, options.case) as run:
        path = options.output or view_beside(run.path)
        view_page(ViewData(run)).write(path)
        yield path


def view_page(data):
    """The page of a ViewData."""
    page = Page(data.description["title"], (PARTS / "viewer.css").read_text(encoding="utf-8"), has_scripts=True)
    page.add_own(markup=(PARTS / "page.html").read_text(encoding="utf-8"))
    for name, packed in data.arrays.items():
        page.packed(name, packed)
    texts = [(PARTS / f"{name}.js").read_text(encoding="utf-8") for name in SCRIPTS]
    page.add_own(script='(() => {\n"use strict";\n' + "\n".join(texts) + "\n})();")
    return page


if __name__ == "__main__":
    sys.exit(main())
