#!/usr/bin/env python3
"""Edits in the studio: what an edit keeps, several bars at once, timelines, variations, files that are dropped.

    studio_edit_test.py <chromedriver> <studio.html> <program motionlang> <folder>

The folder gets the files that are dropped and saved. Exit status: 0 passed, 1 failed.
"""
import base64
import json
import math
import os
import pathlib
import struct
import sys

from pages_test import wait
from studio_test import (CONTROL, DELETE, ENTER, MADE, RIGHT, SHIFT, click, drag, expect, find, made, press, run, saved,
                         state, type_into, write)
from viewer_test import WEBGL, Browser, severe, start_driver

ESCAPE, HOME, TAB = "\ue00c", "\ue011", "\ue004"
LONG = "walk forward # 0 # 4\nraise both arms # 4 # 6\nsit down # 6 # 9\nwalk forward # 9 # 12\n"


def set_timeline(browser, lines):
    click(browser, "#write")
    browser.run(f"document.getElementById('lines').value = {json.dumps(lines)}")
    click(browser, "#apply")
    return wait(browser, f"motionlang.state().timeline === {json.dumps(lines)}", 30)


def generate(browser):
    count = state(browser)["motions"]
    click(browser, "#generate")
    return made(browser, count + 1)


def bars_of(browser):
    return [(b["text"], b["start"], b["end"]) for b in state(browser)["project"]["bars"]]


def poses(browser):
    """For every frame the rotations of all joints but the root."""
    now = state(browser)
    turns, width = browser.run("return motionlang.turns()"), 4 * len(now["joints"])
    return [turns[f * width + 4:(f + 1) * width] for f in range(now["frames"])]


def degrees(a, b):
    """The largest angle between the rotations of two poses."""
    cosines = (min(1, abs(sum(x * y for x, y in zip(a[i:i + 4], b[i:i + 4]))) / 32767 ** 2)
               for i in range(0, len(a), 4))
    return max(2 * math.degrees(math.acos(c)) for c in cosines)


def keeping(browser, problems):
    """An edit of one bar leaves the bytes of far ones as they were."""
    expect(problems, "the long timeline is not read", set_timeline(browser, LONG))
    generate(browser)
    before = poses(browser)
    click(browser, ".bar[data-bar='1']")
    write(browser, "#words", "wave with the right hand")
    expect(problems, "no second motion", generate(browser))
    after, now = poses(browser), state(browser)
    reuse = now["takes"][now["shown"]]["reuse"]
    expect(problems, f"{len(before)} and {len(after)} frames", len(before) == len(after) == 240)
    expect(problems, "the edited bar is the same", before[100] != after[100])
    same = [f for f in range(240) if before[f] == after[f]]
    print(f"{len(same)} of 240 frames have the same bytes after an edit of 40; reuse {reuse}")
    expect(problems, f"the first second changed: {same[:20]}", set(range(20)) <= set(same))
    expect(problems, "the last two seconds changed", set(range(200, 240)) <= set(same))
    expect(problems, f"reuse: {reuse}", reuse["frames"] == 240 and reuse["kept"] >= 120 and reuse["work"] < 0.95
           and not reuse["exact"])
    press(browser, CONTROL, "z")
    expect(problems, "undo does not show the motion before", wait(browser, "!motionlang.state().stale", 5) and
           poses(browser) == before)
    press(browser, CONTROL, SHIFT, "z")
    expect(problems, "redo does not show the motion after", wait(browser, "!motionlang.state().stale", 5) and
           poses(browser) == after)
    click(browser, "#whole")
    made(browser, now["motions"] + 1)
    whole = state(browser)
    expect(problems, "all anew reuses", whole["takes"][whole["shown"]]["reuse"] is None)
    return after


def cancelling(browser, problems):
    """A cancelled motion takes nothing away: the one before can still be saved."""
    click(browser, "#dice")
    wait(browser, "document.getElementById('progress').value > 0", MADE)
    before = poses(browser)
    click(browser, "#cancel")
    expect(problems, "still making", wait(browser, "!motionlang.state().making", 5))
    expect(problems, "the motion is gone", poses(browser) == before)


def several(browser, problems):
    """Several bars at once, split, duplicate, zoom, snap; by mouse and by keys."""
    set_timeline(browser, LONG)
    browser.run("document.querySelector(\".bar[data-bar='0']\").focus()")
    press(browser, "s")
    press(browser, TAB)
    expect(problems, f"chosen: {state(browser)['selected']}", state(browser)["selected"] == [0, 1])
    press(browser, RIGHT)
    moved = bars_of(browser)
    expect(problems, f"both move: {moved}", [b[1] for b in moved] == [0.1, 4.1, 6, 9])
    press(browser, CONTROL, "z")
    press(browser, CONTROL, "a")
    expect(problems, "not all are chosen", state(browser)["selected"] == [0, 1, 2, 3])
    press(browser, ESCAPE)
    expect(problems, "more than one is chosen", len(state(browser)["selected"]) == 1)
    browser.run("document.querySelector(\".bar[data-bar='2']\").focus()")
    press(browser, HOME)
    press(browser, "x")
    expect(problems, f"split: {bars_of(browser)}",
           bars_of(browser)[2:4] == [("sit down", 6, 7.5), ("sit down", 7.5, 9)])
    press(browser, CONTROL, "z")
    click(browser, ".bar[data-bar='1']")
    press(browser, CONTROL, "d")
    expect(problems, f"duplicate: {bars_of(browser)}", bars_of(browser)[2] == ("raise both arms", 6, 8))
    press(browser, DELETE)
    expect(problems, "the copy is not deleted", len(bars_of(browser)) == 4)
    click(browser, "#zoomIn")
    wide = browser.run("return [document.getElementById('lanes').clientWidth, "
                       "document.getElementById('scroller').clientWidth]")
    expect(problems, f"zoom: {wide}", state(browser)["zoom"] == 2 and wide[0] > 1.8 * wide[1])
    press(browser, "0")
    expect(problems, "zoom is not reset", state(browser)["zoom"] == 1)
    second = browser.run("return document.getElementById('lanes').clientWidth") / 12
    drag(browser, ".bar[data-bar='1'] .grip.to", round(0.96 * second))
    expect(problems, f"no snap: {bars_of(browser)[1]}", bars_of(browser)[1][2] in (6.95, 7))
    press(browser, CONTROL, "z")
    drag(browser, ".bar[data-bar='0'] .grip.to", -round(0.94 * second) - 3)
    press(browser, CONTROL, "z")
    click(browser, "#snap")
    expect(problems, "snap is still on", not state(browser)["snapping"])
    click(browser, "#snap")
    expect(problems, "playing ends while one edits", browser.run(
        "document.getElementById('play').getAttribute('aria-pressed') === 'true' || "
        "document.getElementById('play').click(); return true") and
        wait(browser, "motionlang.state().playing", 5))
    click(browser, ".bar[data-bar='1']")
    press(browser, RIGHT)
    expect(problems, "an edit stops the player", state(browser)["playing"])
    press(browser, CONTROL, "z")


def timelines(browser, problems):
    before = state(browser)
    click(browser, "#fresh")
    expect(problems, "no second timeline", state(browser)["timelines"] == before["timelines"] + 1)
    expect(problems, "its motion is not made", made(browser, before["motions"] + 1))
    second = state(browser)
    expect(problems, "it shows the motion of the other", second["frames"] == 80 and not second["stale"])
    click(browser, "#sheet option[value='0']")
    expect(problems, "the first timeline is another", wait(browser, f"motionlang.state().timeline === "
           f"{json.dumps(before['timeline'])} && motionlang.state().frames === 240", MADE))
    click(browser, "#sheet option[value='1']")
    expect(problems, "the second motion is gone", wait(browser, "motionlang.state().frames === 80", 10))


def picture(browser, name):
    """Keeps what the browser shows, for people who want to look at it: MOTIONLANG_PICTURES names a folder."""
    kept = os.environ.get("MOTIONLANG_PICTURES")
    if kept:
        (pathlib.Path(kept) / f"{name}.png").write_bytes(base64.b64decode(browser.request("GET", "/screenshot")))


def variations(browser, problems):
    first = poses(browser)
    seed = state(browser)["project"]["seed"]
    browser.run("document.getElementById('view').focus()")
    press(browser, "v")
    expect(problems, "no variations", wait(browser, "motionlang.state().takes.length === 4 && "
                                           "!motionlang.state().making", 2 * MADE))
    expect(problems, "the variations have no pictures", wait(
        browser, "(() => { const all = [...document.querySelectorAll('#takes canvas')]; return all.length === 4 && "
        "all.every((c) => new Set(new Uint32Array(c.getContext('2d').getImageData(0, 0, c.width, c.height).data.buffer))"
        ".size > 20); })()", 10))
    picture(browser, "variations")
    press(browser, "2")
    expect(problems, "another seed", wait(browser, f"motionlang.state().project.seed !== {seed}", 5) and
           poses(browser) != first)
    press(browser, "k")
    locked = state(browser)
    expect(problems, "not locked", locked["takes"][locked["shown"]]["locked"])
    kept = poses(browser)
    click(browser, "#vary")
    wait(browser, "motionlang.state().making", 5)
    wait(browser, "!motionlang.state().making", 2 * MADE)
    after = state(browser)
    expect(problems, f"the locked one is gone: {after['takes']}",
           any(t["locked"] and t["seed"] == locked["project"]["seed"] for t in after["takes"]) and
           poses(browser) == kept)
    press(browser, CONTROL, "z")
    expect(problems, "undo does not choose the first again", wait(browser, f"motionlang.state().project.seed === {seed}"))
    click(browser, "#drop")
    expect(problems, "the timeline is not removed", state(browser)["timelines"] == 1)


def looking(browser, problems):
    """Colours of texts, path and feet, other moments, curves."""
    set_timeline(browser, "walk forward # 0 # 4 # legs\nraise both arms # 1 # 3 # left arm # right arm\n")
    generate(browser)
    browser.run("const s = document.getElementById('scrub'); if (motionlang.state().playing) "
                "document.getElementById('play').click(); s.value = 2; s.dispatchEvent(new Event('input'))")
    wait(browser, "motionlang.state().tints === 0 && Math.abs(motionlang.state().time - 2) < 0.1", 5)
    plain = state(browser)["cones"]
    click(browser, "#colours")
    expect(problems, "three colours: of two texts and of the rest", wait(browser, "motionlang.state().tints === 3", 5))
    click(browser, "#onion")
    expect(problems, "four other moments", wait(browser, f"motionlang.state().cones === {5 * plain}", 5))
    click(browser, "#path")
    expect(problems, "no path", wait(browser, f"motionlang.state().cones > {5 * plain + 70}", 5))
    click(browser, "#curves")
    expect(problems, "no curves", wait(
        browser, "(() => { const c = document.getElementById('graph'); return c.width > 300 && new Set(new Uint32Array("
        "c.getContext('2d').getImageData(0, 0, c.width, c.height).data.buffer)).size > 20; })()", 5))
    picture(browser, "aids")
    for name in ("colours", "onion", "path", "curves"):
        click(browser, "#" + name)
    expect(problems, "the aids stay", wait(browser, f"motionlang.state().cones === {plain}", 5))


def command(browser, name, **about):
    browser.post("/goog/cdp/execute", {"cmd": name, "params": about})


SEEN = """const hidden = [], seen = (e) => {
  const r = e.getBoundingClientRect(), x = r.x + r.width / 2, y = r.y + r.height / 2;
  return r.left >= 0 && r.top >= 0 && r.right <= innerWidth && r.bottom <= innerHeight &&
    e.contains(document.elementFromPoint(x, y));
};
for (const e of document.querySelectorAll(arguments[0]))
  if (e.checkVisibility() && !seen(e)) hidden.push(e.id || e.textContent);
return hidden"""


def sized(browser, width, height, mobile, problems):
    """A page of this size has all that is needed on one screen."""
    what = f"{width} x {height}"
    command(browser, "Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1,
            mobile=mobile)
    wait(browser, f"innerWidth === {width}", 5)
    browser.run("document.getElementById('panel').scrollTop = 0")  # earlier clicks may have scrolled it
    size = browser.run("const e = document.scrollingElement; return [e.scrollWidth, e.scrollHeight]")
    expect(problems, f"{what}: the page has {size}", size[0] <= width and size[1] <= height)
    rows = browser.run("return document.querySelector('header').offsetHeight")
    expect(problems, f"{what}: the header has {rows} pixels", rows <= 50)
    needed = "header button, header select, #aids button, #play, #scrub, #add, .lane, #words, #generate, #status"
    hidden = browser.post("/execute/sync", {"script": SEEN, "args": [needed]})
    expect(problems, f"{what}: nobody sees {hidden}", hidden == [])
    return what


def sizes(browser, problems):
    """One screen without scrolling, on a laptop and on a phone, where a menu and two groups of fields save room."""
    set_timeline(browser, "walk forward # 0 # 4\n")
    generate(browser)
    sized(browser, 1280, 720, False, problems)
    sized(browser, 1280, 580, False, problems)  # of a small laptop the browser leaves that
    picture(browser, "laptop")
    what = sized(browser, 390, 844, True, problems)
    picture(browser, "phone")
    click(browser, "#menu")
    inside = "#more button, #more select"
    hidden = browser.post("/execute/sync", {"script": SEEN, "args": [inside]})
    expect(problems, f"{what}: the menu hides {hidden}", hidden == [] and browser.run(
        f"return [...document.querySelectorAll('{inside}')].filter((e) => e.checkVisibility()).length") > 6)
    picture(browser, "menu")
    click(browser, "#fresh")
    expect(problems, f"{what}: the menu stays open", not browser.run(
        "return document.getElementById('fresh').checkVisibility()"))
    made(browser, state(browser)["motions"])
    press(browser, CONTROL, "z")
    click(browser, "#showMotion")
    expect(problems, f"{what}: no fields of the motion", browser.post("/execute/sync", {
        "script": SEEN, "args": ["#seed, #length, #vary, #live, #generate"]}) == [] and browser.run(
            "return document.getElementById('seed').checkVisibility() && "
            "!document.getElementById('words').checkVisibility()"))
    picture(browser, "phone_motion")
    click(browser, "#showText")
    end = browser.run("const r = document.querySelector(\".bar[data-bar='0'] .grip.to\").getBoundingClientRect();"
                      "return [r.x + r.width / 2, r.y + r.height / 2]")
    command(browser, "Emulation.setTouchEmulationEnabled", enabled=True)
    for kind, way in (("touchStart", 0), ("touchMove", -20), ("touchMove", -60), ("touchEnd", None)):
        points = [] if way is None else [{"x": end[0] + way, "y": end[1]}]
        command(browser, "Input.dispatchTouchEvent", type=kind, touchPoints=points)
    expect(problems, f"{what}: a finger does not pull the end of a bar: {bars_of(browser)}",
           2.5 < bars_of(browser)[0][2] < 3.6)
    command(browser, "Emulation.setTouchEmulationEnabled", enabled=False)
    press(browser, CONTROL, "z")
    command(browser, "Emulation.clearDeviceMetricsOverride")


def completion(browser, problems):
    click(browser, ".bar[data-bar='0']")
    write(browser, "#words", "jump o")
    expect(problems, "no text of the model is offered", wait(
        browser, "[...document.querySelectorAll('#prompts option')].slice(0, 3).some((o) => o.value.startsWith('jump o'))",
        10))
    press(browser, CONTROL, "z")


def drop(browser, path):
    """Drops a file on the page."""
    data = list(path.read_bytes())
    browser.run(f"""const data = new DataTransfer();
      data.items.add(new File([new Uint8Array({json.dumps(data)})], {json.dumps(path.name)}));
      window.dispatchEvent(new DragEvent("drop", {{ dataTransfer: data, bubbles: true, cancelable: true }}));""")


def dropped(browser, folder, problems):
    """A BVH is kept in the timeline; a character shows the motion; files of neither kind are refused."""
    set_timeline(browser, "walk forward # 0 # 4\n")
    generate(browser)
    bvh = saved(browser, folder, ".bvh")
    kept = poses(browser)
    set_timeline(browser, "sit down # 0 # 6\n")
    browser.run("const s = document.getElementById('scrub'); s.value = 0; s.dispatchEvent(new Event('input'))")
    drop(browser, bvh)
    expect(problems, f"no bar of the file: {state(browser)['project']}",
           wait(browser, "motionlang.state().project.bars.some((b) => b.clip)", 20))
    clip = [b for b in state(browser)["project"]["bars"] if b.get("clip")][0]
    expect(problems, f"the file's bar: {clip}", clip["start"] == 0 and abs(clip["end"] - 4) < 0.06)
    generate(browser)
    now = poses(browser)
    apart = max(degrees(kept[f], now[f]) for f in range(10, 60))
    print(f"the dropped motion is kept within {apart:.2f} degrees")
    expect(problems, f"the dropped motion is not kept: {apart} degrees", len(now) == 120 and apart < 12)
    expect(problems, "the rest is not made", now[110] != now[79])
    click(browser, ".bar[data-bar='1']")
    browser.run("document.querySelector(\".bar[data-bar='1']\").focus()")
    press(browser, RIGHT)
    expect(problems, "it does not move", [b for b in state(browser)["project"]["bars"] if b.get("clip")][0]["start"] == 0.1)
    press(browser, CONTROL, "z")

    drop(browser, folder / "character.vrm")
    expect(problems, "no character: " + browser.run("return document.getElementById('status').textContent"),
           wait(browser, "motionlang.state().character === 'character.vrm' && motionlang.state().mesh > 0", 30))
    with_body = state(browser)
    expect(problems, f"{with_body['mesh']} vertices", with_body["mesh"] >= 3 and with_body["frames"] == 120)
    picture(browser, "character")
    glb = saved(browser, folder, ".glb")
    length, kind = struct.unpack("<II", glb.read_bytes()[12:20])
    document = json.loads(glb.read_bytes()[20:20 + length])
    expect(problems, "the character is not in the saved file", kind == 0x4E4F534A and "meshes" in document and
           len(document["animations"]) >= 1)
    click(browser, "#plain")
    expect(problems, "the character stays", wait(browser, "!motionlang.state().character && !motionlang.state().mesh", 10))
    (folder / "broken.bvh").write_text("HIERARCHY\nnothing", encoding="utf-8")
    before = state(browser)["project"]
    drop(browser, folder / "broken.bvh")
    expect(problems, "a broken file says nothing",
           wait(browser, "/broken.bvh/.test(document.getElementById('status').textContent)", 10))
    expect(problems, "a broken file changes the project", state(browser)["project"] == before)


def again(browser, page, problems):
    """The next visit shows the same motion, which an edit had kept in part, without making it again."""
    set_timeline(browser, LONG)
    click(browser, "#keep")
    click(browser, "#keep")
    generate(browser)
    click(browser, ".bar[data-bar='1']")
    write(browser, "#words", "clap")
    generate(browser)
    before = poses(browser)
    browser.run("window.dispatchEvent(new Event('pagehide'))")
    wait(browser, "false", 1)
    browser.post("/url", {"url": page})
    expect(problems, "nothing after a reload", made(browser, 1))
    now = state(browser)
    reuse = now["takes"][now["shown"]]["reuse"]
    print(f"after a reload: shown {now['opened']:.1f} s after opening; reuse {reuse}")
    expect(problems, f"it is made again: {reuse}", reuse and reuse["work"] == 0)
    expect(problems, "the next visit has another motion", poses(browser) == before)


def main(driver_path, page, program, folder):
    folder, page = pathlib.Path(folder), pathlib.Path(page).resolve().as_uri()
    driver, port = start_driver(driver_path)
    problems, browser = [], None
    try:
        browser = Browser(port, [*WEBGL, "--window-size=1280,720"])
        browser.post("/goog/cdp/execute", {"cmd": "Browser.setDownloadBehavior",
                                           "params": {"behavior": "allow", "downloadPath": str(folder)}})
        browser.post("/url", {"url": page})
        expect(problems, "no first motion", made(browser, 1))
        click(browser, "#steps option[value='fast']")
        keeping(browser, problems)
        for steps in (cancelling, several, timelines, variations, looking, sizes, completion):
            steps(browser, problems)
        dropped(browser, folder, problems)
        again(browser, page, problems)
        problems += severe(browser)
    finally:
        if browser:
            browser.close()
        driver.terminate()
    print(f"edits in the studio: {'; '.join(problems) or 'passed'}")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
