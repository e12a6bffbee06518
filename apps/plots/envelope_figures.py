"""Envelopes over load cases and combinations: quantities at the ends of the runs, section forces along members."""

import numpy as np

import fields
import style
from along_figures import draw_borders, path_of, running_length
from diagram_figures import force_panels, name_extremes
from results import Run, lines, open_file

MOST_SHOWN = 40  # quantities of a picture
BEYOND = 2.0     # end of a bar outside of the panel, for an infinite value
MARKS = ("o", "s", "^", "D", "v", "P", "X", "*")
COLORS = (style.BLUE, style.RED, style.GREEN, style.ORANGE, style.PURPLE, style.SKY, style.BLACK, style.GREY)


class Envelope:
    """Quantities of all runs of a scene with load cases, as `mixbeam run` writes them. `path`: SCENE.h5, beside the files of
    the runs."""

    def __init__(self, path):
        self.path = path
        with open_file(path) as file:
            self.names, self.runs = lines(file.text("quantities")), lines(file.text("runs"))
            group, shape = file.group("envelope"), (len(self.names),)
            self.largest, self.smallest = (group.read(name, shape) for name in ("largest", "smallest"))
            self.largest_in, self.smallest_in = (group.read(name, shape) for name in ("largest_in", "smallest_in"))
            if not all(np.all((0 <= found) & (found < len(self.runs))) for found in (self.largest_in, self.smallest_in)):
                raise group.refused("", "names a run that is not there")
            values = group.group("values")
            self.values = np.array([values.read(str(i), shape) for i in range(len(self.runs))])

    def case(self, run):
        """Returns the name of the load case of a run, by its number."""
        return self.runs[int(run)][len(self.path.stem) + 1:]

    def rows(self):
        """Returns rows (quantity, smallest, in case, largest, in case)."""
        return [(name, float(low), self.case(low_in), float(high), self.case(high_in)) for name, low, low_in, high, high_in in
                zip(self.names, self.smallest, self.smallest_in, self.largest, self.largest_in)]

    def units(self):
        """Returns {name: unit} of the quantities from the file of a run; {} if there is no such file."""
        file = next((file for file in self.files() if file.exists()), None)
        if file is None:
            return {}
        with Run(file) as run:
            return run.quantity_units()

    def files(self):
        return [self.path.with_name(f"{run}.h5") for run in self.runs]


def is_envelope(path):
    """Returns whether a file holds an envelope and no run."""
    if not path.is_file():
        return False
    with open_file(path) as file:
        return "envelope" in file


def envelope_beside(run):
    """Returns the Envelope to which a run belongs; None if there is none, or if its values are not those of this run."""
    ending = f"-{run.case}"
    path = run.path.with_name(run.path.stem[:-len(ending)] + run.path.suffix)
    if not run.case or not run.path.stem.endswith(ending) or not is_envelope(path):
        return None
    envelope, quantities = Envelope(path), run.quantities()
    if run.path.stem not in envelope.runs or any(name not in quantities for name in envelope.names):
        return None
    same = envelope.values[envelope.runs.index(run.path.stem)] == [quantities[name][-1] for name in envelope.names]
    return envelope if same.all() else None


def ranges_figure(envelope):
    """Draws a bar from the smallest to the largest value of each quantity, each in its own scale, and a mark for every run."""
    shown = range(min(MOST_SHOWN, len(envelope.names)))
    canvas, axes = style.figure(10.5, 1.5 + 0.36 * len(shown))
    scale = np.abs(np.where(np.isfinite(envelope.values), envelope.values, 0.0)).max(axis=0)
    scale[scale == 0.0] = 1.0
    low, high = (np.clip(ends / scale, -BEYOND, BEYOND) for ends in (envelope.smallest, envelope.largest))
    axes.barh(shown, (high - low)[shown], 0.5, low[shown], color="#D5E3EE", gid="ranges")
    for i in range(len(envelope.runs)):
        look = {"color": COLORS[i], "marker": MARKS[i]} if len(envelope.runs) <= len(MARKS) else {"color": style.GREY, "marker": "."}
        axes.plot((envelope.values[i] / scale)[shown], shown, linestyle="none", markersize=5.5, gid="run",
                  label=style.literal(envelope.case(i)), **look)
    units = envelope.units()
    for row, (name, low, low_in, high, high_in) in zip(shown, envelope.rows()):
        unit = f" {units[name]}" if units.get(name) else ""
        words = f"{low:.4g} ({low_in})  to  {high:.4g}{unit} ({high_in})" if low < high else f"{low:.4g}{unit} in all"
        axes.annotate(style.literal(words), (1.02, row), xycoords=("axes fraction", "data"), va="center", fontsize=9.5, gid="words")
    axes.axvline(0.0, color=style.BLACK, linewidth=0.7, zorder=1)
    axes.set_yticks(list(shown), [style.literal(envelope.names[i]) for i in shown])
    axes.set(xlim=(-1.06, 1.06), ylim=(len(shown) - 0.4, -0.6), xlabel="value over the largest size of the row")
    axes.grid(axis="y", visible=False)
    if len(envelope.runs) <= len(MARKS):
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.62 / (0.36 * len(shown) + 0.4)), ncol=4)
    more = f", the first {MOST_SHOWN} of {len(envelope.names)}" if len(envelope.names) > MOST_SHOWN else ""
    canvas.suptitle(f"{style.literal(envelope.path.stem[:60])}: quantities at the ends of {len(envelope.runs)} runs{more}",
                    fontsize=13)
    return canvas


def along_figure(envelope, patterns, look):
    """Draws section forces along consecutive members: the range over all runs, and each run in grey."""
    from view import View

    found = []  # (places, {name: values}) of each run
    for path in envelope.files():
        with Run(path) as run:
            view = View(run, run.steps[-1:], look)
            row = path_of(run.members_meant(patterns, "--along"), view.size)
            places, samples, borders = running_length(row)
            found.append((places, {name: field.values_at(run.steps[-1], view.size, samples)
                                   for name, field in fields.SECTION_FORCES.items()}))
    exponent = fields.power_of_ten(borders[-1])
    common = found[0][0]
    same = all(np.array_equal(places, common) for places, _ in found)  # with an Accuracy each run has its own mesh
    if not same:
        common = np.unique(np.concatenate([places for places, _ in found]))
    canvas, panels = style.figure(12.4, 7.6, 3, 2, sharex=True)
    at = common / 10.0 ** exponent
    forces = {name: np.array([values[name] if same else np.interp(common, places, values[name]) for places, values in found])
              for name in fields.SECTION_FORCES}
    for axes, levels in force_panels(view, panels, forces, "running length" + fields.times(exponent, view.run.units[0])):
        axes.plot(at, levels.T, color="#B0B0B0", linewidth=0.8, gid="run")
        axes.plot(at, levels.max(axis=0), color=style.BLUE, gid="largest")
        axes.plot(at, levels.min(axis=0), color=style.RED, gid="smallest")
        axes.fill_between(at, levels.min(axis=0), levels.max(axis=0), color=(*style.rgb(style.BLUE), 0.12), linewidth=0)
        name_extremes(axes, np.tile(at, len(levels)), levels.ravel())
    draw_borders(panels, row, borders / 10.0 ** exponent)
    canvas.suptitle(f"{style.literal(envelope.path.stem[:60])}: largest and smallest of {len(found)} runs, along {style.literal(', '.join(patterns)[:60])}", fontsize=13)
    return canvas
