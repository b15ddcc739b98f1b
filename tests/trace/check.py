#!/usr/bin/env python3
"""check.py COMMAND...: runs COMMAND with the name of a file, and reads the trace that it writes there."""

import collections
import json
import subprocess
import sys
import tempfile
from pathlib import Path


def check(condition, what, event=None):
    if not condition:
        sys.exit("{}{}".format(what, "" if event is None else ": " + json.dumps(event)))


def number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and value >= 0


def main():
    with tempfile.TemporaryDirectory() as directory:
        file = Path(directory, "trace.json")
        subprocess.run(sys.argv[1:] + [str(file)], check=True)
        text = file.read_text()
    events = json.loads(text)
    check(isinstance(events, list) and events, "the trace is not an array of events")
    # A program that crashes does not write the end.
    cut = text[:text.rindex("}") + 1]
    check(json.loads(cut + "]") == events, "the trace cannot be cut")

    names = collections.defaultdict(set)
    slices, open_periods, numbers, last = [], {}, {}, {}
    for e in events:
        check(e["name"] and e["pid"] == 1 and number(e["tid"]) and number(e["ts"]), "members", e)
        names[e["ph"]].add(e["name"])
        if e["ph"] == "X":
            check(number(e["dur"]), "no duration", e)
            if e["name"] == "collect":
                slices.append(e)
        elif e["ph"] == "C":
            check(list(e["args"]) == ["objects"] and number(e["args"]["objects"]), "counter", e)
            numbers.setdefault(e["name"], []).append(e["args"]["objects"])
            check(e["ts"] >= last.get(e["name"], 0), "a counter goes back in time", e)
            last[e["name"]] = e["ts"]
        elif e["ph"] == "b":
            check(not open_periods and e["cat"], "two grace periods are open", e)
            open_periods[e["id"]] = e["ts"]
        elif e["ph"] == "e":
            check(e["ts"] >= open_periods.pop(e["id"]) and e["cat"], "ends before it begins", e)
        else:
            check(e["ph"] == "M", "an unknown phase", e)
    check(not open_periods, "a grace period does not end")

    check({"frame", 'a "span"', "collect"} == names["X"], "spans: {}".format(names["X"]))
    check(names["b"] == names["e"] == {"grace period"}, "no grace periods")
    threads = {e["args"]["name"] for e in events if e["ph"] == "M"}
    check(threads == {'main "thread"\n\\', "other"}, "threads: {}".format(threads))
    check(len({e["tid"] for e in events}) == 2, "two threads")
    check(any('"' in name for name in names["C"]), "a type with quotes")
    check(len(numbers) == 4 and all(n[-1] == 0 and max(n) > 0 for n in numbers.values()),
          "counters: {}".format(numbers))
    check({s["args"]["outcome"] for s in slices} >= {"waiting", "done"}, "outcomes")
    check(sum(s["args"]["reclaimed"] for s in slices) == 20, "20 objects are reclaimed")
    check(any(s["args"].get("waits for") == 'tracking\t"\\\x01' for s in slices), "who delays")
    for before, after in zip(slices, slices[1:]):
        check(before["ts"] + before["dur"] <= after["ts"] + 0.002, "slices overlap", after)
    print("{} events".format(len(events)))


main()
