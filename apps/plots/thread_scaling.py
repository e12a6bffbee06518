"""Figure of the thread-scaling measurement."""

import numpy as np

import style
from results import InputError, read_table

COLORS = (style.BLUE, style.ORANGE, style.GREEN, style.RED, style.PURPLE, style.SKY, style.GREY, style.BLACK)


def speed_up_figure(folder):
    """Speed-up of each phase against one thread, a panel for each mesh."""
    columns = ["elements", "order", "threads", "phase", "median_seconds"]
    table = read_table(folder / "thread_scaling.csv", columns)
    meshes = sorted({(elements, order) for elements, order in zip(table["elements"], table["order"])})
    canvas, axes = style.figure(max(7.0, 6.0 * len(meshes)), 4.6, 1, len(meshes), sharey=True, squeeze=False)
    for panel, (elements, order) in zip(axes[0], meshes):
        _bars(panel, table.where(elements=elements, order=order), folder)
        panel.set_title(f"{elements:g} elements of order $k={order:g}$")
    axes[0, 0].set_ylabel("speed-up against one thread")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    axes[0, -1].legend(handles, labels, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return canvas


def _bars(panel, table, folder):
    phases = list(dict.fromkeys(table["phase"]))  # in the order of the file
    threads = table.values("threads")
    width = 0.8 / len(threads)
    for i, count in enumerate(threads):
        speed_ups = [_seconds(table, phase, 1, folder) / _seconds(table, phase, count, folder) for phase in phases]
        places = np.arange(len(phases)) + (i - (len(threads) - 1) / 2) * width
        bars = panel.bar(places, speed_ups, 0.92 * width, color=COLORS[i % len(COLORS)],
                         label=f"{count:g} thread" + ("s" if count > 1 else ""))
        panel.bar_label(bars, fmt="%.2f", fontsize=9, padding=1)
        panel.axhline(count, color=COLORS[i % len(COLORS)], linewidth=0.9, linestyle=(0, (4, 3)))
    panel.set_xticks(np.arange(len(phases)), phases, rotation=20 if len(phases) > 4 else 0)
    panel.grid(axis="x", visible=False)
    panel.set_ylim(0, max(threads) * 1.12)


def _seconds(table, phase, threads, folder):
    rows = table.where(phase=phase, threads=threads)
    if len(rows) == 0:
        raise InputError(f"{folder / 'thread_scaling.csv'}: no row for phase {phase} with {threads:g} threads")
    return float(np.median(rows["median_seconds"]))


FIGURES = {"speed_up": (["thread_scaling.csv"], speed_up_figure)}
