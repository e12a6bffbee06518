"""Numbers of a page in few bytes, as viewer/packed.js reads them: whole multiples of a unit, the difference of each one to
what its neighbours let expect, deflated."""

import json
import zlib

import numpy as np

FOR_READING = 15    # bits of numbers that the page shows: 16,000 units up to the largest of a column, more than four digits,
FOR_DRAWING = 13    # of directions and modes,
FOR_PLACES = 22     # and of undeformed positions and the path: six digits
PLANES = 3          # bytes of a number
MISSING = 1 << 22   # in place of nan
HALF = 1 << 23      # differences are counted modulo twice this
LEAST_UNIT = 1e-300


class Packed:
    """`bytes` of (n, columns) values; `values` is what a reader of them gets.

    `later`: up to two Packed of the same quantity in the steps behind, from which it is extrapolated.
    """

    def __init__(self, values, bits, later=()):
        values = np.asarray(values, dtype=float)
        values = values.reshape(len(values), -1)
        known = np.isfinite(values)
        largest = np.abs(np.where(known, values, 0.0)).max(axis=0, initial=0.0)
        self.units = np.where(largest > 0, np.maximum(largest / (2 ** (bits - 1) - 1), LEAST_UNIT), 1.0)
        whole = np.where(known, np.floor(values / self.units + 0.5), MISSING)
        self.values = whole * self.units
        rest = whole.astype(np.int64) - self._expected([step.values for step in later])
        rest = np.diff(rest, axis=0, prepend=np.zeros((1, values.shape[1]), dtype=np.int64))
        rest = (rest + HALF) % (2 * HALF) - HALF
        rest = np.where(rest < 0, -2 * rest - 1, 2 * rest).T
        self.bytes = deflated(b"".join(((rest >> (8 * plane)) & 255).astype(np.uint8).tobytes() for plane in range(PLANES)))

    def _expected(self, later):
        if not later:
            return 0
        ahead = later[0] if len(later) == 1 else 2 * later[0] - later[1]
        return np.clip(np.floor(ahead / self.units + 0.5), -MISSING, MISSING).astype(np.int64)


def deflated(data):
    """Without the header of zlib."""
    packer = zlib.compressobj(9, zlib.DEFLATED, -15, 9)
    return packer.compress(data) + packer.flush()


def deflated_text(value):
    """Of JSON with finite numbers."""
    return deflated(json.dumps(value, allow_nan=False, separators=(",", ":")).encode())
