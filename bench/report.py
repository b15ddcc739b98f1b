"""What the reports have in common: report_counting.py, report_deferred.py and report_graph.py."""

import argparse
import json
import math
import statistics
import sys
from collections import defaultdict
from pathlib import Path


class Results:
    """CPU time in nanoseconds, by (operation, shape, threads), contender and round."""

    def __init__(self, directory, names):
        self.times = defaultdict(lambda: defaultdict(dict))
        self.invalid = self.windows = 0
        for name in names:
            for text in (directory / (name + ".json")).read_text().splitlines():
                r = json.loads(text)
                key = r["operation"], r["shape"], r["threads"]
                times = self.times[key][r["contender"]]
                self.windows += 1
                if r["valid"]:
                    times[r["round"]] = r["cpu_ns"]
                else:
                    self.invalid += 1
        self.machine = dict(text.split(" ", 1)
                            for text in (directory / "machine.txt").read_text().splitlines())

    def median(self, key, contender):
        times = self.times[key].get(contender)
        return statistics.median(times.values()) if times else math.nan

    def ratio(self, key, contender, reference):
        """Median of the ratios within a round, and its 95 % confidence interval."""
        a, b = self.times[key].get(contender, {}), self.times[key].get(reference, {})
        return median_of([a[i] / b[i] for i in a.keys() & b.keys()])


def median_of(values):
    """The median and its 95 % confidence interval."""
    if not values:
        return math.nan, math.nan, math.nan
    values = sorted(values)
    n = len(values)
    half = 0.98 * math.sqrt(n)
    low, high = max(0, round(n / 2 - half) - 1), min(n - 1, round(n / 2 + half))
    return statistics.median(values), values[low], values[high]


def verdict(median, low, high, limit):
    """Of a figure with a confidence interval."""
    return "met" if high <= limit else "**missed**" if low > limit else "open"


OPEN = "\"open\": the interval includes the bar, so this run cannot tell"


def with_interval(median, low, high):
    return "{:.3f} ({:.3f} to {:.3f})".format(median, low, high)


def number(x):
    if math.isnan(x):
        return ""
    return "{:.0f}".format(x) if x >= 99.5 else "{:.2f}".format(x) if x < 9.95 else "{:.1f}".format(x)


def table(header, rows, left=1):
    """A table; the first columns are aligned left."""
    yield "| " + " | ".join(header) + " |"
    yield "|" + "|".join("---" if i < left else "---:" for i in range(len(header))) + "|"
    for row in rows:
        yield "| " + " | ".join(row) + " |"
    yield ""


def machine_table(results, command):
    machine = results.machine
    yield "Measured {} with `{}`.".format(machine["date"], command)
    yield ""
    yield from table(["machine", ""], [
        ["processor", "{}, {} processors{}".format(
            machine["cpu"], machine["processors"],
            " of a virtual machine" if machine["virtual"] == "yes" else "")],
        ["system", machine["system"]],
        ["compiler", machine["compiler"] + ", Release"],
        ["load average", "{} before, {} after; the benchmark itself is up to {}".format(
            machine["load_before"], machine["load_after"], machine["processors"])],
        ["windows", "{}, of which {} were disturbed and not used".format(results.windows,
                                                                        results.invalid)],
    ], left=2)


def pyplot():
    """Matplotlib, drawing the same bytes from the same numbers; or None."""
    try:
        import matplotlib
    except ImportError:
        print("no plot: matplotlib was not found", file=sys.stderr)
        return None
    matplotlib.use("svg")
    matplotlib.rcParams["svg.hashsalt"] = "slamgc"
    import matplotlib.pyplot
    return matplotlib.pyplot


def replace_between(file, part, lines):
    """What is between the markers of this part."""
    begin, end = "<!-- begin {} -->".format(part), "<!-- end {} -->".format(part)
    before, rest = file.read_text().split(begin, 1)
    after = rest.split(end, 1)[1]
    file.write_text("\n".join([before + begin, *lines, end + after]))


def main(description, part, read, report, plot, picture):
    """`read(directory)` makes results, of which `report(results, with_plot)` makes lines."""
    parser = argparse.ArgumentParser(description=description,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", type=Path)
    parser.add_argument("--write", type=Path)
    arguments = parser.parse_args()
    results = read(arguments.results)
    if not arguments.write:
        print("\n".join(report(results, False)))
        return
    drawn = plot(results, arguments.write.parent / picture)
    replace_between(arguments.write, part, ["", *report(results, drawn), ""])
