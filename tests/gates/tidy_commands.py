#!/usr/bin/env python3
"""Writes what clang-tidy needs into BUILD/tidy and prints the units that it shall look at.

    python3 tests/gates/tidy_commands.py BUILD FILE ...

compile_commands.json: that of BUILD without what only GCC knows, and without precompiled headers; headers.cpp: a unit
that includes the headers among the files; headers.txt: an expression for their paths.
"""
import json
import pathlib
import re
import shlex
import sys

build = pathlib.Path(sys.argv[1])
root = pathlib.Path.cwd()
files = [pathlib.Path(name) for name in sys.argv[2:]]
gcc_only = re.compile(r"--param=.*|-fpch-preprocess|-Winvalid-pch|-Wa,.*")


def options(command):
    words = shlex.split(command)
    kept = []
    skip = False
    for word in words:
        if skip:
            skip = False
        elif word == "-include":
            skip = True  # a precompiled header
        elif not gcc_only.fullmatch(word):
            kept.append(word)
    return kept


commands = {}
for entry in json.loads((build / "compile_commands.json").read_text()):
    words = options(entry["command"])
    commands.setdefault(entry["file"], {"directory": entry["directory"], "file": entry["file"], "arguments": words})

folder = build / "tidy"
headers = [name for name in files if name.suffix == ".hpp" and name.parts[0] == "include"]
units = [str((root / name).resolve()) for name in files if name.suffix == ".cpp"]
unknown = [name for name in units if name not in commands]
like = commands[str(root / "tests/compile/two_units/first.cpp")]  # a unit that takes all from the headers
if headers:
    unit = str(folder / "headers.cpp")
    (folder / "headers.cpp").write_text("".join(f"#include <{name.relative_to('include')}>\n" for name in headers))
    units.append(unit)
    unknown.append(unit)
for name in unknown:
    arguments = [name if word == like["file"] else word for word in like["arguments"]]
    commands[name] = {"directory": like["directory"], "file": name, "arguments": arguments}
(folder / "compile_commands.json").write_text(json.dumps(list(commands.values())))
paths = [re.escape(str(name.with_suffix(""))) for name in headers]
(folder / "headers.txt").write_text("(" + "|".join(paths or ["none"]) + r")\.(hpp|ipp)$")
print("\n".join(units))
