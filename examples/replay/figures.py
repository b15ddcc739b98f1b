"""Figures of a replay, drawn by matplotlib: of memory and the map, and those of the thesis redrawn.

Each returns the figure and what it shows in words, both computed from the results.
"""

import matplotlib

matplotlib.use("svg")
matplotlib.rcParams.update({"svg.hashsalt": "slamgc", "font.size": 9, "axes.grid": True, "grid.alpha": 0.25, "axes.axisbelow": True,
                            "axes.spines.top": False, "axes.spines.right": False, "legend.frameon": False, "legend.fontsize": 8})
import matplotlib.pyplot as plt  # noqa: E402

from results import KINDS, percent_freed, percent_more, thread  # noqa: E402

OURS, THEIRS, OTHERS, GREY = "#1a7f37", "#d97706", "#7a9cc6", "#9a9a9a"
LINES = {"leak": ("#b42318", 1.8), "deferred": (OURS, 2.6), "shared_ptr": ("#7a5195", 1.3), "shared_ptr_weak": ("#bc5090", 1.3),
         "mutex_all": ("#58508d", 1.1), "cas_all": ("#003f5c", 1.1), "fetch_add_all": ("#2a78b5", 1.3), "boehm": (THEIRS, 1.3)}
CALLED = {"leak": "leak (ORB-SLAM3)", "deferred": "deferred (slamgc)"}
RF, CAS = "mutex_subset", "cas_subset"  # as the thesis calls what these schemes are


def colour(scheme):
    return {"leak": GREY, "deferred": OURS}.get(scheme, OTHERS)


def published(results):
    return {t["scheme"]: t for t in results["thesis"]}


# ---- memory, and the map

def memory(results, runs, size=(9.6, 3.8)):
    """Over the time of the recorded session: it does not depend on how fast this machine is."""
    session = results["session"]
    figure, axis = plt.subplots(figsize=size)
    drawn = {s: r for s, r in runs.items() if r["finished"] and not r["counted"] and r["samples"]}
    for scheme, run in drawn.items():
        line, width = LINES.get(scheme, (GREY, 1.1))
        axis.plot([s["frames"] * session["seconds"] / session["frames"] for s in run["samples"]],
                  [s["live_bytes"] / 1e6 for s in run["samples"]], label=CALLED.get(scheme, scheme), linewidth=width, color=line)
    axis.set_xlabel("seconds of the recorded session")
    axis.set_ylabel("MB in use")
    axis.set_ylim(bottom=0)
    axis.set_xlim(left=0)
    # Beside the lines, from top to bottom as they end.
    order = sorted(range(len(drawn)), key=lambda i: -list(drawn.values())[i]["samples"][-1]["live_bytes"])
    handles, names = axis.get_legend_handles_labels()
    axis.legend([handles[i] for i in order], [names[i] for i in order], loc="center left", bbox_to_anchor=(1.01, 0.5))
    ends = ", ".join(f"{s} {drawn[s]['final_live'] / 1e6:.1f} MB" for s in (list(drawn)[i] for i in order))
    hidden = [s for s in runs if s not in drawn]
    note = f" Not drawn: {', '.join(hidden)}, which stopped; what their counted runs hold says nothing." if hidden else ""
    return figure, f"Bytes in use, more than before the session. At the end: {ends}.{note}"


def over_laps(results, runs):
    """None if there was one lap."""
    drawn = {s: r for s, r in runs.items() if r["finished"] and not r["counted"] and len(r["lap_live"]) > 1}
    if not drawn:
        return None
    figure, axis = plt.subplots(figsize=(9, 3))
    for scheme, run in drawn.items():
        line, width = LINES.get(scheme, (GREY, 1.1))
        axis.plot(range(1, len(run["lap_live"]) + 1), [b / 1e6 for b in run["lap_live"]], label=CALLED.get(scheme, scheme), linewidth=width, color=line)
    axis.xaxis.get_major_locator().set_params(integer=True)
    axis.set_xlabel("laps, the map reset after each")
    axis.set_ylabel("MB in use")
    axis.set_ylim(bottom=0)
    axis.legend()
    ends = ", ".join(f"{s} {r['lap_live'][0] / 1e6:.1f} and {r['lap_live'][-1] / 1e6:.1f} MB" for s, r in drawn.items())
    return figure, f"In use after the reset that ends each lap. After the first and the last: {ends}."


def soak(results, runs):
    """Over the time that it took."""
    figure, axis = plt.subplots(figsize=(9, 3))
    laps = 0
    for scheme, run in runs.items():
        samples, laps = run["samples"], len(run["lap_live"])
        axis.plot([s["seconds"] / 60 for s in samples], [s["live_bytes"] / 1e6 for s in samples], color=LINES.get(scheme, (GREY, 1))[0],
                  linewidth=0.6, label=f"{scheme}, while it plays")
        of_a_lap = results["session"]["frames"]
        ends = [max(s["seconds"] for s in samples if s["frames"] <= (i + 1) * of_a_lap) / 60 for i in range(laps)]
        axis.plot(ends, [b / 1e6 for b in run["lap_live"]], ".", color="black", markersize=3, label="after the reset of each lap")
    axis.set_xlabel("minutes")
    axis.set_ylabel("MB in use")
    axis.set_ylim(bottom=0)
    axis.set_xlim(left=0)
    axis.legend(loc="lower left", bbox_to_anchor=(0, 1), ncol=2)
    return figure, f"{laps} laps."


def maps(results, runs):
    """Seen from where it is the largest; None if no pose is known or slamgc did not play or free all."""
    session, ours = results["session"], runs.get("deferred")
    keyframes = session["keyframes"]
    if len(keyframes) < 2 or not ours or ours["freed"] != ours["marked"]:
        return None
    points, culled = session.get("points", []), session.get("points_culled", "")

    def reach(i):
        values = sorted([p[i] for p in points] or [k["position"][i] for k in keyframes])
        return values[len(values) // 50], values[-1 - len(values) // 50]  # the far ones would make all else small

    x, y = sorted(range(3), key=lambda i: reach(i)[0] - reach(i)[1])[:2]
    figure, axes = plt.subplots(1, 2, figsize=(10.4, 4.2), sharex=True, sharey=True)
    alive = [p for p, c in zip(points, culled) if c == "0"]
    dead = [p for p, c in zip(points, culled) if c == "1"]
    good = [k["position"] for k in keyframes if not k["culled"]]
    bad = [k["position"] for k in keyframes if k["culled"]]

    def scatter(axis, of, mark, size, color, label, order):
        if of:
            axis.plot([p[x] for p in of], [p[y] for p in of], mark, markersize=size, color=color, markeredgewidth=1.2 if mark == "x" else 0,
                      label=f"{len(of):,} {label}", zorder=order, rasterized=len(of) > 1000, alpha=0.5 if size < 2 else 1)

    for axis, title, everything in ((axes[0], "ORB-SLAM3", True), (axes[1], "slamgc", False)):
        if everything:
            scatter(axis, dead, "o", 1.2, "#d08770", "points, removed from the map", 2)
        scatter(axis, alive, "o", 1.6, "#5b6b7a", "points", 3)
        if everything:
            scatter(axis, bad, "x", 5, "#b42318", "keyframes, culled", 4)
        scatter(axis, good, "o", 4.5, "#1d4ed8", "keyframes", 5)
        axis.set_title(f"in memory at the end: {title}", fontsize=10)
        axis.set_aspect("equal", adjustable="box")
        axis.set_xlabel("m")
        axis.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14), ncol=2, markerscale=1.5)
    # Not flatter than a third of its width.
    half = [(reach(i)[1] - reach(i)[0]) / 2 for i in (x, y)]
    half = [1.05 * max(half[0], 0.1), 1.05 * max(half[1], half[0] / 3, 0.1)]
    for limit, i, by in ((axes[0].set_xlim, x, half[0]), (axes[0].set_ylim, y, half[1])):
        middle = sum(reach(i)) / 2
        limit(middle - by, middle + by)
    figure.tight_layout()
    return figure, (f"Left: all that was made, for nothing is freed. Right: without the {ours['freed'][0]} culled keyframes and {ours['freed'][1]:,} "
                    "removed points, which deferred freed." + (" The farthest 2 % on each side are out of the picture." if points else ""))


# ---- the thesis's

def bars(axis, names, values, theirs, unit, decimals=0):
    """One bar for each scheme; a diamond is what the thesis published."""
    axis.barh(names, [0 if v is None else v for v in values], color=[colour(n.split(" ")[0]) for n in names])
    for i, v in enumerate(values):
        if v is not None:
            left = v < 0
            axis.annotate(f"{v:,.{decimals}f}", (v, i), xytext=(-3 if left else 3, 0), textcoords="offset points", va="center",
                          ha="right" if left else "left", fontsize=8)
    at = [(t, i) for i, t in enumerate(theirs) if t is not None and t >= 0]
    if at:
        axis.plot([t for t, _ in at], [i for _, i in at], "D", color=THEIRS, markersize=6, linestyle="none", label="the thesis", zorder=4)
        axis.legend(loc="lower right", bbox_to_anchor=(1, 0.99), borderaxespad=0)
    axis.invert_yaxis()
    axis.grid(False, axis="y")
    axis.margins(x=0.16)
    if not any(values):
        axis.set_xlim(-1, 5)
    axis.set_xlabel(unit)


def by_scheme(results, runs, value, field, unit, decimals=0, only=lambda run: True):
    """`field` of the thesis's row: a function, or None."""
    rows = published(results)
    chosen = {s: r for s, r in runs.items() if only(r) and value(r) is not None}
    if not chosen:
        return None
    figure, axis = plt.subplots(figsize=(5.2, 0.9 + 0.26 * len(chosen)))
    theirs = [field(rows[s]) if field and s in rows else None for s in chosen]
    bars(axis, [s + (" *" if r["counted"] else "") for s, r in chosen.items()], [value(r) for r in chosen.values()], theirs, unit, decimals)
    figure.tight_layout()
    return figure


def said(runs, value, form):
    """leak 1, deferred 2: those of equal value together."""
    groups = {}
    for scheme, run in runs.items():
        if value(run) is not None:
            groups.setdefault(form.format(value(run)), []).append(scheme)
    if len(groups) == 1 and len(runs) > 2:
        return f"all {len(runs)} alike: {next(iter(groups))}"
    return "; ".join(f"{', '.join(names)}: {text}" for text, names in groups.items())


def deletion_percentage(results, runs, scheme, everything):
    chosen = [s for s in (scheme, everything, "deferred") if s in runs and percent_freed(runs[s], 1) is not None]
    if not chosen:
        return None
    theirs = published(results)[scheme]["percent"]
    groups = [("the thesis", theirs, THEIRS)] + [
        (s + (" *" if runs[s]["counted"] else ""), [percent_freed(runs[s], k) or 0 for k in (0, 1)], c)
        for s, c in zip(chosen, (OTHERS, "#33527c", OURS) if len(chosen) == 3 else (OTHERS, OURS))]
    figure, axis = plt.subplots(figsize=(5.2, 3.1))
    width = 0.8 / len(groups)
    for i, (name, values, c) in enumerate(groups):
        shown = axis.bar([k - 0.4 + width * (i + 0.5) for k in (0, 1)], values, width, label=name, color=c)
        axis.bar_label(shown, fmt="%.0f", fontsize=8)
    axis.set_xticks([0, 1])
    axis.set_xticklabels(KINDS)
    axis.set_ylabel("% of the marked, deleted")
    axis.set_ylim(0, 112)
    axis.grid(False, axis="x")
    axis.legend(loc="upper center", bbox_to_anchor=(0.5, -0.1), ncol=2)
    figure.tight_layout()
    words = f"The thesis: {theirs[0]:.0f} % of the keyframes and {theirs[1]:.0f} % of the points. Here: " + "; ".join(
        f"{s} {percent_freed(runs[s], 0) or 0:.0f} % and {percent_freed(runs[s], 1):.0f} %" for s in chosen) + "."
    counted = [s for s in chosen if runs[s]["counted"]]
    for s in counted:
        words += f" {s} is unsafe: it would have used deleted objects {runs[s]['faults']:,} times."
    return figure, words


def keyframe_statistics(results, runs):
    lines = (("processed", lambda r: r["inserted"][0], "#1d4ed8", lambda t: t["processed"][0]),
             ("in the map at the end", lambda r: r["inserted"][0] - r["marked"][0], "#ca8a04", None),
             ("marked", lambda r: r["marked"][0], OURS, lambda t: t["marked"][0]),
             ("freed", lambda r: r["freed"][0], "#b42318", lambda t: t["freed"][0]))
    rows = published(results)
    figure, axis = plt.subplots(figsize=(10.4, 3.2))
    for name, value, c, field in lines:
        axis.plot(list(runs), [value(r) for r in runs.values()], "o-", color=c, label=name, markersize=4)
        if field:
            at = [(s, field(rows[s])) for s in runs if s in rows and field(rows[s]) >= 0]
            axis.plot([s for s, _ in at], [v for _, v in at], "D", color=c, markersize=6, fillstyle="none", linestyle="none",
                      label=f"{name}: the thesis")
    axis.set_ylabel("keyframes")
    axis.set_ylim(bottom=0)
    axis.tick_params(axis="x", rotation=25)
    axis.legend(loc="center left", bbox_to_anchor=(1.01, 0.5))
    figure.tight_layout()
    return figure, ("What is processed and marked is the recorded session's, so the same for all; in the thesis it differed, for slower threads "
                    "made fewer keyframes. What is freed is the scheme's: " + said(runs, lambda r: r["freed"][0], "{}") + ".")


def counts(results, runs, kind, what, note):
    figure = by_scheme(results, runs, lambda r: r[what][kind], lambda t: t[what][kind], f"{KINDS[kind]} {what}")
    return figure, f"Here {said(runs, lambda r: r[what][kind], '{:,}')}.{note}"


def more_freed(results, runs):
    if not runs.get(RF) or not runs[RF]["freed"][0]:
        return None
    base = runs[RF]["freed"][0]
    value = lambda r: 100 * (r["freed"][0] / base - 1)
    rows = published(results)
    theirs = lambda t: 100 * (t["freed"][0] / rows[RF]["freed"][0] - 1) if t["scheme"] == CAS else None
    figure = by_scheme(results, {s: r for s, r in runs.items() if s != RF}, value, theirs, f"% more keyframes freed than by {RF}")
    return figure, (f"The thesis: CAS freed {theirs(rows[CAS]):.1f} % more than the mutex, on runs that differed. Here both play the same session; "
                    f"more than {RF}, in percent: {said({s: r for s, r in runs.items() if s != RF}, value, '{:+.0f}')}.")


def more_marked(results, runs):
    base = runs.get("leak", next(iter(runs.values())))["marked"][1]
    if not base:
        return None
    value = lambda r: 100 * (r["marked"][1] / base - 1)
    rows = published(results)
    theirs = 100 * (rows[CAS]["marked"][1] / rows[RF]["marked"][1] - 1)
    figure = by_scheme(results, runs, value, lambda t: theirs if t["scheme"] == CAS else None, "% more points marked than by leak", 1)
    return figure, (f"The thesis: {theirs:.1f} % more with CAS than with the mutex. A replay marks what was recorded; so "
                    f"{said(runs, value, '{:+.1f} %')}.")


def points_in_memory(results, runs):
    alive = lambda r: r["made"][1] - r["freed"][1]
    base = runs.get("leak")
    chosen = {s: r for s, r in runs.items() if not r["counted"] and r["finished"]}
    if not base or not alive(base):
        return None
    value = lambda r: 100 * (alive(r) / alive(base) - 1)
    figure = by_scheme(results, chosen, value, None, "% more points in memory at the end than with leak", 1)
    in_map = base["inserted"][1] - base["marked"][1]
    return figure, (f"The thesis compares points in the map, which a replay gives to all schemes alike: {in_map:,}. What differs is how many are "
                    f"in memory: {said(chosen, alive, '{:,}')}.")


def times(results, runs, name, field):
    value = lambda r: thread(r, name)["cpu"]["mean"] if thread(r, name) else None
    chosen = {s: r for s, r in runs.items() if r["finished"] and not r["counted"] and value(r) is not None}
    if not chosen:
        return None
    rows = [t for t in results["thesis"] if t[field] >= 0]
    figure, axes = plt.subplots(1, 2, figsize=(10.4, 0.9 + 0.26 * len(chosen)), gridspec_kw={"width_ratios": (1, 2)})
    axes[0].barh([t["scheme"] for t in rows], [t[field] for t in rows], color=THEIRS)
    for i, t in enumerate(rows):
        axes[0].annotate(f"{t[field]:g}", (t[field], i), xytext=(3, 0), textcoords="offset points", va="center", fontsize=8)
    axes[0].set_xlabel("the thesis: mean, ms")
    names = list(chosen)
    of = lambda what: [thread(r, name)["cpu"][what] for r in chosen.values()]
    axes[1].barh(names, of("p99"), color="#dfe5ec", label="99th percentile")
    axes[1].barh(names, of("mean"), color=[colour(n) for n in names], label="mean")
    axes[1].plot(of("median"), range(len(names)), "|", color="black", markersize=10, markeredgewidth=1.5, linestyle="none", label="median")
    axes[1].set_xlabel("here: ms of CPU time")
    axes[1].legend(loc="upper left", bbox_to_anchor=(1.01, 1))
    for axis in axes:
        axis.invert_yaxis()
        axis.grid(False, axis="y")
        axis.margins(x=0.18)
    figure.tight_layout()
    return figure, f"Median, ms: {said(chosen, lambda r: thread(r, name)['cpu']['median'], '{:.2f}')}. No images are computed here, so times are shorter."


def more_time(results, runs, name, field):
    if "leak" not in runs:
        return None
    chosen = {s: r for s, r in runs.items() if s != "leak" and r["finished"] and not r["counted"]}
    value = lambda r: percent_more(results, r["scheme"], name, "median")
    rows = published(results)
    vanilla = rows["leak"][field]
    theirs = lambda t: 100 * (t[field] / vanilla - 1) if t[field] >= 0 and t["scheme"] != "leak" else None
    # Its two count with a mutex and with CAS, as these do; its own stop here.
    beside = dict(results, thesis=[dict(rows[RF], scheme="mutex_all"), dict(rows[CAS], scheme="cas_all")])
    figure = by_scheme(beside, chosen, value, theirs, "% more than leak: median of CPU time", 1)
    if figure is None:
        return None
    return figure, (f"The thesis: {theirs(rows[RF]):.1f} % with the mutex, {theirs(rows[CAS]):.1f} % with CAS, of means; drawn beside the same counters. "
                    f"Here {said(chosen, value, '{:+.1f} %')}.")


MAPPING, TRACKING = ("local mapping", "mapping_ms"), ("tracking", "tracking_ms")
STAR = " * in a run where such uses are counted and nothing is really deleted."
THESIS = (  # number, title, whether it is wide, drawing
    (13, "Deletion percentage with mutexes", False, lambda a, b: deletion_percentage(a, b, RF, "mutex_all")),
    (14, "Deletion percentage with compare and swap", False, lambda a, b: deletion_percentage(a, b, CAS, "cas_all")),
    (15, "Keyframe statistics", True, keyframe_statistics),
    (16, "Keyframes deleted, by implementation", False, lambda a, b: counts(a, b, 0, "freed", "")),
    (17, "Keyframes marked bad", False, lambda a, b: counts(a, b, 0, "marked", " The session decides that, not the scheme.")),
    (18, "Difference among deletions", False, more_freed),
    (19, "Difference in points marked for deletion", False, more_marked),
    (20, "Difference in points of the map", False, points_in_memory),
    (21, "Points deleted, by implementation", False, lambda a, b: counts(a, b, 1, "freed", "")),
    (22, "Local mapping, execution", True, lambda a, b: times(a, b, *MAPPING)),
    (23, "Tracking, execution", True, lambda a, b: times(a, b, *TRACKING)),
    (24, "Difference in local mapping's time", False, lambda a, b: more_time(a, b, *MAPPING)),
    (25, "Difference in tracking's time", False, lambda a, b: more_time(a, b, *TRACKING)),
)
