#!/usr/bin/env python3
"""check_browser.py REPORT.html [--screenshot FILE.png]: opens the page in headless Chromium, offline, and looks at it.

Fails if something is loaded but the page, if the console has an error, if a section or a figure is missing, blank or cut off, or if the
page is wider than the window, on a desk or a telephone. Exit code 77, with the reason: it cannot be tried here.
"""

import argparse
import base64
import io
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

SECTIONS = ("memory", "thesis")
WIDTHS = (1280, 400)
PATIENCE = 60  # seconds, for each answer
LAYOUT = """(() => {
  const box = e => { const r = e.getBoundingClientRect(); return [r.x + scrollX, r.y + scrollY, r.width, r.height]; };
  return JSON.stringify({
    sections: [...document.querySelectorAll('h2')].map(h => h.id),
    figures: [...document.querySelectorAll('figure')].map(f => ({name: f.id, svg: box(f.querySelector('svg')),
      caption: f.querySelector('figcaption').textContent.length,
      outside: [...f.querySelectorAll('svg text')].filter(t => { const a = t.getBoundingClientRect(), b = f.querySelector('svg').getBoundingClientRect();
        return a.left < b.left - 2 || a.right > b.right + 2 || a.top < b.top - 2 || a.bottom > b.bottom + 2; }).map(t => t.textContent)})),
    width: document.documentElement.scrollWidth, height: document.documentElement.scrollHeight});
})()"""


def skip(reason):
    print(f"SKIPPED: the report in a browser: {reason}")
    sys.exit(77)


class Chromium:
    """A browser that is spoken to over a pipe, in the DevTools protocol."""

    def __init__(self, program, profile):
        to_it, self.write_end = os.pipe()
        self.read_end, from_it = os.pipe()
        self.process = subprocess.Popen(
            ["bash", "-c", f'exec "$@" 3<&{to_it} 4>&{from_it}', "bash", program, "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
             "--no-first-run", "--disable-background-networking", "--hide-scrollbars", f"--user-data-dir={profile}", "--remote-debugging-pipe", "about:blank"],
            pass_fds=(to_it, from_it), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_it)
        os.close(from_it)
        os.set_blocking(self.read_end, False)
        self.number, self.received, self.events, self.session = 0, b"", [], None

    def message(self):
        end = time.monotonic() + PATIENCE
        while b"\0" not in self.received:
            try:
                piece = os.read(self.read_end, 1 << 20)
                if not piece:
                    sys.exit("the browser ended")
                self.received += piece
            except BlockingIOError:
                if time.monotonic() > end:
                    sys.exit(f"the browser did not answer for {PATIENCE} seconds")
                time.sleep(0.01)
        text, self.received = self.received.split(b"\0", 1)
        return json.loads(text.decode())

    def ask(self, method, **parameters):
        self.number += 1
        request = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            request["sessionId"] = self.session
        os.write(self.write_end, json.dumps(request).encode() + b"\0")
        while True:
            answer = self.message()
            if answer.get("id") == self.number:
                if "error" in answer:
                    sys.exit(f"{method}: {answer['error']}")
                return answer["result"]
            self.events.append(answer)

    def wait_for(self, event):
        while not any(e.get("method") == event for e in self.events):
            self.events.append(self.message())

    def close(self):
        self.process.terminate()
        self.process.wait()


def look(browser, page, width):
    """The layout of the page in a window of this width, and its picture."""
    browser.events.clear()
    browser.ask("Emulation.setDeviceMetricsOverride", width=width, height=900, deviceScaleFactor=1, mobile=False)
    browser.ask("Page.navigate", url=page.as_uri())
    browser.wait_for("Page.loadEventFired")
    layout = json.loads(browser.ask("Runtime.evaluate", expression=LAYOUT)["result"]["value"])
    picture = browser.ask("Page.captureScreenshot", captureBeyondViewport=True,
                          clip={"x": 0, "y": 0, "width": width, "height": layout["height"], "scale": 1})
    return layout, base64.b64decode(picture["data"])


def complaints(browser, page, layout, picture, width):
    for e in browser.events:
        about = e.get("params", {})
        if e["method"] == "Network.requestWillBeSent" and not about["request"]["url"].startswith(("data:", page.as_uri())):
            yield f"loads {about['request']['url']}"
        if e["method"] == "Runtime.exceptionThrown" or e["method"] == "Runtime.consoleAPICalled" and about["type"] in ("error", "warning"):
            yield f"console: {json.dumps(about)[:300]}"
        if e["method"] == "Log.entryAdded" and about["entry"]["level"] in ("error", "warning"):
            yield f"console: {about['entry']['text']}"
    for section in SECTIONS:
        if section not in layout["sections"]:
            yield f"there is no section '{section}'"
    if not layout["figures"]:
        yield "there is no figure"
    if layout["width"] > width:
        yield f"the page is {layout['width']} pixels wide"
    pixels = Image.open(io.BytesIO(picture)).convert("L")
    for figure in layout["figures"]:
        x, y, w, h = figure["svg"]
        if w < 200 or h < 80 or x < 0 or x + w > width + 1:
            yield f"{figure['name']}: at {figure['svg']}"
            continue
        histogram = pixels.crop((int(x), int(y), int(x + w), int(y + h))).histogram()
        ink = sum(histogram[:200]) / sum(histogram)
        if ink < 0.004 or not figure["caption"]:
            yield f"{figure['name']}: {100 * ink:.2f} % of it is drawn, {figure['caption']} letters below"
        if figure["outside"]:
            yield f"{figure['name']}: cut off: {figure['outside']}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("report", type=Path)
    parser.add_argument("--screenshot", type=Path)
    arguments = parser.parse_args()
    program = shutil.which("chromium") or shutil.which("google-chrome")
    if not program:
        skip("there is no chromium")
    page, found = arguments.report.resolve(), []
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) if sys.version_info >= (3, 10) else tempfile.TemporaryDirectory() as profile:
        browser = Chromium(program, profile)
        try:
            target = browser.ask("Target.createTarget", url="about:blank")["targetId"]
            browser.session = browser.ask("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
            for domain in ("Page", "Runtime", "Log", "Network"):
                browser.ask(domain + ".enable")
            browser.ask("Network.emulateNetworkConditions", offline=True, latency=0, downloadThroughput=0, uploadThroughput=0)
            for width in WIDTHS:
                layout, picture = look(browser, page, width)
                found += [f"{width} pixels wide: {c}" for c in complaints(browser, page, layout, picture, width)]
                if arguments.screenshot:
                    arguments.screenshot.with_name(f"{arguments.screenshot.stem}-{width}.png").write_bytes(picture)
        finally:
            browser.close()
    if found:
        sys.exit("\n".join(found))
    print(f"{len(layout['figures'])} figures in {len(layout['sections'])} sections are to be seen, {' and '.join(map(str, WIDTHS))} pixels wide")


try:
    from PIL import Image  # matplotlib needs it, too
except ImportError:
    skip("there is no Pillow")
main()
