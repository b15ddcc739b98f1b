#!/usr/bin/env python3
"""report.py RESULTS.json REPORT.html: one page, with nothing to load, of what slamgc-replay --json wrote.

Figures are drawn by matplotlib; what is said about them is computed from the results.
"""

import argparse
import html
import io
import json
import sys
from pathlib import Path

import matplotlib

matplotlib.use("svg")
matplotlib.rcParams["svg.hashsalt"] = "slamgc"
matplotlib.rcParams["svg.fonttype"] = "none"
import matplotlib.pyplot as plt  # noqa: E402

SCHEMA = "slamgc-replay 1"
STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; color: #222; }
table { border-collapse: collapse; font-size: 14px; margin: 1rem 0; }
td, th { border-bottom: 1px solid #ddd; padding: .2rem .6rem; text-align: right; vertical-align: top; }
td:first-child, th:first-child { text-align: left; }
th { border-bottom: 2px solid #888; }
figure { margin: 1.5rem 0; } figcaption { color: #555; font-size: 14px; }
svg { max-width: 100%; height: auto; } .ours { background: #eef7ee; } .small { color: #555; font-size: 14px; }
"""


class Refused(Exception):
    """What is wrong with the input."""


def read(path):
    try:
        results = json.loads(path.read_text())
    except (OSError, ValueError) as e:
        raise Refused("{}: {}".format(path, e)) from e
    if not isinstance(results, dict) or results.get("schema") != SCHEMA:
        raise Refused("{}: not of schema '{}'".format(path, SCHEMA))
    if not results.get("runs"):
        raise Refused("{}: no runs".format(path))
    return results


def svg(figure):
    out = io.StringIO()
    figure.savefig(out, format="svg", metadata={"Date": None}, bbox_inches="tight")
    plt.close(figure)
    return out.getvalue()[out.getvalue().index("<svg"):]


def megabytes(n):
    return "{:.1f} MB".format(n / 1e6)


def percent(part, whole):
    return "" if not whole else "{:.1f} %".format(100 * part / whole)


def thread(run, name):
    return next((t for t in run["threads"] if t["name"] == name), None)


def label(run):
    return run["scheme"] + (" (counted)" if run["counted"] else "")


def memory(runs):
    figure, axis = plt.subplots(figsize=(9, 4))
    for run in runs:
        if run["counted"] or not run["samples"]:
            continue
        ours = run["scheme"] == "deferred"
        axis.plot([s["seconds"] for s in run["samples"]],
                  [s["live_bytes"] / 1e6 for s in run["samples"]],
                  label=run["scheme"], linewidth=2.5 if ours else 1, color="black" if ours else None)
    axis.set_xlabel("seconds")
    axis.set_ylabel("MB in use")
    axis.set_ylim(bottom=0)
    axis.grid(alpha=0.3)
    axis.legend(fontsize=8, ncol=2)
    return svg(figure)


def freed(runs, thesis):
    published = {t["scheme"]: t["percent"] for t in thesis}
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.6), sharey=True)
    for kind, axis in enumerate(axes):
        names = [label(r) for r in runs]
        axis.barh(names, [100 * r["freed"][kind] / max(1, r["marked"][kind]) for r in runs])
        for i, r in enumerate(runs):
            at = published.get(r["scheme"], [-1, -1])[kind]
            if at >= 0:
                axis.plot(at, i, "kd", markersize=6, label="the thesis's" if not axis.get_legend_handles_labels()[0] else None)
        axis.set_xlabel("% of the marked {} freed".format(("keyframes", "points")[kind]))
        axis.set_xlim(0, 105)
        axis.invert_yaxis()
        axis.grid(alpha=0.3, axis="x")
        if axis.get_legend_handles_labels()[0]:
            axis.legend(fontsize=8)
    return svg(figure)


def times(runs):
    finished = [r for r in runs if r["finished"] and not r["counted"]]
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.6))
    for name, axis in zip(("tracking", "local mapping"), axes):
        shown = [(label(r), t["cpu"]) for r in finished for t in [thread(r, name)] if t]
        axis.barh([n for n, _ in shown], [t["p99"] for _, t in shown], alpha=0.35, label="99th percentile")
        axis.barh([n for n, _ in shown], [t["median"] for _, t in shown], label="median")
        axis.set_xlabel("{}: ms of CPU time".format(name))
        axis.invert_yaxis()
        axis.grid(alpha=0.3, axis="x")
        axis.legend(fontsize=8)
    figure.tight_layout()
    return svg(figure)


def maps(keyframes):
    """From the two directions in which the camera moved the most."""
    spread = [max(k["position"][i] for k in keyframes) - min(k["position"][i] for k in keyframes) for i in range(3)]
    x, y = sorted(range(3), key=lambda i: -spread[i])[:2]
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.6), sharex=True, sharey=True)
    good = [k["position"] for k in keyframes if not k["culled"]]
    bad = [k["position"] for k in keyframes if k["culled"]]
    for axis, title in zip(axes, ("in memory without reclamation", "in memory with slamgc")):
        axis.plot([p[x] for p in good], [p[y] for p in good], "o", markersize=4, label="good")
        axis.set_title("keyframes " + title, fontsize=10)
        axis.set_xlabel("m")
        axis.grid(alpha=0.3)
        axis.set_aspect("equal", adjustable="box")
    axes[0].plot([p[x] for p in bad], [p[y] for p in bad], "rx", markersize=5, label="culled")
    axes[0].legend(fontsize=8)
    return svg(figure)


def table(header, rows, ours=None):
    yield "<table><tr>" + "".join("<th>{}</th>".format(html.escape(h)) for h in header) + "</tr>"
    for row in rows:
        mark = ' class="ours"' if row[0] == ours else ""
        yield "<tr{}>".format(mark) + "".join("<td>{}</td>".format(html.escape(str(c))) for c in row) + "</tr>"
    yield "</table>"


def in_words(results):
    """What is to be seen, for each scheme that was run."""
    runs = {r["scheme"]: r for r in results["runs"] if not r["counted"]}
    leak, ours = runs.get("leak"), runs.get("deferred")
    if leak:
        yield ("Nothing is ever freed by <b>leak</b>, which is what ORB-SLAM3 does: {} of {} keyframes and {:,} of {:,} points were marked, and "
               "{} are in use at the end.").format(leak["marked"][0], leak["inserted"][0], leak["marked"][1],
                                                  leak["inserted"][1], megabytes(leak["final_live"]))
    if ours:
        yield "<b>deferred</b>, which is slamgc, freed {} of {} marked keyframes and {:,} of {:,} marked points; {} are in use at the end{}.".format(
            ours["freed"][0], ours["marked"][0], ours["freed"][1], ours["marked"][1], megabytes(ours["final_live"]),
            ", {} of leak's".format(percent(ours["final_live"], leak["final_live"])) if leak else "")
        tracker = thread(ours, "tracking")
        if tracker:
            ended = sum(tracker["destroyed"])
            yield ("No destructor of a keyframe or point ran on the tracking thread." if ended == 0 else
                   "{} destructors ran on the tracking thread.".format(ended))
        if leak and tracker and thread(leak, "tracking"):
            yield "Tracking took {:.3f} times the CPU time of leak per frame, at the median.".format(
                tracker["cpu"]["median"] / thread(leak, "tracking")["cpu"]["median"])
    for run in results["runs"]:
        if run["explanation"]:
            yield "<b>{}</b>: {}".format(html.escape(label(run)), html.escape(run["explanation"]))


def page(results):
    runs, session = results["runs"], results["session"]
    yield '<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><title>slamgc-replay</title><style>{}</style></head><body>'.format(STYLE)
    yield "<h1>What is freed, and what it costs</h1>"
    yield "<p>{}: {} frames in {:.0f} s, {} keyframes and {:,} points.</p>".format(
        html.escape(session.get("about") or session["name"]), session["frames"], session["seconds"], session["inserted"][0], session["inserted"][1])
    yield "<ul>" + "".join("<li>{}</li>".format(line) for line in in_words(results)) + "</ul>"

    def figure(drawing, caption):
        yield "<figure>{}<figcaption>{}</figcaption></figure>".format(drawing, caption)

    yield "<h2>Memory</h2>"
    yield from figure(memory(runs), "Bytes in use, more than before the session.")
    yield from table(["scheme", "at most", "at the end", "resident, at most", "longest pause", "from mark to freeing, median"], [
        [label(r), megabytes(r["peak_live"]), megabytes(r["final_live"]), megabytes(r["peak_resident"]),
         "{:.2f} ms".format(max([t["longest_pause"] for t in r["threads"]] or [0])),
         "{:.1f} ms".format(r["death_delay"]["median"]) if r["death_delay"]["count"] else ""]
        for r in runs if not r["counted"]], ours="deferred")
    yield "<h2>Marked and freed</h2>"
    yield from figure(freed(runs, results["thesis"]), "Of what was marked; diamonds are what the thesis published, on other sessions.")
    yield from table(["scheme", "keyframes marked", "freed", "", "points marked", "freed", ""], [
        [label(r), r["marked"][0], r["freed"][0], percent(r["freed"][0], r["marked"][0]),
         r["marked"][1], r["freed"][1], percent(r["freed"][1], r["marked"][1])] for r in runs], ours="deferred")
    yield "<h2>Time</h2>"
    yield from figure(times(runs), "A frame of tracking, a keyframe of mapping; what they waited for others is left out.")
    if any(k["culled"] for k in session["keyframes"]):
        yield "<h2>The map</h2>"
        yield from figure(maps(session["keyframes"]), "Keyframes whose pose is known.")
    footprint = results["footprint"]
    yield ('<p class="small">A keyframe takes {:.0f} kB with all that it owns ({} features), a point {:.2f} kB. The thesis states sizeof only: {} and {} bytes. '
           "Measured on {}, {} processors, with <code>{}</code>.</p>").format(
               footprint["bytes"][0] / 1e3, footprint["features"], footprint["bytes"][1] / 1e3,
               footprint["thesis_sizeof"][0], footprint["thesis_sizeof"][1], html.escape(results["machine"]["cpu"]),
               results["machine"]["threads"], html.escape(Path(results["command"].split(" ")[0]).name + " " + " ".join(results["command"].split(" ")[1:])))
    yield "</body></html>"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", type=Path)
    parser.add_argument("report", type=Path)
    arguments = parser.parse_args()
    try:
        text = "\n".join(page(read(arguments.results)))
        arguments.report.write_text(text)
    except (Refused, OSError) as e:
        sys.exit("report.py: {}".format(e))
    except (KeyError, IndexError, TypeError) as e:
        sys.exit("report.py: {}: something is missing: {!r}".format(arguments.results, e))


main()
