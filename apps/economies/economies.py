#!/usr/bin/python3 -Es
"""Study of the cost of features that a scene does not use: one long rod solved as it is, and with each feature added without
effect. Both ways must give the same answer; times are shown, not judged."""

import math
import sys
from functools import reduce
from pathlib import Path
from statistics import median

BIN = Path(__file__).resolve().parent
sys.path[:0] = [str(BIN / "studies"), str(BIN.parent / "python")]

import study  # noqa: E402
from study import Follow  # noqa: E402

SAME_SOLUTION = 1e-9  # relative, due to Newton's tolerance, with a margin for soft structures
INNER_POINTS = 1000  # with a load of zero
NOTHING = 1e-200  # a line load below rounding; one of zero would be ignored


def changed(scene, change):
    """Returns a changed copy."""
    scene = scene.copy()
    change(scene, one(scene.members), one(scene.sections), one(scene.point_loads))
    return scene


def with_solver(scene, **parameters):
    """Returns a copy with these parameters, lists__parameter=value."""
    scene = scene.copy()
    for name, value in parameters.items():
        *lists, parameter = name.split("__")
        setattr(reduce(getattr, lists, scene), parameter, value)
    return scene


def one(entries):
    return next(iter(entries.values()))


def by_formula(scene, rod, _section, load):
    """Gives the same straight line from the origin along x as a parametric curve."""
    rod.curve.update_by_name({"Shape": "parametric", "Formula": ["t", "0", "0"], "Range": (0, scene.points[load.point][0])})


def line_load_of_nothing(frame):
    def change(scene, rod, *_):
        member = next(iter(scene.members))
        scene.distributed_loads["nothing"] = {"Member": member, "Frame": frame, "Force": (0, NOTHING, 0)}
    return change


STIFFNESSES = ("EA", "GA2", "GA3", "GIt", "EI2", "EI3")


def matrix(scene, _rod, section, _load):
    """Couples forces and moments by negligible entries."""
    values = [section.pop(name) for name in STIFFNESSES]
    section["Matrix"] = [values[i] if i == j else NOTHING if (i < 3) != (j < 3) else 0.0 for i in range(6) for j in range(6)]


def taper(scene, rod, section, _load):
    """Tapers the rod to an equal section."""
    scene.sections["end"] = {name: section[name] for name in STIFFNESSES}
    rod.end_section = "end"


def shape(scene, _rod, section, _load):
    """Gives the section as a rectangle with the same EA, GA2, GA3, EI2 and EI3, so that stresses are known."""
    values = {name: section.pop(name) for name in STIFFNESSES}
    side = math.sqrt(12 * values["EI3"] / values["EA"])
    section.update_by_name({"Shape": "rectangle", "Width": side, "Height": side, "Shear Correction": (1, 1),
                            "Material": {"E": values["EA"] / side**2, "G": values["GA2"] / side**2}})


def heavy(_scene, _rod, section, _load):
    """Adds a mass, which statics does not need."""
    section["Mass"] = 1.0


def heavy_under_force(scene, rod, section, load):
    """Removes the moment at the tip too: it has no potential, so that flutter would be sought."""
    heavy(scene, rod, section, load)
    load.moment = (0, 0, 0)


def inner_points(**load):
    def change(scene, rod, *_):
        for i in range(1, INNER_POINTS + 1):
            rod.inner_points[f"inner {i}"] = i / (INNER_POINTS + 1)
            if load:
                scene.point_loads[f"inner {i}"] = {"Point": f"inner {i}", **load}
    return change


def force_stiffness(stiffness):
    """Sets the axial and shear stiffnesses."""
    def change(_scene, _rod, section, _load):
        section.update_by_name(dict.fromkeys(STIFFNESSES[:3], stiffness))
    return change


def overhang(order, elements):
    """Extends the rod by half its length, without load on the new part."""
    def change(scene, rod, _section, load):
        x, y, z = scene.points[load.point]
        scene.points["end"] = 1.5 * x, y, z
        scene.members["overhang"] = {"Start": load.point, "End": "end", "Section": next(iter(scene.sections)),
                                     "Order": order, "Elements": elements}
    return change


def in_plane(_scene, _rod, _section, load):
    """Keeps the loads, and so the rod, in the plane of x and y."""
    load.force, load.moment = (*load.force[:2], 0), (0, 0, load.moment[2])


def held_twist(scene, _rod, _section, load):
    """Fixes the twist at the tip, where no torque acts."""
    scene.supports["twist"] = {"Point": load.point, "Fixed Displacement": [], "Fixed Rotation": ["x"]}


def tip_asked_for(scene, _rod, _section, load):
    scene.quantities["tip"] = {"Quantity": "displacement", "Point": load.point}


def tip_gradient(scene, rod, section, load):
    """Asks for the gradient of one component with respect to 18 numbers of each element."""
    tip_asked_for(scene, rod, section, load)
    scene.gradient = {"Of": ["tip.y"], "By Element": True}


def hundred_quantities(scene, _rod, _section, load):
    """Asks for 100 quantities, a quarter each: displacements and moments at places, distances to the tip, extremes."""
    member = next(iter(scene.members))
    along = ("material force", "material moment", "spatial moment", "material curvature")
    for i in range(100):
        kind = ("displacement", "material moment", "distance", along[i // 4 % 4])[i % 4]
        asked = {"Quantity": kind}
        if i % 4 == 3:
            asked |= {"Member": member, "Component": "z" if kind == along[2] else "3", "Take": "largest size"}
        elif i % 4 == 2:
            asked |= {"Point": f"{member}@{i}%", "Other Point": load.point}
        else:
            asked["Point"] = f"{member}@{i}%"
        scene.quantities[f"q{i}"] = asked


def unused_features(given):
    """Returns (name, (description, scene, options of the solution) as it is, and the same with the feature)."""
    rod = with_solver(given, analysis__stability=False, analysis__error_estimate="off")  # unless these are measured
    planar = changed(rod, in_plane)
    plane_in_space = with_solver(planar, solver__planar=False)
    shaped = changed(rod, shape)
    elements, order = one(given.members).elements, one(given.members).order
    without_stresses = {"analysis__stresses": "off"}
    file, estimate = {"way": Follow.recorded}, {"estimates": True}
    return [
        ("plane", ("rod in a plane, three unknowns for each vertex", planar), ("six unknowns", plane_in_space)),
        ("straight", ("straight line", rod),
         ("the same line as a parametric curve, triads and curvature by formula", changed(rod, by_formula))),
        ("line_loads", ("no line load", rod),
         ("dead line load of 1e-200: with loops over loads", changed(rod, line_load_of_nothing("dead")))),
        ("line_loads_in_plane", ("rod in a plane, no line load", planar),
         ("dead line load of 1e-200: still three unknowns", changed(planar, line_load_of_nothing("dead")))),
        ("potential", ("all forces have a potential: symmetric tangents", rod),
         ("follower line load of 1e-200: unsymmetric tangents",
          changed(rod, line_load_of_nothing("follower")))),
        ("section", ("six stiffnesses", rod),
         ("the same as a 6 x 6 matrix with couplings of 1e-200", changed(rod, matrix))),
        ("taper", ("one section", rod), ("taper to the same section", changed(rod, taper))),
        ("point_loads", ("1000 inner points without loads", changed(rod, inner_points())),
         ("forces of zero there: right-hand sides alone", changed(rod, inner_points(Force=(0, 0, 0))))),
        ("point_moments", ("1000 inner points without loads", changed(rod, inner_points())),
         ("moments of 1e-100 there: none of these vertices is eliminated in a chain",
          changed(rod, inner_points(Moment=(0, 0, 1e-100))))),
        ("masses", ("no masses", rod), ("mass of the section known, no modes asked for", changed(rod, heavy))),
        ("modes", ("masses, no modes asked for, result file written", changed(rod, heavy_under_force), file),
         ("six natural modes at the end", with_solver(changed(rod, heavy_under_force), analysis__modes__number=6), file)),
        ("rotation_support", ("free end", plane_in_space),
         ("rotation about the axis fixed there: one row that depends on the rotation",
          changed(plane_in_space, held_twist))),
        ("rigid", ("inextensible and shear rigid", changed(rod, force_stiffness(math.inf))),
         ("EA = GA = 1e14", changed(rod, force_stiffness(1e14)))),  # EI = 1: strains are at rounding
        ("one_step", ("one load step", rod),
         ("ten equal load steps", with_solver(rod, solver__load_path__method="fixed", solver__load_path__steps=10))),
        ("stability", ("stability not asked for", rod),
         ("negative eigenvalues counted in every state", with_solver(rod, analysis__stability=True))),
        ("estimate", ("error not estimated", rod), ("estimate at the end", rod, estimate)),
        ("result_file", ("no result file", rod), ("HDF5 and XDMF written", rod, file)),
        ("quantities", ("no quantities asked for, result file written", rod, file),
         ("100 quantities, 25 of them extremes along the rod", changed(rod, hundred_quantities), file)),
        ("one_quantity", ("no quantity asked for, result file written", rod, file),
         ("displacement of the tip asked for", changed(rod, tip_asked_for), file)),
        ("gradient", ("displacement of the tip asked for, result file written", changed(rod, tip_asked_for), file),
         ("its gradient by stiffnesses, compliances and natural strains of each element", changed(rod, tip_gradient), file)),
        ("stresses", ("stresses along members off, result file written", with_solver(shaped, **without_stresses), file),
         ("stresses at the end, of a rectangle", shaped, file)),
        ("no_stresses",
         ("stresses off, section given by its stiffnesses", with_solver(rod, **without_stresses), file),
         ("stresses where they are known, which is nowhere", rod, file)),
        ("mesh_by_member", ("overhang without load: one element of order 1", changed(rod, overhang(1, 1))),
         ("overhang divided like the rest", changed(rod, overhang(order, elements // 2)))),
        ("chains", ("chains condensed to their ends", rod),
         ("KLU2 on the whole matrix", with_solver(rod, solver__linear_solver__method="KLU2"))),
        ("loose", ("linear solves checked to 1e-8", rod),
         ("to 1e-3", with_solver(rod, solver__linear_solver__residual_tolerance=1e-3))),
    ]


def solve(app, description, scene, how=None):
    """Returns (seconds from the scene to the answer, iterations, displacement of the tip)."""
    trial = study.solve(app, scene, **(how or {}))
    if not trial.finished:
        raise study.ConvergenceError(f"{description}: no equilibrium was found")
    return trial.seconds, trial.iterations, trial.displacement(one(scene.point_loads).point)


def measure(app, given, name, plain, other, table):
    """Times both ways in turn, so that a temporary slowdown affects both alike; the first round is a warm-up."""
    rounds = [(solve(app, *plain), solve(app, *other)) for _ in range(app.number("Rounds") + 1)]
    (_, iterations, tip), (_, other_iterations, other_tip) = rounds[-1]
    difference = math.dist(tip, other_tip) / math.hypot(*tip)
    times = [(a[0], b[0]) for a, b in rounds[1:]]
    ratios = [b / a for a, b in times]  # of consecutive runs, under the same load of the machine
    rod = one(given.members)
    table.add_row([name, median(a for a, _ in times), median(b for _, b in times), median(ratios), iterations,
                   other_iterations, difference, plain[0], other[0], rod.order, rod.elements])
    app.check_upper_bound(f"{name}: difference of the two ways", difference, SAME_SOLUTION,
                          "the same scene, solved the other way")


def run(app):
    given = study.scene_of(app)
    if len(given.point_loads) != 1 or len(given.members) != 1:
        app.error(["Scene"], f"{len(given.members)} members and {len(given.point_loads)} point loads; allowed: one rod along x "
                             "from the origin with one load at its end, to which the study adds what it compares")
    table = app.table("economies.csv", "name,plain_seconds,other_seconds,ratio,plain_iterations,other_iterations,difference,"
                      "plain,other,order,elements", 7)
    app.quiet = True  # hundreds of runs
    app.threads = app.number("Threads")
    for name, plain, other in unused_features(given):
        measure(app, given, name, plain, other, table)
    app.write_machine()
    for kind in ("h5", "xdmf") if app.writes_files else ():
        Path(app.output, f"recorded.{kind}").unlink(missing_ok=True)


study.main(__file__, "one long rod solved as it is, and with the features that it does not use: times and results.",
           "How both ways are timed.",
           [("Rounds", 5, 1, 1000, "Timed runs of each way, in turn."), ("Threads", 1, 1, 1024, "OpenMP threads.")], run)
