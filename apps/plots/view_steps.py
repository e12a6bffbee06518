"""The steps that a page of `mixbeam view` holds, packed: all of them, or as many as a page has room for."""

import numpy as np

from fields import MEGAPASCALS, Field
from packed import FOR_DRAWING, FOR_READING, Packed

MOST_NUMBERS = 12e6    # of steps that are read: 100 MB
MOST_BYTES = 1.02e6    # of packed numbers in a page, which base64 makes a third larger: 1.5 MB with all else,
FEWEST_STEPS = 10      # but so many of larger results are drawn
NUMBERS_OF_SAMPLE = 19  # in a step without stresses
SAME = 0.5             # units by which strains may differ from compliance times force

FORCES = ("material_force", "material_moment")
COMPLIANT = dict(zip(("force_strain", "moment_strain"), FORCES))  # by the compliance of a section
COMPONENTS = ("displacement", *FORCES, *COMPLIANT)
STRESSES = ("largest_normal_stress", "largest_shear_stress", "von_mises_stress")
STEP_ARRAYS = (*COMPONENTS, *STRESSES, "utilisation")


class HeldStep:
    """The fields of a step, each read once, round-off being zero; stresses divided by the strength are one of them."""

    units = ("", "")  # stresses are in those of the page

    def __init__(self, step, strength, size):
        self._step, self._strength, self._held = step, strength, {}
        for name in COMPONENTS:
            self._held[name] = step.field(name)
        floors = {name: Field("", name, [0]).floor(self, size) for name in COMPONENTS}
        self.force_floors = [floors[name] for name in FORCES]
        self._is_loaded = any(np.abs(self._held[name]).max(initial=0.0) > floors[name] for name in FORCES)
        for name, floor in floors.items():
            self._held[name][np.abs(self._held[name]) <= floor] = 0.0

    def has(self, name):
        if name == "utilisation":
            return self._step.has("von_mises_stress") and np.isfinite(self._strength).any()
        return self._step.has(name)

    def field(self, name):
        if name == "utilisation":
            return self._step.field("von_mises_stress") / self._strength
        if name not in self._held:
            self._held[name] = self._step.field(name) * (MEGAPASCALS.get(self._step.units, 1.0) if name in STRESSES else 1.0)
            if name in STRESSES and not self._is_loaded:
                self._held[name] = np.where(np.isfinite(self._held[name]), 0.0, np.nan)
        return self._held[name]

    def arrays(self, kept, names):
        """Of the samples that a page draws."""
        return {name: self.field(name)[kept] for name in names if self.has(name)}


def places_read(count, samples):
    """Numbers of the steps that are read: the last one, and as many others as there is memory for, evenly."""
    return _evenly(count, max(2, int(MOST_NUMBERS / (NUMBERS_OF_SAMPLE * samples))))


def packed_steps(steps, room):
    """([number of each step that is held], {name of its array: Packed}) of the arrays of steps, in `room` bytes."""
    count = len(steps)
    while True:
        chosen = _evenly(len(steps), count)
        held = _packed([steps[i] for i in chosen])
        size = sum(len(packed.bytes) for packed in held.values())
        if size <= room or count <= FEWEST_STEPS:
            return chosen, held
        count = max(FEWEST_STEPS, min(count - 1, int(count * room / size)))


def _packed(steps):
    """Backwards from the last step, which the page shows first."""
    held = {}
    for at in reversed(range(len(steps))):
        for name, values in steps[at].items():
            later = [held[f"{name}-{k}"] for k in (at + 1, at + 2) if f"{name}-{k}" in held]
            is_next = f"{name}-{at + 1}" in held
            held[f"{name}-{at}"] = Packed(values, FOR_DRAWING if name == "triad" else FOR_READING, later if is_next else ())
    return held


def taken_out(steps, groups, names):
    """{name of a group of samples: compliances (6,)} where strains are these times the forces in all steps; the strains are
    then taken out of the steps. Nothing where they are not. `groups`: of each sample."""
    found = {name: [] for name in names}
    for strain, force in COMPLIANT.items():
        for component in range(3):
            pairs = [(step[force][:, component], step[strain][:, component]) for step in steps]
            above = sum(np.bincount(groups, f * e, len(names)) for f, e in pairs)
            below = sum(np.bincount(groups, f * f, len(names)) for f, _ in pairs)
            ratio = np.divide(above, below, out=np.zeros(len(names)), where=below > 0)
            for f, e in pairs:
                unit = np.abs(e).max(initial=0.0) / 2 ** (FOR_READING - 1)
                if np.any(np.abs(e - ratio[groups] * f) > SAME * unit):
                    return {}
            for name, one in zip(names, ratio):
                found[name].append(float(one))
    for step in steps:
        for strain in COMPLIANT:
            del step[strain]
    return found


def _evenly(count, room):
    return sorted(set(np.linspace(0, count - 1, min(count, room)).round().astype(int).tolist()))
