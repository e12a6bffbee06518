"""Errors, with the messages of the program."""

from . import _core

MOST_NAMES = 24  # in a message


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
    near = _core.did_you_mean(name, known).replace('"', "'")
    hint = near or (f"; allowed: {', '.join(known[:MOST_NAMES])}" if known else "")
    return UnknownName(f"{what}: nothing of the name {name!r}{hint}")
