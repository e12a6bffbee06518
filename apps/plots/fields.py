"""Scalar fields over the samples of a step, such as the torsional moment, with names, symbols and number formats."""

import numpy as np

import style
from results import InputError

STRESSES = ("von_mises_stress", "largest_normal_stress", "largest_shear_stress")
MEGAPASCALS = {("m", "N"): 1e-6, ("m", "kN"): 1e-3, ("m", "MN"): 1.0}  # factor from a stress in these units
NOISE = 1e-9  # section forces below this share of the largest one in the structure are round-off, drawn as zero
NO_LOAD = 1e-12  # the same for moments below this share of EI / size, if nothing in the structure is larger


class Field:
    """Scalar at every sample: `components` of the dataset `source`; several components give their norm."""

    def __init__(self, label, source, components):
        self.label, self.source, self.components = label, source, components

    @property
    def signed(self):
        return len(self.components) == 1

    def unit(self, units):
        """Returns the unit of the values from `units` of length and force; empty if unknown or dimensionless."""
        length, force = units
        stress = "MPa" if units in MEGAPASCALS else f"{force}/{length}\u00b2"
        kinds = {"material_force": force, "material_moment": f"{force} {length}", "moment_strain": f"1/{length}",
                 "displacement": length, **dict.fromkeys(STRESSES, stress)}
        return kinds.get(self.source, "") if length else ""

    def values(self, step, size):
        """Returns the values of a step (n,), round-off set to zero. `size` of the structure is the lever of forces."""
        columns = step.field(self.source)[:, self.components]
        values = columns[:, 0] if self.signed else np.linalg.norm(columns, axis=1)
        values = np.where(np.isfinite(values), values, 0.0)
        return values if np.abs(values).max(initial=0.0) > self.floor(step, size) else np.zeros_like(values)

    def values_at(self, step, size, samples):
        """Returns the values at some samples, set to zero if these are all round-off."""
        values = self.values(step, size)[samples]
        return values if np.abs(values).max(initial=0.0) > self.floor(step, size) else np.zeros_like(values)

    def floor(self, step, size):
        """Returns the magnitude up to which values of the source are round-off."""
        force, moment = (_largest(step.field(name)) for name in ("material_force", "material_moment"))
        moment = max(moment, NO_LOAD / NOISE * _bending_stiffness(step) / size)
        if self.source == "material_force":
            return NOISE * max(force, moment / size)
        if self.source == "material_moment":
            return NOISE * max(moment, force * size)
        if self.source == "moment_strain":  # small curvatures are judged by the size of the structure
            return NOISE * max(_largest(step.field(self.source)), 1e-3 / size)
        return NOISE * max(_largest(step.field(self.source)), 1e-6)


class StressField(Field):
    """Largest stress over the section at every sample; nan, drawn grey, if the section has no shape."""

    def __init__(self, label, source, signed=False):
        super().__init__(label, source, [0] if signed else [])

    def values(self, step, size):
        if not step.has(self.source):
            raise InputError(f"step {step.number} has no stresses: they are of the last step (Stresses in the list "
                             "Analysis asks for every step), of sections given by Shape and Material")
        factor = MEGAPASCALS.get(step.units, 1.0) if self.source in STRESSES else 1.0
        return factor * step.field(self.source).ravel()


class GradientField(Field):
    """Gradient of a quantity by a stiffness of every element, at the end of the path."""

    def __init__(self, run, quantity, stiffness, values):
        super().__init__(f"gradient of {style.literal(quantity)} by ${stiffness}$: share of it, per length", "gradients", [0])
        self._last, self._values = run.steps[-1].number, values

    def values(self, step, size):
        if step.number != self._last:
            raise InputError(f"step {step.number} has no gradients: they are of the last step")
        return self._values

    def floor(self, step, size):
        return 0.0


STIFFNESSES = {"EA": "EA", "GA2": "GA_2", "GA3": "GA_3", "GIt": "GI_t", "EI2": "EI_2", "EI3": "EI_3"}


def fields_of(run):
    """Returns FIELDS and the gradients by element, "tip.y by EI3"."""
    gradients = {f"{quantity} by {name}": GradientField(run, quantity, symbol, values[:, i])
                 for quantity, values in run.gradients() for i, (name, symbol) in enumerate(STIFFNESSES.items())}
    return {**FIELDS, **gradients}


SECTION_FORCES = {
    "axial_force": Field("axial force $N$", "material_force", [0]),
    "shear_2": Field("shear force $Q_2$", "material_force", [1]),
    "shear_3": Field("shear force $Q_3$", "material_force", [2]),
    "torsion": Field("torsional moment $T$", "material_moment", [0]),
    "bending_2": Field("bending moment $M_2$", "material_moment", [1]),
    "bending_3": Field("bending moment $M_3$", "material_moment", [2]),
}
FIELDS = {
    "moment": Field("moment $|M|$", "material_moment", [0, 1, 2]),
    "bending": Field(r"bending moment $\sqrt{M_2^2+M_3^2}$", "material_moment", [1, 2]),
    **SECTION_FORCES,
    "shear": Field(r"shear force $\sqrt{Q_2^2+Q_3^2}$", "material_force", [1, 2]),
    "force": Field("force $|N|$", "material_force", [0, 1, 2]),
    "axial_strain": Field(r"axial strain $\gamma_1$", "force_strain", [0]),
    "strain": Field(r"force strain $|\gamma|$", "force_strain", [0, 1, 2]),
    "twist": Field(r"twist $\kappa_1$", "moment_strain", [0]),
    "curvature": Field(r"bending strain $\sqrt{\kappa_2^2+\kappa_3^2}$", "moment_strain", [1, 2]),
    "displacement": Field("displacement $|u|$", "displacement", [0, 1, 2]),
    "von_mises": StressField(r"von Mises stress, largest of the section", "von_mises_stress"),
    "utilisation": StressField("utilisation: von Mises stress over strength", "utilisation"),
    "normal_stress": StressField(r"normal stress $\sigma_{11}$, largest of the section", "largest_normal_stress", True),
    "shear_stress": StressField(r"shear stress $|\tau|$, largest of the section", "largest_shear_stress"),
}
OVERVIEW = ("bending", "torsion", "axial_force", "shear", "curvature", "axial_strain")
STRESS_OVERVIEW = ("von_mises",) + OVERVIEW[:-1]  # of steps with stresses


def power_of_ten(largest):
    """Returns the exponent of ten to divide by so that tick labels stay short: 0 for numbers from 0.01 to 1e4."""
    if not np.isfinite(largest) or largest == 0.0 or 1e-2 <= largest < 1e4:
        return 0
    return int(3 * np.floor(np.log10(largest) / 3))


def scaled(values):
    """Returns (exponent of the power of ten, values over that power)."""
    exponent = power_of_ten(np.nanmax(np.abs(values), initial=0.0))
    return exponent, values / 10.0 ** exponent


def number_text(value):
    """Returns four digits, with a power of ten only for very small or large numbers."""
    if value == 0.0 or 1e-3 <= abs(value) < 1e6:
        return np.format_float_positional(value, precision=4, fractional=False, trim="-")
    return f"{value:.4g}"


def times(exponent, unit=""):
    """Returns the suffix of an axis label for numbers in a unit that were divided by 10^exponent."""
    words = [rf"$10^{{{exponent}}}$"] * bool(exponent) + [style.literal(unit)] * bool(unit)
    return f"  [{' '.join(words)}]" if words else ""


def color_scale(field, values):
    """Returns colour map and norm: signed fields are symmetric about a grey zero, magnitudes start at zero."""
    from matplotlib.colors import LinearSegmentedColormap, Normalize

    largest = _largest(values) or 1.0
    if field.signed:
        steps = [style.BLUE, "#7FB2D6", "#BDBDBD", "#E8A36B", style.RED]
        colors, norm = LinearSegmentedColormap.from_list("signed", steps), Normalize(-largest, largest)
    else:
        colors, norm = style.plt.get_cmap("viridis").copy(), Normalize(0.0, largest)
    colors.set_bad(style.GREY)
    return colors, norm


def _bending_stiffness(step):
    """Returns the median ratio of moment to curvature; 0 if nothing bends."""
    moment, strain = (np.abs(step.field(name)).ravel() for name in ("material_moment", "moment_strain"))
    bent = strain > 0
    return float(np.median(moment[bent] / strain[bent])) if bent.any() else 0.0


def _largest(values):
    return float(np.nanmax(np.abs(values), initial=0.0))
