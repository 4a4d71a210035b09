#!/usr/bin/env python3
"""Searches motions by words in the studio's page, without a server.

    studio_search_test.py <chromedriver> <studio.html> <folder>

The folder gets the motions that are searched. Exit status: 0 passed, 1 failed.
"""
import pathlib
import sys
import time

from pages_test import wait
from studio_edit_test import command, degrees, generate, picture, poses, set_timeline
from studio_share_test import open_page, status
from studio_test import ENTER, click, expect, made, saved, state, type_into
from viewer_test import severe, start_driver

MOVES = {"walk.bvh": "walk forward", "jump.bvh": "jump forward", "arms.bvh": "raise both arms"}


def says(browser):
    return browser.run("return document.getElementById('findSays').textContent")


def found(browser):
    """The paths of what was found, best first."""
    lines = browser.run("return [...document.querySelectorAll('#found li button')].map((e) => "
                        "e.getAttribute('aria-label').slice(5))")
    return [line.split(", ")[0] for line in lines]


def ask(browser, words, seconds=120):
    """Searches, and waits for the answer."""
    browser.run("document.getElementById('sought').value = ''; document.getElementById('found').replaceChildren();"
                "document.getElementById('findSays').textContent = ''")
    type_into(browser, "#sought", words + ENTER)
    wait(browser, r"/^(The nearest|Nothing shows|There is no)|[.]bvh:|error/.test("
                  "document.getElementById('findSays').textContent)", seconds)
    return found(browser)


def make_motions(browser, folder):
    """A folder with three BVH files of the page, one of them in a folder below, and files of other kinds."""
    clips = folder / "clips"
    (clips / "more").mkdir(parents=True)
    click(browser, "#steps option[value='fast']")
    for name, words in MOVES.items():
        set_timeline(browser, f"{words} # 0 # 3\n")
        generate(browser)
        place = clips / "more" / name if name == "jump.bvh" else clips / name
        saved(browser, folder, ".bvh").rename(place)
    (clips / "notes.dat").write_text("none of them", encoding="utf-8")
    (clips / "broken.bvh").write_text("HIERARCHY\nnothing", encoding="utf-8")
    return clips


def drop_folder(browser, paths):
    """Drops files and folders of the disk, as a person does."""
    data = {"items": [], "files": [str(p) for p in paths], "dragOperationsMask": 1}
    for kind in ("dragEnter", "dragOver", "drop"):
        command(browser, "Input.dispatchDragEvent", type=kind, x=400, y=300, data=data)


def searching(browser, folder, problems):
    """A dropped folder is found by words; a moment of it becomes a bar, whose frames are kept."""
    click(browser, "#find")
    expect(problems, f"it does not say where motions come from: {browser.run('return document.body.innerText')}", wait(
        browser, "/Drop a folder/.test(document.getElementById('findWhere').textContent) && "
        "document.getElementById('findHelp').hidden", 5))
    expect(problems, f"without motions it finds {ask(browser, 'walk')}: {says(browser)}",
           says(browser).startswith("There is no motion"))
    click(browser, "#findClose")

    drop_folder(browser, [folder])
    expect(problems, "a dropped folder does not open the search: " + status(browser), wait(
        browser, "document.getElementById('findDialog').open && "
        "/^4 files/.test(document.getElementById('findWhere').textContent)", 20))
    began = time.monotonic()
    first = {words: ask(browser, words) for words in ("a person walks forward", "a person jumps",
                                                      "a person raises both arms")}
    print(f"three searches and the reading of four files: {time.monotonic() - began:.1f} s; {first}")
    expect(problems, f"a broken file is not named: {says(browser)}", "1 file could not be read" in says(browser))
    for words, name in zip(first, ("clips/walk.bvh", "clips/more/jump.bvh", "clips/arms.bvh")):
        expect(problems, f"'{words}' finds {first[words][:3]}", first[words][:1] == [name])
    picture(browser, "found_here")
    began = time.monotonic()
    ask(browser, "a person jumps")
    print(f"a search of files that were read: {time.monotonic() - began:.2f} s")
    ask(browser, "a flibber eats glorp")
    expect(problems, f"a text that no clip shows: {says(browser)}", says(browser).startswith("Nothing shows this.") and
           "does not know: flibber, glorp." in says(browser))
    picture(browser, "nothing_shows")
    expect(problems, "the jump is not found again", ask(browser, "a person jumps")[:1] == ["clips/more/jump.bvh"])


def keeping(browser, problems):
    click(browser, "#findClose")
    set_timeline(browser, "sit down # 0 # 6\n")
    browser.run("if (motionlang.state().playing) document.getElementById('play').click();"
                "const s = document.getElementById('scrub'); s.value = 0; s.dispatchEvent(new Event('input'))")
    click(browser, "#find")
    ask(browser, "a person jumps")
    click(browser, "#found button")
    expect(problems, "what was found is not on the timeline: " + says(browser), wait(
        browser, "motionlang.state().project.bars.some((b) => b.clip && /^jump/.test(b.text)) && "
        "!document.getElementById('findDialog').open", 20))
    clip = [b for b in state(browser)["project"]["bars"] if b.get("clip")][0]
    expect(problems, f"the moment: {clip}", 0.9 < clip["end"] - clip["start"] < 3.1 and clip["start"] == 0 and
           clip["whole"] >= clip["from"] + clip["end"])
    generate(browser)
    now = poses(browser)
    seen = browser.run(
        "const b = motionlang.state().project.bars.find((one) => one.clip); return [b.start, b.end, b.from]")
    expect(problems, f"{len(now)} frames", len(now) == 120)
    picture(browser, "kept_found")
    return now, seen


def kept_frames(browser, folder, now, stretch, problems):
    """The frames of the bar are those of the file, whose motion the page shows alone."""
    start, end, _ = stretch
    click(browser, "#kind option[value='.bvh']")
    first, last = round(20 * start) + 4, round(20 * end) - 4
    set_timeline(browser, "jump forward # 0 # 3\n")  # the motion that the file has: same seed, same steps
    generate(browser)
    original = poses(browser)
    whole = len(original)
    apart = min(max(degrees(original[f + way], now[f]) for f in range(first, last))
                for way in range(-first, whole - last))
    print(f"frames {first} to {last} are those of the file within {apart:.1f} degrees")
    expect(problems, f"the found moment is not kept: {apart} degrees", apart < 12)


def several(browser, folder, problems):
    """Files that are dropped together, and files that are chosen, are searched; a motion of the project is, too."""
    drop_folder(browser, [folder / "walk.bvh", folder / "arms.bvh"])
    expect(problems, "two files are not searched: " + status(browser), wait(
        browser, "document.getElementById('findDialog').open", 10))
    expect(problems, "the walk is not found", ask(browser, "a person walks forward")[0].endswith("walk.bvh"))
    click(browser, "#findClose")
    browser.post("/refresh", {})
    made(browser, 1)
    set_timeline(browser, "sit down # 0 # 4\n")
    drop_folder(browser, [folder / "arms.bvh"])
    wait(browser, "motionlang.state().project.bars.some((b) => b.clip)", 20)
    click(browser, "#find")
    expect(problems, "the kept motions are not searched", wait(
        browser, "/keeps are searched/.test(document.getElementById('findWhere').textContent)", 5) and
        ask(browser, "a person raises both arms")[:1] == ["arms.bvh"])
    type_into(browser, "#searchFiles", str(folder / "more" / "jump.bvh"))
    expect(problems, "a chosen file is not searched", wait(
        browser, "/^1 file /.test(document.getElementById('findWhere').textContent)", 5) and
        ask(browser, "a person jumps")[:1] == ["jump.bvh"])
    click(browser, "#findClose")


def main(driver_path, page, folder):
    folder, page = pathlib.Path(folder), pathlib.Path(page).resolve().as_uri()
    driver, port = start_driver(driver_path)
    problems, browser = [], None
    try:
        browser = open_page(port, page, folder)
        clips = make_motions(browser, folder)
        searching(browser, clips, problems)
        now, stretch = keeping(browser, problems)
        kept_frames(browser, clips, now, stretch, problems)
        several(browser, clips, problems)
        problems += severe(browser)
    except Exception:
        print("; ".join(problems))
        raise
    finally:
        if browser:
            browser.close()
        driver.terminate()
    print(f"searches in the studio's page: {'; '.join(problems) or 'passed'}")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
