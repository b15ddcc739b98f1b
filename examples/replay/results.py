"""What slamgc-replay --json wrote (docs/replay.md), for those who draw it or make tables of it."""

import json
import statistics

SCHEMA = "slamgc-replay 1"
KINDS = ("keyframes", "points")


class Refused(Exception):
    """What is wrong with the input."""


def read(path):
    try:
        results = json.loads(path.read_text())
    except (OSError, ValueError) as e:
        raise Refused(f"{path}: {e}") from e
    if not isinstance(results, dict) or results.get("schema") != SCHEMA:
        raise Refused(f"{path}: not of schema '{SCHEMA}'")
    if not results.get("runs"):
        raise Refused(f"{path}: no runs")
    return results


def of_scheme(results, scheme):
    """Those that finished, if any did."""
    runs = [r for r in results["runs"] if r["scheme"] == scheme]
    return [r for r in runs if r["finished"]] or runs


def shown(results):
    """By scheme the run of median duration."""
    schemes = dict.fromkeys(r["scheme"] for r in results["runs"])
    middle = lambda runs: sorted(runs, key=lambda r: r["seconds"])[len(runs) // 2]
    return {s: middle(of_scheme(results, s)) for s in schemes}


def stopped(results):
    """By scheme the first run that stopped."""
    first = {}
    for r in results["runs"]:
        if not r["finished"]:
            first.setdefault(r["scheme"], r)
    return first


def thread(run, name):
    return next((t for t in run["threads"] if t["name"] == name), None)


def percent_freed(run, kind):
    return 100 * run["freed"][kind] / run["marked"][kind] if run["marked"][kind] else None


def cpu_ratios(results, scheme, name, what):
    """CPU time of an iteration, as a multiple of leak's in the same repetition."""
    pairs = zip(of_scheme(results, scheme), of_scheme(results, "leak"))
    both = [(thread(a, name), thread(b, name)) for a, b in pairs if a["finished"] and b["finished"]]
    return [a["cpu"][what] / b["cpu"][what] for a, b in both if a and b and b["cpu"][what] > 0]


def percent_more(results, scheme, name, what):
    ratios = cpu_ratios(results, scheme, name, what)
    return 100 * (statistics.median(ratios) - 1) if ratios else None
