"""Exit codes, error messages and atomic writing of files, shared by plot, report and view."""

import os
import secrets
import sys
from contextlib import contextmanager, suppress
from pathlib import Path

BAD_INPUT = 2   # exit code, as of all programs of mixbeam
inputs = set()  # paths that were read, which must not be overwritten


class InputError(Exception):
    """An input file is missing or unsuitable; the message names file and reason."""


class NothingToDraw(InputError):
    """The input of a figure is missing, or is valid but has no data for the figure."""


def finish(name, result, work):
    """Runs `mixbeam NAME` on a result file: prints the paths of the files that `work()` yields, returns the exit code."""
    try:
        for path in work():
            print(path, flush=True)
        return 0
    except ImportError as error:
        reason = (f"{error}; the Debian packages python3-matplotlib and python3-h5py hold what is needed (packages in ~/.local "
                  "are not looked at)")
    except (InputError, OSError) as error:
        reason = str(error)
    except Exception as error:  # from a file with content that no run writes
        reason = f"unexpected content ({type(error).__name__}: {error})"
    print(f"mixbeam {name}: " + (reason if str(result) in reason else f"{result}: {reason}"), file=sys.stderr)
    return BAD_INPUT


def replace_part(page, name, text):
    """Replaces the text between the lines <!-- NAME:begin --> and <!-- NAME:end --> of a page. Raises InputError."""
    begin, end = f"<!-- {name}:begin -->", f"<!-- {name}:end -->"
    try:
        old = page.read_text(encoding="utf-8")
        before, begun, rest = old.partition(begin)
        _, ended, after = rest.partition(end)
        if not begun or not ended:
            raise InputError(f"{page}: no line {begin} with a line {end} after it")
        new = f"{before}{begin}\n{text}\n{end}{after}"
        if new != old:
            page.write_text(new, encoding="utf-8")
    except OSError as error:
        raise InputError(f"{page}: {error.strerror}") from None


@contextmanager
def whole_file(path):
    """Opens a stream to a file that appears under its name once it is complete. Raises InputError rather than replace an
    input or anything but a file; links are not followed."""
    path = Path(path)
    for other in inputs:
        with suppress(OSError):
            if os.path.samefile(other, path):
                raise InputError(f"{path}: is what was read as {other}, and is not written over; allowed: another name")
    if path.exists() and not path.is_file():
        raise InputError(f"{path}: is there and is no file; allowed: the name of a file")
    hidden = path.with_name(f".mixbeam-{secrets.token_hex(8)}")
    try:
        with open(hidden, "xb") as stream:  # O_EXCL does not follow links
            yield stream
        os.replace(hidden, path)
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror or error}") from None
    finally:
        with suppress(OSError):
            os.unlink(hidden)
