#!/usr/bin/env python3
"""Makes tables of what scripts/benchmark measured of the graph: cycles, stale edges.

  report_graph.py RESULTS                  prints them
  report_graph.py RESULTS --write FILE     replaces what is between the markers in FILE, and draws the
                                           plot beside it
"""

import json
import statistics
from collections import defaultdict

from report import Results, machine_table, main, median_of, number, pyplot, table, with_interval

PLOT = "performance-graph.svg"
RINGS = (1000, 100)
ONE_RING = (1, 1000000)


class GraphResults(Results):
    def __init__(self, directory):
        super().__init__(directory, ())
        self.rings = defaultdict(dict)      # (how, rings, length) -> round -> result
        self.in_map = defaultdict(list)     # size of the map -> ms
        self.purges = defaultdict(list)     # (size, stuck) -> results
        for r in self.lines(directory, "rings"):
            self.rings[r["how"], r["rings"], r["length"]][r["round"]] = r
        for r in self.lines(directory, "trial_deletion"):
            self.in_map[r["map"]].append(r["cpu_ms"])
        for r in self.lines(directory, "purge"):
            self.purges[r["map"], r["stuck"]].append(r)

    @staticmethod
    def lines(directory, name):
        for text in (directory / (name + ".json")).read_text().splitlines():
            yield json.loads(text)

    def ring_ratio(self, how, other, what="cpu_ms", shape=RINGS):
        ours, theirs = self.rings[(how,) + shape], self.rings[(other,) + shape]
        return median_of([ours[i][what] / theirs[i][what] for i in ours.keys() & theirs.keys()])

    def ring_ns(self, how, shape):
        ms = statistics.median(r["cpu_ms"] for r in self.rings[(how,) + shape].values())
        return ms * 1e6 / (shape[0] * shape[1])

    def shapes(self):
        return sorted({key[1:] for key in self.rings if key[0] == "trial deletion"},
                      key=lambda s: (s[1], s[0]))

    def purge(self, size, stuck, what):
        return statistics.median(r[what] for r in self.purges[size, stuck])


def bars(results):
    """(what, measured, limit, met)"""
    def verdict(met):
        return "met" if met else "**missed**"

    ratio = results.ring_ratio("trial deletion", "by hand")
    yield ("1,000 rings of 100 / broken by hand", with_interval(*ratio), "3", verdict(ratio[0] <= 3))
    small, large = results.ring_ns("trial deletion", RINGS), results.ring_ns("trial deletion", ONE_RING)
    yield ("one ring of 1,000,000 / 1,000 rings of 100, per object", number(large / small), "",
           "")
    ratio = results.ring_ratio("beside two threads", "trial deletion")
    yield ("the rings, while two threads work / while none does", with_interval(*ratio), "2",
           verdict(ratio[0] <= 2))
    ratio = results.ring_ratio("two threads alone", "beside two threads", "throughput")
    yield ("what the two threads do alone / beside it", with_interval(*ratio), "1.05",
           verdict(ratio[0] <= 1.05))
    sizes = sorted(results.in_map)
    growth = statistics.median(results.in_map[sizes[-1]]) / statistics.median(results.in_map[sizes[0]])
    yield ("100 retired objects, in a map of {:,} / of {:,}".format(sizes[-1], sizes[0]),
           number(growth), "1.1", verdict(growth <= 1.1))


def report(results, with_plot):
    yield from machine_table(results, "scripts/benchmark --part graph")
    yield "### Bars of the graph"
    yield ""
    yield ("Ratios of CPU time: the median of the ratios within a round, and in parentheses its 95 % "
           "confidence interval. Broken by hand: rings of `std::shared_ptr`, whose links are cleared one by one.")
    yield ""
    yield from table(["bar", "measured", "at most", ""], [list(row) for row in bars(results)])
    yield "### Rings"
    yield ""
    yield "Nanoseconds of CPU time per object of 64 bytes, `retire()` included."
    yield ""
    rows = []
    for shape in results.shapes():
        row = ["{:,} of {:,}".format(*shape)]
        for how in ("delete", "by hand", "trial deletion"):
            known = results.rings.get((how,) + shape)
            row.append(number(results.ring_ns(how, shape)) if known else "")
        rows.append(row)
    yield from table(["rings", "`delete` alone", "broken by hand", "trial deletion"], rows)
    yield "### Trial deletion in a live map"
    yield ""
    yield "Microseconds of CPU time for a ring of 100 retired objects that refer to live ones."
    yield ""
    sizes = sorted(results.in_map)
    yield from table(["objects in the map"] + ["{:,}".format(s) for s in sizes],
                     [["µs"] + [number(1000 * statistics.median(results.in_map[s])) for s in sizes]])
    yield "### Purging stale edges"
    yield ""
    yield ("Each object has 20 edges; `collect()` has 1 ms at a time. All of it: purges, trial deletion, and the "
           "destruction of what was stuck.")
    yield ""
    rows = []
    for size, stuck in sorted(results.purges):
        get = lambda what: results.purge(size, stuck, what)  # noqa: E731
        rows.append(["{:,}".format(size), str(stuck), number(get("cpu_ms")),
                     number(1e6 * get("cpu_ms") / get("edges")), number(get("cpu_ms") / stuck),
                     str(round(get("slices"))), "{:.2f}".format(get("slice_p99_ms")),
                     "{:.2f}".format(get("slice_max_ms"))])
    yield from table(["live objects", "stuck", "CPU ms", "ns per live edge", "ms per stuck object", "slices",
                      "slice p99, ms", "longest"], rows)
    if with_plot:
        yield "![Cost against the size of rings and maps]({})".format(PLOT)


def plot(results, path):
    """Whether it could be drawn."""
    plt = pyplot()
    if plt is None:
        return False
    figure, axes = plt.subplots(1, 3, figsize=(9, 3.4))
    hundreds = [s for s in results.shapes() if s[1] == 100]
    for how, style in (("trial deletion", "-"), ("by hand", "--")):
        axes[0].plot([s[0] * s[1] for s in hundreds], [results.ring_ns(how, s) for s in hundreds],
                     label=how, marker="o", markersize=4, linestyle=style)
    axes[0].set_xlabel("objects in rings of 100")
    axes[0].set_ylabel("ns of CPU time per object")
    sizes = sorted(results.in_map)
    axes[1].plot(sizes, [1000 * statistics.median(results.in_map[s]) for s in sizes], marker="o",
                 markersize=4)
    axes[1].set_xlabel("live objects around 100 retired ones")
    axes[1].set_ylabel("µs of CPU time, trial deletion")
    for stuck in sorted({key[1] for key in results.purges}):
        sizes = sorted(key[0] for key in results.purges if key[1] == stuck)
        axes[2].plot(sizes, [results.purge(s, stuck, "cpu_ms") for s in sizes], marker="o",
                     markersize=4, label="{} stuck".format(stuck))
    axes[2].set_xlabel("live objects")
    axes[2].set_ylabel("ms of CPU time, purge")
    axes[2].set_yscale("log")
    for axis in axes:
        axis.set_xscale("log")
        axis.grid(alpha=0.3, which="both")
    for axis in axes[:2]:
        axis.set_ylim(bottom=0)
    axes[0].legend(fontsize=7)
    axes[2].legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})
    return True


main(__doc__, "graph", GraphResults, report, plot, PLOT)
