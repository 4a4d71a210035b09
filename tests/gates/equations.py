#!/usr/bin/env python3
"""Gate: every numbered equation of the papers is cited where it is computed, and include/motionlang/EQUATIONS.md says where.

    python3 tests/gates/equations.py [MAP]

Each of the 27 equations needs one row. Its file has to exist, to hold the function, and to cite the number within 40 lines of the
function's name. Golden cases and example have to exist. A number that no paper has must not be cited anywhere.
"""
import pathlib
import re
import sys

from files import root, tracked

numbers = {
    "thesis": ["4.1", "4.2", "4.3", "5.1", "6.1", "6.2", "6.3", "6.4", "6.5", "A.1", "A.2", "B.1"],
    "TM2T": [str(i) for i in range(1, 9)],
    "TEMOS": [str(i) for i in range(1, 7)],
    "TMR": ["1"],
}
wanted = [f"{text} eq. {number}" for text, all_of_it in numbers.items() for number in all_of_it]
near = 40  # lines

cited = re.compile(r"\b(thesis|TM2T|TEMOS|TMR) eqs?\. ([AB]?\.?\d[.\d]*)")
library = root / "include/motionlang"
path = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else library / "EQUATIONS.md"
problems = []


def lines_with(lines, expression):
    return [i for i, line in enumerate(lines) if re.search(expression, line)]


def check(equation, file, function, cases, example):
    source = library / file
    if not source.is_file():
        problems.append(f"{equation}: there is no {file}")
        return
    lines = source.read_text(encoding="utf-8").splitlines()
    named = lines_with(lines, rf"\b{re.escape(function)}\b")
    quoted = lines_with(lines, re.escape(equation) + r"(?![.\d]*\d)")
    if not named:
        problems.append(f"{equation}: {file} has no {function}")
    if not quoted:
        problems.append(f"{equation}: {file} does not cite it")
    if named and quoted and min(abs(a - b) for a in named for b in quoted) > near:
        problems.append(f"{equation}: {file} does not cite it near {function}")
    for case in cases.split(", "):
        if not (root / f"tests/golden/cases/{case}.safetensors").is_file():
            problems.append(f"{equation}: there is no golden case {case}")
    if example != "-" and not list((root / "examples" / example).glob("main.c*")):
        problems.append(f"{equation}: there is no example {example}")


rows = {}
for line in path.read_text(encoding="utf-8").splitlines():
    cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
    if len(cells) == 6 and cited.match(cells[0]):
        if cells[0] in rows:
            problems.append(f"{cells[0]}: has two rows")
        rows[cells[0]] = cells
for equation in wanted:
    if equation in rows:
        check(equation, *rows[equation][2:])
    else:
        problems.append(f"{equation}: has no row")
for equation in rows:
    if equation not in wanted:
        problems.append(f"{equation}: no paper has this number")

for name in tracked("include/*.hpp", "include/*.ipp", "include/*.h", "examples/*.cpp", "examples/*.hpp"):
    for number, line in enumerate((root / name).read_text(encoding="utf-8").splitlines(), 1):
        for text, digits in cited.findall(line):
            if digits.rstrip(".") not in numbers[text]:
                problems.append(f"{name}:{number}: {text} has no equation {digits.rstrip('.')}")

if problems:
    sys.exit("\n".join(problems) + f"\n{len(problems)} mistakes in {path}")
print(f"{len(wanted)} equations: each has a place that cites it and golden cases")
