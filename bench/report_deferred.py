#!/usr/bin/env python3
"""Makes tables of what scripts/benchmark measured of deferred reclamation.

  report_deferred.py RESULTS                  prints them
  report_deferred.py RESULTS --write FILE     replaces what is between the markers in FILE, and draws the
                                              plot beside it
"""

import json
import math
import statistics
from collections import defaultdict

from report import Results, machine_table, main, median_of, number, pyplot, table, with_interval

PLOT = "performance-deferred.svg"
TRAVERSAL = "traversal", "10000 nodes"
CONSTANT = "traversal", "10000 nodes, constant degree"
QUIESCENT = "quiescent state", "nothing to do"
RETIRE = "retire+reclaim", "48 bytes, batches of 1024"
STALLED = "retire", "a stalled reader"
BATCHED = "new+delete, batched"
CHANGED = "chain, one atomic change each"
PEERS = {"liburcu QSBR, defer_rcu": "liburcu-dev", "liburcu QSBR, synchronize_rcu": "liburcu-dev",
         "xenium QSBR": "libxenium-dev", "libcds hazard pointers": "libcds-dev"}
BUDGET_MS = 2.0


def read(directory):
    results = Results(directory, ("traversal", "quiescent", "retire", "stalled_reader", "growth"))
    results.drops = defaultdict(dict)
    for text in (directory / "drop_map.json").read_text().splitlines():
        r = json.loads(text)
        results.drops[r["how"]][r["round"]] = r
    return results


def drop_ratio(results, how):
    own, inline = results.drops[how], results.drops["delete"]
    return median_of([own[i]["cpu_ms"] / inline[i]["cpu_ms"] for i in own.keys() & inline.keys()])


def slices(results, how):
    return sorted(ms for r in results.drops[how].values() for ms in r["slices_ms"])


def percentile(values, percent):
    return values[min(len(values) - 1, len(values) * percent // 100)]


def bars(results):
    """(what, measured, limit, met)"""
    def against(what, operation, threads, contender, reference, limit):
        ratio = results.ratio(operation + (threads,), contender, reference)
        if math.isnan(ratio[0]):
            return "{}, {}".format(what, threads_of(threads)), "not installed", "", "skipped"
        return ("{}, {}".format(what, threads_of(threads)), with_interval(*ratio),
                "{:.2f}".format(limit), verdict(ratio[0] <= limit))

    def threads_of(threads):
        return "alone" if threads == 1 else "{} threads".format(threads)

    def verdict(met):
        return "met" if met else "**missed**"

    for threads in (1, 2):
        yield against("traversal, slots / raw pointers", TRAVERSAL, threads,
                      "slots, under a mutator", "raw pointers", 1.05)
    for threads in (1, 2):
        yield against("`quiescent()` with nothing to do / atomic pair", QUIESCENT, threads,
                      "quiescent()", "atomic pair", 0.25)
    for threads in (1, 2):
        yield against("offline and online / atomic pair", QUIESCENT, threads, "offline, online",
                      "atomic pair", 2)
    for threads in (1, 2):
        yield against("retire+reclaim / `new`+`delete`, batched", RETIRE, threads,
                      "slamgc, retire", BATCHED, 1.3)
    for peer in ("liburcu QSBR, defer_rcu", "liburcu QSBR, synchronize_rcu", "xenium QSBR"):
        for threads in (1, 2):
            yield against("retire+reclaim / " + peer, RETIRE, threads, "slamgc, retire", peer, 1)
    yield against("retire while 20,000 are held / none held", STALLED, 1, "20000 held", "none held",
                  1.2)
    calls = [r["call_ms"] for r in results.drops["keyframes"].values()]
    yield ("dropping a map: the call, ms at most", "{:.3f}".format(max(calls)), "1",
           verdict(max(calls) < 1))
    all_slices = slices(results, "keyframes")
    within = percentile(all_slices, 99)
    yield ("dropping a map: 99 % of slices, ms at most", "{:.2f}".format(within),
           "{:.1f}, and one keyframe".format(BUDGET_MS), verdict(within <= BUDGET_MS + 0.5))
    ratio = drop_ratio(results, "keyframes")
    yield ("dropping a map: CPU time / deleting at once", with_interval(*ratio), "1.10",
           verdict(ratio[0] <= 1.1))


def contenders_table(results, operation, reference, threads=(1, 2)):
    names = sorted({c for n in threads for c in results.times[operation + (n,)]},
                   key=lambda c: results.median(operation + (threads[0],), c))
    rows = []
    for name in names:
        row = [name]
        for n in threads:
            key = operation + (n,)
            row.append("{} ({})".format(number(results.median(key, name)),
                                        number(results.ratio(key, name, reference)[0])))
        rows.append(row)
    return table([""] + ["1 thread" if n == 1 else "{} threads".format(n) for n in threads], rows)


def growth(results):
    """(axis, [(x, key)]) of each plot."""
    threads = sorted(key[2] for key in results.times if key[0] == "threads")
    yield "threads", [(n, ("threads", "batches of 1024", n)) for n in threads]
    for axis in ("live objects", "backlog"):
        sizes = sorted(int(key[1]) for key in results.times if key[0] == axis)
        yield axis, [(n, (axis, str(n), 1)) for n in sizes]


def report(results, with_plot):
    yield from machine_table(results, "scripts/benchmark --part deferred")
    yield "### Bars of deferred reclamation"
    yield ""
    yield ("Ratios of CPU time: the median of the ratios within a round, and in parentheses its 95 % "
           "confidence interval.")
    yield ""
    yield from table(["bar", "measured", "at most", ""], [list(row) for row in bars(results)])

    yield "### Retire and reclaim"
    yield ""
    yield ("Nanoseconds of CPU time per object of 48 bytes, its `new` included (ratio to "
           "`new`+`delete`, batched).")
    yield ""
    yield from contenders_table(results, RETIRE, BATCHED)
    measured = results.times[RETIRE + (1,)]
    for package in sorted({package for peer, package in PEERS.items() if peer not in measured}):
        yield "Skipped, as {} was not installed: {}.".format(
            package, ", ".join(peer for peer in PEERS if PEERS[peer] == package))
        yield ""

    yield "### Reading, and being a mutator"
    yield ""
    yield "Nanoseconds of CPU time per node, per call, and per object that is retired."
    yield ""
    for title, operation, reference in (
            ("Traversal", TRAVERSAL, "raw pointers"),
            ("Traversal, number of edges known to the compiler", CONSTANT, "raw pointers"),
            ("Quiescent states", QUIESCENT, "atomic pair")):
        yield "**{}** (ratio to {})".format(title, reference)
        yield ""
        yield from contenders_table(results, operation, reference)
    yield "**Retiring beside a stalled reader** (ratio to none held)"
    yield ""
    yield from contenders_table(results, STALLED, "none held", (1,))

    yield "### Dropping a map"
    yield ""
    yield ("500 keyframes and 50,000 points, in slices of 2 ms on the thread that drops it; {} "
           "times each.".format(len(results.drops["delete"])))
    yield ""
    rows = []
    inline = [r["cpu_ms"] for r in results.drops["delete"].values()]
    rows.append(["deleting at once", number(statistics.median(inline)), "", "", "", "", "", "", ""])
    for how, title in (("keyframes", "points belong to keyframes"),
                       ("registry", "and to a set of the map")):
        all_slices = slices(results, how)
        drops = results.drops[how].values()
        rows.append([title, number(statistics.median(r["cpu_ms"] for r in drops)),
                     number(drop_ratio(results, how)[0]),
                     "{:.4f}".format(statistics.median(r["call_ms"] for r in drops)),
                     str(round(statistics.median(len(r["slices_ms"]) for r in drops)))]
                    + ["{:.2f}".format(percentile(all_slices, p)) for p in (50, 90, 99, 100)])
    yield from table(["", "CPU ms", "ratio", "call, ms", "slices", "slice p50, ms", "p90", "p99",
                      "longest"], rows)

    yield "### Growth"
    yield ""
    yield "Nanoseconds of CPU time per object (ratio to `new`+`delete`, batched)."
    yield ""
    for axis, points in growth(results):
        rows = [[name] + ["{} ({})".format(number(results.median(key, name)),
                                           number(results.ratio(key, name, BATCHED)[0]))
                          for _, key in points] for name in ("slamgc", BATCHED)]
        yield from table([axis] + ["{:,}".format(x) for x, _ in points], rows)
    if with_plot:
        yield "![Cost against threads, live objects and backlog]({})".format(PLOT)


def plot(results, path):
    """Whether it could be drawn."""
    plt = pyplot()
    if plt is None:
        return False
    figure, axes = plt.subplots(1, 3, figsize=(9, 3.4), sharey=True)
    for axis, (title, points) in zip(axes, growth(results)):
        for name, style in (("slamgc", "-"), (BATCHED, "--")):
            drawn = [(x, results.median(key, name)) for x, key in points]
            drawn = [p for p in drawn if not math.isnan(p[1])]
            axis.plot(*zip(*drawn), label=name, marker="o", markersize=4, linestyle=style,
                      color="C0" if name == "slamgc" else "C1")
        axis.set_xscale("log", base=2 if title == "threads" else 10)
        axis.set_yscale("log")
        axis.set_xlabel(title)
        if title == "threads":
            axis.set_xticks([x for x, _ in points], [str(x) for x, _ in points])
        axis.grid(alpha=0.3, which="both")
    axes[0].set_ylabel("ns of CPU time per object")
    axes[0].legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})
    return True


main(__doc__, "deferred", read, report, plot, PLOT)
