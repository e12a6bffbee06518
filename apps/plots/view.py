"""View of a structure: direction, scale of displacements, unit of length. Shared by all pictures of a run."""

import numpy as np

import fields
import style
from results import InputError
from structure import Structure, axis_name, best_plane, best_view, plane_of

SHRUNK = 0.3  # below this share of its undeformed extent a structure is drawn without its other states
FLAT = 1e-6     # a structure thinner than this over its size lies in a plane, which is then the view
PLANES = {"xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}
ISO = (35.264, -45.0)  # all three axes equally foreshortened


class Look:
    """Choices of the user: `view` as in --view, `scale` of displacements, `moments`: side of their diagrams."""

    def __init__(self, view=None, scale=1.0, moments="tension"):
        self.scale, self.moments = scale, moments
        self.camera, self.plane = None, None
        if view in PLANES:
            self.plane = np.eye(3)[list(PLANES[view])]
        elif view is not None:
            self.camera = ISO if view == "iso" else _camera(view)
            self.plane = plane_of(self.camera)


def _camera(text):
    """Parses "azimuth/elevation" into (elevation, azimuth)."""
    try:
        azimuth, elevation = (float(word) for word in text.split("/"))
    except ValueError:
        azimuth, elevation = np.nan, np.nan
    if not (np.isfinite(azimuth) and abs(elevation) <= 90.0):
        raise InputError(f"--view {text}: allowed are xy, xz, yz, iso, or azimuth/elevation in degrees, as -60/25 "
                         "(elevation from -90 to 90)")
    return elevation, azimuth


def _way(direction):
    """Returns an arrow character for a direction in the picture."""
    return "\u2192\u2197\u2191\u2196\u2190\u2199\u2193\u2198"[round(np.arctan2(direction[1], direction[0]) / (np.pi / 4)) % 8]


class View:
    """Structure, plane, camera, unit of length and scale of displacements, determined once for a run."""

    def __init__(self, run, steps, look=None):
        self.run, self.structure, self.look = run, Structure(run), look or Look()
        self.everything = np.vstack([self.structure.reference] + [self.position(step) for step in steps])
        self.exponent = fields.power_of_ten(np.abs(self.everything).max())
        self.unit = 10.0 ** self.exponent
        chosen = self.look.plane is not None
        self.plane = self.look.plane if chosen else best_plane(self.everything / self.unit)
        self.camera = self.look.camera or best_view(self.everything / self.unit)
        self.size = self.structure.size
        centered = self.everything - self.everything.mean(axis=0)
        across = np.abs(centered @ np.cross(self.plane[0], self.plane[1])).max()
        self.is_plane = chosen or across <= FLAT * self.size
        self.projection = self.plane if self.is_plane else plane_of(self.camera)  # directions to the right and upwards

    def position(self, of):
        """Returns positions of all samples at a step or critical point, with scaled displacements."""
        if self.look.scale == 1.0:
            return of.field("position")
        return self.structure.reference + self.look.scale * of.field("displacement")

    def lines(self, points, values=None, slopes=None):
        lines, colors = self.structure.pieces(points, values, slopes)
        return lines / self.unit, colors

    def has_shrunk(self, position):
        return np.ptp(position, axis=0).max() < SHRUNK * np.ptp(self.structure.reference, axis=0).max()

    def axis_label(self, direction):
        return axis_name(direction) + fields.times(self.exponent, self.run.units[0])

    def frame(self, axes, points, margin, least, ticks):
        """Sets equal axes around points of the picture, and names them; `margin` and `least` half side over the extent."""
        low, high = points.min(axis=0), points.max(axis=0)
        extent = (high - low).max() or 1.0
        half = np.maximum((high - low) / 2 + margin * extent, least * extent)
        center = (low + high) / 2
        axes.set(xlim=(center[0] - half[0], center[0] + half[0]), ylim=(center[1] - half[1], center[1] + half[1]))
        axes.set_aspect("equal")
        axes.locator_params(nbins=ticks)
        self.name_axes(axes)

    def name_axes(self, axes):
        """Labels axes along x, y or z with numbers; in an oblique view there are no numbers, only directions as words."""
        if all(np.abs(direction).max() > 1 - 1e-9 for direction in self.projection):
            axes.set(xlabel=self.axis_label(self.projection[0]), ylabel=self.axis_label(self.projection[1]))
            return
        axes.set(xticks=[], yticks=[])
        towards = [f"${name}$ {_way(direction)}" for name, direction in zip("xyz", self.projection.T) if np.linalg.norm(direction) > 0.1]
        axes.set_xlabel(", ".join(towards), fontsize=10)

    def field_label(self, field, exponent=0):
        return field.label + fields.times(exponent, field.unit(self.run.units))

    @property
    def scene_words(self):
        return style.literal((self.run.scene_name + (f", {self.run.case}" if self.run.case else ""))[:60])

    def title(self, step):
        return f"{self.scene_words}: step {step.number}, load factor {step.load_factor:.6g}"

    def scale_words(self):
        """Returns the caption on displacements and units."""
        scale = self.look.scale
        shown = "displacements to scale" if scale == 1.0 else f"displacements times {scale:.6g}"
        length, force = self.run.units
        return shown + (f"; lengths in {style.literal(length)}, forces in {style.literal(force)}" if length else "; in the units of the scene")
