"""What is on the disk: result files, read in a process of its own, and a disk that keeps only what was synced, to which the
calls that faults.c has recorded are played.

On that disk contents of a file survive as they were when it was last synced. Names (new files, renames, removals) survive either all of
them, as a journal may have written them before the data, or only those before the last sync of their folder.
"""
import collections
import concurrent.futures
import hashlib
import multiprocessing
import os

PATIENCE = 120  # seconds to read a file

Call = collections.namedtuple("Call", "name process file place data path other")


def digest(path):
    """Every dataset and attribute of an HDF5 file: name -> hash. Runs in a process of its own: HDF5 crashes on some files."""
    import h5py
    found = {}

    def visit(name, thing):
        for key, value in thing.attrs.items():
            found[f"{name}@{key}"] = hashlib.sha1(repr(value).encode()).hexdigest()
        if isinstance(thing, h5py.Dataset):
            data = thing[()]
            data = data if isinstance(data, bytes) else repr((data.shape, data.dtype)).encode() + data.tobytes()
            found[name] = hashlib.sha1(data).hexdigest()

    with h5py.File(path, "r") as file:
        file.visititems(visit)
    return found


class Reader:
    """Digests of files, kept by their bytes."""

    def __init__(self):
        self.known = {}
        self.pool = None

    def read(self, path):
        data = hashlib.sha1(path.read_bytes()).hexdigest()
        if data not in self.known:
            self.known[data] = self.fresh(path)
        return data, self.known[data]

    def fresh(self, path):
        if self.pool is None:
            self.pool = concurrent.futures.ProcessPoolExecutor(1, multiprocessing.get_context("spawn"))
        try:
            return self.pool.submit(digest, path).result(timeout=PATIENCE)
        except (OSError, RuntimeError, KeyError, ValueError, concurrent.futures.TimeoutError) as error:
            self.pool = None  # which has perhaps crashed
            return f"{type(error).__name__}: {error}"

    def close(self):
        if self.pool is not None:
            self.pool.shutdown()


def steps_of(content):
    return {name.split("/")[1].split("@")[0] for name in content if name.startswith("steps/")}


def same_bits(content, whole, complete):
    """What differs from the undisturbed file, else ''. `complete`: all of it is there, not only its first steps."""
    if isinstance(content, str):
        return f"cannot be read: {content[:80]}"
    steps, all_steps = steps_of(content), sorted(steps_of(whole))
    if steps != set(all_steps[:len(steps)]) or (complete and len(steps) < len(all_steps)):
        return f"has the steps {sorted(steps)} of {all_steps}"
    fixed = ("scene", "version", "imported", "members", "supports", "polyline")
    for name, value in whole.items():
        top, inside = name.split("/")[0], name.split("/")[1].split("@")[0] if "/" in name else ""
        wanted = inside in steps if top == "steps" else bool(steps) and top in fixed or complete and top in (
            "monitor", "buckling", "columns", "causes")
        if wanted and content.get(name) != value:
            return f"{name} {'differs' if name in content else 'is missing'}"
    return ""


class Node:
    """A file without a name: what the program sees, and what the disk has."""

    def __init__(self, data=b""):
        self.seen, self.kept = bytearray(data), bytes(data)

    def write(self, place, data):
        self.resize(max(len(self.seen), place + len(data)))
        self.seen[place:place + len(data)] = data

    def resize(self, size):
        del self.seen[size:]
        self.seen.extend(bytes(size - len(self.seen)))


def recorded(log, folder):
    """The calls in a log, with names relative to the folder in which the program was started."""
    calls, at = [], 0
    while at < len(log):
        end = log.index(b"\n", at)
        name, process, file, place, size, path, other = log[at:end].decode().split("\t")
        at = end + 1
        data = b""
        if name == "write":
            data, at = log[at:at + int(size)], at + int(size)
        relative = [os.path.relpath(os.path.join(folder, p), folder) if p else "" for p in (path, other)]
        calls.append(Call(name, process, int(file), int(place), data, *relative))
    return calls


def disks(calls, before, names_kept):
    """What is on the disk when the power is cut behind each of the calls: name -> bytes. `before`: the same at the beginning.
    `names_kept`: names survive without a sync of their folder."""
    names = {name: Node(data) for name, data in before.items()}
    kept, open_files = dict(names), {}
    for call in calls:
        play(call, names, kept, open_files)
        yield {name: node.kept for name, node in (names if names_kept else kept).items()}


def play(call, names, kept, open_files):
    file = (call.process, call.file)
    if call.name in ("create", "open"):
        if call.name == "create" and call.path in names:
            names[call.path].resize(0)
        if call.name == "create" or call.place & os.O_CREAT:
            names.setdefault(call.path, Node())
        open_files[file] = names.get(call.path)  # a folder has no node
    elif call.name == "close":
        open_files.pop(file, None)
    elif call.name in ("rename", "link"):
        names[call.other] = names[call.path]
        if call.name == "rename":
            del names[call.path]
    elif call.name == "unlink":
        names.pop(call.path, None)
    elif call.name == "sync":
        if open_files.get(file) is not None:
            open_files[file].kept = bytes(open_files[file].seen)
        else:
            keep_names(call.path, names, kept)
    elif open_files.get(file) is not None:
        node = open_files[file]
        if call.name == "write":
            node.write(call.place, call.data)
        elif call.name == "truncate":
            node.resize(call.place)
        elif call.name == "extend":
            node.resize(max(call.place, len(node.seen)))


def keep_names(folder, names, kept):
    inside = lambda name: os.path.dirname(name) == ("" if folder == "." else folder)
    for name in [name for name in kept if inside(name)]:
        del kept[name]
    kept.update({name: node for name, node in names.items() if inside(name)})
