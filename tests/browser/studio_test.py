#!/usr/bin/env python3
"""Opens the studio in Chromium, and makes, edits and saves a motion as a person does.

    studio_test.py <chromedriver> <studio.html> <program motionlang> <the page's model> <folder>

The folder gets the saved files, which the program reads. Exit status: 0 passed, 1 failed.
"""
import json
import os
import pathlib
import struct
import subprocess
import sys
import time
import urllib.error

from pages_test import wait
from viewer_test import WEBGL, Browser, severe, start_driver

ELEMENT = "element-6066-11e4-a52e-4f735466cecf"  # the key of an element in WebDriver
CONTROL, SHIFT, ENTER, RIGHT, DELETE = "\ue009", "\ue008", "\ue007", "\ue014", "\ue017"
MADE = 240  # seconds that a motion may take


def state(browser):
    return browser.run("return motionlang.state()")


def find(browser, selector):
    return browser.post("/element", {"using": "css selector", "value": selector})[ELEMENT]


def click(browser, selector, tries=3):
    """The page draws its bars anew after it has checked them, so an element may be gone before the click."""
    try:
        browser.post(f"/element/{find(browser, selector)}/click", {})
    except urllib.error.HTTPError as reason:
        if reason.code != 404 or tries == 1:
            raise
        time.sleep(0.3)
        click(browser, selector, tries - 1)


def type_into(browser, selector, keys):
    browser.post(f"/element/{find(browser, selector)}/value", {"text": keys})


def write(browser, selector, words):
    """Replaces what a field has."""
    type_into(browser, selector, CONTROL + "a" + CONTROL + words)


def press(browser, *keys):
    """Keys at the element that has the focus; all but the last are held."""
    down = [{"type": "keyDown", "value": k} for k in keys]
    up = [{"type": "keyUp", "value": k} for k in reversed(keys)]
    browser.post("/actions", {"actions": [{"type": "key", "id": "keys", "actions": down + up}]})


def drag(browser, selector, way):
    """Drags an element to the right with the mouse."""
    x, y = browser.run(f"const r = document.querySelector({json.dumps(selector)}).getBoundingClientRect(); "
                       "return [Math.floor(r.x + r.width / 2), Math.floor(r.y + r.height / 2)]")
    move = {"type": "pointerMove", "duration": 100}
    browser.post("/actions", {"actions": [{"type": "pointer", "id": "mouse", "actions": [
        {**move, "origin": "viewport", "x": x, "y": y}, {"type": "pointerDown", "button": 0},
        {**move, "origin": "pointer", "x": way, "y": 0}, {"type": "pointerUp", "button": 0}]}]})


def made(browser, motions):
    return wait(browser, f"motionlang.state().motions >= {motions} && !motionlang.state().making", MADE)


def largest_move(a, b):
    return max(sum((x - y) ** 2 for x, y in zip(p, q)) ** 0.5 for p, q in zip(a["joints"], b["joints"]))


def expect(problems, what, holds):
    if not holds:
        problems.append(what)


def saved(browser, folder, kind):
    """The path of the motion, saved by the page's button."""
    before = set(folder.iterdir())
    click(browser, f"#kind option[value='{kind}']")
    click(browser, "#save")
    end = time.monotonic() + 30
    while time.monotonic() < end:
        for path in set(folder.iterdir()) - before:
            if path.suffix == kind:
                return path
        time.sleep(0.1)
    raise RuntimeError(f"no {kind} was saved; {browser.run('return document.getElementById(`status`).textContent')}")


def joints_of(npy):
    """The shape and the values of a file of joint positions."""
    data = npy.read_bytes()
    size = struct.unpack("<H", data[8:10])[0]
    header = data[10:10 + size].decode()
    shape = tuple(int(n) for n in header.split("(")[1].split(")")[0].split(",") if n.strip())
    code, width = ("f", 4) if "<f4" in header else ("d", 8)
    body = data[10 + size:]
    return shape, struct.unpack(f"<{len(body) // width}{code}", body)


def first_motion(browser, problems):
    """The page makes the example by itself."""
    expect(problems, "starts with a rest pose", state(browser)["frames"] == 1)
    expect(problems, "no first motion: " + browser.run("return document.getElementById('status').textContent"),
           made(browser, 1))
    now = state(browser)
    print(f"first motion {now['opened']:.1f} s after opening, {now['took']:.1f} s of them to make it")
    expect(problems, f"{now['frames']} frames", now["frames"] == 120)
    expect(problems, "the motion is that of the timeline", not now["stale"])
    count = browser.run("return document.querySelectorAll('.bar').length")
    expect(problems, f"two bars, one of them in two rows: {count}", count == 3)
    expect(problems, "it plays", wait(browser, "motionlang.state().time > 0.2", 20))
    others = browser.run("return performance.getEntriesByType('resource').map((e) => e.name)"
                         ".filter((name) => !/^(blob|data):/.test(name))")
    expect(problems, f"asks for {others}", others == [])


def texts(browser, problems):
    """Types a text, generates, sees another pose; undo and redo."""
    browser.run("const s = document.getElementById('scrub'); document.getElementById('play').click(); s.value = 3;"
                "s.dispatchEvent(new Event('input'))")
    before = state(browser)
    click(browser, ".bar[data-bar='0']")
    write(browser, "#words", "sit down")
    now = state(browser)
    expect(problems, "the text is not that of the field", now["project"]["bars"][0]["text"] == "sit down")
    expect(problems, "a changed timeline makes the motion stale", now["stale"])
    write(browser, "#words", "sti")  # one step of undo with the text before
    known = browser.run("return [...document.querySelectorAll('#prompts option')].map((o) => o.value)")
    expect(problems, "completion has what the model knows", "stand still" in known and len(known) > 100)
    write(browser, "#words", "sit down" + ENTER)
    expect(problems, "Enter does not generate", made(browser, 2))
    after = state(browser)
    expect(problems, "the pose is the same", largest_move(before, after) > 0.1)
    while state(browser)["undos"]:
        press(browser, CONTROL, "z")
    back = state(browser)
    expect(problems, "undo does not bring back the example", back["project"] == before["project"])
    expect(problems, "undo does not show the example's motion", wait(browser, "!motionlang.state().stale", 5) and
           largest_move(before, state(browser)) < 1e-9)
    press(browser, CONTROL, SHIFT, "z")
    expect(problems, "redo", state(browser)["project"]["bars"][0]["text"] == "sit down")
    press(browser, CONTROL, "z")


def bars(browser, problems):
    """Mouse and keyboard on the timeline."""
    width = browser.run("return document.getElementById('lanes').clientWidth")
    drag(browser, ".bar[data-bar='1'] .grip.to", -round(width / 6))  # one second
    now = state(browser)["project"]["bars"][1]
    expect(problems, f"resized to {now}", now["start"] == 2 and abs(now["end"] - 4) < 0.06)
    drag(browser, ".bar[data-bar='1']", round(width / 12))
    moved = state(browser)["project"]["bars"][1]
    expect(problems, f"moved to {moved}",
           abs(moved["start"] - 2.5) < 0.06 and abs(moved["end"] - now["end"] - 0.5) < 0.06)
    expect(problems, "a drag is one step of undo", state(browser)["undos"] == 2)
    press(browser, RIGHT)
    start = state(browser)["project"]["bars"][1]["start"]
    expect(problems, f"a key moves the bar to {start}", abs(start - moved["start"] - 0.1) < 1e-6)
    press(browser, SHIFT, RIGHT)
    press(browser, CONTROL, "d")
    expect(problems, "no duplicate", len(state(browser)["project"]["bars"]) == 3)
    click(browser, ".bar[data-bar='0']")
    press(browser, DELETE)
    expect(problems, "not deleted", [b["text"] for b in state(browser)["project"]["bars"]] == ["raise both arms"] * 2)
    lines = state(browser)["timeline"].splitlines()
    expect(problems, f"no rest at the start: {lines}", lines[0].startswith("stand still # 0 # 2.6"))
    while state(browser)["undos"]:
        press(browser, CONTROL, "z")
    click(browser, ".bar[data-bar='0']")
    write(browser, "#words", "walk forwad")
    expect(problems, "no warning at the bar",
           wait(browser, "document.querySelector('.bar.warned[data-bar=\"0\"]') && motionlang.state().warnings.length"))
    while state(browser)["undos"]:
        press(browser, CONTROL, "z")
    names = browser.run(
        "return [...document.querySelectorAll('button, select, textarea, input:not([hidden])')].filter((e) =>"
        "!(e.textContent.trim() || e.getAttribute('aria-label') || e.closest('label'))).map((e) => e.id)")
    expect(problems, f"without a name: {names}", names == [])


def cancelling(browser, problems):
    count = state(browser)["motions"]
    click(browser, "#whole")
    expect(problems, "no progress", wait(browser, "document.getElementById('progress').value > 0", MADE))
    alive = browser.run("return document.getElementById('left').textContent")
    expect(problems, f"time left: {alive}", alive.startswith("step ") and alive.endswith("s left"))
    click(browser, "#cancel")
    now = state(browser)
    expect(problems, "it is not cancelled at once", not now["making"] and count > 0)
    click(browser, "#whole")
    expect(problems, "nothing is made after a cancelled motion", made(browser, count + 1))


def files(browser, program, model, folder, problems):
    """Saved files are read by the program, and have the bytes of those that the program makes of the same timeline."""
    browser.post("/goog/cdp/execute", {"cmd": "Browser.setDownloadBehavior",
                                       "params": {"behavior": "allow", "downloadPath": str(folder)}})
    positions, contents = {}, {}
    for kind in (".npy", ".bvh", ".glb"):
        path = saved(browser, folder, kind)
        contents[kind] = path.read_bytes()
        if kind != ".npy":
            path = convert(program, path, folder / f"from_{kind[1:]}.npy")
        positions[kind] = joints_of(path)
    shape, values = positions[".npy"]
    expect(problems, f"{shape} positions", shape[:2] == (120, 24))
    for kind in (".bvh", ".glb"):
        apart = max(abs(a - b) for a, b in zip(values, positions[kind][1]))
        expect(problems, f"{kind}: {positions[kind][0]}, {apart} m apart", positions[kind][0] == shape and apart < 1e-3)
    timeline = folder / "timeline.txt"
    timeline.write_text(state(browser)["timeline"], encoding="utf-8")
    run(program, "generate", "--timeline", str(timeline), "--seed", "7", "--model", model,
        "--out", str(folder / "out"))
    for kind in (".npy", ".bvh"):
        expect(problems, f"the {kind} of the page is not that of the program",
               contents[kind] == (folder / f"out/timeline{kind}").read_bytes())


def run(program, *arguments):
    subprocess.run([program, *arguments], check=True, stdout=subprocess.DEVNULL,
                   env={**os.environ, "MOTIONLANG_KERNELS": "portable"})


def convert(program, path, to):
    run(program, "convert", str(path), str(to))
    return to


def kept(browser, page, problems):
    """Visits the page again, and returns the link to the project and its timeline."""
    write(browser, "#seed", "41" + ENTER)
    time.sleep(1)  # until it is stored
    before = state(browser)
    link = browser.run("return location.href")
    browser.post("/url", {"url": page})
    expect(problems, "the project is lost", wait(browser, "motionlang.state().project.seed === 41") and
           state(browser)["project"] == before["project"])
    return link, before["timeline"]


def elsewhere(browser, link, timeline, problems):
    """Another browser, without the project in its storage, opens the link."""
    browser.post("/url", {"url": link})
    expect(problems, "the link has another timeline", wait(browser, "motionlang.state().project.seed === 41", 60) and
           state(browser)["timeline"] == timeline)


def main(driver_path, page, program, model, folder):
    folder, size, page = pathlib.Path(folder), os.path.getsize(page), pathlib.Path(page).resolve().as_uri()
    driver, port = start_driver(driver_path)
    problems = []
    print(f"{size} bytes")
    expect(problems, f"the page has {size} bytes, more than 16 MB", size <= 16_000_000)
    browser = None
    try:
        browser = Browser(port, [*WEBGL, "--window-size=1280,720"])
        browser.post("/url", {"url": page})
        for steps in (first_motion, texts, bars, cancelling):
            steps(browser, problems)
        files(browser, program, model, folder, problems)
        link, timeline = kept(browser, page, problems)
        problems += severe(browser)
        browser.close()
        browser = Browser(port, WEBGL)
        elsewhere(browser, link, timeline, problems)
    finally:
        if browser:
            browser.close()
        driver.terminate()
    print(f"studio: {'; '.join(problems) or 'passed'}")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
