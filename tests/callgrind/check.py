#!/usr/bin/env python3
"""Counts the instructions of kernels.cpp under valgrind.

  check.py reading PROGRAM [--slack N]   reading costs what it costs with standard containers
  check.py counting PROGRAM BASELINE     operations that count cost no more than BASELINE says
  check.py update PROGRAM BASELINE       writes BASELINE

Counts are exact: the same program gives the same numbers everywhere (glibc is told to compare memory
as on a processor without AVX2, or its choice would be another on each). They depend on the compiler,
so there is a baseline for each: baseline/NAME-MAJOR.txt. Where there is none, --slack allows for
another choice of what to inline.
"""

import argparse
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

# Per call, not per element: what a wrapper may add around a loop.
ALLOWED_PER_CALL = 3
# Per element. A slot is read by an atomic load, which compilers do not fold into a comparison.
ALLOWED = {"slot: if (!member)": 1}
ALLOWED_ABOVE_BASELINE = 1
# Both names that glibc has had for it.
ENVIRONMENT = {**os.environ, "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2_Usable,-AVX2"}


def instructions(program):
    """Per measurement: instructions for each number of elements, less those of an empty kernel."""
    counts = {}
    with tempfile.TemporaryDirectory() as directory:
        subprocess.run(["valgrind", "-q", "--tool=callgrind", "--collect-atstart=no",
                        "--callgrind-out-file=" + directory + "/out", program], check=True, env=ENVIRONMENT)
        for file in sorted(Path(directory).glob("out.*"), key=lambda f: int(f.suffix[1:])):
            text = file.read_text()
            label = re.search(r"^desc: Trigger: Client Request: (.*) (\d+)$", text, re.M)
            if label:
                total = re.search(r"^totals: (\d+)$", text, re.M)
                counts.setdefault(label[1], {})[int(label[2])] = int(total[1])
    nothing = counts.pop("nothing")
    return {name: {n: count - nothing[n] for n, count in sizes.items()}
            for name, sizes in counts.items()}


def line(sizes):
    """Instructions per element and per call: the straight line through both measurements."""
    (n1, c1), (n2, c2) = sorted(sizes.items())
    per_element = (c2 - c1) / (n2 - n1)
    return per_element, c1 - per_element * n1


def reading(counts, slack):
    print("{:<44}{:>10}{:>14}{:>15}".format("instructions", "std, each", "slamgc, each",
                                            "more per call"))
    failed = []
    for std_name in [name for name in counts if name.startswith("std ")]:
        name = std_name[len("std "):]
        std, own = line(counts[std_name]), line(counts["slamgc " + name])
        per_call = own[1] - std[1]
        ok = (own[0] <= std[0] + ALLOWED.get(name, 0) + slack
              and per_call <= ALLOWED_PER_CALL + 16 * slack)
        print("{:<44}{:>10.2f}{:>14.2f}{:>15.0f}{}".format(name, std[0], own[0], per_call,
                                                           "" if ok else "  <-- too many"))
        if not ok:
            failed.append(name)
    return failed


def counting(counts, baseline):
    print("{:<44}{:>10}{:>14}".format("instructions", "each", "baseline"))
    expected = dict(text.rsplit(None, 1) for text in baseline.read_text().splitlines()
                    if text and not text.startswith("#"))
    failed = []
    for name, per_element in costs(counts).items():
        allowed = float(expected.pop(name, "nan"))
        ok = per_element <= allowed + ALLOWED_ABOVE_BASELINE
        print("{:<44}{:>10.2f}{:>14.2f}{}".format(name, per_element, allowed,
                                                  "" if ok else "  <-- more than the baseline"))
        if not ok:
            failed.append(name)
    return failed + list(expected)  # what the baseline names has to be measured


def costs(counts):
    return {name[len("count "):]: line(sizes)[0]
            for name, sizes in counts.items() if name.startswith("count ")}


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("command", choices=["reading", "counting", "update"])
    parser.add_argument("program")
    parser.add_argument("baseline", nargs="?", type=Path)
    parser.add_argument("--slack", type=int, default=0)
    arguments = parser.parse_args()
    counts = instructions(arguments.program)
    if arguments.command == "update":
        arguments.baseline.write_text(
            "# Instructions per operation; written by check.py update.\n"
            + "".join("{:<40}{:8.2f}\n".format(*item) for item in costs(counts).items()))
        return
    if arguments.command == "reading":
        failed = reading(counts, arguments.slack)
    else:
        failed = counting(counts, arguments.baseline)
    if failed:
        sys.exit("too many instructions: " + "; ".join(failed))


main()
