#!/usr/bin/env python3
"""Makes tables of what scripts/benchmark measured of counting references.

  report_counting.py RESULTS                  prints them
  report_counting.py RESULTS --write FILE     replaces what is between the markers in FILE, and draws the
                                              plot beside it
"""

import json
import math

from report import Results, machine_table, main, number, pyplot, table, with_interval

PLOT = "performance.svg"
REFERENCE = "hand fetch_add"
THREADS = (1, 2, 4, 8)
ONE, SPREAD = "one object", "spread objects"


def read(directory):
    results = Results(directory, ("copy_destroy", "move", "slot_assignment", "rebuild", "elements"))
    results.memory = [json.loads(text)
                      for text in (directory / "memory.json").read_text().splitlines()]
    results.compile_time = (directory / "compile_time.txt").read_text().splitlines()
    results.callgrind = (directory / "callgrind.txt").read_text()
    return results


def milliseconds(results, what):
    for text in results.compile_time:
        if what in text:
            return float(text.split(what)[1].split()[0])
    return math.nan


def bars(results):
    """(what, measured, limit, met)"""
    def against(what, contender, reference, limit, threads):
        key = "copy+destroy", ONE, threads
        ratio, low, high = results.ratio(key, contender, reference)
        alone = "alone" if threads == 1 else "{} threads".format(threads)
        return ("{}, {}".format(what, alone), with_interval(ratio, low, high),
                "{:.2f}".format(limit), ratio <= limit)

    for threads in (1, 2):
        yield against("`fetch_add_counter` / hand-written `fetch_add`", "slamgc fetch_add",
                      REFERENCE, 1.05, threads)
    for threads in (1, 2):
        yield against("`fetch_add_counter` / `boost::intrusive_ptr`", "slamgc fetch_add",
                      "boost::intrusive_ptr", 1.05, threads)
    for threads in (1, 2):
        yield against("`fetch_add_counter` / `std::shared_ptr`", "slamgc fetch_add",
                      "std::shared_ptr", 0.5, threads)
    for policy in ("cas", "mutex"):
        for threads in (1, 2):
            yield against("`{0}_counter` / hand-written {0}".format(policy), "slamgc " + policy,
                          "hand " + policy, 1.10, threads)
    memory = milliseconds(results, "<memory>")
    umbrella = milliseconds(results, "<slamgc/slamgc.hpp>")
    yield ("compile time of `<slamgc/slamgc.hpp>`, ms more than `<memory>`",
           "{:.0f}".format(umbrella - memory), "300", umbrella - memory < 300)
    more = [own - std for std, own in reading(results)]
    equal = sum(difference <= 0 for difference in more)
    yield ("reading: ways in which it takes no more instructions than with a standard container",
           "{} of {}; elsewhere {:.0f} more at most".format(equal, len(more), max(more)),
           "all", equal == len(more))


def matrix(results, operation, shape):
    keys = [(operation, shape, threads) for threads in THREADS]
    contenders = list(dict.fromkeys(c for key in keys for c in results.times[key]))
    order = ["slamgc", "hand", "boost", "std"]
    contenders.sort(key=lambda c: (order.index(c.split()[0].split("::")[0]), c))
    for contender in contenders:
        row = ["`" + contender + "`" if "::" in contender else contender]
        for key in keys:
            ns = results.median(key, contender)
            ratio = results.ratio(key, contender, REFERENCE)[0]
            row.append("" if math.isnan(ns) else "{} ({})".format(number(ns), number(ratio)))
        yield row


def reading(results):
    """Instructions per element of the standard and of our containers."""
    for text in instructions(results):
        if ": " in text and not text.startswith(("instructions", "copy+", "vector: push_back")):
            std, own = text[44:].split()[:2]
            yield float(std), float(own)


def growth(results, operation):
    keys = sorted((key for key in results.times if key[0] == operation),
                  key=lambda key: int(key[1].split()[0]))
    for contender in sorted(results.times[keys[0]]):
        yield (["`" + contender + "`"]
               + [number(results.median(key, contender)) for key in keys])


def instructions(results):
    """The output of tests/callgrind/check.py within that of ctest."""
    for text in results.callgrind.splitlines():
        if text[:1].isdigit() and ": " in text:
            text = text.split(": ", 1)[1]
            if text.startswith(("instructions ", "vector", "list:", "set:", "map:", "value map:",
                                "unordered", "slot", "copy+", "move ", "v[i]",
                                "quiescent")):
                if text.startswith("instructions "):
                    yield ""
                yield text


def report(results, with_plot):
    yield from machine_table(results, "scripts/benchmark --part counting")

    yield "### Bars"
    yield ""
    yield ("Ratio of the time of copy and destruction of a pointer to one object; in parentheses "
           "the 95 % confidence interval of the median.")
    yield ""
    yield from table(["bar", "measured", "at most", ""],
                     [[what, measured, limit, "met" if met else "**missed**"]
                      for what, measured, limit, met in bars(results)])
    shared = [results.ratio(("copy+destroy", ONE, threads), REFERENCE, "std::shared_ptr")[0]
              for threads in (1, 2)]
    yield ("For the bar against `std::shared_ptr`: the hand-written counter itself is at {:.3f} alone "
           "and {:.3f} with two threads on this machine.".format(*shared))
    versioned = [results.ratio(("copy+destroy", ONE, threads), "slamgc cas",
                               "hand cas, versioned")[0] for threads in (1, 2)]
    yield ("For the bar of `cas_counter`: against a hand-written one whose word has a version, too, "
           "it is at {:.3f} alone and {:.3f} with two threads.".format(*versioned))
    yield ""

    yield "### The matrix"
    yield ""
    yield ("Nanoseconds of CPU time per operation (ratio to the hand-written `fetch_add`), by number "
           "of threads.")
    yield ""
    operations = list(dict.fromkeys(key[0] for key in results.times if key[1] in (ONE, SPREAD)))
    for operation in operations:
        for shape in (ONE, SPREAD):
            yield "**{}, {}**".format(operation[0].upper() + operation[1:], shape)
            yield ""
            yield from table(["", "1 thread"] + ["{} threads".format(n) for n in THREADS[1:]],
                             matrix(results, operation, shape))
    if with_plot:
        yield "![Cost against threads]({})".format(PLOT)
        yield ""

    yield "### Whole containers"
    yield ""
    yield "Nanoseconds per operation on the whole container, by number of elements, one thread."
    yield ""
    for operation in dict.fromkeys(key[0] for key in results.times if "elements" in key[1]):
        sizes = sorted(int(key[1].split()[0]) for key in results.times if key[0] == operation)
        yield "**{}**".format(operation[0].upper() + operation[1:])
        yield ""
        yield from table([""] + [str(size) for size in sizes], growth(results, operation))

    yield "### Instructions"
    yield ""
    yield "```"
    yield from list(instructions(results))[1:]
    yield "```"
    yield ""
    yield "### Memory"
    yield ""
    yield from table(["", "bytes"], [["`{}`".format(m["what"]), str(m["bytes"])]
                                     for m in results.memory])
    yield "### Compile time"
    yield ""
    yield ("Median of whole compilations with `-O2`. This is elapsed time: at a load average above the "
           "number of processors it is too high.")
    yield ""
    yield "```"
    yield from results.compile_time
    yield "```"


def plot(results, path):
    """Cost against threads for the policies; whether it could be drawn."""
    plt = pyplot()
    if plt is None:
        return False
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.6), sharey=True)
    colours = {"fetch_add": "C0", "cas": "C1", "mutex": "C2", "unsync": "C3"}
    for axis, shape in zip(axes, (ONE, SPREAD)):
        for name in ("slamgc mutex", "hand mutex", "slamgc cas", "hand cas", "std::shared_ptr",
                     "boost::intrusive_ptr", "slamgc fetch_add", "hand fetch_add",
                     "slamgc unsync"):
            points = [(threads, results.median(("copy+destroy", shape, threads), name))
                      for threads in THREADS]
            points = [p for p in points if not math.isnan(p[1])]
            axis.plot(*zip(*points), label=name, marker="o", markersize=4,
                      color=colours.get(name.split()[-1], "C4" if "std" in name else "C5"),
                      linestyle="-" if name.startswith("slamgc") else "--")
        axis.set_title(shape)
        axis.set_xscale("log", base=2)
        axis.set_yscale("log")
        axis.set_xticks(THREADS, [str(n) for n in THREADS])
        axis.set_xlabel("threads")
        axis.grid(alpha=0.3, which="both")
    axes[0].set_ylabel("copy + destroy, ns of CPU time")
    axes[1].legend(fontsize=7, loc="center left", bbox_to_anchor=(1, 0.5))
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})
    return True


main(__doc__, "counting", read, report, plot, PLOT)
