#!/usr/bin/env python3
"""Makes tables of what scripts/benchmark measured of keyframe redundancy.

  report_redundancy.py RESULTS                  prints them
  report_redundancy.py RESULTS --write FILE     replaces what is between the markers in FILE, and draws the
                                                plots beside it
"""

import json
import math
import statistics
from collections import defaultdict

from report import main, median_of, number, pyplot, table

EXACT = "recompute", "connection_sets", "level_histogram"
ALONE, COPYING = "map alone", "recompute, copying"
CHANGES = ALONE, "connection_sets", "level_histogram"
COLOURS = {"recompute": "C1", "connection_sets": "C2", "level_histogram": "C0", ALONE: "C7"}
PLOTS = "redundancy-pass.svg", "redundancy-change.svg", "redundancy-session.svg"


class Results:
    """CPU time in nanoseconds by benchmark and repetition, and the counters of those that count."""

    def __init__(self, directory):
        self.times, self.counters = defaultdict(dict), {}
        self.sessions, self.axes = [], defaultdict(list)
        for b in json.loads((directory / "redundancy.json").read_text())["benchmarks"]:
            if b.get("run_type") == "aggregate":
                continue
            name = tuple(b["run_name"].split("/iterations:")[0].split("/"))
            self.times[name][b.get("repetition_index", 0)] = b["cpu_time"] * {"ns": 1, "us": 1e3, "ms": 1e6}[b["time_unit"]]
            self.counters[name] = b
            if name[0] == "session" and name[1] not in self.sessions:
                self.sessions.append(name[1])
            if name[0] == "pass" and int(name[2]) not in self.axes[name[1]]:
                self.axes[name[1]].append(int(name[2]))
        # Repetitions are interleaved, so that the order of the results says nothing.
        self.sessions.sort()
        self.axes = {axis: sorted(self.axes[axis]) for axis in sorted(self.axes)}
        self.machine = dict(text.split(" ", 1)
                            for text in (directory / "machine.txt").read_text().splitlines())

    def median(self, *name):
        times = self.times.get(name)
        return statistics.median(times.values()) if times else math.nan

    def over_map(self, session, scheme):
        """What a scheme adds to a session, in each repetition."""
        own, alone = self.times[("session", session, scheme)], self.times[("session", session, ALONE)]
        return {i: own[i] - alone[i] for i in own.keys() & alone.keys()}

    def session_ratio(self, session, scheme):
        """Of what each adds to its repetition; the medians first, since small differences may be lost in noise."""
        own = statistics.median(self.over_map(session, scheme).values())
        return own / statistics.median(self.over_map(session, "level_histogram").values())

    def pass_ratio(self, session):
        a, b = (self.times[("pass30", session, s)] for s in ("recompute", "level_histogram"))
        return median_of([a[i] / b[i] for i in a.keys() & b.keys()])[0]


def against(ratio, least):
    return number(ratio) if ratio >= least else "**{}**".format(number(ratio))


def report(results, with_plot):
    machine = results.machine
    yield "Measured {} with `scripts/benchmark --part redundancy --data FOLDER` on {}, {} processors{}; {}; load average {} before, {} after.".format(
        machine["date"], machine["cpu"], machine["processors"],
        " of a virtual machine" if machine["virtual"] == "yes" else "", machine["compiler"],
        machine["load_before"], machine["load_after"])
    yield "Times are medians of CPU time."
    yield ""
    if results.sessions:
        yield "### A whole session"
        yield ""
        yield ("Milliseconds that a scheme adds to the session's own changes of the map: all announcements and all culling passes. "
               "\"Copying\" is recomputing as ORB-SLAM3 does it, which copies the slots and each point's observations. "
               "Bold: below the aim of 5 times recompute and 3 times connection_sets.")
        yield ""
        rows = []
        for s in results.sessions:
            added = {scheme: statistics.median(results.over_map(s, scheme).values()) / 1e6
                     for scheme in EXACT + (COPYING,)}
            rows.append([s, number(results.median("session", s, ALONE) / 1e6), number(added[COPYING])] +
                        [number(added[scheme]) for scheme in EXACT] +
                        [against(results.session_ratio(s, "recompute"), 5),
                         against(results.session_ratio(s, "connection_sets"), 3)])
        yield from table(["session", "the map alone", "copying", "recompute", "connection_sets", "level_histogram",
                          "recompute / level_histogram", "connection_sets / level_histogram"], rows)
        if with_plot:
            yield "![What each scheme adds to a session]({})".format(PLOTS[2])
            yield ""
        yield "### One pass over 30 covisible keyframes"
        yield ""
        yield ("Microseconds, at the moment of the session with most covisible keyframes. Bold: below the aim of 50 times.")
        yield ""
        rows = []
        for s in results.sessions:
            rows.append([s] + [number(results.median("pass30", s, scheme) / 1e3) for scheme in (COPYING,) + EXACT] +
                        [against(results.pass_ratio(s), 50)])
        yield from table(["session", "copying", "recompute", "connection_sets", "level_histogram",
                          "recompute / level_histogram"], rows)
        yield "### Memory over the map itself"
        yield ""
        yield ("`recompute` keeps 8 bytes per keyframe. In the objects: `sizeof`; besides: what is allocated at the end of the session, "
               "per keyframe and point ever made.")
        yield ""
        rows = []
        for s in results.sessions:
            row = [s]
            work = results.counters[("workload", s)]
            for scheme in ("level_histogram", "connection_sets"):
                m = results.counters[("memory", s, scheme)]
                row.append("{:.0f} + {:.0f}".format(m["keyframe_bytes"], m["point_bytes"]))
                row.append("{:.0f} kB".format(m["heap_bytes"] / 1e3))
            row.append("{:.0f}".format(work["keyframes"]))
            row.append("{:.0f}".format(work["points"]))
            rows.append(row)
        yield from table(["session", "level_histogram: per keyframe + per point", "besides", "connection_sets: per keyframe + per point", "besides",
                          "keyframes", "points"], rows)
        yield "### The thesis's pseudo code against its rule"
        yield ""
        yield "Every verdict of every pass, with the thesis's rule (three others)."
        yield ""
        rows = []
        for s in results.sessions:
            p = results.counters[("published", s)]
            rows.append([s] + ["{:.0f}".format(p[n]) for n in ("asked", "redundant", "wrong", "wrongly_redundant")] +
                        ["{:.1f} %".format(100 * p["wrong"] / p["asked"]),
                         "{:.1f} %".format(100 * p["counts_differ"] / p["asked"])])
        yield from table(["session", "asked", "redundant", "answered otherwise", "of those called redundant",
                          "share", "count differs"], rows)
        yield "### The thesis's estimate"
        yield ""
        yield ("Changes: events that are announced. Visits: each candidate of each pass. The thesis expects its scheme to win if "
               "changes x O(n) is less than visits x points x O(n).")
        yield ""
        rows = []
        for s in results.sessions:
            w = results.counters[("workload", s)]
            visits = w["candidates"] * w["slots"]
            sets = 1 / (results.session_ratio(s, "connection_sets") / results.session_ratio(s, "recompute"))
            rows.append([s, number(w["candidates"] / w["keyframes"]), number(w["candidates"] / w["passes"]), number(w["changes"] / w["keyframes"]),
                         number(w["slots"]), number(visits / w["changes"]), number(sets)])
        yield from table(["session", "passes that ask for a keyframe", "candidates per pass", "changes per keyframe",
                          "points per candidate", "points visited per change", "recompute / connection_sets, time"], rows)
    yield "### Synthetic maps"
    yield ""
    yield ("Microseconds per pass over all covisible keyframes, and nanoseconds per change: of the map alone (which is what "
           "recompute leaves it), and with the announcement. If not varied: 30 keyframes (100 where observers vary), 300 points "
           "per keyframe, 8 observers per point.")
    yield ""
    for axis, values in results.axes.items():
        yield from table([axis] + [str(v) for v in values],
                         [["{}: pass".format(s)] + [number(results.median("pass", axis, str(v), s) / 1e3) for v in values]
                          for s in EXACT] +
                         [["{}: change".format(s)] + [number(change(results, axis, v, s)) for v in values]
                          for s in CHANGES])
    if with_plot:
        yield "![Time of a pass]({})".format(PLOTS[0])
        yield ""
        yield "![Time of a change]({})".format(PLOTS[1])


def change(results, axis, value, scheme):
    """Nanoseconds of one of four events, with the map's own change."""
    return results.median("change", axis, str(value), scheme) / 4


def plot(results, path):
    """Whether they could be drawn."""
    plt = pyplot()
    if plt is None:
        return False
    for picture, unit, value, schemes in (
            (PLOTS[0], "µs per pass", lambda a, v, s: results.median("pass", a, str(v), s) / 1e3, EXACT),
            (PLOTS[1], "ns per change", lambda a, v, s: change(results, a, v, s), CHANGES)):
        figure, axes = plt.subplots(1, len(results.axes), figsize=(9, 3.4), sharey=True)
        for axis, (title, values) in zip(axes, results.axes.items()):
            for s in schemes:
                axis.plot(values, [value(title, v, s) for v in values], label=s, marker="o", markersize=4, color=COLOURS[s])
            axis.set_xscale("log")
            axis.set_yscale("log")
            axis.set_xlabel(title)
            axis.set_xticks(values, [str(v) for v in values])
            axis.minorticks_off()
            axis.grid(alpha=0.3)
        axes[0].set_ylabel(unit)
        axes[0].legend(fontsize=7)
        figure.tight_layout()
        figure.savefig(path.parent / picture, metadata={"Date": None})
    if results.sessions:
        figure, axis = plt.subplots(figsize=(9, 3.4))
        width = 0.27
        for n, s in enumerate(EXACT):
            axis.bar([i + (n - 1) * width for i in range(len(results.sessions))],
                     [max(1e-2, statistics.median(results.over_map(f, s).values()) / 1e6) for f in results.sessions],
                     width, label=s, color=COLOURS[s])
        axis.set_yscale("log")
        axis.set_xticks(range(len(results.sessions)), results.sessions, rotation=20, ha="right", fontsize=7)
        axis.set_ylabel("ms over the map alone")
        axis.legend(fontsize=7)
        axis.grid(alpha=0.3, axis="y")
        figure.tight_layout()
        figure.savefig(path.parent / PLOTS[2], metadata={"Date": None})
    return True


main(__doc__, "redundancy", Results, report, plot, PLOTS[0])
