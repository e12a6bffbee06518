"""Page on the order and mesh to choose for an accuracy, from the tables of the program trade."""

import csv

import numpy as np

import page
from tables import InputError, read_table

ACCURACIES = 10.0 ** -np.arange(2, 13)
QUANTITIES = ("displacement", "centerline", "moment", "energy")
MEASURES = {"largest": "largest_error", "displacement": "displacement_error"}
FULL_ELEMENTS = 16  # of the comparison of integrations
# Estimates are judged if the true error is neither that of a very coarse mesh nor rounding, and is known to a tenth
# from the references.
LARGEST, SMALLEST, ABOVE_DIFFERENCE, FACTOR = 1e-2, 1e-10, 10.0, 5.0
ROUND_OFF = 1e-11  # errors below are not used for rates


def cells(folder, kind="matrix"):
    return read_table(folder / "trade.csv").where(set=kind)


def benchmarks(folder, kind="matrix"):
    return read_table(folder / "benchmarks.csv").where(set=kind).rows()


def seconds(table):
    """Returns processor times with the first number of threads: the first column of that name."""
    return table[next(name for name in table.names() if name.startswith("processor_seconds_"))]


def operations(table):
    return table["flops"]


COSTS = {"seconds": seconds, "flops": operations}


class Candidates:
    """Cells of a benchmark with an equilibrium, both force parts with reduced integration."""

    def __init__(self, about, table):
        self.name, self.floor = about["benchmark"], about["floor"]
        self.table = table.where(benchmark=self.name, integration="both reduced", status="converged")

    def cheapest(self, error, cost, accuracy, order=None):
        """Returns the number of the cell; None if no cell is as accurate, or if so small an error cannot be judged."""
        good = self.table[error] <= accuracy
        if order is not None:
            good &= self.table["order"] == order
        if accuracy < self.floor or not good.any():
            return None
        return int(np.argmin(np.where(good, cost(self.table), np.inf)))

    def cost(self, error, cost, accuracy, order=None):
        cell = self.cheapest(error, cost, accuracy, order)
        return np.nan if cell is None else cost(self.table)[cell]

    def mesh(self, cell):
        return f"{self.table['order'][cell]:.0f} x {self.table['elements'][cell]:.0f}"


def candidates(folder):
    table, about = cells(folder), benchmarks(folder)
    if not about:
        raise InputError(f"{folder / 'benchmarks.csv'}: only scenes of the gallery")
    return [Candidates(one, table) for one in about]


def mean(values):
    """Returns the geometric mean."""
    return np.exp(np.mean(np.log(values))) if len(values) else np.nan


def order_prices(folder):
    """Computes the price of using one order everywhere: a row for each error, cost, accuracy and order.

    mean and worst: cost of its cheapest mesh over that of the cheapest order, over the benchmarks on which it reaches
    the accuracy; elements: of that mesh; judged: benchmarks on which any order reaches it.
    """
    everything, rows = candidates(folder), []
    orders = cells(folder).values("order")
    for measure, error in MEASURES.items():
        for unit, cost in COSTS.items():
            for accuracy in ACCURACIES:
                best = [one.cost(error, cost, accuracy) for one in everything]
                for order in orders:
                    chosen = [(one, one.cheapest(error, cost, accuracy, order), least)
                              for one, least in zip(everything, best)]
                    chosen = [choice for choice in chosen if choice[1] is not None]
                    ratios = [cost(one.table)[cell] / least for one, cell, least in chosen]
                    rows.append({
                        "measure": measure, "cost": unit, "accuracy": accuracy, "order": order, "reached": len(chosen),
                        "judged": np.count_nonzero(np.isfinite(best)), "mean": mean(ratios),
                        "worst": max(ratios, default=0.0),
                        "elements": mean([one.table["elements"][cell] for one, cell, _ in chosen])})
    return rows


def write_orders(folder, prices):
    with open(folder / "orders.csv", "w", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, list(prices[0]))
        writer.writeheader()
        writer.writerows(prices)


INTRODUCTION = """Every element order on every mesh, on {benchmarks} structures: what each digit costs, and which order
pays when. {cells} cells, {converged} with an equilibrium.

A cell is an order k on a number of elements for each member, written k x n. Its error is the largest of four, all
relative to a reference: displacement of a tip, centerline and material moment in the L2 norm, strain energy. Its time
is the processor time with one thread from the scene to equilibrium, reading left out, which is the wall time on an idle
machine: the median of several runs for short ones. Wall times are in trade.csv; here they were {wall:.2f} times as long
(median). Stability is determined only where a branch is followed.
"""

ORDERS = """## Which order to take

Price of an order: cost of its cheapest mesh over that of the cheapest mesh of all orders, geometric mean over the
benchmarks (largest in brackets). Where an order misses the accuracy on some benchmarks with the meshes allowed, it
says on how many it is reached. `benchmarks`: those on which the accuracy can be judged. `n`: elements of each member
for the order taken, geometric mean.

![Price of each order](trade_orders.png)

Meshes are powers of two, so that prices below about 1.5 are as good as equal. By time:

{seconds} By floating-point operations (counted for a Newton iteration of a plain section, times iterations): what
large structures cost, whose time does not go into parts that are the same on every mesh.

{flops}
![What each digit costs](trade_digits.png)
"""

CHEAPEST = """
## The cheapest cell of each benchmark

For the largest of the four errors; `-`: below the judged range (ten times the difference of the references), or not
reached.

{largest}
For the displacement of the tip alone, which converges with the power 2 k in place of k + 1:

{displacement}
![Error over time](trade_time.png)

![Error over unknowns](trade_unknowns.png)
"""

ASKING = """
## Asking for an accuracy

Runs with `Accuracy` in a scene: meshes that they went through (order x elements of a member, the finest
where they differ; a star: the solution carried over, else the whole path followed), estimated and true error of tip and
centerline, time of all of it, the cheapest single cell with so small an error, and the ratio of the times. Times are
those of the processor with one thread and those of the clock with more: medians of runs of both in turn. More threads
than one are used where a structure is large enough, unless the user says otherwise; here they were forced on all. Times
of the clock mean something on an idle machine only.

"""

GALLERY = """
### Scenes of the gallery

The start meshes were found with the benchmarks above; these scenes had no part in that. They are solved as their files
say, stability, steps and stages included, so that time is that of the whole path. The error is the larger one of
centerline and points, these over the largest displacement. `on the path`: critical loads, and displacements at load
factors for which the file has values; no accuracy was asked for them. Cells: the elements of the file, halved and
doubled, in all orders, as far as they may be the cheapest for one of the accuracies.

"""

ESTIMATES = """
## Estimated errors

Every run estimates its own error (one Newton correction in the next order, on few elements the one after). Estimate over true error in all cells of
the default integration whose true error is 1e-10 to 1e-2 and at least ten times the difference of the references:

{table}
It takes {cost:.2f} times as long as the solution (median over all cells, most of which take a millisecond).
"""

REFERENCES = """
## References

Errors are measured against a far finer solution, which another order on another mesh confirms; the run checks that
they agree to 1e-10, and compares the reference with the closed forms and literature values of the scene. Scenes of the
gallery are judged by their displacements only; elements are those of the finest member, and values of the path are
compared by the scene itself.

"""


def trade_page(folder):
    table, about, scenes = cells(folder), benchmarks(folder), benchmarks(folder, "gallery")
    good = table.where(status="converged")
    wall = good[next(name for name in table.names() if name.startswith("seconds_"))] / seconds(good)
    solved = len(good) + np.count_nonzero(table["status"] == "failed")
    text = page.head("trade", "The trade between accuracy and cost", INTRODUCTION.format(
        benchmarks=len(about), cells=solved, converged=len(good), wall=np.median(wall) if len(wall) else np.nan),
        folder, figures=True)
    if about:
        prices, everything = order_prices(folder), candidates(folder)
        write_orders(folder, prices)
        text += ORDERS.format(**{unit: _prices(everything, prices, unit) for unit in COSTS})
        text += CHEAPEST.format(**{name: _cheapest(everything, error) for name, error in MEASURES.items()})
    text += ASKING + (_accuracies(folder, "matrix", "benchmark") if about else "")
    text += GALLERY + _accuracies(folder, "gallery", "scene") if scenes else ""
    if about:
        text += _rates(everything) + _integrations(table) + _threads(table, about) + _estimates(table, about)
    return text + REFERENCES + _references(about + scenes) + _failures(table)


def _prices(everything, prices, unit):
    """Returns a table with a row for each accuracy, the price of each order in it."""
    rows, cost = [], COSTS[unit]
    orders = list(dict.fromkeys(price["order"] for price in prices))
    for accuracy in ACCURACIES:
        of_accuracy = [price for price in prices if price["accuracy"] == accuracy and price["cost"] == unit
                       and price["measure"] == "largest"]
        best = max(of_accuracy, key=lambda price: (price["reached"], -price["mean"]))
        if best["reached"] == 0:
            continue
        row = [f"{accuracy:.0e}", best["judged"]]
        for price in of_accuracy:
            text = f"{price['mean']:.2f} ({price['worst']:.1f})"
            row.append(f"{price['reached']} of {price['judged']}" if price["reached"] < best["reached"] else
                       f"**{text}**" if price is best else text)
        ratios = [one.cost("largest_error", cost, accuracy) / one.cost("largest_error", cost, ACCURACIES[0])
                  for one in everything]
        rows.append(row + [f"**{best['order']:.0f}**", f"{best['elements']:.0f}",
                           f"{mean([ratio for ratio in ratios if np.isfinite(ratio)]):.1f}"])
    return page.table(["error", "benchmarks", *(f"k = {order:.0f}" for order in orders), "take k", "n",
                       "cost against 1e-02"], rows)


def _cheapest(everything, error):
    def text(one, accuracy):
        cell = one.cheapest(error, seconds, accuracy)
        return "-" if cell is None else f"{one.mesh(cell)}, {page.duration(seconds(one.table)[cell])}"

    return page.table(["benchmark", *(f"{accuracy:.0e}" for accuracy in ACCURACIES)],
                      [[one.name, *(text(one, accuracy) for accuracy in ACCURACIES)] for one in everything])


def _accuracies(folder, kind, label):
    table = read_table(folder / "accuracy.csv").where(set=kind)
    floors = {about["benchmark"]: about["floor"] for about in benchmarks(folder, kind)}
    threads = list(dict.fromkeys(table["threads"]))
    first = table.where(threads=threads[0]).rows() if threads else []
    kept = [_motion(row) <= row["wanted"] for row in first if row["wanted"] >= floors[row["benchmark"]]]
    text = f"{sum(kept)} of {len(kept)} true errors are below the accuracy."
    for count in threads:
        ratios = table.where(threads=count)["ratio"]
        ratios = ratios[np.isfinite(ratios)]
        if len(ratios):
            text += (f" Ratio with {count:.0f} thread{'' if count == 1 else 's'}: {np.median(ratios):.2f} (median), at "
                     f"most {ratios.max():.2f}.")
    head = [label, "wanted", "meshes", "estimated", "true", "on the path", "time", "best cell", "ratio"]
    for count in threads[1:]:
        head += [f"{count:.0f} threads", "best cell", "ratio"]
    rows = []
    for row in first:
        cells_of_row = [row["benchmark"], f"{row['wanted']:.0e}", row["meshes"], page.error(row["estimated_error"]),
                        page.error(_motion(row)), page.error(row["path_error"])]
        for price in table.where(benchmark=row["benchmark"], wanted=row["wanted"]).rows():
            has_best = price["best_order"] > 0
            cells_of_row += [page.duration(price["seconds"]),
                             f"{price['best_order']:.0f} x {price['best_elements']:.0f}, "
                             f"{page.duration(price['best_seconds'])}" if has_best else "-",
                             f"{price['ratio']:.2f}" if has_best else "-"]
        rows.append(cells_of_row)
    return text + "\n\n" + page.table(head, rows)


def _motion(row):
    return max(row["displacement_error"], row["centerline_error"])


def _rates(everything):
    """Returns the rates of convergence between the finest two meshes above rounding."""
    def rate(table, error, floor):
        above = np.cumprod(table[error] > max(ROUND_OFF, floor)).sum()
        if above < 2:
            return "-"
        errors, elements = table[error][above - 2:above], table["elements"][above - 2:above]
        return f"{np.log(errors[0] / errors[1]) / np.log(elements[1] / elements[0]):.1f}"

    orders = sorted({order for one in everything for order in one.table.values("order")})
    rows = []
    for one in everything:
        of_orders = [one.table.where(order=order).sorted_by("elements") for order in orders]
        rows.append([one.name, *(" / ".join(rate(table, name + "_error", one.floor) for name in QUANTITIES)
                                 for table in of_orders)])
    return ("\n## Rates of convergence\n\nDisplacement of the tip / centerline / moment / energy, between the finest "
            "two meshes above rounding and reference.\n\n"
            + page.table(["benchmark", *(f"k = {order:.0f}" for order in orders)], rows))


def _integrations(table):
    """Returns error and time with force strains fully integrated, beside those with both parts reduced."""
    full = table.where(integration="full", elements=FULL_ELEMENTS)
    text = ""
    for name in dict.fromkeys(full["benchmark"]):
        pairs = [(reduced, row) for row in full.where(benchmark=name).rows() for reduced in table.where(
            benchmark=name, integration="both reduced", elements=row["elements"], order=row["order"]).rows()]
        key = next(column for column in table.names() if column.startswith("processor_seconds_"))
        text += f"\n{name}:\n\n" + page.table(["k x n", "reduced", "full", "reduced", "full"], [
            [f"{row['order']:.0f} x {row['elements']:.0f}",
             *(f"{of['largest_error']:.1e}" if of["status"] == "converged" else of["status"] for of in (reduced, row)),
             *(page.duration(of[key]) if of["status"] == "converged" else "-" for of in (reduced, row))]
            for reduced, row in pairs])
    head = f"\n## Full integration of the force strains\n\nError and time on {FULL_ELEMENTS} elements.\n"
    return head + text if text else ""


def _threads(table, about):
    threads = [name[len("seconds_"):] for name in table.names() if name.startswith("seconds_")]
    if len(threads) < 2:
        return ""
    members = {row["benchmark"]: row["members"] for row in about}
    elements = table["elements"] * np.array([members[name] for name in table["benchmark"]])
    gain = table["seconds_" + threads[0]] / table["seconds_" + threads[1]]
    rows = []
    for least in 4 ** np.arange(6):
        of_size = gain[(elements >= least) & (elements < 4 * least) & np.isfinite(gain)]
        if len(of_size):
            rows.append([f"{least} to {4 * least - 1}", len(of_size), f"{mean(of_size):.2f}"])
    return (f"\n## Threads\n\nTime with {threads[0]} thread over time with {threads[1]}, geometric mean over the cells "
            "with so many elements in all.\n\n" + page.table(["elements", "cells", "gain"], rows))


def _estimates(table, about):
    good = table.where(status="converged")
    reduced, rows = good.where(integration="both reduced"), []
    for quantity in QUANTITIES:
        difference = {row["benchmark"]: row[quantity + "_difference"] for row in about}
        error = reduced[quantity + "_error"]
        judged = (error >= SMALLEST) & (error <= LARGEST) & (
            error >= ABOVE_DIFFERENCE * np.array([difference[name] for name in reduced["benchmark"]]))
        if not judged.any():
            continue
        ratio = reduced[quantity + "_estimate"] / np.where(judged, error, np.nan)
        within = np.count_nonzero((ratio >= 1 / FACTOR) & (ratio <= FACTOR))
        cell = int(np.nanargmin(ratio))
        rows.append([quantity, np.count_nonzero(judged), np.count_nonzero(judged & np.isnan(ratio)),
                     f"{100 * within / np.count_nonzero(judged):.1f} %", f"{ratio[cell]:.2g}",
                     f"{reduced['benchmark'][cell]} {reduced['order'][cell]:.0f} x {reduced['elements'][cell]:.0f}",
                     f"{np.nanmax(ratio):.2g}"])
    return ESTIMATES.format(cost=np.median(good["estimate_seconds"] / seconds(good)), table=page.table(
        ["quantity", "cells", "without estimate", "within a factor of 5", "least", "at", "largest"], rows))


def _references(about):
    return page.table(
        ["benchmark", "what", "members", "tip", "reference", "confirmed by", *QUANTITIES, "values checked"],
        [[row["benchmark"], row["kind"], f"{row['members']:.0f}", row["point"] or "all points", row["reference"],
          row["confirmation"], *(f"{row[name + '_difference']:.0e}" if row["set"] == "matrix" or name in QUANTITIES[:2]
                                 else "-" for name in QUANTITIES),
          f"{row['values_checked']:.0f}"] for row in about])


def _failures(table):
    text, failed = "", table.where(status="failed")
    for name in dict.fromkeys(failed["benchmark"]):
        text += f"- {name}: " + ", ".join(
            f"{row['order']:.0f} x {row['elements']:.0f}" + (" (full)" if row["integration"] == "full" else "")
            for row in failed.where(benchmark=name).rows()) + "\n"
    return "\n## Meshes without an equilibrium\n\n" + (text or "None.\n")
