"""Runs one program in its own process: reads a job (file of the program, options, calls) and prints a line of JSON for each call,
with its processor time. The first line is the version of the program, or why it cannot be imported."""

import importlib
import json
import sys
import time

import peer_problems

LONGEST_FAILURE = 100  # letters


def tried(program, call, options):
    """Tries numbers of load steps until one leads to an equilibrium near the truth; returns it with the time of that one only."""
    problem = peer_problems.PROBLEMS.get(call["problem"], peer_problems.CHAIN)
    mesh = {"order": call["order"], "elements": call["elements"]}
    for steps in call["steps"]:
        try:
            start = time.process_time()
            found = {**mesh, **program.solve(problem, *mesh.values(), steps, **options)}
            found.setdefault("seconds", time.process_time() - start)
            found["error"] = problem.error(found.pop("tip"))
            if found["error"] < 1:
                return found
            failure = "another equilibrium, or not a number"
        except Exception as error:  # programs raise various errors if they do not converge
            failure = f"{type(error).__name__}: {error}".splitlines()[0][:LONGEST_FAILURE]
    return {**mesh, "failure": failure}


def say(facts):
    print("PEER " + json.dumps(facts), flush=True)


def main():
    job = json.load(sys.stdin)
    try:
        program = importlib.import_module(job["file"])
        without = {"version": "importable", "absent": "it is importable, but these problems are not written for it"}
        say({"version": program.version()} if hasattr(program, "solve") else without)
    except (ImportError, OSError) as error:
        return say({"absent": str(error)})
    for call in job["calls"]:
        say(tried(program, call, job["options"]))
    return None


if __name__ == "__main__":
    main()
