"""Errors, with the messages of the program."""

import difflib


class InputError(ValueError):
    """What was given cannot be used (exit code 2 of the program); the message says where, what was seen, what is allowed."""


class UnknownName(InputError, AttributeError, KeyError):
    """A name that the scene or the declarations of its parameters do not have; the message names the nearest one."""

    def __str__(self):
        return str(self.args[0])


class ConvergenceError(RuntimeError):
    """No equilibrium was found (exit code 3 of the program).

    `run`: the Run as far as it came, whose last step is the last converged state.
    """

    def __init__(self, message, run=None):
        super().__init__(message)
        self.run = run


def unknown(what, name, known):
    """An UnknownName that says what was looked for and which known names are near."""
    near = difflib.get_close_matches(name, known, 1, 0.0)
    hint = f"; did you mean {near[0]!r}?" if near else ""
    return UnknownName(f"{what}: nothing of the name {name!r}{hint}")
