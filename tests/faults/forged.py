#!/usr/bin/python3
"""Forged result files through the Python reader, in this process: only its clear error, and no byte of another file.

usage: forged.py MIXBEAM [--files N] [--seed S] [--flips]     --flips: bits of the file too, which the HDF5 library may not survive
"""

import argparse
import contextlib
import os
import random
import subprocess
import sys
import tempfile
import time
import warnings
from pathlib import Path

import h5py
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "apps" / "plots"))  # without a program beside it: not verified

import envelope_figures  # noqa: E402
import results  # noqa: E402

SECRET = b"TOPSECRT"  # eight bytes: a text, and a number
SLOWEST = 5.0  # seconds of the processor for a file of 100 kB
VIEWED = 50     # one in so many is drawn by the program too, as one of a version without checksums
LARGEST = 10000  # numbers of a dataset that is filled
SCENES = {"toggle": """Scene:
  Units: "m, N"
  Sections: {rod: {Shape: circle, Diameter: 0.05, Material: {E: 2.0e+9, nu: 0.3, Strength: 1.0e+8}}}
  Points: {left: [-1, 0, 0], top: [0, 0, 0.1], right: [1, 0, 0]}
  Members: {a: {Start: left, End: top, Order: 2, Elements: 2}, b: {Start: top, End: right, Order: 2, Elements: 2}}
  Joints: {hinge: {Point: top, Members: [b], Kind: hinge, Axis: [0, 1, 0]}}
  Supports: {l: {Point: left}, r: {Point: right}}
  Point Loads: {push: {Point: top, Force: [0, 0, -2000]}}
  Distributed Loads: {snow: {Member: a, Force: [0, 0, -1]}}
  Eigenstrains: {heat: {Member: b, Strain: [1.0e-5, 0, 0]}}
Solver: {Load Path: {Maximum Step: 0.25}}
Analysis: {Snap: jump, Buckling Modes: 1}
Quantities: {sag: {Quantity: displacement, Point: top, Component: z}, most: {Quantity: von Mises stress, Member: "*", Take: largest}}
""", "cases": """Scene:
  Load Cases: [one, two]
  Sections: {rod: {Shape: circle, Diameter: 4, Material: {E: 206000, nu: 0.3}}}
  Points: {wall: [0, 0, 0], tip: [1000, 0, 0]}
  Members: {wire: {Start: wall, End: tip, Order: 2, Elements: 2}}
  Supports: {clamp: {Point: wall}}
  Point Loads: {weight: {Point: tip, Force: [0, 0, -1], Case: one}, wind: {Point: tip, Force: [0, 1, 0], Case: two}}
Quantities: {sag: {Quantity: displacement, Point: tip, Component: z}}
"""}


def objects_of(file):
    found = []
    file.visit(found.append)
    return sorted(found)


def odd_dataset(parent, name, old, rng, secret):
    """Something else under the name of a dataset."""
    kind, shape = rng.randrange(16), getattr(old, "shape", None) or ()
    shape = shape if np.prod(shape, dtype=float) < LARGEST else (LARGEST,)  # what was forged before may have no end
    dtype = getattr(old, "dtype", np.dtype("f8"))
    kind = kind if kind < 14 or shape else 0
    values = np.zeros(shape, dtype)
    other = rng.choice([(), (0,), (1,), (400,), (7, 3), (3, 7, 2), shape + (2,), tuple(2 * n for n in shape)])
    if kind == 0:
        parent.create_dataset(name, data=np.zeros(other, dtype))
    elif kind == 1:
        parent.create_dataset(name, shape=shape, dtype=rng.choice(["f4", ">f8", "i8", "u4", "i4", "S1", "S400", "c16", "V9", "f8", "?"]))
    elif kind == 2:
        parent.create_dataset(name, data=np.full(other, "x" * 40, dtype=object), dtype=h5py.string_dtype())
    elif kind == 3:
        parent.create_dataset(name, shape=rng.choice([(10 ** 12,), (10 ** 12, 3), (2 ** 40, 2 ** 20)]), dtype=dtype)
    elif kind == 4:
        parent.create_dataset(name, shape=(10 ** 9,), maxshape=(None,), chunks=(64,), dtype=dtype)
    elif kind == 5 and shape:
        parent.create_dataset(name, data=values, compression="gzip")
    elif kind in (5, 6):
        plan, size = h5py.h5p.create(h5py.h5p.DATASET_CREATE), max(1, int(np.prod(shape))) * dtype.itemsize
        plan.set_external(secret.encode(), 0, size)
        kept = shape or (1,)
        space = h5py.h5s.create_simple(kept) if shape else h5py.h5s.create(h5py.h5s.SCALAR)
        h5py.h5d.create(parent.id, name.encode(), h5py.h5t.py_create(dtype), space, plan)
    elif kind == 7:
        parent[name] = h5py.SoftLink(rng.choice(["/", "/steps", "/scene", "/nowhere", "."]))
    elif kind == 8:
        parent[name] = h5py.ExternalLink(rng.choice([secret, secret + ".h5", "/etc/passwd"]), rng.choice(["/x", "/t"]))
    elif kind == 9:
        parent[name] = parent.file[rng.choice(["/", "/steps", "/members", "/monitor"])]
    elif kind == 10:
        parent.create_group(name)
    elif kind == 11:
        parent[name] = np.dtype("f8")
    elif kind == 12:
        parent[name] = h5py.Empty(dtype)
    elif kind == 13:
        parent.create_dataset(name, shape=other, dtype=rng.choice([h5py.ref_dtype, np.dtype([("a", "f8"), ("b", "i4")]), np.dtype(("f8", (3,)))]))
    elif kind == 14:
        layout = h5py.VirtualLayout(shape=shape, dtype=dtype)
        layout[...] = h5py.VirtualSource(secret + ".h5", "x", shape=shape, dtype=dtype)
        parent.create_virtual_dataset(name, layout)
    elif dtype.kind in "fi":
        with np.errstate(all="ignore"):
            filled = np.asarray([rng.choice([0.0, -1.0, 1e300, 2e9, np.nan, np.inf, 3.7, -2147483648.0]) for _ in range(values.size)])
            parent.create_dataset(name, data=filled.reshape(shape).astype(dtype))


def forge(file, rng, secret):
    for _ in range(rng.choice((1, 1, 1, 2, 4))):
        name = rng.choice(objects_of(file))
        if name not in file:
            continue
        thing = file[name]
        if rng.random() < 0.3 and len(thing.attrs):
            key = rng.choice(list(thing.attrs))
            thing.attrs[key] = rng.choice([np.zeros(64), "text", 2 ** 40, -1, np.nan, np.float32(1), np.int32(-7), h5py.Empty("f8"),
                                           np.full(99, b"y", "S9"), "x" * 60000, np.int32(2 ** 31 - 1), b"\xff\xfe", np.bytes_(b"z")])
            if rng.random() < 0.3:
                del thing.attrs[key]
            continue
        parent = thing.parent
        last = name.rpartition("/")[2]
        if rng.random() < 0.1 and isinstance(parent, h5py.Group):
            parent[rng.choice(["0", "1", "-1", "x", "\u00e9\n", "9" * 200])] = thing
            continue
        del file[name]
        if rng.random() < 0.9:
            odd_dataset(parent, last, thing if isinstance(thing, h5py.Dataset) else None, rng, secret)


def bytes_of(value):
    if isinstance(value, (str, bytes)):
        return value.encode("utf-8", "replace") if isinstance(value, str) else value
    if isinstance(value, np.ndarray):
        return value.tobytes() if value.dtype != object else b""
    if isinstance(value, dict):
        return b"".join(bytes_of(one) for pair in value.items() for one in pair)
    if isinstance(value, (list, tuple)):
        return b"".join(map(bytes_of, value))
    return np.float64(value).tobytes() if isinstance(value, (int, float)) else b""


def read_all(path):
    """All that the reader gives, as bytes."""
    if envelope_figures.is_envelope(path):
        return bytes_of(vars(envelope_figures.Envelope(path)))
    with results.Run(path) as run:
        seen = [run.scene_name, run.case, run.units, run.scene_text(), run.properties(), run.quantity_units(), run.reference()]
        seen += [[member.name, member.arc_length, member.element, member.reference_position] for member in run.members]
        seen += [run.acting(), run.monitor(), run.quantities(), run.buckling_modes(), run.supported_points()]
        for step in run.steps:
            seen += [step.field(name) for name in results.FIELDS if step.has(name) and name not in ("arc_length", "element")]
            seen += [step.residual_histories(), step.jump or 0, step.reactions(len(run.supported_points()))]
            for point in step.critical_points():
                seen += [point.field(name) for name in ("position", "displacement", "mode")]
                seen += [point.kind] + [point.monitored(name) for name in run.monitor()]
        return bytes_of(seen)


def problem_of_view(program, path):
    """Of `mixbeam view`, by its own reader: it draws the file or refuses it; empty: none."""
    with contextlib.suppress(Exception), h5py.File(path, "r+") as file:
        file.attrs["format_version"] = np.int32(2)
    ended = subprocess.run([program, "view", path, "--output", "forged.html"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=100)
    return "" if ended.returncode in (0, 2) else f"mixbeam view ended with {ended.returncode}"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("mixbeam")
    parser.add_argument("--files", type=int, default=1500)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--flips", action="store_true")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    np.seterr(all="ignore")
    program, rng, counts, problems = Path(options.mixbeam).resolve(), random.Random(options.seed), {}, []
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for name, text in SCENES.items():
            Path(f"{name}.yaml").write_text(text)
            subprocess.run([program, "run", f"{name}.yaml", "--quiet", "--output", "."], stdout=subprocess.DEVNULL, timeout=100)
        secret = str(Path("secret.txt").resolve())
        Path(secret).write_bytes(SECRET * 100000)
        with h5py.File(secret + ".h5", "w") as file:
            file["x"] = file["t"] = np.frombuffer(SECRET * 5000)
        whole = {name: Path(name).read_bytes() for name in ("toggle.h5", "cases-one.h5", "cases.h5")}
        for name in whole:
            assert SECRET not in read_all(Path(name))  # an intact one is read to its end
        for number in range(options.files):
            path = Path(rng.choice(("toggle.h5", "toggle.h5", "cases-one.h5", "cases.h5")))
            data = bytearray(whole[path.name])
            path = Path(f"forged-{number % 8}.h5")
            begin = time.process_time()
            try:
                if options.flips:
                    for _ in range(rng.choice((1, 3, 20))):
                        data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
                path.unlink(missing_ok=True)
                path.write_bytes(data)
                if not options.flips:
                    with h5py.File(path, "r+") as file, contextlib.suppress(Exception):  # what was forged first may be in the way
                        forge(file, rng, secret)
                begin = time.process_time()
                seen = read_all(path)
                word = "foreign bytes" if SECRET in seen else "read"
            except results.InputError as error:
                word = "refused" if str(path) in str(error) or ".h5" in str(error) else f"unclear: {error}"
            except Exception as error:
                word = f"{type(error).__name__}: {error}"
            if number % VIEWED == 0:
                word = problem_of_view(program, path) or word
            if time.process_time() - begin > SLOWEST:
                word = f"slow, {word}"
            counts[word if word in ("read", "refused") else "wrong"] = counts.get(word if word in ("read", "refused") else "wrong", 0) + 1
            if word not in ("read", "refused") and len(problems) < 20:
                problems.append(f"file {number}: {word}")
            if (number + 1) % 2000 == 0:
                print(f"{number + 1} files: {counts}", *problems, sep="\n", file=sys.stderr, flush=True)
        os.chdir("/")
    print(f"{options.files} forged files: {counts}", *problems, sep="\n")
    return len(problems) > 0


if __name__ == "__main__":
    sys.exit(main())
