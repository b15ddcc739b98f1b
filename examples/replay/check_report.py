#!/usr/bin/env python3
"""check_report.py SLAMGC_REPLAY REPORT.PY [CHECK_BROWSER.PY]: plays a small session, makes the report, and reads it, or looks at it in a browser.

Exit code 77: there is no matplotlib, or no browser.
"""

import html.parser
import json
import subprocess
import sys
import tempfile
from pathlib import Path

TRACE = """# slamtrace 1 a small session
F 0 1.0 0
K 0 1.0 0 0 0 0 0 0 1 100 f0 0
P 0 1 2 3 0
P 1 1 2 4 0
o 0 0 0 0 0
o 0 1 1 0 0
F 1 1.1 0
K 1 1.1 1 0 0 0 0 0 1 100 f1 1
o 1 0 0 0 1
o 1 1 1 0 1
F 2 1.2 0
D 1 1
B 1 1
F 3 1.3 0
"""


class Reader(html.parser.HTMLParser):
    def __init__(self):
        super().__init__()
        self.open, self.figures, self.text, self.links, self.captions = [], 0, [], [], []

    def handle_starttag(self, tag, attributes):
        if tag not in ("meta", "br", "use", "path", "rect"):
            self.open.append(tag)
        self.figures += tag == "svg"
        if tag == "figcaption":
            self.captions.append("")
        # Nothing to load: a figure refers to its own parts alone.
        self.links += [v for k, v in attributes if k in ("src", "href", "xlink:href") and not v.startswith("#")]

    def handle_endtag(self, tag):
        if tag in self.open:
            while self.open.pop() != tag:
                pass

    def handle_data(self, data):
        self.text.append(data)
        if self.open and self.open[-1] == "figcaption":
            self.captions[-1] += data


def check(condition, what):
    if not condition:
        sys.exit(what)


def main():
    program, report, *browser = sys.argv[1:]
    # Matplotlib's package is for the distribution's own Python.
    pythons = [p for p in (sys.executable, "/usr/bin/python3") if Path(p).exists() and subprocess.run(
        [p, "-c", "import matplotlib"], stderr=subprocess.DEVNULL).returncode == 0]
    if not pythons:
        print("SKIPPED: the replay's report: there is no matplotlib")
        sys.exit(77)
    python = pythons[0]
    with tempfile.TemporaryDirectory() as directory:
        trace, results, page, bad = (Path(directory, n) for n in ("t.trace", "r.json", "r.html", "bad.json"))
        trace.write_text(TRACE)
        if browser:  # all schemes, so that all is drawn
            subprocess.run([program, str(trace), "--in-order", "--laps", "2", "--json", str(results)], check=True, stdout=subprocess.DEVNULL)
            subprocess.run([python, report, str(results), str(page)], check=True)
            check(all(f'id=figure-{n}' in page.read_text() for n in range(13, 26)), "a figure of the thesis is missing")
            sys.exit(subprocess.run([python, browser[0], str(page)]).returncode)
        subprocess.run([program, str(trace), "--in-order", "--schemes", "leak,deferred", "--json", str(results)],
                       check=True, stdout=subprocess.DEVNULL)
        subprocess.run([python, report, str(results), str(page)], check=True)
        reader = Reader()
        reader.feed(page.read_text())
        everything = json.loads(results.read_text())
        for text in ("{}", "[", json.dumps({"schema": everything["schema"], "runs": [{}], "session": {}})):
            bad.write_text(text)
            if page.exists():
                page.unlink()
            refused = subprocess.run([python, report, str(bad), str(page)], stderr=subprocess.PIPE)
            check(refused.returncode == 1 and b"bad.json" in refused.stderr, "takes bad input: " + text)
            check(not page.exists(), "writes a report of bad input")
    check(reader.figures == len(reader.captions) >= 10, "figures: {}, captions: {}".format(reader.figures, reader.captions))
    check(all(reader.captions), "a figure says nothing")
    check(reader.links == [], "loads {}".format(reader.links))
    text = " ".join(reader.text)
    for words in ("freed 1 of 1 marked keyframes and 1 of 1 marked points", "1 of 2 keyframes and 1 of 2 points were marked"):
        check(words in text, "does not say: {}: {}".format(words, text[:2000]))


main()
