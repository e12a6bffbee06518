"""Members as shaded solids with their true sections, like on the page of `mixbeam view`, projected to a plane."""

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb

import style
from results import DRAWN_AS
from structure import RASTER_PIECES, tangents

THIN_ROD = 1 / 110     # diameter of members without a shape over the size of the structure,
SLENDER_ROD = 1 / 10   # and at most this share of the median length of members
MOST_FACES = 60000   # of a picture; sections of larger structures are drawn with fewer sides
MOST_SIDES = 24      # of round sections
FEWEST_SIDES = 3     # of round sections in large structures
THINNEST = 0.003     # least thickness of a member over the extent of the picture
LIGHT, SHINE = np.array([-0.35, 0.55, 0.75]), np.array([-0.18, 0.30, 0.94])  # to the right, up, toward the reader
LIGHT, SHINE = LIGHT / np.linalg.norm(LIGHT), SHINE / np.linalg.norm(SHINE)


class Sections:
    """Kinds of sections of all members, and `dimensions` (n, 4) of all samples, as on the page of `mixbeam view`."""

    def __init__(self, structure):
        run, starts = structure.run, structure.starts
        acting = run.acting()
        shapes = acting.get("sections")
        rod = min(THIN_ROD * structure.size, SLENDER_ROD * float(np.median([member.arc_length[-1] for member in run.members])))
        known = [row[0] for row, shape in zip(shapes["dimensions"], shapes["shape"]) if shape != "none"] if shapes else []
        rod = min([rod, *known])  # not thicker than any member with a shape
        self.kinds = ["none"] * len(run.members)
        self.dimensions = np.tile([rod, rod, 0.0, 0.0], (len(structure.reference), 1))
        for at, member in enumerate(run.members if shapes else ()):
            row = int(acting["members"]["section"][member.index])
            if shapes["shape"][row] == "none":
                continue
            kind, places = shapes["shape"][row].removeprefix(DRAWN_AS), shapes["dimensions"][row].reshape(-1, 4)
            own = slice(starts[at], structure.ends[at])
            self.dimensions[own] = _along(places, member.arc_length / member.arc_length[-1])
            self.kinds[at] = _with_centroid(kind, *places[0]) if kind[0] in "TLU" else kind
            if kind in ("circle", "tube"):
                self.dimensions[own, 1] = self.dimensions[own, 0]


def _along(values, x):
    """Interpolates values at equidistant places to relative arc lengths `x`."""
    places = np.linspace(0.0, 1.0, len(values))
    return np.stack([np.interp(x, places, column) for column in values.T], axis=1)


def _with_centroid(shape, width, height, wall, web):
    """Returns the drawing of a T, L or U: orientation, and offset of the centroid from the middle over width and height."""
    upright = width * wall, 0.0, (height - wall) / 2  # area and middle of the flange at the top, then of the web
    parts = {"T": [upright, (web * (height - wall), 0.0, -wall / 2)],
             "U": [(2 * width * wall, 0.0, 0.0), (web * (height - 2 * wall), (web - width) / 2, 0.0)],
             "L": [(upright[0], 0.0, -upright[2]), (wall * (height - wall), (wall - width) / 2, wall / 2)]}[shape[0]]
    area = sum(part[0] for part in parts)
    second, third = (sum(part[0] * part[i] for part in parts) / area for i in (1, 2))
    turned = shape.endswith("mirrored")
    return f"{shape[0]} {'mirrored' if turned else 'upright'} {second / width:.4f} {(-third if turned else third) / height:.4f}"


def outline(kind, dimensions, sides):
    """Returns corners (..., corners, 2) of sections along axes 2 and 3, counter-clockwise; `dimensions` (..., 4)."""
    width, height, wall, web = (dimensions[..., i, None] for i in range(4))
    x, y, inner, web = width / 2, height / 2, height / 2 - wall, web / 2
    word, *turn = kind.split(" ")
    if word in ("circle", "tube", "none", "ellipse"):
        angle = 2 * np.pi * np.arange(sides) / sides
        return np.stack([x * np.cos(angle), y * np.sin(angle)], axis=-1)
    corners = {"I": [(x, y), (-x, y), (-x, inner), (-web, inner), (-web, -inner), (-x, -inner), (-x, -y), (x, -y), (x, -inner),
                     (web, -inner), (web, inner), (x, inner)],
               "T": [(-x, y), (-x, inner), (-web, inner), (-web, -y), (web, -y), (web, inner), (x, inner), (x, y)],
               "L": [(-x, y), (-x, -y), (x, -y), (x, -inner), (wall - x, -inner), (wall - x, y)],
               "U": [(-x, y), (-x, -y), (x, -y), (x, -inner), (2 * web - x, -inner), (2 * web - x, inner), (x, inner), (x, y)]
               }.get(word, [(x, y), (-x, y), (-x, -y), (x, -y)])
    found = np.stack([np.concatenate(np.broadcast_arrays(*corner), axis=-1) for corner in corners], axis=-2)
    if len(turn) == 3:  # "T upright 0 0.2": with the offset of the centroid over width and height
        found = found - np.concatenate([float(turn[1]) * width, float(turn[2]) * height], axis=-1)[..., None, :]
        if turn[0] == "mirrored":
            found = (found * (1, -1))[..., ::-1, :]
    return found


def draw_solid(axes, view, position, triads, projection, values=None, scale=None, colors=None):
    """Draws the members at `position` (n, 3), `triads` (g2, g3), coloured by `values` on `scale` = (colour map, norm), or by
    `colors` (members, 3). Returns the mappable of a colour bar, and the corners of all faces in the picture."""
    sections, structure = Sections(view.structure), view.structure
    levels = [position[:, 0] * 0 if values is None else np.nan_to_num(values, nan=-1e300), *np.hstack(triads).T, *sections.dimensions.T]
    nodes, along, between, owner = structure.nodes(position, tangents(position, structure.starts), *levels)
    extent = np.ptp(position @ projection.T, axis=0).max() or view.size
    second, third = (np.stack(between[1 + 3 * i:4 + 3 * i], axis=-1) for i in range(2))
    sizes = np.maximum(np.stack(between[7:], axis=-1), THINNEST * extent * np.array([1, 1, 0.3, 0.3]))
    sizes[..., 2:] = np.minimum(sizes[..., 2:], sizes[..., :1] / 2)
    pieces = nodes.shape[0] * (nodes.shape[1] - 1)
    sides = int(np.clip(2 * MOST_FACES / max(pieces, 1), FEWEST_SIDES, MOST_SIDES))
    toward = np.cross(projection[0], projection[1])
    eye, faces, depth, light, level, of = np.vstack([projection, toward]), [], [], [], [], []
    is_first = np.append(True, np.diff(owner) != 0)
    is_last = np.append(np.diff(owner) != 0, True)
    kinds = np.array(sections.kinds)
    for kind in sorted(set(sections.kinds)):
        some = kinds[owner] == kind
        corner = outline(kind, sizes[some], sides)
        ring = nodes[some][:, :, None] + corner[..., :1] * second[some][:, :, None] + corner[..., 1:] * third[some][:, :, None]
        ring = (ring @ eye.T)
        turned = np.roll(ring, -1, axis=2)
        quads = np.stack([ring[:, :-1], turned[:, :-1], turned[:, 1:], ring[:, 1:]], axis=3).reshape(-1, 4, 3)
        normal = np.cross(quads[:, 1] - quads[:, 0], quads[:, 3] - quads[:, 0])
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
        mean = (between[0][some][:, :-1] + between[0][some][:, 1:]) / 2
        seen = normal[:, 2] > 0
        faces += list(quads[seen][..., :2])
        depth.append(quads[seen][..., 2].mean(axis=1))
        light.append(_light(normal[seen]))
        level.append(np.repeat(mean.reshape(-1), ring.shape[2])[seen])
        of.append(np.repeat(owner[some], (ring.shape[1] - 1) * ring.shape[2])[seen])
        for ends, at, sign in ((is_first[some], 0, -1), (is_last[some], -1, 1)):
            caps, outward = ring[ends][:, at], sign * along[some][ends][:, at] @ eye.T
            seen = outward[:, 2] > 0
            faces += list(caps[seen][..., :2])
            depth.append(caps[seen][..., 2].mean(axis=1))
            light.append(_light(outward[seen]))
            level.append(between[0][some][ends][:, at][seen])
            of.append(owner[some][ends][seen])
    order = np.argsort(np.concatenate(depth), kind="stable")
    light, level = (np.concatenate(each)[order, None] for each in (light, level))
    own = np.array(colors)[np.concatenate(of)[order]] if values is None else scale[0](scale[1](level[:, 0]))[:, :3]
    if values is not None:
        own = np.where(level < -1e299, to_rgb(style.GREY), own)
    solid = PolyCollection([faces[i] / view.unit for i in order], facecolors=np.clip(own * light[:, :1], 0, 1), linewidth=0.25, edgecolors="face",
                           zorder=3, rasterized=len(order) > RASTER_PIECES, gid="solid")
    axes.add_collection(solid)
    corners = np.concatenate([ring.reshape(-1, 2) for ring in faces]) / view.unit if faces else position @ projection.T / view.unit
    if values is None:
        return None, corners
    return style.plt.cm.ScalarMappable(scale[1], scale[0]), corners


def _light(normal):
    return 0.62 + 0.42 * np.maximum(normal @ LIGHT, 0.0) + 0.10 * np.maximum(normal @ SHINE, 0.0) ** 40
