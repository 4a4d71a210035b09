#!/usr/bin/env python3
"""What leaves the studio and comes back: projects as files, pictures, videos; and the examples to start from.

    studio_share_test.py <chromedriver> <studio.html> <folder>

The folder gets the files that are saved. Exit status: 0 passed, 1 failed.
"""
import base64
import json
import pathlib
import struct
import sys
import time

from pages_test import wait
from studio_edit_test import bars_of, drop, generate, picture, poses, set_timeline
from studio_test import CONTROL, ENTER, MADE, click, drag, expect, made, press, saved, state, write
from viewer_test import WEBGL, Browser, severe, start_driver


def status(browser):
    return browser.run("return document.getElementById('status').textContent")


def open_page(port, page, folder, flags=()):
    """A browser that has never been on the page, which makes motions in ten steps."""
    browser = Browser(port, [*WEBGL, "--window-size=1280,720", *flags])
    browser.post("/goog/cdp/execute", {"cmd": "Browser.setDownloadBehavior",
                                       "params": {"behavior": "allow", "downloadPath": str(folder)}})
    browser.post("/url", {"url": page})
    made(browser, 1)
    return browser


def new_file(folder, before, kind, seconds=60):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        for path in set(folder.iterdir()) - before:
            if path.suffix == kind:
                return path
        time.sleep(0.1)
    raise RuntimeError(f"no {kind} was saved")


def make_project(browser, folder, problems):
    """Three timelines, one with a locked variation and one with a kept motion, and settings. The files of both."""
    click(browser, "#steps option[value='fast']")
    set_timeline(browser, "walk forward # 0 # 2\n")
    generate(browser)
    kept = saved(browser, folder, ".bvh")
    browser.run("document.getElementById('view').focus()")
    press(browser, "v")
    wait(browser, "motionlang.state().takes.length === 4 && !motionlang.state().making", 2 * MADE)
    press(browser, "3")
    press(browser, "k")
    click(browser, "#fresh")
    made(browser, 6)
    click(browser, ".bar[data-bar='0']")
    write(browser, "#words", "sit down")
    write(browser, "#seed", "12345678901" + ENTER)
    generate(browser)
    click(browser, "#fresh")
    made(browser, 8)
    browser.run("const s = document.getElementById('scrub'); s.value = 0; s.dispatchEvent(new Event('input'))")
    drop(browser, kept)
    wait(browser, "motionlang.state().project.bars.some((b) => b.clip)", 20)
    generate(browser)
    click(browser, "#snap")
    click(browser, "#keep")
    before = set(folder.iterdir())
    click(browser, "#saveProject")
    project = new_file(folder, before, ".json")
    whole = state(browser)["whole"]
    expect(problems, "the file is not the project", json.loads(project.read_text(encoding="utf-8")) == whole)
    expect(problems, f"it lacks something: {whole}", len(whole["timelines"]) == 3 and whole["shown"] == 2 and
           whole["settings"] == {"keep": False, "live": False, "snap": False} and
           len(whole["timelines"][0]["locked"]) == 1 and whole["timelines"][1]["seed"] == 12345678901 and
           whole["kept"] == [kept.name] and whole["timelines"][2]["bars"][1]["clip"].startswith(f"clip {kept.name} "))
    return project, kept, whole, poses(browser)


def restored(browser, project, kept, whole, motion, problems):
    """Another browser has the same project after the file is dropped, and the same motion after the kept one is."""
    empty = state(browser)["whole"]
    drop(browser, project)
    expect(problems, "the project is not opened: " + status(browser),
           wait(browser, "motionlang.state().timelines === 3", 10))
    now = state(browser)
    expect(problems, f"the project is another:\n{now['whole']}\n{whole}", now["whole"] == whole)
    expect(problems, "the settings are not shown", browser.run(
        "return ['keep', 'live', 'snap'].map((id) => document.getElementById(id).getAttribute('aria-pressed'))") ==
        ["false"] * 3)
    expect(problems, "it does not ask for the kept file: " + status(browser),
           wait(browser, f"document.getElementById('status').textContent.includes({json.dumps(kept.name)})", 10))
    wait(browser, "!motionlang.state().making", MADE)
    drop(browser, kept)
    expect(problems, "no motion after the kept file: " + status(browser), wait(
        browser, "!motionlang.state().stale && !motionlang.state().making", MADE))
    expect(problems, "the kept file changed the project", state(browser)["whole"] == whole)
    expect(problems, "its motion is another", poses(browser) == motion)

    click(browser, "#sheet option[value='0']")
    expect(problems, "no motion of the first timeline", wait(
        browser, "!motionlang.state().stale && !motionlang.state().making && motionlang.state().frames === 40", MADE))
    locked = whole["timelines"][0]["locked"][0]
    expect(problems, "the locked seed is not the one that is shown", state(browser)["project"]["seed"] == locked)
    expect(problems, "it is not locked again", [t["seed"] for t in state(browser)["takes"] if t["locked"]] == [locked])
    press(browser, CONTROL, "z")
    expect(problems, f"undo does not bring back what was here: {state(browser)['whole']}", wait(
        browser, "motionlang.state().timelines === 1", 5) and
        state(browser)["whole"]["timelines"] == empty["timelines"])
    browser.post("/refresh", {})
    expect(problems, "a reload loses it", wait(browser, "window.motionlang && motionlang.state().motions > 0", MADE) and
           state(browser)["whole"]["timelines"] == empty["timelines"])


def trimmed(browser, folder, kept, problems):
    """A clip of 134 / 30 s survives the next visit after its start was dragged to its end."""
    head, frames = kept.read_text(encoding="utf-8").split("MOTION\n")
    lines = frames.splitlines()[2:]
    clip = folder / "thirds.bvh"  # 134 frames of 1/30 s: 4.466667 s, and its bar ends at 4.467 s
    clip.write_text(head + "MOTION\nFrames: 134\nFrame Time: 0.03333333\n" + "\n".join((lines * 4)[:134]) + "\n",
                    encoding="utf-8")
    set_timeline(browser, "walk forward # 0 # 6\n")
    browser.run("if (motionlang.state().playing) document.getElementById('play').click();"
                "const s = document.getElementById('scrub'); s.value = 0; s.dispatchEvent(new Event('input'))")
    drop(browser, clip)
    expect(problems, "the clip is not kept: " + status(browser), wait(
        browser, "motionlang.state().project.bars.some((b) => b.clip)", 20))
    bar = state(browser)["project"]["bars"][1]
    expect(problems, f"the bar of the clip: {bar}", bar["start"] == 0 and bar["end"] == 4.467 and
           abs(bar["whole"] - 134 / 30) < 1e-5)
    width = browser.run("return document.getElementById('lanes').clientWidth")
    drag(browser, ".bar.clip .grip.from", round(4.6 / 6 * width))
    time.sleep(1)  # until it is stored
    before = state(browser)["whole"]
    bar = before["timelines"][0]["bars"][1]
    expect(problems, f"its start is not at its end: {bar}", bar["start"] == 4.217 and bar["from"] > 4.2)
    browser.post("/refresh", {})
    expect(problems, "a clip loses the project", wait(
        browser, "window.motionlang && motionlang.state().motions > 0", MADE) and state(browser)["whole"] == before)


def largest(browser, folder, whole, problems):
    """A project of more than 3 MB is within the bounds, and so is a clip as earlier studios stored it."""
    copy = json.loads(json.dumps(whole))
    clip = copy["timelines"][2]["bars"][1]
    clip.update({"start": 4.217, "end": 4.467, "from": 4.217, "whole": 4.466667})
    copy["timelines"][2]["seconds"] = 6
    text = {"text": "walk forward " * 8, "start": 0, "end": 1, "parts": ["left arm", "right arm"]}
    copy["timelines"] += [{"bars": [text] * 200, "seconds": 1, "seed": 1, "fast": True}] * 97
    copy["shown"] = 0
    path = folder / "largest.json"
    path.write_text(json.dumps(copy), encoding="utf-8")
    expect(problems, f"it has only {path.stat().st_size} bytes", path.stat().st_size > 3_000_000)
    drop(browser, path)
    expect(problems, "it is not opened: " + status(browser), wait(browser, "motionlang.state().timelines === 100", 20))
    bar = state(browser)["whole"]["timelines"][2]["bars"][1]
    expect(problems, f"its clip: {bar}", bar["end"] == 4.467 and abs(bar["from"] - 4.216667) < 1e-9)
    wait(browser, "!motionlang.state().stale && !motionlang.state().making", MADE)
    press(browser, CONTROL, "z")
    expect(problems, "undo does not bring back what was here", wait(browser, "motionlang.state().timelines < 100", 20))


def broken(browser, folder, whole, problems):
    """Each broken file says where it is broken, and changes nothing."""
    def changed(change):
        copy = json.loads(json.dumps(whole))
        change(copy)
        return json.dumps(copy)

    def put(*path):
        *way, last, value = path

        def change(copy):
            for key in way:
                copy = copy[key]
            copy[last] = value
        return changed(change)

    words = json.dumps(whole)
    cases = {"cut": (words[:len(words) // 2], "not JSON"), "empty": ("", "not JSON"), "list": ("[]", "not a project"),
             "other": ('{"motionlang":"timeline"}', "not a project"), "null": ("null", "not a project"),
             "later": (put("version", 2), "version is 2"), "none": (put("timelines", []), "0 timelines"),
             "many": (changed(lambda c: c["timelines"].extend(c["timelines"][:1] * 100)), "103 timelines"),
             "bars": (put("timelines", 0, "bars", None), "timeline 1: it has no list"),
             "bar": (put("timelines", 1, "bars", 0, None), "timeline 2: text 1"),
             "number": (put("timelines", 1, "bars", 0, "start", "0"), "timeline 2: text 1: its start"),
             "before": (put("timelines", 1, "bars", 0, "start", -1), "timeline 2: text 1: its start"),
             "beyond": (put("timelines", 1, "bars", 0, "end", 1e9), "timeline 2: text 1: its end"),
             "part": (put("timelines", 1, "bars", 0, "parts", ["tail"]), "unknown body parts"),
             "parts": (put("timelines", 1, "bars", 0, "parts", "legs"), "unknown body parts"),
             "long": (put("timelines", 1, "bars", 0, "text", "a" * 2000), "no words, or too many"),
             "texts": (put("timelines", 1, "bars", whole["timelines"][1]["bars"] * 300), "300 texts"),
             "seconds": (put("timelines", 2, "seconds", 1e300), "timeline 3: its length"),
             "seed": (put("timelines", 2, "seed", None), "timeline 3: its seed"),
             "lock": (put("timelines", 2, "locked", [1, 2, 3, 4, 5]), "locked seeds"),
             "clips": (changed(lambda c: c["timelines"][2]["bars"].append(c["timelines"][2]["bars"][1])), "several motions"),
             "whole": (put("timelines", 2, "bars", 1, "whole", "x"), "the length of its file"),
             "deep": ("[" * 100000, "not JSON")}
    before = state(browser)
    for name, (text, part) in cases.items():
        path = folder / f"broken_{name}.json"
        path.write_text(text, encoding="utf-8")
        drop(browser, path)
        expect(problems, f"{name}: '{status(browser)}' lacks '{part}'",
               wait(browser, f"document.getElementById('status').textContent.startsWith('{path.name}: ') && "
                    f"document.getElementById('status').textContent.includes({json.dumps(part)})", 10))
    now = state(browser)
    expect(problems, "a broken file changes the project", now["whole"] == before["whole"] and
           now["undos"] == before["undos"] and now["frames"] == before["frames"])
    path = folder / "evil.json"
    path.write_text(put("timelines", 1, "bars", 0, {"text": "<img src=x onerror=alert(1)>\n# 1", "start": 0, "end": 1,
                                                    "parts": [], "__proto__": {"polluted": 1}, "more": [1]}))
    drop(browser, path)
    wait(browser, "motionlang.state().timelines === 3", 10)
    bar = state(browser)["whole"]["timelines"][1]["bars"][0]
    expect(problems, f"it takes what does not belong there: {bar}", sorted(bar) == ["end", "parts", "start", "text"] and
           not browser.run("return document.querySelector('img') || ({}).polluted"))
    wait(browser, "/Drop .* again/.test(document.getElementById('status').textContent)", 20)
    photo = folder / "photo.jpg"
    photo.write_bytes(b"\xff\xd8\xff\xe0" + bytes(1000))
    drop(browser, photo)
    expect(problems, "a photo says nothing of what can be read: " + status(browser), wait(
        browser, "/photo.jpg: .*\\.bvh.*\\.json/.test(document.getElementById('status').textContent)", 10))


def unreadable(browser, problems):
    """A stored project that cannot be read is put aside, not lost."""
    browser.run("localStorage.setItem('motionlang studio', '{\"timelines\":7}'); Storage.prototype.setItem = () => {};")
    browser.post("/refresh", {})
    expect(problems, "no motion after a project that cannot be read",
           wait(browser, "window.motionlang && motionlang.state().motions > 0", MADE))
    expect(problems, "a project that cannot be read is lost", browser.run(
        "return localStorage.getItem('motionlang studio, not read')") == '{"timelines":7}')


def elements(data, begin=0, end=None, ids=()):
    """The ids of the elements of an EBML file in order, into its segment, clusters and groups."""
    def number(at, keep):
        width = 9 - data[at].bit_length()
        value = int.from_bytes(data[at:at + width], "big")
        mask = (1 << 7 * width) - 1
        return at + width, value if keep else (None if value & mask == mask else value & mask)

    end = len(data) if end is None else end
    at = begin
    while at < end:
        at, name = number(at, True)
        at, size = number(at, False)
        yield name, data[at:at + (size if size is not None else 0)]
        if name not in (0x18538067, 0x1F43B675, 0xA0, 0x1549A966):
            at += size


def pictures(browser, folder, problems):
    """A PNG of twice the size of the view, and a WebM as long as the motion."""
    set_timeline(browser, "walk forward # 0 # 3\n")
    generate(browser)
    size = browser.run("const v = document.getElementById('view'); return [v.clientWidth, v.clientHeight]")
    png = saved(browser, folder, ".png").read_bytes()
    wide, high = struct.unpack(">II", png[16:24])
    print(f"a picture of {wide} x {high} in {len(png)} bytes")
    expect(problems, "the picture is not a PNG", png.startswith(b"\x89PNG\r\n\x1a\n") and png.endswith(b"IEND\xaeB`\x82"))
    expect(problems, f"{wide} x {high} for a view of {size}", [wide, high] == [2 * n for n in size])
    expect(problems, f"the picture is empty: {len(png)} bytes", len(png) > 10000)

    before, files = state(browser), set(folder.iterdir())
    click(browser, "#kind option[value='.webm']")
    click(browser, "#save")
    expect(problems, "no progress of the video", wait(
        browser, "document.getElementById('progress').value > 0.1 && "
        "/of 3.0 s/.test(document.getElementById('left').textContent)", 20))
    picture(browser, "recording")
    expect(problems, "one can generate while it is recorded",
           browser.run("return document.getElementById('generate').disabled"))
    video = new_file(folder, files, ".webm")
    after = state(browser)
    expect(problems, "it plays otherwise than before", wait(browser, "!motionlang.state().making", 5) and
           (after["speed"], after["playing"]) == (before["speed"], before["playing"]))
    data = video.read_bytes()
    names = [name for name, _ in elements(data)]
    frames = names.count(0xA3) + names.count(0xA1)
    print(f"a video of {frames} frames in {len(data)} bytes: {status(browser)}")
    expect(problems, "the video is not a WebM", data.startswith(b"\x1aE\xdf\xa3") and b"webm" in data[:64])
    expect(problems, f"{frames} frames", frames >= 10)

    gif = moving(browser, folder, problems)
    click(browser, "#kind option[value='.webm']")
    files = set(folder.iterdir())
    click(browser, "#save")
    wait(browser, "document.getElementById('progress').value > 0.1", 20)
    click(browser, "#cancel")
    expect(problems, "the recording is not cancelled: " + status(browser), wait(
        browser, "!motionlang.state().making && document.getElementById('status').textContent === 'Cancelled.'", 5))
    time.sleep(1)
    expect(problems, "a cancelled video is saved", set(folder.iterdir()) == files)
    expect(problems, "a cancelled video ends the model", state(browser)["frames"] == before["frames"] and
           generate(browser))
    return video, gif


GIF = """const [data, done] = [Uint8Array.from(atob(arguments[0]), (c) => c.charCodeAt(0)), arguments[1]];
(async () => {
  const out = { apart: [] };
  const decoder = new ImageDecoder({ data, type: "image/gif" }), canvas = document.createElement("canvas");
  await decoder.completed;
  await decoder.tracks.ready;
  out.frames = decoder.tracks.selectedTrack.frameCount;
  const first = (await decoder.decode()).image, width = first.displayWidth, height = first.displayHeight;
  first.close();
  Object.assign(canvas, { width, height });
  Object.assign(out, { width, height });
  const context = canvas.getContext("2d"), view = document.getElementById("view");
  for (const frameIndex of [0, Math.floor(out.frames / 2), out.frames - 1]) {
    const { image: frame } = await decoder.decode({ frameIndex, completeFramesOnly: true });
    out.delay = frame.duration;
    context.drawImage(frame, 0, 0);
    const made = context.getImageData(0, 0, width, height).data, usual = quality;
    quality = 1;
    seek(frameIndex * frame.duration / 1e6);
    frame.close();
    render();
    context.drawImage(view, 0, 0, width, height);
    quality = usual;
    const shown = context.getImageData(0, 0, width, height).data;
    let sum = 0;
    for (let i = 0; i < made.length; ++i) sum += Math.abs(made[i] - shown[i]);
    out.apart.push(sum / made.length);
  }
  decoder.close();
  done(out);
})().catch((reason) => done({ wrong: String(reason) }));"""


def moving(browser, folder, problems):
    """A GIF of 20 pictures a second, which the browser reads, and which are those of the view."""
    files = set(folder.iterdir())
    click(browser, "#kind option[value='.gif']")
    click(browser, "#save")
    gif = new_file(folder, files, ".gif", MADE)
    wait(browser, "!motionlang.state().making", 20)
    data = gif.read_bytes()
    # that script uses the page's own names, which are not members of window
    browser.run("document.body.append(Object.assign(document.createElement('script'), { textContent: "
                + json.dumps("window.readGif = function () {" + GIF + "}") + " }))")
    seen = browser.post("/execute/async", {"script": "readGif(arguments[0], arguments[1])",
                                           "args": [base64.b64encode(data).decode()]})
    print(f"a GIF of {len(data)} bytes: {seen}; {status(browser)}")
    expect(problems, f"the GIF: {seen}", data.startswith(b"GIF89a") and seen.get("frames") == 60 and
           seen["delay"] == 50000 and 300 < seen["width"] <= 480)
    expect(problems, f"its pictures are others: {seen}", max(seen.get("apart") or [99]) < 4)
    return gif


def watched(browser, video, problems):
    """The browser plays it, with its length and frames that differ."""
    browser.post("/url", {"url": video.resolve().as_uri()})
    film = "document.querySelector('video')"
    expect(problems, "the video does not load", wait(browser, f"{film} && {film}.readyState >= 2", 20))
    wide, high, seconds = browser.run(f"return [{film}.videoWidth, {film}.videoHeight, {film}.duration]")
    print(f"the browser plays {wide} x {high}, {seconds} s")
    expect(problems, f"a video of {wide} x {high}, {seconds} s", wide > 300 and high > 100 and 2.8 < seconds < 4)
    browser.run(f"{film}.muted = true; {film}.play(); return 1")
    expect(problems, "it does not play to its end", wait(browser, f"{film}.ended || {film}.currentTime > 2.5", 20))
    shown = browser.run(f"return {film}.getVideoPlaybackQuality().totalVideoFrames")
    expect(problems, f"{shown} frames are shown", shown >= 10)


def examples(browser, problems):
    """Each example opens with a click, is what the model knows, gives a motion, and undo takes it back."""
    set_timeline(browser, "walk forward # 0 # 2.5\n")
    generate(browser)
    own = state(browser)
    names = browser.run("return [...document.getElementById('examples').options].slice(1).map((o) => o.text)")
    expect(problems, f"{len(names)} examples", 8 <= len(names) <= 12 and len(set(names)) == len(names))
    for i, name in enumerate(names):
        before = state(browser)["motions"]
        click(browser, f"#examples option[value='{i}']")
        expect(problems, f"{name}: no motion", made(browser, before + 1))
        now = state(browser)
        expect(problems, f"{name}: {now['frames']} frames of {now['project']['seconds']} s",
               not now["stale"] and abs(now["frames"] - 20 * now["project"]["seconds"]) <= 1)
        expect(problems, f"{name}: {now['timelines']} timelines", now["timelines"] == own["timelines"] + 1)
        wait(browser, "false", 0.6)  # until it is checked
        wait(browser, "!motionlang.state().making", MADE)
        expect(problems, f"{name}: {state(browser)['warnings']}", state(browser)["warnings"] == [])
        picture(browser, f"example{i}")
    for _ in names:
        press(browser, CONTROL, "z")
    expect(problems, "undo does not bring back the own timeline", wait(
        browser, f"motionlang.state().timelines === {own['timelines']} && !motionlang.state().stale", 10) and
        bars_of(browser) == [("walk forward", 0, 2.5)])


def main(driver_path, page, folder):
    folder, page = pathlib.Path(folder), pathlib.Path(page).resolve().as_uri()
    driver, port = start_driver(driver_path)
    problems, browser = [], None
    try:
        browser = open_page(port, page, folder)
        project, kept, whole, motion = make_project(browser, folder, problems)
        problems += severe(browser)
        browser.close()
        browser = open_page(port, page, folder)
        restored(browser, project, kept, whole, motion, problems)
        trimmed(browser, folder, kept, problems)
        largest(browser, folder, whole, problems)
        click(browser, "#steps option[value='fast']")
        video, gif = pictures(browser, folder, problems)
        examples(browser, problems)
        broken(browser, folder, whole, problems)
        unreadable(browser, problems)
        problems += severe(browser)
        watched(browser, video, problems)
        browser.post("/url", {"url": gif.resolve().as_uri()})
        expect(problems, "an image element does not take the GIF", browser.post("/execute/async", {"script":
            "const done = arguments[0]; document.images[0].decode().then(() => done(true), () => done(false))",
            "args": []}))
    finally:
        if browser:
            browser.close()
        driver.terminate()
    print(f"what leaves the studio and comes back: {'; '.join(problems) or 'passed'}")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
