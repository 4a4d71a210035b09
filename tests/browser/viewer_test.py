#!/usr/bin/env python3
"""Opens a viewer page in Chromium through chromedriver (WebDriver over HTTP) and uses it. Only Python's own library.

    viewer_test.py <chromedriver> <page.html> <probe.js>

Exit status: 0 passed, 1 failed.
"""
import json
import pathlib
import re
import subprocess
import sys
import urllib.request

FLAGS = ["--headless", "--no-sandbox", "--disable-dev-shm-usage", "--disable-quic", "--no-first-run",
         "--disable-background-networking", "--window-size=1000,700"]
WEBGL = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]


class Browser:
    """One session; every command is one HTTP request."""

    def __init__(self, port, flags):
        self.direct = urllib.request.build_opener(urllib.request.ProxyHandler({}))
        self.address = f"http://127.0.0.1:{port}/session"
        session = self.post("", {"capabilities": {"alwaysMatch": {
            "browserName": "chrome", "goog:chromeOptions": {"args": FLAGS + flags},
            "goog:loggingPrefs": {"browser": "ALL"}, "timeouts": {"script": 60000}}}})
        self.address += "/" + session["sessionId"]

    def request(self, method, path, body=None):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self.address + path, data, {"Content-Type": "application/json"}, method=method)
        with self.direct.open(request, timeout=90) as answer:
            return json.load(answer)["value"]

    def post(self, path, body):
        return self.request("POST", path, body)

    def run(self, script):
        return self.post("/execute/sync", {"script": script, "args": []})

    def close(self):
        self.request("DELETE", "")


def drag_and_wheel(browser):
    """Real mouse events on the figure: what is wrong."""
    before = browser.run("return motionlang.state().camera")
    move = {"type": "pointerMove", "duration": 50, "origin": "viewport"}
    browser.post("/actions", {"actions": [{"type": "pointer", "id": "mouse", "actions": [
        {**move, "x": 400, "y": 200}, {"type": "pointerDown", "button": 0},
        {**move, "x": 500, "y": 240}, {"type": "pointerUp", "button": 0}]}]})
    turned = browser.run("return motionlang.state().camera")
    browser.post("/actions", {"actions": [{"type": "wheel", "id": "wheel", "actions": [
        {"type": "scroll", "x": 400, "y": 200, "deltaX": 0, "deltaY": -300, "duration": 50, "origin": "viewport"}]}]})
    zoomed = browser.run("return motionlang.state().camera")
    problems = []
    if not (turned["yaw"] < before["yaw"] and turned["pitch"] > before["pitch"]):
        problems.append(f"dragging does not turn: {before} {turned}")
    if not zoomed["distance"] < turned["distance"]:
        problems.append(f"the wheel does not zoom: {turned} {zoomed}")
    return problems


def severe(browser):
    """What the page's console reports as an error."""
    return [entry["message"] for entry in browser.post("/se/log", {"type": "browser"}) if entry["level"] == "SEVERE"]


def start_driver(path, tries=5):
    """The program and the port on which it listens.

    Chromedriver takes any free port of one address family and then the same port of the other, which somebody may have
    (a test beside this one): then it ends without a port, and the next try gets another.
    """
    for _ in range(tries):
        driver = subprocess.Popen([path, "--port=0"], stdout=subprocess.PIPE, text=True)
        for line in driver.stdout:
            if found := re.search(r"successfully on port (\d+)", line):
                return driver, found.group(1)
        driver.stdout.close()
        driver.wait()
    raise RuntimeError(f"{path} ended {tries} times without a port")


def use_page(port, page, name, steps, renderer, flags):
    """Opens a page, checks what it draws with, calls steps(browser), and prints the problems under a name."""
    browser = Browser(port, flags)
    try:
        browser.post("/url", {"url": pathlib.Path(page).resolve().as_uri()})
        problems = [] if browser.run("return 'motionlang' in window") else ["the page's program did not start"]
        if not problems:
            used = browser.run("return motionlang.state().renderer")
            problems += [] if used == renderer else [f"draws with {used}"]
            problems += steps(browser)
        problems += severe(browser)
    finally:
        browser.close()
    print(f"{name}{renderer}: {'; '.join(problems) or 'passed'}")
    return not problems


def main(driver_path, page, probe_path):
    probe = pathlib.Path(probe_path).read_text(encoding="utf-8")

    def steps(browser):
        return drag_and_wheel(browser) + browser.post("/execute/async", {"script": probe, "args": []})

    driver, port = start_driver(driver_path)
    try:
        passed = [use_page(port, page, "", steps, "webgl2", WEBGL),
                  use_page(port, page, "", steps, "canvas", ["--disable-3d-apis"])]
    finally:
        driver.terminate()
    return 0 if all(passed) else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
