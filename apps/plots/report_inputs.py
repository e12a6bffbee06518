"""Tables of the inputs of a run, from its result file: sections, members, supports, joints, loads."""

from collections import defaultdict

import numpy as np

from html_page import Cell
from results import DRAWN_AS

SIDE = 64          # pixels of a drawing
FEW = 6            # names shown in a row of the table
ROUNDING = 1e-12   # of the largest component: components below this are zero
AXES = "xyz"
SIZES = {"circle": ("diameter",), "tube": ("diameter", "", "wall"), "rectangle": ("width", "height"), "ellipse": ("width", "height"),
         "box": ("width", "height", "wall"), "I": ("width", "height", "flange", "web"), "T": ("width", "height", "flange", "web"),
         "L": ("width", "height", "wall"), "U": ("width", "height", "flange", "web")}
SIZES.update({f"{word} mirrored": SIZES[word] for word in "TL"})


def write_sections(page, run):
    _sections(page, run, run.acting(), run.units[0])


def write_inputs(page, run, of_case=False):
    """Writes tables in which equal inputs at several places share a row. `of_case`: only supports and loads of one case."""
    acting = run.acting()
    length, force = run.units
    units = {"force": force, "moment": f"{force} {length}", "force per length": f"{force}/{length}", "couple per length": force,
             "displacement": length, "rotation": "rad", "strain": "", "curvature": f"1/{length}", "turns of the ends": "rad"} if length else {}
    if not of_case:
        _sections(page, run, acting, length)
    _supports(page, run, acting.get("supports"), length)
    joints = acting.get("joints")
    if joints and not of_case:
        rows = defaultdict(list)
        for name, kind, point, axis, stiffness in zip(*(joints[column] for column in ("name", "kind", "point", "axis", "stiffness"))):
            rows[kind, _vector(axis) if kind != "ball" else "", float(stiffness) or ""].append(f"{name} at {point}")
        page.table(("joint", "kind", "axis", "stiffness"), [(_names(places), *row) for row, places in rows.items()])
    loads = acting.get("point_loads")
    if loads:
        rows = defaultdict(list)
        for i, point in enumerate(loads["point"]):
            rows[_vector(loads["force"][i]), _vector(loads["moment"][i]), _turns(loads, i), _begin(loads, i)].append(point)
        page.table(_head(("point load at", "force", "moment", "turns with the section", "acts from"), units),
                   [(_names(points), *row) for row, points in rows.items()])
    frames = acting.get("rotating_frames")
    if frames:
        page.table(_head(("point of the axis of the rotating frame", "angular velocity", "turns from"), {"point of the axis of the rotating frame": length}),
                   [(_vector(at), _vector(velocity), _begin(frames, i)) for i, (at, velocity) in enumerate(zip(frames["position"], frames["velocity"]))])
    _along(page, run, acting.get("line_loads"), {"force per length": "force", "couple per length": "couple"}, "line load on", units)
    _along(page, run, acting.get("eigenstrains"), {"strain": "strain", "curvature": "curvature", "turns of the ends": "turns"}, "eigenstrain of", units)


def _head(names, units):
    return [f"{name} [{units[name]}]" if units.get(name) else name for name in names]


def _sections(page, run, acting, length):
    sections, of_member = acting.get("sections"), acting.get("members")
    if not sections or not of_member:
        return
    users = defaultdict(list)
    for member, row in zip(run.members, of_member["section"]):
        users[int(row)].append(member.name)
    sizes, strength = sections["dimensions"].reshape(-1, 9, 4), sections["strength"]
    rows = []
    for i, members in sorted(users.items()):
        shape = sections["shape"][i].removeprefix(DRAWN_AS)
        words = "stiffnesses" if shape == "none" else sections["shape"][i] + ": " + ", ".join(
            f"{what} {_range(sizes[i, :, k])}" for k, what in enumerate(SIZES.get(shape, ())) if what)
        rows.append((sections["name"][i], _drawing(shape, *sizes[i, 0]), words, _range(strength[i]) if strength[i].any() else "",
                     _names(members)))
    page.table(("section", "", f"shape{f' [{length}]' if length else ''}", "strength", "members"), rows)


def _supports(page, run, supports, length):
    if not supports:
        return
    rows = defaultdict(list)
    for i, point in enumerate(supports["point"]):
        fixed, stiffness, prescribed = (supports[name][i] for name in ("fixed", "stiffness", "prescribed"))
        turned = np.abs(supports["axes"][i].reshape(3, 3) - np.eye(3)).max() > ROUNDING
        words = [", ".join(f"{kind} {_letters(held)}" for kind, held in (("displacement", fixed[:3]), ("rotation", fixed[3:]))
                           if np.any(held))]
        words += [f"spring {what} {AXES[k % 3]}: {stiffness[k]:.4g}" for k, what in enumerate(["displacement"] * 3 + ["rotation"] * 3)
                  if stiffness[k] > 0.0]
        moved = f"{_vector(prescribed[:3])} {length}; {_vector(prescribed[3:])} rad" if prescribed.any() else ""
        axes = " / ".join(map(_vector, supports["axes"][i].reshape(3, 3))) if turned else ""
        rows["; ".join(filter(None, words)) or "free", axes, moved, _begin(supports, i) if moved else ""].append(point)
    page.table(("support at", "fixed", "axes", "prescribed displacement; rotation", "acts from"),
               [(_names(points), *row) for row, points in rows.items()])


def _along(page, run, table, columns, title, units):
    """Writes vectors at the start, in the middle and at the end of members or of the range in which they act."""
    if not table:
        return
    rows = defaultdict(list)
    columns = {name: column for name, column in columns.items() if column != "turns" or np.any(table.get(column, 0.0))}
    for i, member in enumerate(table["member"]):
        of = run.member_of_index(int(member))
        begin, end = table["range"][i] if "range" in table else (0.0, 1.0)
        part = f" ({begin:.4g} to {end:.4g} of its length)" if end - begin < 1.0 else ""
        vectors = [table[column][i].reshape(-1, 3) for column in columns.values()]
        parts = [" ... ".join(dict.fromkeys(_vector(of_member[place]) for place in (0, len(of_member) // 2, -1))) for of_member in vectors]
        rows[(*parts, *([_turns(table, i)] if "follower" in table else []), _begin(table, i))].append((of.name if of else f"{member}") + part)
    turns = ["turns with the section"] if "follower" in table else []
    page.table(_head((title, *columns, *turns, "acts from"), units), [(_names(members), *row) for row, members in rows.items()])


def _turns(table, i):
    return "yes" if table["follower"][i] else "no"


def _begin(table, i):
    begins = float(table["begins"][i])
    return "by its amplitude" if begins < 0.0 else f"stage {begins + 1:.4g}"


def _letters(held):
    return " ".join(AXES[k] for k in range(3) if held[k])


def _vector(values):
    """Returns four digits of each component; empty if all are zero."""
    values = np.where(np.abs(values) < ROUNDING * np.abs(values).max(), 0.0, values)
    return "(" + ", ".join(f"{value:.4g}" for value in values) + ")" if values.any() else ""


def _range(values):
    low, high = values.min(), values.max()
    return f"{low:.4g}" if high - low <= ROUNDING * abs(high) else f"{values[0]:.4g} to {values[-1]:.4g}"


def _names(names):
    kinds = list(dict.fromkeys(names))
    return ", ".join(kinds[:FEW]) + (f" and {len(kinds) - FEW} more" if len(kinds) > FEW else "")


def _drawing(shape, width, height, wall, web):
    """Draws a section, axis 2 to the right, axis 3 upwards."""
    from solid import outline

    if shape not in SIZES:
        return ""
    height = height if shape not in ("circle", "tube") else width
    wall, web = (min(size, 0.5 * min(width, height)) for size in (wall, web))

    def around(w, h):
        if shape in ("circle", "tube", "ellipse"):
            return f"M{-w / 2:.6g} 0A{w / 2:.6g} {h / 2:.6g} 0 1 0 {w / 2:.6g} 0A{w / 2:.6g} {h / 2:.6g} 0 1 0 {-w / 2:.6g} 0Z"
        corners = outline(shape, np.array([w, h, wall, web]), 0) * (1, 1 if shape.endswith("mirrored") else -1)  # an SVG's y points down
        return "M" + "L".join(f"{x:.6g} {y:.6g}" for x, y in corners) + "Z"

    path = around(width, height)
    if shape in ("tube", "box"):
        path += around(width - 2 * wall, height - 2 * wall)
    side = 1.1 * max(width, height)
    return Cell(f"{shape} section", f"<svg width={SIDE} height={SIDE} viewBox=\"{-side / 2:.6g} {-side / 2:.6g} {side:.6g} {side:.6g}\">"
                f"<path d=\"{path}\" fill=\"#9fbcd6\" stroke=\"#24506f\" stroke-width=\"{side / 60:.3g}\" fill-rule=\"evenodd\"/></svg>")
