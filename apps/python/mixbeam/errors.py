"""Exceptions, with the messages of the program."""

from . import _core

MOST_NAMES = 24  # in a message


class InputError(ValueError):
    """The input cannot be used (exit code 2 of the program); the message gives the place, the value seen and what is allowed."""


class UnknownName(InputError, AttributeError, KeyError):
    """A name that neither the scene nor the declared parameters have; the message gives the nearest one."""

    def __str__(self):
        return str(self.args[0])


class ConvergenceError(RuntimeError):
    """No equilibrium was found (exit code 3 of the program).

    `run`: the Run up to its last converged state.
    """

    def __init__(self, message, run=None):
        super().__init__(message)
        self.run = run


def unknown(what, name, known):
    """Returns an UnknownName that names `name` and the nearest of the known names."""
    near = _core.did_you_mean(name, known).replace('"', "'")
    hint = near or (f"; allowed: {', '.join(known[:MOST_NAMES])}" if known else "")
    return UnknownName(f"{what}: nothing of the name {name!r}{hint}")
