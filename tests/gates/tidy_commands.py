#!/usr/bin/env python3
"""Writes what clang-tidy needs into BUILD/gate and prints the units that it shall look at.

    python3 tests/gates/tidy_commands.py BUILD FILE ...

BUILD was configured with clang and without unity builds. compile_commands.json: its commands without precompiled headers;
headers.cpp: a unit that includes the headers among the files; headers.txt: an expression for their paths. Sources that no
target of BUILD compiles (examples of mistakes, other systems) are reported and left out.
"""
import json
import pathlib
import re
import shlex
import sys

build = pathlib.Path(sys.argv[1]).resolve()
root = pathlib.Path.cwd()
files = [pathlib.Path(name) for name in sys.argv[2:]]
folder = build / "gate"


def options(command):
    """Without `-Xclang -include-pch -Xclang FILE` and the like."""
    words = shlex.split(command)
    for name in ("-include-pch", "-include"):
        while name in words:
            at = words.index(name)
            first, last = at - (words[at - 1] == "-Xclang"), at + 1 + (words[at + 1] == "-Xclang")
            del words[first:last + 1]
    return [word for word in words if word != "-Winvalid-pch"]


commands = {}
for entry in json.loads((build / "compile_commands.json").read_text()):
    commands.setdefault(entry["file"], {"directory": entry["directory"], "file": entry["file"], "arguments": options(entry["command"])})
like = commands[str(root / "tests/compile/two_units/first.cpp")]  # it takes all from the headers


def as_the_like(unit):
    arguments = [unit if word == like["file"] else word for word in like["arguments"]]
    commands[unit] = {"directory": like["directory"], "file": unit, "arguments": arguments}


headers = {name.with_suffix(".hpp") for name in files if name.parts[0] == "include" and name.suffix in (".hpp", ".ipp")}
headers = sorted(name for name in headers if name.exists())
units = [str((root / name).resolve()) for name in files if name.suffix == ".cpp"]
for unit in list(units):
    if unit not in commands and "tests/gates/broken" in unit:
        as_the_like(unit)
    elif unit not in commands:
        print(f"clang-tidy: no target compiles {unit}, left out", file=sys.stderr)
        units.remove(unit)
if headers:
    unit = str(folder / "headers.cpp")
    (folder / "headers.cpp").write_text("".join(f"#include <{name.relative_to('include')}>\n" for name in headers))
    as_the_like(unit)
    units.insert(0, unit)
(folder / "compile_commands.json").write_text(json.dumps(list(commands.values())))
paths = [re.escape(str(name.with_suffix(""))) + r"\.(hpp|ipp)" for name in headers]
(folder / "headers.txt").write_text("(" + "|".join(paths or ["none"]) + ")$")
print(*units, sep="\n", end="\n" if units else "")
