#!/usr/bin/python3 -Es
"""Comparison of mixbeam with other installed programs on the same problems: processor time over the error of the tip, load
steps and iterations, lines that a user writes, growth of the cost with the number of elements."""

import ast
import json
import math
import os
import subprocess
import sys
from pathlib import Path
from statistics import median
from typing import NamedTuple

BIN = Path(__file__).resolve().parent
sys.path[:0] = [str(BIN / "studies"), str(BIN.parent / "python")]

import peer_problems  # noqa: E402
import study  # noqa: E402

LEVELS = (1e-2, 1e-4, 1e-6, 1e-8)
NUMBERS = ("order", "elements", "steps", "iterations", "error", "seconds", "stepping")
# Error that mixbeam must reach on its finest mesh: the references have eleven digits or more.
REACHED = 1e-9
# Error that another discretization of the same equations must reach, else the problems differ.
SAME_PROBLEM = 1e-7
FEW_STEPS = (1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64)  # tried in turn until one leads to the equilibrium
FINER_STEPS = 4  # times as many steps, which may need fewer iterations in all
GROWING = 10.0  # least growth of the time to the next larger chain
WARMING = 10  # elements of the chain that is solved first
LONGEST_SWEEP = 3600.0  # seconds after which a program counts as hung


class Setting(NamedTuple):
    name: str
    program: str
    cells: tuple  # (order, elements)
    options: dict
    steps: tuple = (1,)
    chain: tuple = ()  # orders whose cost is measured on long chains
    factors: tuple = (1,)  # times the least number of steps


PROGRAMS = {"mixbeam": ("peer_mixbeam", "this one"), "FEniCSx": ("peer_fenicsx", "python3-dolfinx"),
            "CalculiX": ("peer_calculix", "calculix-ccx"), "cardillo": ("cardillo", "not in Debian"),
            "EXUDYN": ("exudyn", "not in Debian")}


def grid(orders, elements):
    return tuple((order, count) for order in orders for count in elements)


def settings(app):
    own, by_hand, solid = grid(app.numbers("Orders"), app.numbers("Elements")), (2, 4, 8, 16, 32, 64), grid((2,), (8, 16, 32))
    every = [
        Setting("mixbeam", "mixbeam", own, {"plain": True}, chain=(1, 2)),
        Setting("mixbeam, all answers", "mixbeam", own, {}, chain=(1, 2)),
        *(Setting(f"mixbeam, Accuracy {level:.0e}", "mixbeam", ((0, 0),), {"accuracy": level}) for level in LEVELS),
        Setting("mixbeam, defaults", "mixbeam", ((0, 0),), {}),
        Setting("FEniCSx", "FEniCSx", grid((1, 2, 3, 4), by_hand), {"solver": "superlu"}, FEW_STEPS, (1, 2), (1, FINER_STEPS)),
        Setting("FEniCSx, MUMPS", "FEniCSx", (), {"solver": "mumps"}, FEW_STEPS, (1, 2)),
        Setting("FEniCSx, defaults", "FEniCSx", grid((1,), by_hand), {}, FEW_STEPS),
        Setting("CalculiX", "CalculiX", solid, {"equal": True}, FEW_STEPS, (2,)),
        Setting("CalculiX, defaults", "CalculiX", solid, {}, (10,))]
    return [one for one in every if one.program in app.words("Programs")]


def ask(program, options, calls, most_seconds=LONGEST_SWEEP):
    """Runs a program in a process. Returns its version or absence, and a row for each call."""
    job = {"file": PROGRAMS[program][0], "options": options, "calls": calls}
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1",
                   "PYTHONPATH": os.pathsep.join([str(BIN.parent / "python"), os.environ.get("PYTHONPATH", "")])}
    try:
        printed = subprocess.run([sys.executable, str(BIN / "studies" / "peer_worker.py")], input=json.dumps(job).encode(),
                                 stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, env=environment, timeout=most_seconds,
                                 check=False).stdout
    except subprocess.TimeoutExpired as late:
        printed = late.stdout or b""
    rows = [json.loads(line[5:]) for line in printed.decode().splitlines() if line.startswith("PEER ")]
    facts, rows = rows[0] if rows else {"absent": "it ended at once"}, rows[1:]
    return facts, rows + [{**one, "steps": 0, "failure": "no answer in time, or the program ended"} for one in calls[len(rows):]]


def call(problem, cell, steps):
    return {"problem": problem, "order": cell[0], "elements": cell[1], "steps": list(steps)}


def merged(turns):
    """Merges turns: medians of times, or the failure if there is one."""
    failed = [row for row in turns if "failure" in row]
    return failed[0] if failed else {**turns[0], **{key: median(row[key] for row in turns) for key in ("seconds", "stepping")
                                                    if key in turns[0]}}


def sweep(app, every):
    """Returns (setting, problem, row) of all cells. A first run determines load steps and compiles forms; then all settings
    take turns."""
    plan, rows = [], []
    for setting in every:
        calls = [call(problem, cell, setting.steps) for problem in app.words("Problems") for cell in setting.cells]
        tried = list(zip(calls, ask(setting.program, setting.options, calls)[1], strict=True))
        rows += [(setting, one["problem"], row) for one, row in tried if "failure" in row]
        cells = [(one["problem"], (one["order"], one["elements"]), row) for one, row in tried if "failure" not in row]
        plan.append((setting, [call(problem, cell, [row["steps"] * factor] if len(setting.steps) > 1 else setting.steps)
                               for problem, cell, row in cells for factor in setting.factors]))
    rounds = [[(setting, calls, ask(setting.program, setting.options, calls[:1] + calls)[1][1:])
               for setting, calls in plan if calls] for _ in range(app.number("Rounds"))]
    for same in zip(*rounds, strict=True):
        setting, calls, _ = same[0]
        rows += [(setting, one["problem"], merged([found[i] for _, _, found in same])) for i, one in enumerate(calls)]
    return rows


def grow(app, every):
    """Returns (setting, row) on ever longer chains, until they would take too long; only short runs are repeated."""
    rows, most = [], app.real("Most Seconds")
    for setting, order in ((setting, order) for setting in every for order in setting.chain):
        seconds, steps = 0.0, setting.steps[:1]
        for elements in app.numbers("Chain"):
            if GROWING * seconds > most:
                break
            calls = [call("", (order, count), steps) for count in (WARMING, elements)]
            turns = [ask(setting.program, setting.options, calls, most)[1][1]
                     for _ in range(app.number("Rounds") if GROWING * seconds < 1 else 1)]
            rows.append((setting, merged(turns)))
            seconds = rows[-1][1].get("seconds", math.inf)
    return rows


def lines_of(file):
    """Counts the lines of a program that are neither empty nor comments nor docstrings."""
    text = (BIN / "studies" / f"{file}.py").read_text(encoding="utf-8")
    notes = {number for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
             for number in range(node.lineno, node.end_lineno + 1)}
    return sum(bool(line.partition("#")[0].strip()) and number not in notes for number, line in enumerate(text.splitlines(), 1))


def check(app, rows):
    def bounded(what, chosen, bound, source):
        for problem in app.words("Problems") if chosen else ():
            errors = [row["error"] for _, where, row in chosen if where == problem and "failure" not in row]
            app.check_upper_bound(f"{what}, {problem}: smallest error of the tip", min(errors, default=math.inf), bound, source)

    truths = "closed form, elliptic integrals, shooting on the rod equations"
    bounded("mixbeam", [row for row in rows if row[0].name == "mixbeam"], REACHED, truths)
    for level in LEVELS:
        bounded(f"Accuracy {level:.0e}", [row for row in rows if row[0].options.get("accuracy") == level], level, truths)
    bounded("FEniCSx", [row for row in rows if row[0].program == "FEniCSx"], SAME_PROBLEM, "the same equations, discretized otherwise")


def run(app):
    every, here = settings(app), set()
    programs = app.table("programs.csv", "program,version,package,lines", 4)
    for name in app.words("Programs"):
        file, package = PROGRAMS[name]
        facts = ask(name, {}, [])[0]
        if "absent" not in facts:
            here.add(name)
        else:
            print(f"{name} is left out: {facts['absent']}; package: {package}", flush=True)
        lines = lines_of(file) if file.startswith("peer_") else 0
        programs.add_row([name, facts.get("version", "not importable"), package, lines])
    every = [one for one in every if one.program in here]
    swept = sweep(app, every)
    for name, first, rows in (("peers", "setting,program,problem", [(s.name, s.program, where, row) for s, where, row in swept]),
                              ("growth", "setting,program", [(s.name, s.program, row) for s, row in grow(app, every)])):
        table = app.table(f"{name}.csv", f"{first},{','.join(NUMBERS)},failure", 0)
        for *words, row in rows:
            table.add_row([*words, *(row.get(number, math.nan) for number in NUMBERS), row.get("failure", "")])
    check(app, swept)
    app.write_machine()


study.main(__file__, "mixbeam beside other programs that are installed here: processor time over error.",
           "Which programs and problems, and how often they take turns.",
           [("Programs", list(PROGRAMS), None, None, "Those that are asked; what is not installed is left out with a line."),
            ("Problems", list(peer_problems.PROBLEMS), None, None, "Cantilevers with a known truth."),
            ("Orders", [1, 2, 3, 4, 5, 6, 7, 8], 1, 8, "Of mixbeam's elements."),
            ("Elements", [1, 2, 4, 8, 16, 32], 1, 100000, "Of mixbeam's meshes."),
            ("Chain", [1000, 10000, 100000], 1, 1000000, "Elements of the chains on which the growth of cost is measured."),
            ("Rounds", 3, 1, 1000, "Turns of all programs; times are medians."),
            ("Most Seconds", 90.0, 0.0, 1e5, "Of a program on a chain: a larger one is left out where it would take longer.")], run)
