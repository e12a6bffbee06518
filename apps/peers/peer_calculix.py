"""CalculiX: beam elements of three nodes with reduced integration, B32R, with large displacements. CalculiX expands them to solid
elements of 20 nodes of St. Venant-Kirchhoff material; that theory differs from rods by the strain at the edge of the section."""

import re
import resource
import subprocess
import tempfile
from pathlib import Path

PROGRAM, LONGEST_RUN = "ccx", 300.0  # seconds


def version():
    printed = subprocess.run([PROGRAM, "-v"], capture_output=True, text=True, check=False).stdout
    return re.search(r"[\d.]+", printed)[0]


def deck(problem, elements, steps, equal):
    count = 2 * elements + 1
    places = [problem.place(problem.length * i / (count - 1))[0] for i in range(count)]
    loads = [f"{count}, {i + 1}, {load:.15g}" for i, load in enumerate(problem.force + problem.moment) if load]
    return "\n".join([
        "*NODE", *(f"{i + 1}, {x:.15g}, {y:.15g}, {z:.15g}" for i, (x, y, z) in enumerate(places)),
        "*ELEMENT, TYPE=B32R, ELSET=ROD", *(f"{e + 1}, {2 * e + 1}, {2 * e + 2}, {2 * e + 3}" for e in range(elements)),
        "*MATERIAL, NAME=M", "*ELASTIC", f"{problem.E:.15g}, 0",
        "*BEAM SECTION, ELSET=ROD, MATERIAL=M, SECTION=RECT", f"{problem.side:.15g}, {problem.side:.15g}", "0, 0, 1",
        "*NSET, NSET=TIP", f"{count}", "*BOUNDARY", "1, 1, 6", "*STEP, NLGEOM, INC=100000",
        "*STATIC" + (", DIRECT" if equal else ""), f"{1 / steps:.15g}, 1" + ("" if equal else ", 1e-8"),
        "*CLOAD", *loads, "*NODE PRINT, NSET=TIP, FREQUENCY=1000000", "U", "*END STEP", ""])


def solve(problem, order, elements, steps, equal=False):
    """Solves a problem; the order is always 2. CalculiX chooses the load steps unless `equal`."""
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "rod.inp").write_text(deck(problem, elements, steps, equal), encoding="ascii")
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([PROGRAM, "rod"], cwd=folder, capture_output=True, timeout=LONGEST_RUN, check=False)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        texts = [file.read_text() if (file := Path(folder, f"rod.{kind}")).exists() else "" for kind in ("dat", "sta", "cvg")]
    printed, increments, iterations = texts
    reached = [line.split() for line in increments.splitlines() if re.match(r"\s*\d+\s+\d+", line)]
    values = re.findall(r"^\s+\d+\s+(\S+)\s+(\S+)\s+(\S+)\s*$", printed, re.M)
    if not values or not reached or abs(float(reached[-1][4]) - 1) > 1e-9:
        raise RuntimeError("no convergence")
    return {"tip": [float(value) for value in values[-1]], "steps": len(reached),
            "iterations": len(re.findall(r"^\s*\d+\s+\d+", iterations, re.M)),
            "seconds": after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime}
