"""Installs the package into the environment of the running Python, without network: python -m mixbeam.install."""

import shutil
import sysconfig
from pathlib import Path


def main():
    source = Path(__file__).resolve().parent
    target = Path(sysconfig.get_path("platlib")) / source.name
    if target == source:
        print(f"{target}: installed already")
        return
    shutil.rmtree(target, ignore_errors=True)
    shutil.copytree(source, target, ignore=shutil.ignore_patterns("__pycache__"))
    print(target)


if __name__ == "__main__":
    main()
