#!/usr/bin/env python3
"""Makes tables of what scripts/benchmark measured of mini_orb, with slamgc and without.

  report_slam.py RESULTS                  prints them
  report_slam.py RESULTS --write FILE     replaces what is between the markers in FILE, and draws the
                                          plot beside it
"""

import json
import re
import statistics
from pathlib import Path

from report import OPEN, Results, machine_table, main, median_of, number, pyplot, table, verdict, with_interval

PLOT = "performance-slam.svg"
MODES = ("one-thread", "threads")
WHAT = {"tracking_us": "tracking, a frame", "local_mapping_us": "local mapping, a keyframe",
        "tracking_processor_us": "processor time of tracking, a frame",
        "local_mapping_processor_us": "processor time of local mapping, a keyframe"}


class SlamResults(Results):
    def __init__(self, directory):
        super().__init__(directory, ())
        self.runs = {}          # (build, mode) -> runs, in rounds
        for mode in MODES:
            for build in ("plain", "slamgc"):
                self.runs[build, mode] = [
                    json.loads(f.read_text()) for f in
                    sorted(Path(directory).glob("{}.{}.*.json".format(build, mode)))]
        self.long = {b: json.loads((directory / (b + ".long.json")).read_text())["laps"]
                     for b in ("plain", "slamgc")}
        # callgrind's totals: instructions inside one function and what that calls
        self.instructions = {}
        for f in Path(directory).glob("*.callgrind.txt"):
            build, what = f.name.split(".")[:2]
            found = re.search(r"Collected : (\d+)", f.read_text())
            self.instructions[build, what] = int(found.group(1))

    def ratio(self, mode, what, of):
        pairs = zip(self.runs["slamgc", mode], self.runs["plain", mode])
        return median_of([of(a[what]) / of(b[what]) for a, b in pairs])

    def median(self, build, mode, what, of):
        return statistics.median(of(r[what]) for r in self.runs[build, mode])


def p99(values):
    return sorted(values)[int(len(values) * 0.99)]


def report(results, drawn):
    yield from machine_table(results, "scripts/benchmark --part slam")
    yield "### Bars of mini_orb"
    yield ""
    yield ("With slamgc / without. Instructions are exact (callgrind, one thread, collectors apart). Times: the ratio of the two runs of a "
           "round, the median over {} rounds, and its 95 % confidence interval ({}). With threads, there are more of them than processors here, and with slamgc the "
           "reclaimer is one more: the time that a thread waits for a processor is in its times, and not in its processor time.".format(len(results.runs["plain", "threads"]), OPEN))
    yield ""
    rows = []

    for what, name in (("tracking", "instructions, " + WHAT["tracking_us"]),
                       ("local_mapping", "instructions, " + WHAT["local_mapping_us"])):
        ratio = results.instructions["slamgc", what] / results.instructions["plain", what]
        rows.append([name, "{:.4f}".format(ratio), "1.01", "met" if ratio <= 1.01 else "**missed**"])
    for mode in MODES:
        for what, name in WHAT.items():
            for of, which in ((statistics.median, "median"), (p99, "99th percentile")):
                r = results.ratio(mode, what, of)
                rows.append(["{}, {}, {}".format(name, which, mode), with_interval(*r), "1.01", verdict(*r, 1.01) if len(results.runs["plain", mode]) >= 6 else ""])
    yield from table(["bar", "measured", "at most", ""], rows)
    yield "### Times"
    yield ""
    rows = []
    for mode in MODES:
        for what, name in WHAT.items():
            for build in ("plain", "slamgc"):
                of = [results.median(build, mode, what, f) for f in (statistics.median, p99, max)]
                rows.append([mode, name, build] + [number(x / 1000) for x in of] +
                            [str(len(results.runs[build, mode][0][what]))])
    yield from table(["mode", "what", "build", "median, ms", "99th percentile, ms", "longest, ms", "how many"],
                     rows, left=3)
    yield "### A long session"
    yield ""
    yield "Laps of {} frames round one track, with threads; at the end of a lap.".format(157)
    yield ""
    rows = []
    laps = [0, 4, 9, 14, len(results.long["plain"]) - 1]
    for lap in laps:
        row = [str(lap + 1)]
        for build in ("plain", "slamgc"):
            l = results.long[build][lap]
            row += ["{:.1f}".format(l["bytes"] / 1e6), str(l["keyframes"]), str(l["live_keyframes"]), str(l["live_points"])]
        rows.append(row)
    yield from table(["lap", "plain: MB", "keyframes in the map", "alive", "points alive", "slamgc: MB",
                      "keyframes in the map", "alive", "points alive"], rows)
    if drawn:
        yield "![Memory and live keyframes over the laps, with slamgc and without]({})".format(PLOT)


def plot(results, path):
    """Whether it could be drawn."""
    plt = pyplot()
    if plt is None:
        return False
    figure, axes = plt.subplots(1, 2, figsize=(8, 3.2))
    for build, style in (("plain", "--"), ("slamgc", "-")):
        laps = results.long[build]
        x = range(1, len(laps) + 1)
        axes[0].plot(x, [l["bytes"] / 1e6 for l in laps], style, label=build)
        axes[1].plot(x, [l["live_keyframes"] for l in laps], style, label=build + ", alive")
    axes[1].plot(x, [l["keyframes"] for l in results.long["slamgc"]], ":", label="slamgc, in the map")
    axes[0].set_ylabel("MB given out by malloc")
    axes[1].set_ylabel("keyframes")
    for axis in axes:
        axis.set_xlabel("laps")
        axis.set_ylim(bottom=0)
        axis.grid(alpha=0.3)
        axis.legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})
    return True


main(__doc__, "slam", SlamResults, report, plot, PLOT)
