#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Compiles the usage examples in the comments of the headers.

    python3 usage.py INCLUDE OUT COMPILER [FLAGS ...]

An example is a block of lines `///     code` (five blanks) of which one ends with ; or { before its trailing comment.
Other such blocks are formulas and tables. Example n of a header becomes a file in OUT, `<folder>/<name>.<n>.inc`. A unit
beside this script includes it in a function whose parameters are what the example takes for granted. An example that no
unit includes is an error, and one that is included but is not there. All units are compiled as one, which reads every
header once, with the flags and -fsyntax-only; the compiler names the line of the header.
"""
import pathlib
import re
import subprocess
import sys

BLOCK = re.compile(r"\s*///     (.*)")
NAME = re.compile(r'#include "([\w/]+\.\d+\.inc)"')


def examples(text):
    """The first line's number and the lines of each example."""
    block, first = [], 0
    for number, line in enumerate(text.split("\n") + [""], 1):
        found = BLOCK.fullmatch(line)
        if found and (block or not found.group(1).startswith(" ")):
            if not block:
                first = number
            block.append(found.group(1))
        elif block:
            code = (re.sub(r"\s*//.*", "", b).rstrip() for b in block)
            if any(c.endswith((";", "{")) for c in code):
                yield first, block
            block = []


def write_examples(include, out):
    names = set()
    for header in sorted((include / "motionlang").rglob("*.hpp")):
        for n, (line, block) in enumerate(examples(header.read_text()), 1):
            name = f"{header.relative_to(include / 'motionlang').with_suffix('')}.{n}.inc"
            names.add(name)
            path = out / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(f'#line {line} "{header}"\n' + "\n".join(block) + "\n")
    return names


def main():
    include, out, compiler = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3:]
    here = pathlib.Path(__file__).parent
    names = write_examples(include, out)
    units = sorted(here.glob("*.cpp"))
    used = [name for unit in units for name in NAME.findall(unit.read_text())]
    problems = [f"{n}: no unit of tests/compile/usage includes this example" for n in sorted(names - set(used))]
    problems += [f"{n}: there is no such example" for n in sorted(set(used) - names)]
    together = out / "all.cpp"
    together.write_text("".join(f'#include "{unit}"\n' for unit in units))
    command = [*compiler, "-DMOTIONLANG_INSTANTIATED", f"-I{out}", f"-I{here}", "-fsyntax-only", str(together)]
    if subprocess.run(command).returncode != 0:
        problems.append("the units do not compile")
    print("\n".join(problems) if problems else f"{len(names)} examples compile")
    return 1 if problems or not names else 0


if __name__ == "__main__":
    sys.exit(main())
