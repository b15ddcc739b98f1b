#!/usr/bin/env python3
"""Makes tables of what scripts/benchmark --part replay measured.

  report_replay.py RESULTS                  prints them
  report_replay.py RESULTS --write FILE     replaces what is between the markers in FILE and in README.md, and draws
                                            the plots beside FILE
"""

import re
import sys
from pathlib import Path

from report import OPEN, Results, machine_table, main, median_of, pyplot, replace_between, table, verdict, with_interval

ROOT = Path(__file__).resolve().parent.parent
sys.path.append(str(ROOT / "examples/replay"))
from results import cpu_ratios, of_scheme, read, shown, stopped, thread  # noqa: E402

THREADS = {"tracking": "tracking, a frame", "local mapping": "local mapping, a keyframe"}
README = ("leak", "direct_delete", "shared_ptr", "mutex_subset", "cas_subset", "fetch_add_all", "deferred")
ABOUT = {"leak": "plain pointers: ORB-SLAM3", "direct_delete": "`delete` when marked", "shared_ptr": "`std::shared_ptr` everywhere",
         "shared_ptr_weak": "`shared_ptr`, `weak_ptr` upwards", "mutex_subset": "counts with a mutex, some members",
         "cas_subset": "counts with compare and swap, some members", "mutex_all": "counts with a mutex, all members",
         "cas_all": "counts with compare and swap, all members", "fetch_add_all": "counts with `fetch_add`, all members",
         "rcu": "grace periods alone (liburcu)", "boehm": "a conservative collector (libgc)", "deferred": "**slamgc**"}


class ReplayResults(Results):
    def __init__(self, directory):
        super().__init__(directory, ())
        self.schemes, self.laps = read(directory / "schemes.json"), read(directory / "laps.json")
        self.in_order = {f.name.split(".")[0]: read(f) for f in sorted(directory.glob("*.in-order.json"))}
        self.threads = {f.name.split(".")[0]: read(f) for f in sorted(directory.glob("*.threads.json"))}
        self.instructions = re.findall(r"^(.*?)  +leak.*ratio ([0-9.]+)$", (directory / "instructions.txt").read_text(), re.M)


def all_freed(run):
    return run["finished"] and run["freed"] == run["marked"]


def end_of(r):
    """In words: does it get through?"""
    return "" if r is None else "stops after {:,} frames".format(r["frames"])


def of(part, whole):
    return "{:,} of {:,}".format(part, whole)


def scheme_rows(results, names):
    runs, stops = shown(results), stopped(results)
    for s in names:
        if s not in runs:
            continue
        r = runs[s]
        held = r["finished"] and not r["counted"]
        bold = "**{}**".format if s == "deferred" else "{}".format
        yield s, r, stops.get(s), [
            ("" if s == "deferred" else "`{}`: ".format(s)) + ABOUT[s], *(bold(of(r["freed"][k], r["marked"][k])) for k in (0, 1)),
            bold("{:.1f} MB".format(r["final_live"] / 1e6)) if held else "", bold("{:.1f} MB".format(r["reset_live"] / 1e6)) if held else ""]


def readme_table(results):
    rows = []
    for _, r, stop, row in scheme_rows(results, README):
        if stop is not None:
            row[3] = "uses deleted objects"
        rows.append(row)
    yield from table(["", "culled keyframes freed", "removed points freed", "memory at the end", "after a reset"], rows)


def bars(results):
    rows = []

    def bar(name, measured, limit, met):
        rows.append([name, measured, limit, met if isinstance(met, str) else "" if met is None else "met" if met else "**missed**"])

    everywhere = [(n, shown(r)["deferred"]) for n, r in results.in_order.items()]
    failed = [n for n, r in everywhere if not all_freed(r)]
    sums = [sum(r["freed"][k] for _, r in everywhere) for k in (0, 1)], [sum(r["marked"][k] for _, r in everywhere) for k in (0, 1)]
    bar("marked and freed on {} data sets, in order".format(len(everywhere)), "keyframes {}, points {}{}".format(
        of(sums[0][0], sums[1][0]), of(sums[0][1], sums[1][1]), "; not all: " + ", ".join(failed) if failed else ""), "all", not failed)
    compared = [(n, r) for n, rs in results.in_order.items() for r in rs["runs"] if r["compared"]]
    differ = [n for n, r in compared if r["differences"]]
    bar("the end as recorded, kind by kind", "{} of {} comparisons".format(len(compared) - len(differ), len(compared)), "all", not differ)
    laps = shown(results.laps)["deferred"]
    growth = (laps["lap_live"][-1] - laps["lap_live"][1]) / 1e6
    bar("memory after {} laps, more than after two".format(len(laps["lap_live"])), "{:+.2f} MB".format(growth), "1 % of the peak",
        growth <= 0.01 * laps["peak_live"] / 1e6)
    destroyed = sum(sum(thread(r, "tracking")["destroyed"]) for rs in (results.schemes, *results.threads.values())
                    for r in of_scheme(rs, "deferred") if thread(r, "tracking"))
    bar("destructors on the tracking thread", str(destroyed), "0", destroyed == 0)
    for name, ratio in results.instructions:
        limit = "1.01" if name.startswith(("tracking", "local mapping")) else ""
        bar("instructions of `deferred` / of `leak`: " + name, ratio, limit, float(ratio) <= 1.01 if limit else None)
    sessions = {"the embedded session": results.schemes, **results.threads}
    for name, of_name in (("all sessions", sessions.values()), *((n, [rs]) for n, rs in sessions.items())):
        for who, text in THREADS.items():
            for what in ("median", "p99"):
                ratios = [x for rs in of_name for x in cpu_ratios(rs, "deferred", who, what)]
                if not ratios:
                    continue
                r = median_of(ratios)
                bar("CPU time, {}: {}, {}".format(name, text, what), with_interval(*r), "1.01", verdict(*r, 1.01) if len(ratios) >= 6 else None)
    yield from table(["bar", "measured", "at most", ""], rows)


def report(results, drawn):
    yield from machine_table(results, "scripts/benchmark --part replay --data FOLDER")
    yield "### Bars of the replay"
    yield ""
    yield ("`deferred` compared with `leak` of the same repetition; the median, and in parentheses its 95 % confidence interval "
           "(repetitions: {}, schemes in turn; of fewer than six nothing is concluded; {}). Instructions are counted by callgrind, with one thread.".format(len(of_scheme(results.schemes, "leak")), OPEN))
    yield ""
    yield from bars(results)
    yield "### The embedded session"
    yield ""
    rows = []
    for s, r, stop, row in scheme_rows(results.schemes, list(ABOUT)):
        times = ["{:.2f}, {:.2f}, {:.2f}".format(*(thread(r, n)["cpu"][w] for w in ("median", "p99", "max")))
                 if not r["counted"] and r["finished"] else "" for n in THREADS]
        rows.append([*row, *times, str(sum(thread(r, "tracking")["destroyed"])) if times[0] else "",
                     end_of(stop) + (", uses deleted objects {:,} times".format(r["faults"]) if r["counted"] else "")])
    yield from table(["", "culled keyframes freed", "removed points freed", "memory at the end", "after a reset", "tracking: p50, p99, max ms",
                      "local mapping", "destructors on tracking", ""], rows)
    if drawn:
        yield "![Memory under each scheme, over the embedded session](replay-memory.svg)"
        yield ""
        yield "![Memory after each lap](replay-laps.svg)"
        yield ""
    yield "### All recorded sessions"
    yield ""
    yield ("By one thread, in the recorded order. *As recorded*: what lives at the end is what the recorded system had in memory, kind by kind; "
           "`leak` is compared whole. A graph marks nothing; what it shows is what is left after the reset.")
    yield ""
    rows = []
    for name, rs in results.in_order.items():
        runs = shown(rs)
        r, leak = runs["deferred"], runs["leak"]
        same = ["" if not x["compared"] else "yes" if not x["differences"] else "**no**" for x in (leak, r)]
        rows.append([name, "{:,}".format(rs["session"]["frames"]), of(r["freed"][0], r["marked"][0]), of(r["freed"][1], r["marked"][1]),
                     "{:.1f}, {:.1f}".format(leak["final_live"] / 1e6, r["final_live"] / 1e6),
                     "{:.1f}, {:.1f}".format(leak["reset_live"] / 1e6, r["reset_live"] / 1e6), ", ".join(x for x in same if x),
                     "yes" if r["map_digest"] == leak["map_digest"] else "**no**"])
    yield from table(["session", "frames", "culled keyframes freed", "removed points freed", "MB at the end: leak, slamgc", "after a reset",
                      "as recorded: leak, slamgc", "same live map"], rows)


def plot(results, path):
    replace_between(ROOT / "README.md", "replay", ["", *readme_table(results.schemes)])
    if pyplot() is None:
        return False
    from picture import draw
    draw("memory", results.schemes, path)
    draw("laps", results.laps, path.with_name("replay-laps.svg"))
    return True


main(__doc__, "replay", ReplayResults, report, plot, "replay-memory.svg")
