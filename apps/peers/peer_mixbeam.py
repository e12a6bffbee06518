"""mixbeam. The mesh is given, or chosen by the program for an accuracy. `plain`: no stability and no error estimate, else
everything that a run does by default."""

import mixbeam


def version():
    return mixbeam.__version__


def solve(problem, order, elements, steps, accuracy=None, plain=False):
    scene = mixbeam.Scene("cantilever")
    scene.sections["rod"] = {"EA": problem.EA, "GA2": problem.GA, "GA3": problem.GA, "GIt": problem.EI, "EI2": problem.EI,
                             "EI3": problem.EI}
    scene.points["clamp"] = 0, 0, 0
    scene.members["rod"] = mixbeam.Member(start="clamp", end="tip", section="rod")
    rod = scene.members["rod"]
    if problem.radius:
        rod.curve = mixbeam.Arc(center=(0, -problem.radius, 0), axis=(0, 0, -1), angle=problem.length / problem.radius)
    else:
        scene.points["tip"] = problem.length, 0, 0
    scene.supports["clamp"] = {"point": "clamp"}
    scene.point_loads["load"] = {"point": "tip", "force": problem.force, "moment": problem.moment}
    if accuracy:
        scene.accuracy = accuracy
    elif order:
        rod.order, rod.elements = order, elements
    if plain:
        scene.analysis.stability, scene.analysis.error_estimate = False, "off"
    run = mixbeam.run(scene)
    return {"tip": [float(u) for u in run.displacement("tip")], "iterations": int(sum(run.newton_iterations)),
            "steps": len(run) - 1, "order": run.members["rod"].order, "elements": run.members["rod"].elements}
