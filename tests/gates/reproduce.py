#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Checks examples/training/REPRODUCE.md against the tests of the program.

usage: reproduce.py [PAGE]
A check mark on that page says that a test runs what stands before it in its cell, back to the mark before. So one file
of tests/program (with the headers that it includes) has to have the command and every option of it, as strings or in a
line of the shell, and every setting (--set name=). What has no command itself belongs to the one before it in the cell.
Settings without one are of a training, options without one of any command.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = ROOT / "examples/training/REPRODUCE.md"
OPTIONS = ROOT / "examples/motionlang/OPTIONS.md"


def files_of_tests():
    """The sources of the program's tests, each with the headers beside it that it includes."""
    folder = ROOT / "tests/program"
    headers = {p.name: p.read_text() for p in folder.glob("*.hpp")}

    def whole(text, known):
        for name in re.findall(r'#include "([a-z_]+\.hpp)"', text):
            if name in headers and name not in known:
                known.add(name)
                text += whole(headers[name], known)
        return text

    tests = {p.name: whole(p.read_text(), set()) for p in sorted(folder.glob("*.cpp"))}
    tests["bandai.cpp"] += (ROOT / "examples/training/bandai_all.sh").read_text()  # which it runs
    return list(tests.values())


def commands():
    return set(re.findall(r"^  ([a-z][a-z0-9-]+) ", OPTIONS.read_text().split("Commands:")[1].split("```")[0], re.M))


def marked(page):
    """Lists of codes, one for each mark: what stands before the list in its cell, and the list itself."""
    for line in page.splitlines():
        if line.startswith("    ") and line.rstrip().endswith("# ✓"):
            yield [], [line.strip().split("  ")[0].rstrip("# ✓").strip()]
        for cell in re.split(r"(?<!\\)\|", line) if line.startswith("|") else []:
            before, codes = [], []
            for found in re.finditer(r"`([^`]+)`|✓", cell):
                if found.group(1):
                    codes.append(found.group(1))
                    continue
                yield before, codes
                before, codes = before + codes, []


def command_of(code, known):
    """The command of a code, or None."""
    words = code.split()
    if "motionlang" in words:
        words = words[words.index("motionlang") + 1:]
    return words[0] if words and words[0] in known else None


def wanted(code):
    """The strings of a test that runs a command: options and settings."""
    for option in re.findall(r"(?<![\w-])--[a-z][a-z-]*", code):
        if option != "--set":
            yield option
    for setting in re.findall(r"--set ([a-z_.]+)=|^([a-z_]+\.[a-z_.]+)(?:=|$)", code):
        yield "".join(setting) + "="


def has(test, name):
    """If a test has an option, whole, or a setting."""
    return re.search(rf'["\s]{name}["\s]', test) if name.startswith("--") else name in test


def main():
    tests, known = files_of_tests(), commands()
    page = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else PAGE
    problems, marks = [], 0
    for before, codes in marked(page.read_text()):
        marks += 1
        if not codes:
            problems.append(f"{page.name}: a mark without a command before it")
        command = next(filter(None, (command_of(c, known) for c in reversed(before))), None)
        for code in codes:
            command = command_of(code, known) or (None if code.startswith("--set ") else command)
            start = f'"{command}"' if command else '"' if code.startswith("--") and "--set " not in code else '"train'
            here = [t for t in tests if start in t or (command and f"motionlang {command} " in t)]
            if not here:
                problems.append(f"{page.name}: no test of the program runs {command}, of `{code}`")
            names = list(wanted(code))
            if here and not any(all(has(t, name) for name in names) for t in here):
                problems.append(f"{page.name}: no test of the program has {' and '.join(names)} with {start}, of `{code}`")
    if marks == 0:
        problems.append(f"{page.name}: no marks")
    for p in problems:
        print(p)
    print(f"{marks} marks: {len(problems)} problems")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
