"""One program in a process of its own: reads a job (file of the program, options, calls) and prints a line of JSON for each call,
with the processor time that it took. The first line is the version of the program, or why it is not there."""

import importlib
import json
import sys
import time

import peer_problems

LONGEST_FAILURE = 100  # letters


def tried(program, call, options):
    """The first number of load steps that leads to an equilibrium near the truth, and the time with that one alone."""
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
        except Exception as error:  # whatever a program raises where it does not converge
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
