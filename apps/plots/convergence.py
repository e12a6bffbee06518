"""Convergence plots: error over number of elements, one line per element order."""

import matplotlib
import numpy as np

import style

SLOPE_TOLERANCE = 0.3  # a triangle is drawn if the slope of the line agrees to this
DISTANCE_FROM_LINE = 0.6
ROUND_OFF_MARGIN = 50  # and if the error is this many times the round-off floor


def optimal(order):
    return order + 1


def figure_of_vertices(panels, label):
    """Draws a panel for each (rows of a table, title), whose column `error` falls with the power 2 k."""
    canvas, axes = style.figure(9.5, 4.6, 1, len(panels), sharey=True)
    for each, (rows, title) in zip(axes, panels):
        panel(each, rows, title, "error", lambda order: 2 * order)
        each.tick_params(axis="y", labelleft=True)
    axes[0].set_ylabel(label)
    axes[1].legend(ncol=2, loc="lower left")
    return canvas


def panel(axes, table, title, error="l2_error", rate=None):
    """Draws every order in `table` (columns order, elements and `error`), with triangles of slope `rate(order)` if given."""
    for order in table.values("order"):
        line = table.where(order=order).sorted_by("elements")
        axes.loglog(line["elements"], line[error], **style.order_line(order))
    axes.set_title(title)
    axes.set_xscale("log", base=2)
    axes.xaxis.set_major_formatter(matplotlib.ticker.ScalarFormatter())
    axes.xaxis.set_minor_locator(matplotlib.ticker.NullLocator())
    axes.set_xticks(table.values("elements"))
    axes.set_xlabel("number of elements")
    if rate:
        _slope_triangles(axes, table, error, rate)


def _slope_triangles(axes, table, error, rate):
    """Draws a triangle of slope `rate(order)`, with that number, beside each line."""
    floor = np.nanmin(table[error])
    for order in table.values("order"):
        line = table.where(order=order).sorted_by("elements")
        place = _regular_segment(line["elements"], line[error], rate(order), floor)
        if place is not None:
            _triangle(axes, *place, int(rate(order)), style.ORDER_COLORS[int(order)])


def _regular_segment(elements, errors, rate, floor):
    """Returns the last segment with that rate: (elements at its start, at its end, error at its start), or None."""
    with np.errstate(divide="ignore", invalid="ignore"):
        rates = -np.diff(np.log(errors)) / np.diff(np.log(elements))
    good = (np.abs(rates - rate) < SLOPE_TOLERANCE) & (errors[1:] > ROUND_OFF_MARGIN * floor)
    if not good.any():
        return None
    i = np.flatnonzero(good)[-1]
    return elements[i], elements[i + 1], errors[i]


def _triangle(axes, left, right, top, rate, color):
    first, last = left * (right / left) ** 0.15, left * (right / left) ** 0.85  # does not overlap the markers
    high, low = (DISTANCE_FROM_LINE * top * (end / left) ** -rate for end in (first, last))
    axes.fill([first, last, first], [high, low, low], facecolor=color, alpha=0.25, edgecolor=color, linewidth=0.8)
    axes.annotate(f"{rate}", (np.sqrt(first * last), low), xytext=(0, -2), textcoords="offset points", ha="center",
                  va="top", fontsize=10.5, color=color)
