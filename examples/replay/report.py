#!/usr/bin/env python3
"""report.py RESULTS.json REPORT.html: one page, with nothing to load, of what slamgc-replay --json wrote.

Figures are drawn by matplotlib; what is said about them is computed from the results.
"""

import argparse
import html
import io
import sys
from pathlib import Path

import figures
from results import KINDS, Refused, percent_freed, percent_more, read, shown, stopped, thread

STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; max-width: 68rem; margin: 2rem auto; padding: 0 1rem; color: #222; }
h1 { margin-bottom: .2rem; } h2 { margin-top: 2.5rem; border-bottom: 1px solid #ddd; } h3 { font-size: 1rem; margin: 0 0 .3rem; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: 13.5px; margin: 1rem 0; }
td, th { border-bottom: 1px solid #ddd; padding: .15rem .35rem; text-align: right; vertical-align: bottom; white-space: nowrap; }
th { border-bottom: 2px solid #888; white-space: normal; }
td:first-child, th:first-child { text-align: left; }
.ours td { background: #eaf5ec; font-weight: 600; } .thesis td { color: #b45f06; font-style: italic; }
figure { margin: 1rem 0; min-width: 0; } figcaption { color: #555; font-size: 14px; }
svg { max-width: 100%; height: auto; display: block; }
.grid { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 30rem), 1fr)); gap: 1.5rem 2rem; align-items: start; }
.wide { grid-column: 1 / -1; } .small { color: #555; font-size: 14px; } code { overflow-wrap: anywhere; }
"""


def megabytes(n):
    return f"{n / 1e6:.1f} MB"


def percent(value):
    return "" if value is None else f"{value:.1f} %"


def name_of(run):
    return run["scheme"] + (" *" if run["counted"] else "")


def svg(figure):
    """As text: what it says can be found and read aloud."""
    out = io.StringIO()
    with figures.matplotlib.rc_context({"svg.fonttype": "none"}):
        figure.savefig(out, format="svg", metadata={"Date": None}, bbox_inches="tight", dpi=150)
    figures.plt.close(figure)
    return out.getvalue()[out.getvalue().index("<svg"):]


def figure_of(drawn, title="", wide=False, name=""):
    if drawn is None or drawn[0] is None:
        return
    figure, words = drawn
    yield f'<figure{" class=wide" if wide else ""}{f" id={name}" if name else ""}>'
    if title:
        yield f"<h3>{title}</h3>"
    yield svg(figure)
    yield f"<figcaption>{html.escape(words)}</figcaption></figure>"


def table(header, rows):
    """A row begins with its class."""
    yield '<div class="scroll"><table><tr>' + "".join(f"<th>{html.escape(h)}</th>" for h in header) + "</tr>"
    for mark, *row in rows:
        yield f'<tr class="{mark}">' + "".join(f"<td>{html.escape(str(c))}</td>" for c in row) + "</tr>"
    yield "</table></div>"


def mark_of(run):
    return "ours" if run["scheme"] == "deferred" else ""


def thesis_table(results, runs):
    """The thesis's tables 1 to 12, with what it published below each scheme."""
    sizes = results["footprint"]["thesis_sizeof"]
    published = figures.published(results)
    known = lambda v, form="{:,}": form.format(v) if v >= 0 else ""

    def rows():
        for scheme, r in runs.items():
            raw = [r["freed"][k] * sizes[k] / 1e6 for k in (0, 1)]
            row = [f"{r['marked'][k]:,}" for k in (0, 1)] + [f"{r['freed'][k]:,}" for k in (0, 1)]
            row = [row[0], row[2], percent(percent_freed(r, 0)), f"{raw[0]:.2f}", row[1], row[3], percent(percent_freed(r, 1)), f"{raw[1]:.2f}"]
            means = [thread(r, n)["wall"]["mean"] if r["finished"] and thread(r, n) else None for n in ("local mapping", "tracking")]
            yield [mark_of(r), name_of(r), *row, f"{r['seconds']:.0f}", *("" if m is None else f"{m:.2f}" for m in means),
                   f"{r['inserted'][0]:,}", f"{r['inserted'][1]:,}"]
            t = published.get(scheme)
            if t:
                yield ["thesis", t["name"], known(t["marked"][0]), known(t["freed"][0]), known(t["percent"][0], "{:.0f} %"),
                       known(t["raw_freed_mb"][0], "{:.2f}"), known(t["marked"][1]), known(t["freed"][1]), known(t["percent"][1], "{:.0f} %"),
                       known(t["raw_freed_mb"][1], "{:.2f}"), known(t["seconds"], "{:.0f}"), known(t["mapping_ms"], "{:.0f}"),
                       known(t["tracking_ms"], "{:.2f}"), known(t["processed"][0]), known(t["processed"][1])]

    yield from table(["", "keyframes marked", "freed", "", "MB freed, sizeof", "points marked", "freed", "", "MB freed, sizeof", "seconds",
                      "mapping, ms", "tracking, ms", "keyframes processed", "points"], rows())


def in_words(results, runs):
    """What is to be seen."""
    leak, ours = runs.get("leak"), runs.get("deferred")
    if leak:
        yield ("Nothing is ever freed by <b>leak</b>, which is what ORB-SLAM3 does: {} of {} keyframes and {:,} of {:,} points were marked, and "
               "{} are in use at the end.").format(leak["marked"][0], leak["inserted"][0], leak["marked"][1],
                                                  leak["inserted"][1], megabytes(leak["final_live"]))
    if ours and ours["finished"]:
        yield "<b>deferred</b>, which is slamgc, freed {} of {} marked keyframes and {:,} of {:,} marked points; {} are in use at the end{}.".format(
            ours["freed"][0], ours["marked"][0], ours["freed"][1], ours["marked"][1], megabytes(ours["final_live"]),
            f", {100 * ours['final_live'] / leak['final_live']:.0f} % of leak's" if leak and leak["final_live"] else "")
        tracker = thread(ours, "tracking")
        if tracker:
            ended = sum(tracker["destroyed"])
            yield ("No destructor of a keyframe or point ran on the tracking thread." if ended == 0 else
                   f"{ended} destructors ran on the tracking thread.")
        more = [(n, percent_more(results, "deferred", n, "median")) for n in ("tracking", "local mapping")]
        if all(m is not None for _, m in more):
            yield "CPU time of an iteration, at the median, compared to leak: " + ", ".join(f"{n} {m:+.1f} %" for n, m in more) + "."
    for scheme, run in stopped(results).items():
        counted = runs.get(scheme)
        yield f"<b>{html.escape(scheme)}</b> stopped after {run['frames']:,} frames: {html.escape(run['explanation'])}." + (
            f" Had it gone on, it would have used deleted objects {counted['faults']:,} times." if counted and counted["counted"] else "")
    if set(stopped(results)) & {figures.RF, figures.CAS}:
        yield "The thesis saw no crash of these two on EuRoC. Using a deleted object need not crash; here each use is checked."
    others = {s: r for s, r in runs.items() if s not in ("leak", "deferred")}
    left = lambda k: lambda r: "" if r["marked"][k] == r["freed"][k] else f"{r['marked'][k] - r['freed'][k]:,} of {r['marked'][k]:,} {KINDS[k]}"
    for k in (0, 1):
        for schemes, words in alike(others, left(k)):
            yield f"<b>{schemes}</b> never free{'s' if ',' not in schemes else ''} {words} that were marked: references to them are left."
    freed = max([runs[s]["freed"][1] for s in ("shared_ptr", "shared_ptr_weak") if s in runs] or [0])
    if freed:
        yield (f"The thesis freed nothing with <b>shared_ptr</b>. Here it frees {freed:,} points: a point that goes bad loses its observations, and the "
               "keyframes their slots with it, so that no cycle holds it.")
    on_tracking = lambda r: sum((thread(r, "tracking") or {"destroyed": [0]})["destroyed"])
    for schemes, words in alike({s: r for s, r in others.items() if not r["counted"]}, lambda r: f"{on_tracking(r):,}" if on_tracking(r) else ""):
        yield f"<b>{schemes}</b>: {words} objects were destroyed by the tracking thread."


def alike(runs, words):
    """Those of which the same is to be said, and what."""
    groups = {}
    for scheme, run in runs.items():
        groups.setdefault(words(run), []).append(html.escape(scheme))
    return [(", ".join(schemes), text) for text, schemes in groups.items() if text]


def page(results):
    runs, session = shown(results), results["session"]
    yield f'<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>slamgc-replay</title><style>{STYLE}</style></head><body>'
    yield "<h1>What is freed, and what it costs</h1>"
    yield "<p>{}<br>{:,} frames in {:.0f} s, {:,} keyframes and {:,} points, played under {} ways to own them.</p>".format(
        html.escape(session.get("about") or session["name"]), session["frames"], session["seconds"], *session["inserted"], len(runs))
    yield "<ul>" + "".join(f"<li>{line}</li>" for line in in_words(results, runs)) + "</ul>"

    yield '<h2 id="memory">Memory</h2>'
    yield from figure_of(figures.memory(results, runs), name="figure-memory")
    yield from figure_of(figures.over_laps(results, runs), name="figure-laps")
    yield from table(["", "at most", "at the end", "resident, at most", "local mapping paused, at most", "from mark to freeing, median", "at most"], [
        [mark_of(r), r["scheme"], megabytes(r["peak_live"]), megabytes(r["final_live"]), megabytes(r["peak_resident"]),
         "{:.1f} ms".format(max([t["longest_pause"] for t in r["threads"]] or [0])),
         *([f"{r['death_delay'][w]:.1f} ms" for w in ("median", "max")] if r["death_delay"]["count"] else ["", ""])]
        for r in runs.values() if r["finished"] and not r["counted"]])
    drawing = figures.maps(results, runs)
    if drawing:
        yield '<h2 id="map">The map, before and after</h2>'
        yield from figure_of(drawing, name="figure-map")

    yield '<h2 id="thesis">Beside the thesis</h2>'
    yield ("<p>Tables 1 to 12 of “Automatic Memory Management in ORB SLAM-3”, and its figures 13 to 25, drawn anew from this replay. "
           "Diamonds and slanted rows are what the thesis published: means over the eleven sequences of EuRoC, so compare proportions, not sizes. "
           "Its megabytes are sizeof alone: {0[0]:,} and {0[1]:,} bytes each. With all that it owns, a keyframe of {1} features takes {2:.0f} kB here, "
           "and a point {3:.2f} kB.{4}</p>").format(
               results["footprint"]["thesis_sizeof"], results["footprint"]["features"], results["footprint"]["bytes"][0] / 1e3,
               results["footprint"]["bytes"][1] / 1e3, figures.STAR if any(r["counted"] for r in runs.values()) else "")
    yield from thesis_table(results, runs)
    yield '<div class="grid">'
    missing = []
    for number, title, wide, draw in figures.THESIS:
        drawn = list(figure_of(draw(results, runs), f"Figure {number}: {title}", wide, f"figure-{number}"))
        yield from drawn
        if not drawn:
            missing.append(str(number))
    yield "</div>"
    if missing:
        yield f'<p class="small">Figures that need schemes which were not played: {", ".join(missing)}.</p>'

    machine = results["machine"]
    command = results["command"].split(" ")
    yield '<p class="small">Measured on {}, {} processors, {}; slamgc {}{}: <code>{}</code></p>'.format(
        html.escape(machine["cpu"]), machine["threads"], html.escape(machine["system"]), html.escape(results["program"]["slamgc"]),
        "" if results["program"]["release_build"] else ", not optimised", html.escape(" ".join([Path(command[0]).name, *command[1:]])))
    yield "</body></html>"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", type=Path)
    parser.add_argument("report", type=Path)
    arguments = parser.parse_args()
    try:
        text = "\n".join(page(read(arguments.results)))
        arguments.report.write_text(text, encoding="utf-8")
    except (Refused, OSError) as e:
        sys.exit(f"report.py: {e}")
    except (KeyError, IndexError, TypeError) as e:
        sys.exit(f"report.py: {arguments.results}: something is missing: {e!r}")


main()
