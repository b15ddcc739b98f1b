#!/usr/bin/env python3
"""Reads what program.cpp writes: JSON with a parser of JSON, DOT with Graphviz if it is there.

  check.py PROGRAM [ARGUMENT...]
"""

import json
import shutil
import subprocess
import sys

output = subprocess.run(sys.argv[1:], check=True, stdout=subprocess.PIPE).stdout.decode()
one, of_type, audit, dot = output.split("\n", 3)
EDGE = 'a "quoted\\ name"\n\tof two lines'


def same(found, expected):
    if found != expected:
        sys.exit("found {!r}, expected {!r}".format(found, expected))


def check_child(report):
    same(report["result"], "done")
    same(report["roots_left_out"], [])
    same(report["delayed_by"]["mutator"], 'local "mapping"')
    if report["delayed_by"]["ns"] <= 0:
        sys.exit("no time")
    (child,) = report["objects"]
    same(child["object"]["id"], 812)
    same(child["object"]["name"], "KeyFrame 812")
    same(child["object"]["type"], "program::KeyFrame")
    same((child["retired"], child["queued"], child["count"]), (True, True, 2))
    same(child["not_described"], 1)
    (held,) = child["held_by"]
    same((held["type"], held["edge"], held["disposition"], held["references"], held["holders"]),
         ("program::KeyFrame", "mpParent", "hold", 1, 1))
    same((held["root"], held["retired"], held["first"][0]["id"]), (False, False, 811))
    same([(step["from"]["name"], step["edge"]) for step in child["path"]],
         [("root Mäp", EDGE), ("KeyFrame 811", "mpParent")])
    if child["stuck_ns"] < 0:
        sys.exit("stuck in the future")


check_child(json.loads(one))
check_child(json.loads(of_type))

audit = json.loads(audit)
same(audit["agrees"], False)
same(audit["references"], 3)
same(audit["more_described"], [])
(child,) = audit["more_counted"]
same((child["object"]["id"], child["count"], child["described"]), (812, 2, 1))
same(audit["types"], [{"type": "program::KeyFrame", "live": 2, "found": 2}])

if not shutil.which("dot"):
    print("SKIPPED: diagnosis.dot: dot was not found (Debian: graphviz)")
else:
    svg = subprocess.run(["dot", "-Tsvg"], input=dot.encode(), check=True, stdout=subprocess.PIPE,
                         stderr=subprocess.PIPE)
    same(svg.stderr, b"")
    for text in ["root Mäp", "KeyFrame 811", "KeyFrame 812", "retired", "1 not described"]:
        if text not in svg.stdout.decode():
            sys.exit("the picture does not show " + text)
