"""Figure of the critical points of a path: structure and mode at each of them."""

import numpy as np

import style
from structure import add_lines, line_width, tangents

MOST_POINTS = 6
MODE_SHARE = 0.12     # largest displacement of the mode in the picture over the size of the structure
MOST_ACROSS = 0.5     # a mode with more than this share out of the plane is drawn from an oblique direction,
TURN, TILT = 0.6, 0.5  # rotated [rad] about the vertical of the picture, then about its horizontal


def modes_figure(view, points):
    """Draws the undeformed structure (grey), the critical state (black), and that moved along +mode and -mode (red, thin)."""
    shown = points[:MOST_POINTS]
    canvas, panels = style.panels(len(shown), 3, 4.4, 4.2, (0.0, 0.5))
    for axes, (number, point) in zip(panels.flat, enumerate(shown, start=1)):
        axes.set_axis_off()
        _draw_mode(axes, view, point)
        together = f", {point.modes} modes" if point.modes > 1 else ""
        axes.set_title(f"{number}: {point.kind}{together}, load factor {point.load_factor:.6g}\n"
                       + (f"omega {point.omega:.6g}" if point.kind == "flutter" else
                          f"negative eigenvalues {point.negative_before} before, {point.negative_after} after"))
    left_out = f"; the first {MOST_POINTS} of {len(points)}" if len(points) > MOST_POINTS else ""
    canvas.suptitle(f"{view.scene_words}: critical modes (red), amplitude arbitrary{left_out}", fontsize=13)
    return canvas


def _draw_mode(axes, view, point):
    position, mode = view.position(point), point.field("mode")
    plane = view.plane if view.look.plane is not None else _projection(view.plane, mode)
    largest = np.linalg.norm(mode, axis=1).max(initial=0.0)
    mode = mode * (MODE_SHARE * view.size / largest if largest else 0.0)
    width = 0.8 * line_width(view.structure)
    thin = max(0.4 * width, 0.5)
    for points, color, thickness in ((view.structure.reference, style.GREY, thin), (position, style.BLACK, width),
                                     (position - mode, style.RED, thin), (position + mode, style.RED, width)):
        lines, _ = view.lines(points, slopes=tangents(points, view.structure.starts))
        add_lines(axes, lines @ plane.T, color=color, width=thickness)
    axes.autoscale_view()
    axes.set_aspect("equal")
    axes.margins(0.06)


def _projection(plane, mode):
    """Returns the plane of the picture, rotated if it would hide the mode."""
    normal = np.cross(plane[0], plane[1])
    if np.abs(mode @ normal).max(initial=0.0) <= MOST_ACROSS * np.linalg.norm(mode, axis=1).max(initial=0.0):
        return plane
    right = np.cos(TURN) * plane[0] + np.sin(TURN) * normal
    toward = np.cos(TURN) * normal - np.sin(TURN) * plane[0]
    return np.array([right, np.cos(TILT) * plane[1] - np.sin(TILT) * toward])
