"""A disk that keeps only what was synced: the calls that faults.c has recorded are played to it.

Contents of a file survive as they were when it was last synced. Names (new files, renames, removals) survive either all of
them, as a journal may have written them before the data, or only those before the last sync of their folder.
"""
import collections
import os

Call = collections.namedtuple("Call", "name process file place data path other")


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
