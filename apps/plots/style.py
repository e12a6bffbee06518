"""Style of all figures: fonts, colours that colour-blind readers can distinguish, axes, layout, files."""

import os
import re
import sys
import textwrap

from command import whole_file

if "matplotlib" not in sys.modules:  # else the settings of the host are kept
    here = os.open(".", os.O_PATH)
    os.chdir(os.path.dirname(os.path.abspath(__file__)))  # so that no matplotlibrc of the current folder is read
    import matplotlib
    os.fchdir(here)
    os.close(here)
    matplotlib.rcdefaults()

import matplotlib.colors  # noqa: E402

if "matplotlib.pyplot" not in sys.modules:
    matplotlib.use("Agg")  # draws into files, without a display

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

# Palette of Okabe and Ito without yellow, which is too light for lines on white.
BLUE, ORANGE, GREEN, RED, PURPLE, SKY, BLACK = (
    "#0072B2", "#E69F00", "#009E73", "#D55E00", "#CC79A7", "#56B4E9", "#000000")
GREY = "#8A8A8A"
COMPONENT_COLORS = (BLUE, RED, GREEN)  # components 1, 2, 3 of a vector
COMPONENT_DASHES = ("-", (0, (6, 2)), (0, (2, 1.5)))
ORDER_COLORS = {1: BLUE, 2: ORANGE, 3: GREEN, 4: RED, 5: PURPLE, 6: SKY, 7: GREY, 8: BLACK}
ORDER_MARKERS = {1: "o", 2: "s", 3: "^", 4: "D", 5: "v", 6: "P", 7: "X", 8: "*"}

DOTS_PER_INCH = 160

SETTINGS = {
    "font.family": "STIXGeneral",
    "mathtext.fontset": "stix",
    "font.size": 12,
    "axes.titlesize": 12,
    "axes.labelsize": 12,
    "legend.fontsize": 11,
    "xtick.labelsize": 10.5,
    "ytick.labelsize": 10.5,
    "axes.grid": True,
    "grid.color": "#DDDDDD",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "lines.linewidth": 1.5,
    "lines.markersize": 5,
    "legend.frameon": True,
    "legend.edgecolor": "white",
    "legend.framealpha": 0.85,
    "figure.constrained_layout.use": True,
    "svg.fonttype": "none",  # text stays text
    "savefig.dpi": DOTS_PER_INCH,
}
plt.rcParams.update(SETTINGS)
AS_IS = "as is"  # id of figures whose panels have fixed positions


def figure(width, height, rows=1, columns=1, **options):
    """Returns a figure of that size in inches and its 2-D axes, as `plt.subplots` does."""
    return plt.subplots(rows, columns, figsize=(width, height), **options)


def panels(count, most, width, height, more=(0.0, 0.0), **options):
    """Returns a figure of `count` panels of this size, at most `most` in a row, and its axes; `more`: inches beside and above."""
    columns = min(most, count)
    rows = -(-count // columns)
    canvas, axes = figure(width * columns + more[0], height * rows + more[1], rows, columns, squeeze=False, **options)
    for unused in axes.flat[count:]:
        unused.set_visible(False)
    return canvas, axes


def figure_as_is(width, height, rows=1, columns=1, left=0.1, right=0.98, top=0.9, bottom=0.1, wspace=0.2, hspace=0.2, **options):
    """Returns a figure with panels at fixed positions, which saves the layout: that takes five times as long as drawing."""
    canvas, panels = plt.subplots(rows, columns, figsize=(width, height), constrained_layout=False, **options)
    canvas.subplots_adjust(left, bottom, right, top, wspace, hspace)
    canvas.set_gid(AS_IS)
    return canvas, panels


def figure_3d(width, height, columns=1, rows=1):
    """Returns a figure and a list of 3-D axes, row by row."""
    canvas = plt.figure(figsize=(width, height), constrained_layout=False)
    panels = [canvas.add_subplot(rows, columns, i + 1, projection="3d") for i in range(rows * columns)]
    canvas.subplots_adjust(left=0.02, right=0.96, bottom=0.1, top=0.94, wspace=0.16, hspace=0.1)
    return canvas, panels


def save(canvas, path):
    """Writes the picture, cropped to its content, closes the figure and returns the path."""
    return save_all(canvas, path.with_suffix(""), [path.suffix[1:]])[0]


def lay_out(canvas):
    """Fixes the layout of a figure and returns its bounding box, for bbox_inches of `savefig`."""
    if canvas.get_gid() == AS_IS:
        return None
    if canvas.get_layout_engine() is not None:
        canvas.get_layout_engine().execute(canvas)  # first of two: room for titles depends on panels with fixed aspect
    canvas.draw_without_rendering()
    extras = canvas.get_default_bbox_extra_artists()
    for axes in canvas.axes:
        if axes.name == "3d":
            extras += _finish_3d(axes)
    box = canvas.get_tightbbox(canvas._get_renderer(), bbox_extra_artists=extras).padded(0.08)
    with plt.rc_context({"figure.constrained_layout.use": False}):
        canvas.set_layout_engine(None)  # the layout is not repeated for each format
    return box


def save_all(canvas, path, formats):
    """Writes the picture as `path` with each of these endings, closes the figure and returns the paths."""
    box = lay_out(canvas)
    paths = [path.parent / f"{path.name}.{ending}" for ending in formats]
    with plt.rc_context({"figure.constrained_layout.use": False}):
        for file in paths:
            with whole_file(file) as stream:
                canvas.savefig(stream, format=file.suffix[1:], bbox_inches=box)
    plt.close(canvas)
    return paths


def _finish_3d(axes):
    """Puts the title just above the box, and returns the artists that matplotlib omits when it measures 3-D axes."""
    coordinate_axes = (axes.xaxis, axes.yaxis, axes.zaxis)
    top = max(axis.pane.get_window_extent().y1 for axis in coordinate_axes)
    axes.set_title(axes.get_title(), y=1.0)  # an explicit y keeps matplotlib from choosing one when it draws
    axes.title.set_y(axes.transAxes.inverted().transform((0, top))[1])  # set_title would scale it in 3-D axes
    return [artist for axis in coordinate_axes for artist in (axis.pane, axis.label)]


def equal_axes_3d(axes, points, ticks=5, thinnest=0.25, zoom=1.1):
    """Sets limits around `points` with equal scales on all axes; each extent is at least `thinnest` of the widest one."""
    points = np.asarray(points)
    low, high = points.min(axis=0), points.max(axis=0)
    widest = (high - low).max() or 1.0
    center = (low + high) / 2
    extent = np.maximum(high - low, thinnest * widest) * 1.06
    axes.set_xlim(center[0] - extent[0] / 2, center[0] + extent[0] / 2)
    axes.set_ylim(center[1] - extent[1] / 2, center[1] + extent[1] / 2)
    axes.set_zlim(center[2] - extent[2] / 2, center[2] + extent[2] / 2)
    axes.set_box_aspect(extent, zoom=zoom)
    for axis, size in zip((axes.xaxis, axes.yaxis, axes.zaxis), extent):
        count = max(2, round(ticks * size / extent.max())) + 1
        axis.set_major_locator(matplotlib.ticker.MaxNLocator(count, steps=[1, 2, 5, 10], prune="both"))
        axis.set_rotate_label(False)
        axis.set_pane_color((0.97, 0.97, 0.97, 1.0))
    axes.patch.set_visible(False)  # it would cover the labels of the panel to the left
    axes.tick_params(pad=0, labelsize=9.5)
    axes.set_xlabel("$x_1$", labelpad=2)
    axes.set_ylabel("$x_2$", labelpad=2)
    axes.set_zlabel("$x_3$", labelpad=-1)


def line_3d(axes, points, **options):
    return axes.plot(points[:, 0], points[:, 1], points[:, 2], **options)


def rgb(color):
    return matplotlib.colors.to_rgb(color)


def wrapped(text, letters):
    """Wraps a text into lines of at most `letters` characters, about equally long."""
    count = len(textwrap.wrap(text, letters))
    return next(lines for width in range(len(text) // max(count, 1), letters + 1)
                if len(lines := textwrap.wrap(text, width)) <= count) if count > 1 else [text]


def literal(name):
    """Returns a name from a scene as one line of literal text: matplotlib would typeset text between dollars."""
    return re.sub(r"[\x00-\x1f\x7f]", " ", name).replace("$", r"\$")


def blend(share, first=RED, last=BLUE):
    """Interpolates between two colours; `share` from 0 to 1."""
    first, last = (np.array(matplotlib.colors.to_rgb(color)) for color in (first, last))
    return tuple((1 - share) * first + share * last)


def components_figure(table, across, across_label, prefix, name, label, place):
    """Draws three columns `prefix`1 to 3 of a table over the column `across`; `name` has {} for the number."""
    canvas, axes = figure(7.0, 4.6)
    for i, (color, dashes) in enumerate(zip(COMPONENT_COLORS, COMPONENT_DASHES), start=1):
        axes.plot(table[across], table[f"{prefix}{i}"], color=color, linestyle=dashes, label=name.format(i))
    axes.set(xlabel=across_label, ylabel=label, xlim=(0, table[across].max()))
    axes.legend(loc=place)
    return canvas


def order_line(order):
    """Returns the plot options of element order k, the same in all figures."""
    order = int(order)
    return {"color": ORDER_COLORS[order], "marker": ORDER_MARKERS[order], "label": f"$k={order}$"}


def legend_below_3d(canvas, axes, height):
    """Adds one line of legend for all 3-D panels, at `height` (0 to 1) of the figure."""
    handles, labels = axes.get_legend_handles_labels()
    canvas.legend(handles, labels, loc="upper center", ncol=len(labels), bbox_to_anchor=(0.5, height))
