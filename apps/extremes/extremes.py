#!/usr/bin/python3 -Es
"""Study of limits: one quantity of a structure at a time is swept to its limits to see convergence, cost, accuracy and where
runs end. Then paths of random imperfect structures are compared with the same paths in small steps."""

import math
import sys
from collections import Counter, namedtuple
from pathlib import Path

BIN = Path(__file__).resolve().parent
sys.path[:0] = [str(BIN / "studies"), str(BIN.parent / "python")]

import study  # noqa: E402
from cantilever import Cantilever, elastica_tip, thrust_tip  # noqa: E402
from imperfect_structures import ImperfectStructure  # noqa: E402
from judged_path import follow, is_same_end, judge_path  # noqa: E402

LOAD = 10.0  # F L^2 / EI of scenes that need some load: the tip rotates by 1.43 radians
NEXT = 1e-12  # relative distance to the ends of series
TURN = 2 * math.pi
SHOOTING_ERROR = 1e-12
THRUST_DIGITS = 3e-11  # of the printed references, relative to the smallest of them
MOST_REFUSED = 0.02  # share of the paths with a known end that may be refused
LOCATED = 1e-8  # promised relative error of critical load factors
# Rotations at which the program changes from series to closed forms: the argument of the first is half of the rotation of
# an element, that of the second twice the angle to a vertex (kStumpffSeriesLimit, kLogSeriesLimit).
SERIES = 2 * math.sqrt(10.0)
LOGARITHM = 4 * math.atan(math.sqrt(2.5e-3))

ELASTICA = "elastica, elliptic integrals; plus s F / C where EA = GA = C is finite"
CIRCLE = "circle of curvature M / EI"
HELIX = "helix about the moment: constant spatial moment, EI2 = EI3"
GAUSS_RULE = "k-point Gauss rule of the exact tangent of the circle, exact rotations"
PENDULUM = "elastica of a thrust beside the axis, elliptic integrals; the stable equilibrium"
SHOOTING = ("shooting on the rod ODE with Runge-Kutta 7(8), no finite elements; step doubling changes less than 1e-10")

# `allowed`: promised error for values from `first` to `last`; the others are only recorded. `make`: (given scene,
# value) -> (scene, error of a trial or None, load factors of all critical points). apps/plots/extremes.py describes
# the sweeps.
Sweep = namedtuple("Sweep", "name values allowed first last source make")


def decades(first, last, step=1):
    return [10.0**i for i in range(first, last + 1, step)]


def approaching(angle):
    """Returns values that approach `angle` from below."""
    return [angle * (1 - gap) for gap in (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6)]


def of_rod(name, values, allowed, first, last, source, change):
    """Makes a sweep of the inextensible and shear rigid rod of the scene; `change(rod, value)` applies a value."""

    def make(scene, value):
        rod = Cantilever(scene)
        change(rod, value)
        return rod.scene_with_all_this(), rod.error, []

    return Sweep(name, values, allowed, first, last, source, make)


def of_slenderness(rod, value):
    rod.set_slenderness(value)
    rod.pull(LOAD)


def of_stiffness_ratio(rod, value):
    rod.torsion = rod.bending / value
    rod.turn([0.0, 1.0, 0.0], min(1.0, value))


def of_mesh(order, elements, ratio, load):
    """Changes the mesh; order and elements 0: as in the scene."""

    def change(rod, value):
        rod.order, rod.elements, rod.ratio = order(value) or rod.order, elements(value) or rod.elements, ratio(value)
        rod.pull(load(value))

    return change


def of_turns(rod, value):
    rod.elements = 8 * max(1, int(value))
    rod.turn([0.0, 0.0, value * TURN], 0.0)


def of_load_steps(rod, value):
    rod.steps, rod.torsion = int(value), 0.5 * rod.bending
    rod.turn([0.0, 2.0, 1.0], 1.0)


def of_element_turn(order, elements):
    def change(rod, value):
        rod.order, rod.elements = order or rod.order, elements
        rod.turn_by_gauss_rule(elements * value)

    return change


def snapping_truss(given, rise):
    """Makes two hinged bars, half span 1, EA = 1, too stiff to bend: P = 2 EA (l / l0 - 1) sin(slope). They carry twice
    the load at which they snap through."""
    bending = 1e3
    limit = 2 * (1 - (1 / math.hypot(1, rise))**(2 / 3))**1.5
    scene = of_own("truss", given, EA=1.0, GIt=bending, EI=bending)
    scene.points.update({"left": (-1, 0, 0), "apex": (0, rise, 0), "right": (1, 0, 0)})
    for start, end in (("left", "apex"), ("apex", "right")):
        scene.members[f"{start} to {end}"] = {"Start": start, "End": end, "Section": "bar", "Order": 2, "Elements": 1}
    scene.joints["hinge"] = {"Point": "apex", "Members": ["apex to right"], "Kind": "hinge", "Axis": (0, 0, 1)}
    for point, displacement, rotation in (("left", "xyz", "xy"), ("right", "xyz", "xy"), ("apex", "xz", "")):
        scene.supports[point] = {"Point": point, "Fixed Displacement": list(displacement), "Fixed Rotation": list(rotation)}
    scene.point_loads["load"] = {"Point": "apex", "Force": (0, -2 * limit, 0)}
    return scene, None, [0.5, -0.5]


def heated_rail(given, axial):
    """Makes a clamped rail of length 1 and EI = 1. Its thrust is EA times the thermal strain until it buckles at 4 pi^2."""
    overheated = 3.0
    scene = of_own("rail", given, EA=axial, GIt=1.0, EI=1.0)
    if scene.analysis.stability is not False:  # needed to find bifurcations
        scene.analysis.branch = "positive"
    scene.points.update({"left": (0, 0, 0), "right": (1, 0, 0)})
    rail = {"Start": "left", "End": "right", "Section": "bar", "Order": 5, "Elements": 16, "Inner Points": {"middle": 0.5}}
    scene.members["left to right"] = rail
    for point, displacement, rotation in (("left", "xyz", "xyz"), ("right", "xyz", "xyz"), ("middle", "z", "xy")):
        scene.supports[point] = {"Point": point, "Fixed Displacement": list(displacement), "Fixed Rotation": list(rotation)}
    strain = overheated * 4 * math.pi * math.pi / axial
    scene.eigenstrains["heat"] = {"Member": "left to right", "Strain": (strain, 0, 0)}
    return scene, None, [1 / overheated]


def of_own(name, given, EA, GIt, EI):  # noqa: N803: as in scenes
    scene = study.new_scene(name, given)
    scene.sections["bar"] = {"EA": EA, "Shear Rigid": True, "GIt": GIt, "EI2": EI, "EI3": EI}
    return scene


def all_sweeps(most_elements):
    """Returns the sweeps of the cantilever, in the order of the page."""
    same, rigid = (lambda value: 0), math.inf
    last = int(math.log10(most_elements))
    return [
        of_rod("slenderness", [*decades(0, 10), rigid], 1e-9, 1, rigid, ELASTICA, of_slenderness),
        of_rod("stiffness_ratio", decades(-6, 6), 1e-5, 1e-6, 1e6, HELIX, of_stiffness_ratio),
        of_rod("unit_of_length", decades(-9, 9, 3), 1e-9, 1e-9, 1e9, ELASTICA,
               lambda rod, value: rod.pull_in_units(value / rod.length, 1.0, LOAD)),
        of_rod("unit_of_force", decades(-9, 9, 3), 1e-9, 1e-9, 1e9, ELASTICA,
               lambda rod, value: rod.pull_in_units(1.0, value, LOAD)),
        of_rod("elements", [1, 2, 5, *decades(1, last)], 1e-6, 10, 1e5, ELASTICA,
               of_mesh(lambda value: 2, int, same, lambda value: 1.0)),
        of_rod("length_ratio", decades(0, 8), 1e-8, 1, 1e8, ELASTICA,
               of_mesh(same, lambda value: 24, float, lambda value: LOAD)),
        of_rod("turns", [0.01, 0.1, 0.5, 1, 2, 5, 10, 20, 50, 100], 1e-9, 0.01, 100, CIRCLE, of_turns),
        of_rod("load_steps", [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000], 1e-9, 1, 1000, HELIX, of_load_steps),
        of_rod("element_turn_k1",
               [0.1, 1.0, 2.0, *approaching(math.pi), 3.5, 4.5, *approaching(2 * math.pi), 6.5], 1e-9, 0.1, 2 * math.pi,
               GAUSS_RULE, of_element_turn(1, 2)),
        of_rod("element_turn",
               [0.1, 1.0, 2.0, *approaching(math.pi), 3.5, 4.5, 6.0, SERIES * (1 - NEXT), SERIES * (1 + NEXT), 9.0, 12.0],
               1e-9, 0.1, 20, GAUSS_RULE, of_element_turn(0, 2)),
        of_rod("angle",
               [0.0, 1e-300, 1e-200, 1e-100, 1e-16, 1e-12, 1e-8, 1e-6, 1e-4, LOGARITHM * (1 - NEXT), LOGARITHM * (1 + NEXT)],
               1e-8, 0, 1, GAUSS_RULE, of_element_turn(1, 1)),
        of_rod("tip_force", decades(-12, 8, 2), 1e-8, 1e-12, 1e8, ELASTICA,
               of_mesh(same, lambda value: 24, lambda value: 1.4**23, float)),
        of_rod("order", [1, 2, 3, 4, 5, 6, 7, 8], 1e-1, 1, 8, ELASTICA,
               of_mesh(int, lambda value: 4, same, lambda value: LOAD)),
        of_rod("imperfection", [*decades(-8, -1), 0.3], 1e-8, 1e-8, 0.3, PENDULUM,
               lambda rod, value: rod.push(1.2, value)),
        of_rod("thrust", [0.5, 0.9, 0.99, 1.0, 1.01, 1.05, 1.2, 1.5, 2.0, 3.0, 5.0, 8.0, 12.0, 20.0], 1e-7, 0.5, 20,
               PENDULUM, lambda rod, value: rod.push(value, 1e-4)),
    ]


def critical_sweeps():
    """Returns sweeps with a closed form of the critical load factors: the rise of a two-bar truss that snaps through, and
    the axial stiffness of a rail heated to three times its critical temperature, followed on its branch."""
    return [Sweep("truss_rise", [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 3.0], LOCATED, 0, math.inf,
                  "2 EA (1 - cos(slope)^(2/3))^(3/2), and its negative", snapping_truss),
            Sweep("rail_stiffness", decades(3, 8), LOCATED, 0, math.inf,
                  "a third: strain of the heat = 4 pi^2 EI / (EA L^2)", heated_rail)]


def check_closed_forms(app):
    """Checks the closed forms against shooting."""

    def check(load, names, values, references, tolerance):
        for name, value, reference in zip(names, values, references):
            app.check_relative(f"closed form, {load}: tip {name}", value, reference, tolerance, SHOOTING)

    for load, *references in ((1.0, 0.30172077379981, 0.0564332362834, 0.46135194971188),
                              (10.0, 0.8106090248803, 0.5549955977538, 1.4302855388039),
                              (100.0, 0.94142135086201, 0.8585786445629, 1.57064588466)):
        back, across, angle = elastica_tip(load)
        check("F L^2 / EI = " + study.shortest(load), ("across", "back", "angle"), (across, back, angle), references,
              SHOOTING_ERROR)
    for over_euler, eccentricity, *references in ((1.05, 1e-4, 0.90498259324, 0.38064428348, 0.62274480879),
                                                  (1.2, 1e-6, 0.67391082498, 0.64878450511, 1.18440249350),
                                                  (1.5, 0.1, 0.34171752220, 0.79568923565, 1.74769556929),
                                                  (8.0, 1e-4, -0.54784720364, 0.44971259087, 3.04718635507)):
        back, across, angle = thrust_tip(0.25 * math.pi * math.pi * over_euler, eccentricity)
        check("P / P_cr = " + study.shortest(over_euler), ("x", "y", "angle"), (1 - back, across, angle), references,
              THRUST_DIGITS)


def thinned(values, most):
    """Returns at most `most` values, including first and last."""
    count = len(values)
    return values if most >= count else [values[i * (count - 1) // max(1, most - 1)] for i in range(most)]


def critical_error(found, expected):
    """Returns the largest relative error of the critical load factors; infinity if their number differs."""
    return max([0.0 if len(found) == len(expected) else math.inf, *(abs(a / b - 1) for a, b in zip(found, expected))])


def compute(app, given, sweep, value, table):
    """Solves and judges one value, and adds a row to the table."""
    scene, error_of, critical = sweep.make(given, value)
    trial = study.solve(app, scene)
    is_promised = sweep.first <= value <= sweep.last
    error = math.nan
    if trial.finished:
        error = error_of(trial) if error_of else critical_error(trial.critical_loads, critical)
    table.add_row([sweep.name, value, int(trial.finished), trial.steps, trial.failed_steps, trial.iterations, error,
                   sweep.allowed if is_promised else math.nan, trial.residual, trial.condition(), len(critical),
                   len(trial.critical_loads), trial.negative[-1] if trial.negative else -1, trial.seconds,
                   trial.processor_seconds, trial.failure, sweep.source])
    if is_promised:
        what = "error of the tip" if error_of else "critical load factors"
        app.check_upper_bound(f"{sweep.name} {study.shortest(value)}: {what}", error, sweep.allowed,
                              "closed form: " + sweep.source)


def run_sweeps(app, given):
    table = app.table("extremes.csv", "sweep,value,converged,load_steps,failed_steps,iterations,error,allowed,residual,"
                      "condition,expected_points,critical_points,negative,seconds,processor_seconds,failure,closed_form", 10)
    chosen, most = app.words("Sweeps"), app.number("Most Values")
    sweeps = [sweep for sweep in all_sweeps(app.number("Most Elements")) if sweep.name in chosen]
    for sweep in sweeps + (critical_sweeps() if app.switch("Critical Loads") else []):
        for value in thinned(sweep.values, most):
            compute(app, given, sweep, float(value), table)


def run_random_paths(app, given):
    """Follows random structures with the parameters of the scene; with a known reference no end may be wrong, few refused."""
    count, seed, step = app.number("Random Structures"), app.number("Random Seed"), app.real("Reference Step")
    if count == 0:
        return
    table = app.table("random_paths.csv", "family,number,load,imperfection,estimate,outcome,difference,reference_difference,"
                      "steps,failed_steps,iterations,processor_seconds,negative,critical_points,plain_is_right,plain_iterations,plain_processor_seconds,reference_iterations,reference_processor_seconds,"
                      "reference_step,failure", 12)
    ends = Counter()
    for number in range(count):
        structure = ImperfectStructure(seed, number, given)
        judged = judge_path(app, structure.scene, step)
        path, plain = judged.followed, follow(app, structure.scene, study.Follow.at_once)
        plain_is_right = judged.reference_known and plain.finished and is_same_end(structure.scene, plain, judged.reference)
        ends[judged.outcome] += 1
        table.add_row([structure.family, number, structure.load, structure.imperfection, structure.estimate, judged.outcome,
                       judged.difference, judged.reference_difference, path.steps, path.failed_steps, path.iterations,
                       path.processor_seconds, path.negative, path.critical_points, int(plain_is_right), plain.iterations,
                       plain.processor_seconds, judged.reference.iterations, judged.reference.processor_seconds, step,
                       path.failure.partition("\n")[0]])
    source = "the same path in small steps, which do not change its end"
    known = count - ends["unknown"]
    app.check_upper_bound("random structures: wrong ends", ends["wrong"], 0, source)
    app.check_upper_bound("random structures: paths refused", ends["refused"], MOST_REFUSED * known, source)


def run(app):
    given = study.scene_of(app)
    Cantilever(given)  # raises InputError for other scenes
    check_closed_forms(app)
    run_sweeps(app, given)
    run_random_paths(app, given)
    app.write_machine()


study.main(
    __file__, "a straight cantilever, one of its quantities at a time swept to its limits and held against a closed form.",
    "Which sweeps, and how far.",
    [("Sweeps", [sweep.name for sweep in all_sweeps(1)], None, None,
      "Those that are computed, in the order of the page."),
     ("Most Elements", 100000, 1, 1000000,
      "End of the sweep over the number of elements; a million takes minutes and gigabytes."),
     ("Most Values", 1000, 1, 1000, "Values of each sweep, evenly chosen from first to last."),
     ("Critical Loads", True, None, None,
      "Also sweep structures whose critical loads have a closed form: a truss, a heated rail."),
     ("Random Structures", 500, 0, 100000,
      "Imperfect structures whose paths are compared with those of small steps; 3 s each."),
     ("Random Seed", 15, 0, 1000000, "Begins the series of structures; another seed, other structures."),
     ("Reference Step", 0.002, 0.0, 0.1, "Largest load step of a reference; a second one takes half of it.")], run)
