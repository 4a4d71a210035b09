#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Checks examples/training/REPRODUCE.md against the tests of the program.

usage: reproduce.py [PAGE]
A check mark on that page says that a test runs the command before it. So every option and every setting (--set name=)
of such a command has to stand in a file of tests/program.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = ROOT / "examples/training/REPRODUCE.md"
MARKED = re.compile(r"`([^`]+)`\)? ?✓|^    (.+?) +# ✓", re.M)


def wanted(code):
    """The options and settings of a command."""
    for option in re.findall(r"(?<![\w-])--[a-z][a-z-]*", code):
        if option != "--set":
            yield option
    for setting in re.findall(r"--set ([a-z_.]+)=", code):
        yield setting + "="


def main():
    tests = "\n".join(p.read_text() for p in sorted((ROOT / "tests/program").glob("*.[ch]pp")))
    page = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else PAGE
    problems, commands = [], 0
    for found in MARKED.finditer(page.read_text()):
        code = found.group(1) or found.group(2)
        commands += 1
        for name in wanted(code):
            if name not in tests:
                problems.append(f"{page.name}: no test of the program has {name}, of `{code}`")
    for p in problems:
        print(p)
    print(f"{commands} marked commands: {len(problems)} problems")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
