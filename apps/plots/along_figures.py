"""Section forces and moments of consecutive members, over one running length."""

import numpy as np

import fields
import style
from diagram_figures import force_panels, name_extremes
from results import InputError

SAME_PLACE = 1e-6  # of the extent of the structure: ends nearer to each other meet
MOST_NAMES = 14    # of members shown in a picture
NAME_SHARE = 0.1   # of the height of a panel, below the diagram


def along_figure(view, step, patterns):
    """Draws six panels over the running length of members that form a path; dashed: their ends."""
    members = view.run.members_meant(patterns, "--along")
    row = path_of(members, view.size)
    places, samples, borders = running_length(row)
    exponent = fields.power_of_ten(borders[-1])
    places, borders = places / 10.0 ** exponent, borders / 10.0 ** exponent
    canvas, panels = style.figure(12.4, 7.6, 3, 2, sharex=True)
    values = {name: field.values_at(step, view.size, samples) for name, field in fields.SECTION_FORCES.items()}
    for axes, level in force_panels(view, panels, values, "running length" + fields.times(exponent, view.run.units[0])):
        axes.plot(places, level, color=style.BLUE, gid="diagram")
        axes.fill_between(places, level, color=(*style.rgb(style.BLUE), 0.18), linewidth=0)
        name_extremes(axes, places, level)
    draw_borders(panels, row, borders)
    canvas.suptitle(f"{view.title(step)}: along {style.literal(', '.join(patterns)[:60])}", fontsize=13)
    return canvas


def path_of(members, size):
    """Returns [(member, whether it runs against the path)]. Raises InputError if the members do not form one path."""
    ends = [(member.reference_position[0], member.reference_position[-1]) for member in members]

    def meets(a, b):
        return np.linalg.norm(a - b) <= SAME_PLACE * size

    def touching(point, others):
        return [j for j in others if meets(point, ends[j][0]) or meets(point, ends[j][1])]

    every = range(len(members))
    free = [(i, side) for i in every for side in (0, 1) if not touching(ends[i][side], [j for j in every if j != i])]
    first, side = min(free, default=(0, 0))  # a ring begins with its first member
    left, row, here = [i for i in every if i != first], [(members[first], side == 1)], ends[first][1 - side]
    while left:
        following = touching(here, left)
        if len(following) != 1:
            what = "is followed by none of the others" if not following else "is followed by several: " + ", ".join(
                members[j].name for j in following)
            raise InputError(f"--along: the members form no path: \"{row[-1][0].name}\" {what}")
        nearest = following[0]
        against = meets(here, ends[nearest][1]) and not meets(here, ends[nearest][0])
        row.append((members[nearest], against))
        here = ends[nearest][0 if against else 1]
        left.remove(nearest)
    return row


def running_length(row):
    """Returns (places along the path, numbers of the samples there, places of the ends of members)."""
    places, samples, borders = [], [], [0.0]
    for member, against in row:
        s, numbers = member.arc_length, np.arange(member.samples.start, member.samples.stop)
        places.append(borders[-1] + (s[-1] - s[::-1] if against else s))
        samples.append(numbers[::-1] if against else numbers)
        borders.append(borders[-1] + s[-1])
    return np.concatenate(places), np.concatenate(samples), np.array(borders)


def draw_borders(panels, row, borders):
    """Draws the ends of members in all panels, and the names of the members in the lowest ones."""
    for axes in panels.flat:
        for border in borders[1:-1]:
            axes.axvline(border, color=style.GREY, linewidth=0.7, linestyle=(0, (4, 3)), zorder=1)
    if len(row) > MOST_NAMES:
        return
    for axes in panels[-1]:
        low, high = axes.get_ylim()
        axes.set_ylim(low - NAME_SHARE * (high - low), high)
        for (member, against), begin, end in zip(row, borders[:-1], borders[1:]):
            name = member.name if len(member.name) <= 14 else member.name[:11] + "..."
            axes.annotate(style.literal(name) + (" (from its end)" if against else ""), ((begin + end) / 2, 0.02), fontsize=8.5,
                          xycoords=("data", "axes fraction"), ha="center", color="#666666", gid="member")
