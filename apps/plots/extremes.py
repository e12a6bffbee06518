"""Figure of the sweeps of parameters to their limits, and page on them and on random imperfect structures."""

import numpy as np

import page
import style
from tables import read_table

COLUMNS = 4
LOWEST_ERROR = 1e-17  # drawn in place of an error of zero
LINEAR = ("order", "element_turn", "element_turn_k1", "thrust")  # sweeps that do not span decades

RIGID = "Inextensible and shear rigid"
MOMENT = f"{RIGID}, dead tip moment."
SLENDER = "Slenderness 100, dead tip force F L^2 / EI = 10."
UNITS = "Residuals and tolerances have no dimension."
# name: label of the panel, scene, swept parameter, reason why errors grow or runs end
SWEEPS = {
    "slenderness": ("slenderness $L/a$", "Dead tip force F L^2 / EI = 10.", "slenderness L/a of a square section, EA = GA = 12 "
        "(L/a)^2 EI / L^2; inf: inextensible and shear rigid", "The force is an unknown of its own and the compliance "
        "goes to zero without any other change, so there is nothing to lose on the way to the rigid beam."),
    "stiffness_ratio": ("$EI/GI_t$", "Dead tip moment that bends by 1 rad about y and twists, by 1 rad where GIt is the smaller "
        "stiffness.", "ratio EI / GIt", "Residuals of moments are measured against the largest moment: the soft rotation "
        "is only as exact as the tolerance of 1e-11 times the ratio."),
    "unit_of_length": ("unit of length", SLENDER, "numerical value of the length L, forces unchanged", UNITS),
    "unit_of_force": ("unit of force", SLENDER, "factor on all stiffnesses and loads", UNITS),
    "elements": ("elements, $k=2$", f"{RIGID}, dead tip force F L^2 / EI = 1.", "number of elements of order 2",
        "The error of order 2 falls with the fourth power of the number of elements down to rounding; from there it grows: the "
        "condition number grows with the square of the number of elements, and strains are differences of displacements over "
        "ever shorter elements."),
    "length_ratio": ("longest / shortest element", f"{RIGID}, dead tip force F L^2 / EI = 10.", "longest to shortest element of "
        "one member, 24 elements growing by one factor from the clamp to the tip", "Strains are differences of "
        "displacements over the length of an element: over the shortest ones they are lost in the rounding of the largest "
        "displacements, which residuals of compatibility allow for."),
    "turns": ("turns of the rod", MOMENT, "turns of one rod, 8 elements for each turn, at least 8",
        "The rotation of the tip is M L / EI = 2 pi turns: a rounding error of the load turns the tip by as much, times the "
        "number of turns."),
    "load_steps": ("load steps", "GIt = EI / 2, dead tip moment that bends by 2 rad about y and 1 rad about z and twists by 1 "
        "rad.", "equal load steps of one path", "The state is total, not a sum of increments: only the rounding of "
        "quaternion products adds up."),
    "element_turn_k1": ("radians per element, $k=1$", MOMENT, "rotation from end to end of each of two elements of order 1, "
        "which have no relative rotation inside", "Half of the rotation lies between the element's triad and each "
        "of its vertices: where it reaches pi, the logarithm has no derivative and the equilibrium ends."),
    "element_turn": ("radians per element", MOMENT, "rotation from end to end of each of two elements of the scene's order",
        "The relative rotation inside the element is a vector without bound; only what remains between it and the "
        "vertices must stay below pi on the way."),
    "angle": ("angle in radians", MOMENT, "rotation of the tip, one element of order 1; the last but two next to the end of the "
        "logarithm's series", "Every coefficient is an entire function of the squared angle, so no small angle is "
        "special. Below 1e-6 the linear solution already meets the tolerance: the part of the motion that is left out is a "
        "quarter of the angle, relative to all of it."),
    "tip_force": ("$FL^2/EI$", f"{RIGID}.", "dead tip force F L^2 / EI, 24 elements growing by 1.4 from the clamp",
        "Large forces bend the rod within sqrt(EI / F) of the clamp, which the mesh has to resolve. Small ones move it by less "
        "than the rounding error of its coordinates, but displacements are unknowns of their own; where the linear solution "
        "already meets the tolerance, the nonlinear part of the motion is left out."),
    "order": ("order $k$", f"{RIGID}, dead tip force F L^2 / EI = 10.", "order k of 4 elements",
        "Vertices converge with the power 2 k of the element length, so each order gains about one and a half digits on this "
        "mesh."),
    "imperfection": ("force across / thrust", f"{RIGID}, in space; dead thrust of 1.2 times Euler's load.",
        "force across over the thrust", "The smaller the force across, the sharper the path turns at Euler's load; "
        "nothing else tells the two sides apart. The turn about the axis of the thrust is as soft as the force across is "
        "small."),
    "thrust": ("thrust / Euler's load", f"{RIGID}, in space; a force across of 1e-4 of the thrust.", "dead thrust over Euler's "
        "load", "Beyond Euler's load there are two equilibria and more; the stable one on the side of the force is "
        "the one that the path reaches. Below it the motion is small, and errors are relative to it."),
    "truss_rise": ("rise / half span", "Two bars on hinges, loaded at the apex by twice the load at which they snap through.",
        "rise over half the span", "The error is that of the critical load factors."),
    "rail_stiffness": (r"$EA\,L^2/EI$", "A clamped rail, shear rigid, heated to three times its critical temperature, on its "
        "branch.", "EA L^2 / EI", "The error is that of the critical load factor.")}


def extremes_figure(folder):
    """Draws a panel for each sweep: error, promised error, condition number times rounding, iterations (right)."""
    table = read_table(folder / "extremes.csv")
    sweeps = list(dict.fromkeys(table["sweep"]))  # in the order of the file
    rows = -(-len(sweeps) // COLUMNS)
    canvas, axes = style.figure(3.4 * COLUMNS, 2.7 * rows + 0.5, rows, COLUMNS, squeeze=False)
    for panel, sweep in zip(axes.flat, sweeps):
        counts = _panel(panel, table.where(sweep=sweep), sweep)
    for panel in axes.flat[len(sweeps):]:
        panel.axis("off")
    handles, labels = axes.flat[0].get_legend_handles_labels()
    more, names = counts.get_legend_handles_labels()
    free = axes.flat[len(sweeps)] if len(sweeps) < axes.size else axes.flat[-1]
    legend = free.legend(handles + more, labels + names, loc="upper left")
    legend.set_in_layout(False)  # it may reach over the free panels beside it
    return canvas


def _panel(axes, table, sweep):
    value, labels = _places(table["value"], sweep)
    good = table["converged"] == 1
    axes.semilogy(value, np.maximum(table["error"], LOWEST_ERROR), "o-", color=style.BLUE, label="error")
    axes.semilogy(value, table["allowed"], color=style.GREY, linestyle=(0, (4, 2)), label="promised")
    axes.semilogy(value[good], table["condition"][good] * np.finfo(float).eps / 2, color=style.GREEN, linewidth=1.0,
                  label="condition number x rounding")
    axes.plot(value[~good], np.full(np.count_nonzero(~good), 1.0), "X", color=style.RED, markersize=8,
              label="no equilibrium found")
    axes.set_ylim(LOWEST_ERROR / 3, 10)
    axes.set_yticks([1e-16, 1e-12, 1e-8, 1e-4, 1])
    if labels:
        axes.set_xticks(*labels)
    elif sweep not in LINEAR:
        axes.set_xscale("log")
    axes.set_title(SWEEPS[sweep][0])
    counts = axes.twinx()
    counts.plot(value[good], table["iterations"][good], ".", color=style.ORANGE, label="Newton iterations (right)")
    counts.set_yscale("log")
    counts.set_ylim(0.8, 5000)
    counts.grid(False)
    counts.spines["right"].set_visible(True)
    counts.tick_params(colors=style.ORANGE, labelsize=8.5)
    axes.set_zorder(counts.get_zorder() + 1)
    axes.patch.set_visible(False)
    return counts


def _places(values, sweep):
    """Returns abscissas, and ticks with labels if the axis does not show plain numbers: infinity is drawn one
    decade beyond the largest value; angles are evenly spaced, since zero and 1e-300 would leave no room for the others."""
    if sweep == "angle":
        places = np.arange(len(values), dtype=float)
        return places, (places[::2], [f"{value:.0e}" if 0 < value < 0.01 else f"{value:.2g}" for value in values[::2]])
    if not np.isinf(values).any():
        return values, None
    finite = np.log10(values[np.isfinite(values)])
    places = np.append(finite, finite.max() + 1)
    shown = places[:-1:3]
    return places, (np.append(shown, places[-1]), [f"$10^{{{place:.0f}}}$" for place in shown] + [r"$\infty$"])


def extremes_page(folder):
    table = read_table(folder / "extremes.csv")
    sweeps = {name: table.where(sweep=name).rows() for name in dict.fromkeys(table["sweep"])}
    text = page.head("extremes", "Extremes",
                     "One quantity of a structure at a time, swept to its limits and compared with a closed form; then "
                     f"paths of random imperfect structures. {len(table)} runs.", folder, figures=True)
    text += "![Errors, iterations and condition numbers over each quantity](extremes.png)\n\n"
    text += _overview(sweeps) + _ends(sweeps) + "".join(_sweep(name, rows) for name, rows in sweeps.items())
    if (folder / "random_paths.csv").is_file():
        text += _random_paths(folder)
    return text


def _overview(sweeps):
    rows = []
    for name, values in sweeps.items():
        good = [row for row in values if row["converged"]]
        counts = [row["iterations"] for row in good] or [float("nan")]
        promised = [row for row in good if row["error"] == row["error"] and row["allowed"] == row["allowed"]]
        worst = max(promised, key=lambda row: row["error"], default=None)
        ends = list(dict.fromkeys(page.short(values[i]["value"]) for i in (0, -1)))
        rows.append([f"[{name}](#{name})", " to ".join(ends), f"{len(good)} of {len(values)}",
                     " to ".join(dict.fromkeys(f"{count:.0f}" for count in (min(counts), max(counts)))),
                     page.error(worst["error"]) if worst else "-", page.short(worst["value"]) if worst else "-",
                     f"{worst['allowed']:.0e}" if worst else "-"])
    return ("The error is the distance of the tip from the closed form over its displacement, or the angle between the "
            "two\nrotations over the angle turned (at most 1 rad), whichever is larger; of the last two sweeps the largest "
            "relative error\nof a critical load factor. `allowed` is what every run checks.\n\n"
            + page.table(["sweep", "values", "converged", "iterations", "largest error", "at", "allowed"], rows))


def _ends(sweeps):
    """Lists runs that end early and errors above the allowed one, each with the reason of its sweep."""
    text = ""
    for name, rows in sweeps.items():
        allowed = np.nanmax([row["allowed"] for row in rows] + [0.0])
        ends = ""
        for row in rows:
            if row["converged"] and not row["error"] > allowed:
                continue
            promise = "allowed" if row["allowed"] == allowed else "allowed elsewhere in this sweep"
            cause = row["failure"].split("\n")[0].split(" What to try:")[0]
            ends += f"  - {page.short(row['value'])}: " + (
                f"error {row['error']:.1e}, {allowed:.0e} is {promise}" if row["converged"] else cause) + "\n"
        text += f"- {name}: {SWEEPS[name][-1]}\n{ends}" if ends else ""
    return "\n## Where it ends\n\n" + (text or "Every run converges, with an error below the allowed one.\n")


def _sweep(name, rows):
    _, scene, swept, limit = SWEEPS[name]
    points = any(row["expected_points"] > 0 for row in rows)
    head = ["value", "converged", "load steps", "failed steps", "iterations", "error", "residual", "condition"]
    cells = [[page.short(row["value"]), "yes" if row["converged"] else "**no**",
              *(f"{row[key]:.0f}" for key in ("load_steps", "failed_steps", "iterations")),
              *(page.error(row[key]) for key in ("error", "residual", "condition")),
              *([f"{row['critical_points']:.0f} of {row['expected_points']:.0f}", f"{row['negative']:.0f}"]
                if points else []), f"{row['processor_seconds']:.3f}"] for row in rows]
    head += ["critical points", "negative eigenvalues at the end"] if points else []
    return (f"\n## {name}\n\n{scene} Swept: {swept}. Closed form: {rows[0]['closed_form']}. {limit}\n\n"
            + page.table([*head, "processor s"], cells))


RANDOM = """
## Random imperfect structures

Columns, frames, arches, rings, lattices, domes and strips in random units, with an imperfection of 1e-6 to 0.1 of the
load or of the length, under forces, moments, heat and motions of supports; all settings are defaults. `passes`: the
full load exceeds a hand formula of the critical one. The end is compared with that of the same path in steps of at
most {step:g}, and in steps half as long; where these differ by more than 1e-10 of the length, or end unstable without
a critical point on the way, nothing is known and the structure is left out. `right`: within 1e-7 of the length;
`refused`: exit code 3; `wrong`: another end, exit code 0. `plain` counts the ends that Newton's method finds for the
whole load at once without any check; `iterations` is the mean, and the costs compare the structures that both find.

"""


def _random_paths(folder):
    table = read_table(folder / "random_paths.csv")
    families = list(dict.fromkeys(table["family"]))
    head = ["family", "structures", "passes", "right", "refused", "wrong", "unknown", "plain right", "iterations",
            "cost in iterations", "in time", "reference in time"]
    rows = [_family(name, table.where(family=name)) for name in families] + [_family("all", table)]
    troubles = "".join(
        f"- {row['family']} {row['number']:.0f}, {row['load']}, imperfection {row['imperfection']:.1e}, "
        f"{row['estimate']:.2f} times critical: {row['outcome']} ({row['steps']:.0f} steps, "
        f"{row['iterations']:.0f} iterations)\n" for row in table.rows() if row["outcome"] in ("refused", "wrong"))
    return RANDOM.format(step=table["reference_step"][0]) + page.table(head, rows) + "\n" + troubles


def _family(name, table):
    both = (table["plain_is_right"] == 1) & (table["outcome"] == "right")

    def cost(key):
        plain = table["plain_" + key][both].sum()
        return table[key][both].sum() / plain if plain > 0 else 0.0

    outcomes = [np.count_nonzero(table["outcome"] == outcome) for outcome in ("right", "refused", "wrong", "unknown")]
    return [name, len(table), np.count_nonzero(table["estimate"] > 1), *outcomes,
            np.count_nonzero(table["plain_is_right"] == 1), f"{table['iterations'].mean():.1f}",
            f"{cost('iterations'):.2f}", f"{cost('processor_seconds'):.2f}",
            f"{table['reference_processor_seconds'].sum() / table['processor_seconds'].sum():.0f}"]
