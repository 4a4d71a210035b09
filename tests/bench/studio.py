#!/usr/bin/env python3
"""Measures the studio's page in headless Chromium beside the program, by hand.

    studio.py <studio.html> <program motionlang> <the page's model> [rounds]

The page and the program make the README's timeline in turns, each on one thread. The program has its portable kernels.
Seconds of processor are those of the page's process and of the program, which other programs hardly change; seconds of
the clock show what a person waits. The program's start is left out: a run with one step is subtracted. Bars, for a quiet
machine: 0.5 s for a second of motion with 20 steps of DDPM, 0.25 s with 10 of DDIM, 3 times the program, and 4 s from
opening the page to its first motion.
"""
import os
import pathlib
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "browser"))
from studio_test import ENTER, click, made, state, write  # noqa: E402
from viewer_test import WEBGL, Browser, start_driver  # noqa: E402

SAMPLERS = {"20 steps of DDPM": ("usual", "ddpm", 20, 0.5),
            "10 steps of DDIM": ("fast", "ddim", 10, 0.25)}


def renderer_seconds():
    """Processor seconds of every page's process below this one, by its id."""
    parents, kinds = {}, {}
    for place in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            stat = (place / "stat").read_text().rsplit(")", 1)[1].split()
            line = (place / "cmdline").read_text()
        except OSError:
            continue
        parents[int(place.name)] = int(stat[1])
        if "--type=renderer" in line:
            kinds[int(place.name)] = (int(stat[11]) + int(stat[12])) / os.sysconf("SC_CLK_TCK")

    def is_below(process):
        while process in parents:
            process = parents[process]
            if process == os.getpid():
                return True
        return False

    return {process: seconds for process, seconds in kinds.items() if is_below(process)}


def page_run(browser, kind, seed):
    """Seconds of the clock and of the processor that the page needs for a motion."""
    click(browser, f"#steps option[value='{kind}']")
    write(browser, "#seed", f"{seed}" + ENTER)
    if state(browser)["playing"]:
        click(browser, "#play")  # drawing costs time as well
    count, before = state(browser)["motions"], renderer_seconds()
    click(browser, "#whole")
    made(browser, count + 1)
    after = renderer_seconds()
    return state(browser)["took"], max(after[process] - before.get(process, 0) for process in after)


def program_run(program, model, timeline, folder, sampler, steps):
    """Processor seconds of the program."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([program, "generate", "--timeline", timeline, "--model", model, "--threads", "1", "--out", folder,
                    "--sampler", sampler, "--steps", f"{steps}"], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                   env={**os.environ, "MOTIONLANG_KERNELS": "portable"})
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main(page, program, model, rounds="3"):
    page = pathlib.Path(page).resolve().as_uri()
    driver, port = start_driver(shutil.which("chromedriver"))
    with tempfile.TemporaryDirectory() as folder:
        try:
            opened = []
            for _ in range(2):  # the second time the system has the file in memory
                browser = Browser(port, [*WEBGL, "--window-size=1280,720"])
                browser.post("/url", {"url": page})
                made(browser, 1)
                now = state(browser)
                opened.append((now["opened"], max(renderer_seconds().values())))
                if len(opened) == 1:
                    browser.close()
            seconds, frames = now["project"]["seconds"], now["frames"]
            timeline = pathlib.Path(folder, "timeline.txt")
            timeline.write_text(now["timeline"], encoding="utf-8")
            print(f"{seconds} s of motion, {frames} frames; load {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors")
            print("first motion, the page opened twice: " + " and ".join(
                f"{clock:.1f} s of the clock after opening, {spent:.1f} s of processor" for clock, spent in opened) +
                " (bar 4)")
            for name, (kind, sampler, steps, bar) in SAMPLERS.items():
                ours, clocks, theirs = [], [], []
                for i in range(int(rounds)):
                    clock, spent = page_run(browser, kind, 100 + i)
                    one, whole = (program_run(program, model, str(timeline), folder + "/out", sampler, n)
                                  for n in (1, steps))
                    ours.append(spent)
                    clocks.append(clock)
                    theirs.append((whole - one) * steps / (steps - 1))
                mine, other = statistics.median(ours), statistics.median(theirs)
                print(f"{name}: page {mine / seconds:.2f} s of processor and {statistics.median(clocks) / seconds:.2f} s "
                      f"of the clock for a second of motion (bar {bar}); program {other / seconds:.2f} s of processor; "
                      f"ratio {mine / other:.2f} (bar 3); load {os.getloadavg()[0]:.1f}")
            browser.close()
        finally:
            driver.terminate()


if __name__ == "__main__":
    if len(sys.argv) not in (4, 5):
        sys.exit(__doc__)
    main(*sys.argv[1:])
