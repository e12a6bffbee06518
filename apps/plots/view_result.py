#!/usr/bin/python3 -Es
"""One HTML file that shows a result in a browser: the structure to turn, colour and step through, its path and modes. It
needs no network."""

import argparse
import os
import sys
import time
from contextlib import suppress
from pathlib import Path

from command import InputError, finish
from html_page import page_beside

WATCHING = 0.5  # seconds between two looks at a file that is watched
RENEWED = 2      # and after which the page asks for itself


def main():
    parser = argparse.ArgumentParser("mixbeam view", description=__doc__)
    parser.add_argument("result", type=Path, help="result file (.h5), or a scene, which is drawn without being solved")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE.html", help="default: NAME-view.html beside the file")
    parser.add_argument("--case", metavar="NAME", help="this load case only")
    parser.add_argument("--watch", action="store_true", help="writes the page anew whenever the file changes, until Ctrl-C")
    options = parser.parse_args()
    return finish("view", options.result, lambda: _watched(options) if options.watch else _write(options))


def _watched(options):
    """As _write, again and again; the page asks for itself anew. The end of mixbeam, which waits for this program, ends it."""
    seen, mixbeam = None, os.getppid()
    while os.getppid() == mixbeam:
        with suppress(OSError):
            now = options.result.stat().st_mtime_ns
        if seen is None and not options.result.exists():
            raise InputError(f"{options.result}: no such file")
        if now != seen:
            seen = now
            try:
                yield from _write(options)
            except InputError as error:  # of a file that is being edited: the page stays as it was
                print(f"mixbeam view: {error}", file=sys.stderr, flush=True)
        time.sleep(WATCHING)


def _write(options):
    """Writes the page, and yields its path."""
    from preview import is_scene, undeformed
    from results import file_of_case
    from view_page import page_of_files, page_of_results

    renew, of_case = RENEWED if options.watch else 0, file_of_case(options.result, options.case)
    path = options.output or page_beside(of_case if options.case and of_case.is_file() else options.result, "view")
    if is_scene(options.result):
        with undeformed(options.result, options.case) as (files, said):
            page_of_files(files, said, renew=renew).write(path)
    else:
        page_of_results(options.result, options.case, renew).write(path)
    yield path


if __name__ == "__main__":
    sys.exit(main())
