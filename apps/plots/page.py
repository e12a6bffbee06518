"""Markdown for pages of the documentation, from the tables that a program has written."""

import math

from tables import read_table


def table(head, rows, right=0):
    """Returns a table; the last `right` columns are aligned to the right."""
    marks = ["---"] * (len(head) - right) + ["---:"] * right
    return "".join("| " + " | ".join(str(cell) for cell in row) + " |\n" for row in (head, marks, *rows))


def head(name, title, text, folder, figures=False):
    """Returns title, introduction, the command that renews the page, and the machine of the measurement."""
    pictures = f" results/{name}/*.png" if figures else ""
    facts = read_table(folder / "machine.csv")
    machine = ", ".join(value if fact == "date" else f"{fact} {value}"
                        for fact, value in zip(facts["name"], facts["value"]) if fact != "flags")
    return (f"# {title}\n\n{text}\nWritten by `apps/plots/{name}.py` from the tables of the program; to renew it:\n\n"
            f"```sh\n./run.sh {name} && cp results/{name}/{name}.md{pictures} apps/docs/\n```\n\n{machine}.\n\n")


def short(value):
    """Returns 1e-09, 0.5, 1000, inf: six digits, or up to 13 for a number that these do not represent."""
    text = f"{value:.6g}"
    return text if math.isclose(float(text), value, rel_tol=1e-15) else f"{value:.13g}"


def error(value):
    return "-" if math.isnan(value) else f"{value:.1e}"


def duration(seconds):
    return "-" if math.isnan(seconds) else f"{1e3 * seconds:.2g} ms" if seconds < 1 else f"{seconds:.2g} s"
