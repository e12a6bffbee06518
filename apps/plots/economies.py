"""Page on the cost of features that a scene does not use."""

import page
from tables import read_table

REMARKS = {
    "straight": "Elements read the reference tangents at their Gauss points and the triads at their ends, straight or "
                "not; curvature costs time once, when the mesh is made.",
    "rotation_support": "The row is evaluated with the vertex it belongs to; elements know nothing of it.",
    "rigid": "The force of a rigid strain stays an unknown of the element, its constitutive row becomes the "
             "constraint: there is no strain term to leave out.",
    "loose": "Solves are direct: the first answer is far below either tolerance, and a looser one saves nothing."}
INTRODUCTION = (
    "A rod of {elements:.0f} elements of order {order:.0f}, clamped, bent and twisted at its tip, solved from the "
    "straight rod: seconds from the\nscene to the answer (median), Newton iterations, and how far the two displacements of "
    "the tip are apart, relative.\nLeft: the scene as it is. Right: the same scene with the feature in it, at rest.")


def economies_page(folder):
    rows = read_table(folder / "economies.csv").rows()
    text = page.head("economies", "Only what the scene requires", INTRODUCTION.format(**rows[0]), folder)
    text += page.table(["as it is", "with the feature", "s", "s", "ratio", "iterations", "difference"],
                       [[r["plain"], r["other"], f"{r['plain_seconds']:.3f}", f"{r['other_seconds']:.3f}",
                         f"{r['ratio']:.2f}", f"{r['plain_iterations']:.0f} / {r['other_iterations']:.0f}",
                         f"{r['difference']:.0e}"] for r in rows], right=5)
    remarks = [f"- {r['plain']}: {REMARKS[r['name']]}\n" for r in rows if r["name"] in REMARKS]
    return text + "\n" + "".join(remarks)
