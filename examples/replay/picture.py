#!/usr/bin/env python3
"""picture.py memory|laps|soak RESULTS.json FILE.svg: one figure of what slamgc-replay --json wrote, for a document."""

import sys
from pathlib import Path

import figures
from results import Refused, read, shown

FEW = ("leak", "shared_ptr", "fetch_add_all", "deferred")


def draw(which, results, path):
    runs = shown(results)
    if which == "memory":
        drawn = figures.memory(results, {s: r for s, r in runs.items() if s in FEW}, (8, 3))
    else:
        drawn = {"laps": figures.over_laps, "soak": figures.soak}[which](results, runs)
    if drawn is None:
        raise Refused(f"{path}: one lap only")
    drawn[0].savefig(path, metadata={"Date": None}, bbox_inches="tight")
    figures.plt.close(drawn[0])


if __name__ == "__main__":
    if len(sys.argv) != 4 or sys.argv[1] not in ("memory", "laps", "soak"):
        sys.exit(__doc__)
    try:
        draw(sys.argv[1], read(Path(sys.argv[2])), Path(sys.argv[3]))
    except (Refused, OSError) as e:
        sys.exit(f"picture.py: {e}")
