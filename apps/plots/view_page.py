"""The page of `mixbeam view`: of a run, of all load cases of a scene, or of a scene that is not solved."""

from pathlib import Path

from envelope_figures import Envelope, is_envelope
from html_page import Page
from packed import deflated_text
from results import InputError, Run
from view_data import ViewData
from view_steps import MOST_BYTES

PARTS = Path(__file__).resolve().parent / "viewer"
SCRIPTS = ("numbers", "packed", "result", "camera", "shapes", "shaders", "painter", "marks", "curve", "picking", "panel", "main", "input")


def page_of_results(result, case=None, renew=0):
    """Of a run, or of all runs whose envelope the file holds."""
    if case or not is_envelope(result):
        return page_of_files([result], case=case, renew=renew)
    files = [file for file in Envelope(result).files() if file.is_file()]
    if not files:
        raise InputError(f"{result}: the envelope of several load cases, none of whose files is beside it")
    return page_of_files(files, renew=renew)


def page_of_files(files, said=None, case=None, renew=0):
    """One page of several load cases."""
    data = []
    for file in files:
        with Run(file, case) as run:
            data.append(ViewData(run, said, MOST_BYTES / len(files) ** 0.5))
    return view_page(*data, renew=renew)


def view_page(*cases, renew=0):
    """The page of one ViewData, or of those of several load cases; `renew`: seconds after which it asks for itself anew."""
    page = Page(cases[0].title if len(cases) == 1 else cases[0].scene_name, (PARTS / "viewer.css").read_text(encoding="utf-8"), has_scripts=True)
    page.add_own(markup=(PARTS / "page.html").read_text(encoding="utf-8"))
    page.packed("pages", deflated_text({"cases": [data.case for data in cases], "renew": renew}))
    for number, data in enumerate(cases):
        for name, packed in data.arrays.items():
            page.packed(f"{number}/{name}", packed)
    texts = [(PARTS / f"{name}.js").read_text(encoding="utf-8") for name in SCRIPTS]
    page.add_own(script='(() => {\n"use strict";\n' + "\n".join(texts) + "\n})();")
    return page
