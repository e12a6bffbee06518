"""Figures of the trade-off between accuracy and cost: work and precision, unknowns, price of each order."""

import matplotlib.lines
import matplotlib.ticker
import numpy as np

import style
import trade_page as trade_of
from tables import Table

COLUMNS = 4
LOWEST_ERROR = 1e-14
HIGHEST_ERROR = 0.3  # beyond, the mesh has followed another path
SOME = {"linewidth": 0.8, "linestyle": (0, (2, 2))}  # mean over the benchmarks on which an order reaches the accuracy
trade_page = trade_of.trade_page


def trade_time_figure(folder):
    """Draws error over time, a panel for each benchmark, and joins the cells that no other cell beats."""
    return _panels(folder, _draw_times, "time in ms, one thread")


def trade_unknowns_figure(folder):
    """Draws error over all unknowns, including those inside the elements."""
    return _panels(folder, _draw_unknowns, "unknowns (vertices and interior)")


def _panels(folder, draw, label):
    everything, kinds = trade_of.candidates(folder), [row["kind"] for row in trade_of.benchmarks(folder)]
    names = [one.name for one in everything]
    canvas, axes = style.panels(len(names), COLUMNS, 3.5, 2.8, (0.0, 0.7), sharey=True)
    for i, (panel, one) in enumerate(zip(axes.flat, everything)):
        panel.set_xscale("log")
        panel.set_yscale("log")
        floor = max(one.floor, LOWEST_ERROR)
        draw(panel, one.table, floor)
        panel.axhspan(LOWEST_ERROR / 10, floor, color="#EEEEEE", zorder=0)
        panel.set_ylim(LOWEST_ERROR, 3.0)
        panel.set_yticks([1e-12, 1e-9, 1e-6, 1e-3, 1.0])
        panel.set_title(one.name)
        panel.text(0.98, 0.98, kinds[i], transform=panel.transAxes, ha="right", va="top", fontsize=9,
                   color="#555555")
        if i + axes.shape[1] >= len(names):
            panel.set_xlabel(label)
            panel.tick_params(labelbottom=True)
    for row in axes:
        row[0].set_ylabel("largest relative error")
    handles = {text: handle for panel in axes.flat for handle, text in zip(*panel.get_legend_handles_labels())}
    order = sorted(handles)
    canvas.legend([handles[text] for text in order], order, loc="lower center", ncol=len(order),
                  bbox_to_anchor=(0.5, 1.0))
    return canvas


def _lines(panel, cells, across):
    for order in cells.values("order"):
        line = cells.where(order=order).sorted_by("elements")
        look = {**style.order_line(order), "markersize": 3.5, "linewidth": 0.9}
        error = np.where(line["largest_error"] < HIGHEST_ERROR, line["largest_error"], np.nan)
        panel.plot(across(line), np.maximum(error, LOWEST_ERROR * 1.3), **look)


def _draw_times(panel, cells, floor):
    _lines(panel, cells, lambda line: 1e3 * trade_of.seconds(line))
    place = np.argsort(trade_of.seconds(cells))
    error = cells["largest_error"][place]
    place = place[error < np.concatenate(([np.inf], np.fmin.accumulate(error)[:-1]))]  # cells that no other one beats
    place = place[:1 + np.count_nonzero(cells["largest_error"][place] > floor)]  # below, errors are rounding
    panel.plot(1e3 * trade_of.seconds(cells)[place], np.maximum(cells["largest_error"][place], LOWEST_ERROR * 1.3),
               color=style.BLACK, alpha=0.25, linewidth=6, solid_capstyle="round", zorder=1, label="least time")


def _draw_unknowns(panel, cells, _floor):
    _lines(panel, cells, lambda line: line["global_unknowns"] + line["interior_unknowns"])


def trade_orders_figure(folder):
    """Draws the price of using one order everywhere, by time and by operations, for all errors and for the tip alone."""
    prices = trade_of.order_prices(folder)
    canvas, axes = style.figure(11.0, 7.6, 2, 2, sharex=True, sharey=True)
    for row, (measure, error) in zip(axes, (("largest", "largest of all errors"), ("displacement", "tip alone"))):
        for panel, (cost, unit) in zip(row, (("seconds", "time"), ("flops", "operations"))):
            _draw_prices(panel, [price for price in prices if price["measure"] == measure and price["cost"] == cost])
            panel.set_title(f"{unit}, {error}")
        row[0].set_ylabel("cost over that of the cheapest order")
    for panel in axes[1]:
        panel.set_xlabel("accuracy asked for")
    handles, labels = axes[0, 1].get_legend_handles_labels()
    some = matplotlib.lines.Line2D([], [], color=style.GREY, **SOME)
    axes[0, 1].legend(handles + [some], labels + ["on half of the\nbenchmarks\nor more"], loc="upper left",
                      bbox_to_anchor=(1.0, 1.0))
    return canvas


def _draw_prices(panel, prices):
    for order in sorted({price["order"] for price in prices}):
        line = Table({key: np.array([price[key] for price in prices if price["order"] == order])
                      for key in ("accuracy", "reached", "judged", "mean")})
        everywhere = (line["reached"] == line["judged"]) & (line["judged"] > 0)
        look = style.order_line(order)
        panel.plot(line["accuracy"], np.where(everywhere, line["mean"], np.nan), **look)
        if not everywhere.all():  # the mean over a few benchmarks would look too good
            panel.plot(line["accuracy"], np.where(2 * line["reached"] >= line["judged"], line["mean"], np.nan),
                       color=look["color"], **SOME)
    panel.set_xscale("log")
    panel.set_yscale("log")
    panel.set_ylim(0.9, 60)
    _plain_ticks(panel, 50)
    panel.set_xlim(2e-2, 5e-13)


def trade_digits_figure(folder):
    """Draws the cost of the cheapest cell for an accuracy over that for the first one: each benchmark, and the mean."""
    accuracies, everything = trade_of.ACCURACIES, trade_of.candidates(folder)
    canvas, axes = style.figure(11.0, 4.2, 1, 2)
    for panel, cost, title in zip(axes, trade_of.COSTS.values(), ("time", "operations")):
        curves = []
        for one in everything:
            costs = np.array([one.cost("largest_error", cost, accuracy) for accuracy in accuracies])
            curves.append(costs / costs[0])
            panel.loglog(accuracies, curves[-1], color=style.GREY, linewidth=0.9, label="each benchmark")
        panel.loglog(accuracies, np.exp(np.nanmean(np.log(curves), axis=0)), "o-", color=style.BLUE, linewidth=2.2,
                     label="geometric mean")
        panel.set_xlim(2e-2, 5e-13)
        _plain_ticks(panel, np.nanmax(curves))
        panel.set_title(title)
        panel.set_xlabel("accuracy asked for")
    axes[0].set_ylabel("cost of the cheapest cell over that for $10^{-2}$")
    handles = dict(zip(*reversed(axes[1].get_legend_handles_labels())))
    axes[0].legend(handles.values(), handles.keys(), loc="upper left")
    return canvas


def _plain_ticks(panel, highest):
    ticks = [tick for tick in (1, 2, 5, 10, 20, 50, 100, 200, 500) if tick <= 1.01 * highest]
    panel.set_yticks(ticks, [str(tick) for tick in ticks])
    panel.yaxis.set_minor_locator(matplotlib.ticker.NullLocator())
