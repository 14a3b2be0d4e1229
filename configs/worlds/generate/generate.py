#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes the worlds, their meshes and the trajectories below configs/. Needs Python 3 and nothing else.

  generate.py                   writes into this checkout's configs/
  generate.py --out DIR         writes the same tree below DIR
  generate.py --check           writes nothing; fails naming each committed file that differs
  generate.py --trajectories    only the trajectories, as each build does; git has one of them, as an example
"""

import argparse
import pathlib
import sys

sys.dont_write_bytecode = True
HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

from trajectories import trajectories  # noqa: E402
from worlds import docking_station, grid, manifold, oil_and_gas, ssiv, tank  # noqa: E402


def contents(worlds):
    """{path below configs/: bytes}."""
    files = {f"trajectories/{path}": data for path, data in trajectories().items()}
    for world in worlds:
        files |= {f"worlds/{path}": data for path, data in world().items()}
    return files


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=HERE.parent.parent)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--trajectories", action="store_true")
    options = parser.parse_args()
    worlds = () if options.trajectories else (docking_station, ssiv, manifold, tank, grid, oil_and_gas)

    different = []
    for path, data in sorted(contents(worlds).items()):
        target = options.out / path
        if target.is_file() and target.read_bytes() == data:
            continue
        if options.check:
            different.append(path)
            continue
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(data)
    for path in different:
        print(f"configs/{path} is not what the generator makes", file=sys.stderr)
    return 1 if different else 0


if __name__ == "__main__":
    sys.exit(main())
