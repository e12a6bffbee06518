"""Figures of time, speed-up and machine use of a Newton iteration."""

import matplotlib.lines
import numpy as np

import style
from tables import NothingToDraw, read_table

THREAD_COLORS = (style.BLUE, style.ORANGE, style.GREEN, style.RED, style.PURPLE, style.SKY, style.GREY, style.BLACK)
# Phases of an iteration from the bottom of a bar to its top, with their colours.
PHASE_COLORS = {
    "residual": style.SKY, "element tangent": style.BLUE, "condense chains": style.ORANGE, "assemble": style.GREY,
    "numeric factorisation": style.PURPLE, "solve": style.RED, "check of the solve": "#F2B49B",
    "recover": style.GREEN, "update": "#7FCEB8", "other": style.BLACK}
SUMS = ("element work", "linear solver", "linear solver, KLU2", "whole iteration", "run, per iteration")
KIND = "spatial"
LATTICES = {"cubic": style.BLUE, "octet": style.ORANGE, "sheet": style.GREEN}
ELEMENTS_OF_STRUT = 2


def _longest(folder):
    """Returns the rows of the longest spatial chains, and their number of elements."""
    table = _table(folder)
    return table.where(elements=max(table["elements"])), max(table["elements"])


def _table(folder):
    """Returns the rows of spatial chains, or of the first kind in the table if it has none."""
    table = read_table(folder / "thread_scaling.csv")
    kinds = list(table.values("kind"))
    return table.where(kind=KIND if KIND in kinds else kinds[0])


def _seconds(table, **key):
    rows = table.where(**key)
    return float(rows["median_seconds"][0]) if len(rows) else 0.0


def cost_figure(folder):
    """Draws microseconds per element over the number of elements, phases stacked, with the unit B for comparison."""
    table, units = _table(folder), read_table(folder / "cases.csv")
    orders, sizes, threads = table.values("order"), table.values("elements"), table.values("threads")[[0, -1]]
    canvas, axes = style.figure(3.1 * len(orders) + 1.5, 4.6, 1, len(orders), squeeze=False)
    width = 0.8 / len(threads)
    for panel, order in zip(axes[0], orders):
        for i, size in enumerate(sizes):
            for j, count in enumerate(threads):
                place = i + (j - (len(threads) - 1) / 2) * width
                _stack(panel, table.where(elements=size, order=order, threads=count), place, 0.92 * width, size)
                panel.annotate(f"{count:g}", (place, 0), (0, -3), textcoords="offset points", ha="center", va="top",
                               fontsize=8.5, color=style.GREY)
            unit = np.median(units.where(elements=size, order=order)["unit_seconds"])
            panel.plot([i - 0.47, i + 0.47], 2 * [1e6 * unit / size], color=style.BLACK, linewidth=1.6,
                       linestyle=(0, (3, 2)), label="B (dgbtrf + dgbtrs)")
        panel.set_xticks(range(len(sizes)), [f"$10^{{{np.log10(size):.0f}}}$" if np.log10(size) % 1 == 0 else f"{size:g}"
                                            for size in sizes])
        panel.tick_params(axis="x", pad=13, length=0)
        panel.grid(axis="x", visible=False)
        panel.set_title(f"order $k={order:g}$")
        panel.set_xlabel("threads, number of elements")
    axes[0, 0].set_ylabel("microseconds for each element")
    handles = {label: handle for panel in axes[0] for handle, label in zip(*panel.get_legend_handles_labels())}
    labels = [label for label in (*reversed(PHASE_COLORS), "B (dgbtrf + dgbtrs)") if label in handles]
    axes[0, -1].legend([handles[label] for label in labels], labels, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return canvas


def _stack(panel, table, place, width, size):
    bottom = 0.0
    for phase, color in PHASE_COLORS.items():
        height = 1e6 * _seconds(table, phase=phase) / size
        if height > 0.0:
            panel.bar(place, height, width, bottom, color=color, label=phase)
            bottom += height


def speed_up_figure(folder):
    """Draws the speed-up of each phase on the longest chain, a panel for each order."""
    table, size = _longest(folder)
    orders = table.values("order")
    canvas, axes = style.figure(11.0, 1.0 + 2.0 * len(orders), len(orders), 1, sharex=True, squeeze=False)
    for panel, order in zip(axes[:, 0], orders):
        _speed_ups(panel, table.where(order=order))
        panel.set_ylabel(f"$k={order:g}$")
    axes[0, 0].set_title(f"speed-up against {min(table['threads']):g} thread, {size:g} elements")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    axes[0, 0].legend(handles, labels, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return canvas


def _speed_ups(panel, table):
    names = set(table["phase"])
    phases = [phase for phase in (*PHASE_COLORS, *SUMS) if phase in names and phase != "other"]
    threads = table.values("threads")[1:]  # the first is the reference
    width = 0.8 / max(1, len(threads))
    for i, count in enumerate(threads):
        rows = table.where(threads=count)
        heights = [float(rows.where(phase=phase)["speed_up"][0]) for phase in phases]
        places = np.arange(len(phases)) + (i - (len(threads) - 1) / 2) * width
        color = THREAD_COLORS[i % len(THREAD_COLORS)]
        panel.axhline(count, color=color, linewidth=0.9, linestyle=(0, (4, 3)))
        bars = panel.bar(places, heights, 0.92 * width, color=color, label=f"{count:g} threads")
        panel.bar_label(bars, fmt="%.2f", fontsize=9.5, padding=-14, color="white")
    panel.set_xticks(np.arange(len(phases)), phases, rotation=25, ha="right")
    panel.grid(axis="x", visible=False)
    panel.set_ylim(0, 1.1 * max(table["threads"]))


def ceilings_figure(folder):
    """Draws operations per second over operations per byte, with the limits of the machine (roofline)."""
    table, size = _longest(folder)
    ceilings = read_table(folder / "ceilings.csv")
    threads = table.values("threads")[[0, -1]]
    canvas, axes = style.figure(6.2 * len(threads) + 2, 5.0, 1, len(threads), sharey=True, squeeze=False)
    for panel, count in zip(axes[0], threads):
        shown = _machine_use(panel, table.where(threads=count))
        _roof(panel, ceilings.where(threads=count), shown)
        panel.set_title(f"{count:g} thread" + ("s" if count > 1 else "") + f", {size:g} elements")
        panel.set_xlabel("floating-point operations for each byte")
    axes[0, 0].set_ylabel("GFlop/s")
    counted = set(table["phase"][np.isfinite(table["flops_per_second"])])
    phases = [phase for phase in PHASE_COLORS if phase in counted]
    handles = [matplotlib.lines.Line2D([], [], color=PHASE_COLORS[phase], marker="o", linestyle="") for phase in phases]
    orders = table.values("order")
    handles += [matplotlib.lines.Line2D([], [], color=style.BLACK, marker=style.ORDER_MARKERS[int(order)], linestyle="")
                for order in orders]
    axes[0, -1].legend(handles, [*phases, *(f"$k={order:g}$" for order in orders)], loc="upper left",
                       bbox_to_anchor=(1.0, 1.0))
    return canvas


def _machine_use(panel, table):
    """Draws a point for each phase and order whose operations are counted; returns the range of operations per byte."""
    intensities = []
    for phase, color in PHASE_COLORS.items():
        rows = table.where(phase=phase)
        for order, flops, size, rate in zip(rows["order"], rows["flops_per_element"], rows["bytes_per_element"],
                                            rows["flops_per_second"]):
            if np.isfinite(flops) and np.isfinite(rate):
                intensities.append(flops / size)
                panel.loglog(flops / size, 1e-9 * rate, color=color, marker=style.ORDER_MARKERS[int(order)],
                             linestyle="")
    if not intensities:
        raise NothingToDraw("thread_scaling.csv has no phase with a number of operations")
    return min(intensities), max(intensities)


def _roof(panel, ceiling, shown):
    peak, bandwidth = (1e-9 * float(ceiling[name][0]) for name in ("flops_per_second", "bytes_per_second"))
    ends = np.array([0.5 * shown[0], max(2 * shown[1], 2 * peak / bandwidth)])
    corner = peak / bandwidth
    panel.plot([ends[0], corner, ends[1]], [bandwidth * ends[0], peak, peak], color=style.BLACK)
    panel.annotate(f"multiply-add: {peak:.1f} GFlop/s", (ends[1], peak), (0, 4), textcoords="offset points", ha="right",
                   fontsize=10)
    panel.annotate(f"triad: {bandwidth:.1f} GB/s", (corner, peak), (4, -8), textcoords="offset points", ha="left",
                   va="top", fontsize=10)


def lattices_figure(folder):
    """Draws time of an iteration and memory per strut of lattices over the number of struts."""
    table = read_table(folder / "thread_scaling.csv").where(phase="whole iteration")
    cases = read_table(folder / "cases.csv")
    kinds = [kind for kind in LATTICES if kind in set(table["kind"])]
    if not kinds:
        raise NothingToDraw("thread_scaling.csv has no lattices")
    canvas, (times, memory) = style.figure(11.0, 4.4, 1, 2)
    for kind in kinds:
        for line, threads in zip(("-", (0, (5, 2)), (0, (1, 1.5))), table.values("threads")):
            rows = table.where(kind=kind, threads=threads).sorted_by("elements")
            times.loglog(rows["elements"] / ELEMENTS_OF_STRUT,
                         1e6 * ELEMENTS_OF_STRUT * rows["median_seconds"] / rows["elements"], marker="o", linestyle=line,
                         color=LATTICES[kind], label=f"{kind}, {threads:g} thread" + ("s" if threads > 1 else ""))
        rows = cases.where(kind=kind).sorted_by("elements")
        memory.semilogx(rows["elements"] / ELEMENTS_OF_STRUT,
                        1e-3 * ELEMENTS_OF_STRUT * rows["memory_bytes_per_element"], marker="o", color=LATTICES[kind],
                        label=kind)
    times.set_ylabel("microseconds of an iteration for each strut")
    memory.set_ylabel("kB of memory for each strut")
    memory.set_ylim(bottom=0)
    for panel in (times, memory):
        panel.set_xlabel("struts")
        panel.legend()
    return canvas
