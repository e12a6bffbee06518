"""Makes the wheel of the Python module from the archive, beside it: make_wheel.py mixbeam-VERSION-linux-x86_64.tar.xz."""

import base64
import hashlib
import re
import sys
import tarfile
import zipfile
from pathlib import Path

TAG = f"cp{sys.version_info.major}{sys.version_info.minor}"
PLATFORM = "manylinux_2_36_x86_64"  # glibc of Debian 12
MODULE, LIBRARIES, DOCUMENTS = "lib/python3/dist-packages/mixbeam/", "lib/mixbeam/", "share/doc/mixbeam/"
OF_SYSTEM = ("libstdc++.so.6", "libgcc_s.so.1", "libz.so.1")  # which a process has once: manylinux leaves them to the system
METADATA = """Metadata-Version: 2.1
Name: mixbeam
Version: {version}
Summary: Static solver for structures of geometrically exact beams
Requires-Python: =={major}.{minor}.*
Requires-Dist: numpy
Provides-Extra: pictures
Requires-Dist: matplotlib; extra == "pictures"
Requires-Dist: h5py; extra == "pictures"
"""


def place_in_wheel(name, information):
    """Of a file of the archive; None where the wheel does without it."""
    if name.startswith(MODULE):
        return "mixbeam/" + name.removeprefix(MODULE)
    if name.startswith(LIBRARIES):
        return None if name.removeprefix(LIBRARIES) in OF_SYSTEM or name.endswith("/orterun") else (
            "mixbeam/lib/" + name.removeprefix(LIBRARIES))
    if name.startswith(DOCUMENTS) and ("/licences/" in name or name.endswith("/copyright")):
        return f"{information}/{name.removeprefix(DOCUMENTS)}"
    return None


def main(archive):
    version = re.match(r"mixbeam-([^-]+)-", archive.name)[1]
    information = f"mixbeam-{version}.dist-info"
    record = []
    wheel = archive.with_name(f"mixbeam-{version}-{TAG}-{TAG}-{PLATFORM}.whl")
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as out, tarfile.open(archive) as files:

        def add(place, content, mode=0o644):
            entry = zipfile.ZipInfo(place)
            entry.external_attr, entry.compress_type = (0o100000 | mode) << 16, zipfile.ZIP_DEFLATED
            out.writestr(entry, content)
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
            record.append(f"{place},sha256={digest},{len(content)}")

        for member in files:
            place = place_in_wheel(member.name.partition("/")[2], information)
            if member.isfile() and place:
                add(place, files.extractfile(member).read(), member.mode & 0o777)
        add(f"{information}/METADATA", METADATA.format(version=version, major=sys.version_info.major,
                                                       minor=sys.version_info.minor).encode())
        add(f"{information}/WHEEL", f"Wheel-Version: 1.0\nGenerator: mixbeam\nRoot-Is-Purelib: false\nTag: {TAG}-{TAG}-{PLATFORM}\n".encode())
        out.writestr(f"{information}/RECORD", "\n".join([*record, f"{information}/RECORD,,", ""]))
    print(wheel)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
