"""Scenes of a few members as texts, for the tests of pictures and pages."""

import subprocess

NUMBERS, WORDS = "Array(double)", "Array(string)"


def entry(name, kind, value):
    return f'<Parameter name="{name}" type="{kind}" value="{value}"/>'


def listed(name, *content):
    return f'<ParameterList name="{name}">{"".join(content)}</ParameterList>'


def member(name, start, end, *more):
    return listed(name, entry("Start", "string", start), entry("End", "string", end), entry("Section", "string", "s"),
                  entry("Elements", "int", "4"), *more)


def scene(*content, points=()):
    section = listed("s", entry("EA", "double", "1e4"), entry("Shear Rigid", "bool", "true"),
                     *(entry(name, "double", "1") for name in ("GIt", "EI2", "EI3")))
    places = listed("Points", *(entry(name, NUMBERS, "{%g, %g, %g}" % place) for name, place in points))
    return listed("portal", listed("Scene", entry("Units", "string", "m, kN"), listed("Sections", section), places, *content))


def support(name, point, displacement="{x, y, z}", rotation="{x, y, z}", *more):
    return listed(name, entry("Point", "string", point), entry("Fixed Displacement", WORDS, displacement),
                  entry("Fixed Rotation", WORDS, rotation), *more)


def cantilever(force, follower=False):
    frame = (entry("Frame", "string", "follower"), entry("Member", "string", "m")) if follower else ()
    return scene(listed("Members", member("m", "a", "b", entry("Order", "int", "3"))), listed("Supports", support("clamp", "a")),
                 listed("Point Loads", listed("f", entry("Point", "string", "b"), entry("Force", NUMBERS, force), *frame)),
                 points=(("a", (0, 0, 0)), ("b", (1, 0, 0))))


def solve(program, folder, name, text):
    """Runs a scene of this name; the result file."""
    (folder / f"{name}.xml").write_text(text, encoding="utf-8")
    ended = subprocess.run([program, "run", f"{name}.xml", "--output", ".", "--quiet"], cwd=folder, capture_output=True,
                           text=True, check=False)
    assert ended.returncode == 0, ended.stderr
    return folder / f"{name}.h5"
