#!/usr/bin/env python3
"""Opens the pages of the gallery and of studies in Chromium, and uses them as a reader and a rater do.

    pages_test.py <chromedriver> <folder>

The folder has gallery.html, pairs.html, ranking.html and rating.html, as make_page.cpp writes them. Exit status: 0
passed, 1 failed.
"""
import pathlib
import sys
import time

from viewer_test import WEBGL, start_driver, use_page


def wait(browser, condition, seconds=20):
    """True as soon as a JavaScript condition holds."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if browser.run(f"return !!({condition})"):
            return True
        time.sleep(0.1)
    return False


def gallery(browser):
    problems = []
    if not wait(browser, "motionlang.state().drawn >= 2"):
        problems.append("no cards are drawn")
    browser.run("document.getElementById('play').getAttribute('aria-pressed') === 'true' || "
                "document.getElementById('play').click()")
    before = browser.run("return motionlang.state().times[0]")
    if not wait(browser, f"motionlang.state().times[0] !== {before}"):
        problems.append("the first card does not move")
    browser.run("document.getElementById('play').click()")
    if browser.run("return motionlang.state().playing"):
        problems.append("it does not pause")
    browser.run("const f = document.getElementById('find'); f.value = 'TURN'; f.dispatchEvent(new Event('input'))")
    shown = browser.run("return motionlang.state().shown")
    if shown != ["turn"]:
        problems.append(f"'turn' finds {shown}")
    colours = browser.run(
        "const c = [...document.querySelectorAll('.card')].find((e) => !e.hidden).querySelector('canvas');"
        "const p = c.getContext('2d').getImageData(0, 0, c.width, c.height).data, seen = new Set();"
        "for (let i = 0; i < p.length; i += 4) seen.add(p[i] + ' ' + p[i + 1] + ' ' + p[i + 2]); return seen.size")
    if colours < 20:
        problems.append(f"a card has {colours} colours")
    return problems


def click(browser, selector):
    browser.run(f"document.querySelector('{selector}').click()")


def pairs(browser):
    problems = []
    browser.run("document.getElementById('rater').value = 'Ann B'")
    click(browser, "#begin")
    if not wait(browser, "motionlang.state().time > 0"):
        problems.append("nothing moves")
    if not browser.run("return document.getElementById('next').disabled"):
        problems.append("an unanswered trial can be left")
    click(browser, "[data-place=\"1\"]")
    click(browser, "#next")
    click(browser, "[data-place=\"0\"]")
    click(browser, "#back")
    click(browser, "[data-place=\"-1\"]")  # changes the first answer to no preference
    click(browser, "#next")
    if browser.run("return document.getElementById('next').disabled"):
        problems.append("the second answer is lost")
    while browser.run("return motionlang.state().trial") >= 0:
        click(browser, "[data-place=\"0\"]")
        click(browser, "#next")
    lines = browser.run("return document.getElementById('answers').value").splitlines()
    trials = browser.run("return motionlang.state().trials")
    head = [line.split("\t")[0] for line in lines[:5]]
    if head != ["study", "kind", "seed", "rater", "trial"] or lines[3] != "rater\tAnn B":
        problems.append(f"the file begins {lines[:5]}")
    answers = [line.split("\t")[1] for line in lines[5:]]
    if answers != ["-"] + ["0"] * (trials - 1):
        problems.append(f"answers {answers}")
    browser.run("HTMLAnchorElement.prototype.click = function () { window.downloaded = [this.download, this.href]; }")
    click(browser, "#save")
    if browser.run("return downloaded[0]") != "answers_Ann_B.tsv":
        problems.append("the file is not saved")
    return problems


def ranking(browser):
    click(browser, "#begin")
    count = browser.run("return document.querySelectorAll('[data-place]').length")
    problems = [] if count == 3 else [f"{count} texts"]
    click(browser, "[data-place=\"2\"]")
    click(browser, "[data-place=\"0\"]")  # the third is the rest
    label = browser.run("return document.querySelector('[data-place=\"1\"]').textContent")
    if not label.endswith("3"):
        problems.append(f"the last rank is '{label}'")
    click(browser, "[data-place=\"2\"]")  # taken back
    if not browser.run("return document.getElementById('next').disabled"):
        problems.append("an incomplete ranking can be left")
    click(browser, "[data-place=\"2\"]")
    answer = browser.run("return motionlang.state().file").splitlines()[5].split("\t")[1]
    return problems + ([] if answer == "0,1,2" else [f"ranking {answer}"])


def rating(browser):
    click(browser, "#begin")
    browser.run("dispatchEvent(new KeyboardEvent('keydown', { key: '4', bubbles: true }))"
                " || document.body.dispatchEvent(new KeyboardEvent('keydown', { key: '4', bubbles: true }))")
    answer = browser.run("return motionlang.state().file").splitlines()[5:]
    return [] if answer and answer[0].split("\t")[1] == "4" else [f"rating {answer}"]


def use(port, page, steps, renderer, flags):
    return use_page(port, page, f"{page.name}, ", steps, renderer, flags)


def main(driver_path, folder):
    folder = pathlib.Path(folder)
    driver, port = start_driver(driver_path)
    try:
        passed = [use(port, folder / f"{steps.__name__}.html", steps, "webgl2", WEBGL)
                  for steps in (gallery, pairs, ranking, rating)]
        passed.append(use(port, folder / "gallery.html", gallery, "canvas", ["--disable-3d-apis"]))
    finally:
        driver.terminate()
    return 0 if all(passed) else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
