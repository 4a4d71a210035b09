#!/usr/bin/env python3
"""Gate: no text of ours has a word or phrase of words.txt, and no message of the library has an option of the program.

A third column of words.txt limits a rule to some files: it is a regular expression that their paths have to match.

    python3 tests/gates/words.py [FILE ...]
"""
import pathlib
import re
import sys

from files import root, tracked

rules = []
for line in (root / "tests/gates" / "words.txt").read_text(encoding="utf-8").splitlines():
    if line and not line.startswith("#"):
        pattern, better, paths = (line.split("\t") + [""])[:3]
        rules.append((re.compile(pattern), better, re.compile(paths)))

files = [pathlib.Path(name).resolve() for name in sys.argv[1:]]
if not files:
    files = [root / name for name in tracked(
        "*.hpp", "*.ipp", "*.inc", "*.cpp", "*.h", "*.c", "*.md", "*.sh", "*.cmake", "*.txt", "*.py",
        "!single_include", "!tests/gates", "!tests/fuzz/corpus", "!tests/golden/cases")]

option = re.compile(r'"[^"]*(?<![-\w])--[a-z][^"]*"')  # the library writes `text_encoder`, the program --text-encoder
marker = re.compile(r"^\s*(///?|\*|#)?\s*")
found = 0
for file in files:
    lines = file.read_text(encoding="utf-8").splitlines()
    path = file.relative_to(root).as_posix()
    rules_here = [(pattern, better) for pattern, better, paths in rules if paths.search(path)]
    is_library = "include/motionlang" in str(file) and not re.search("(viewer|studio)_page", str(file))  # they have CSS
    for number, line in enumerate(lines, 1):
        if is_library and option.search(line.split("// ")[0]):
            print(f"{file}:{number}: an option of the program: write the field that it sets, in backticks")
            found += 1
        begin = line.rstrip() + " "
        rest = marker.sub("", lines[number]) if number < len(lines) else ""  # a phrase may go on in the next line
        for pattern, better in rules_here:
            match = pattern.search(begin + rest)
            if match and match.start() == marker.match(line).end() and number > 1:  # the line before may allow it: "there"
                before = lines[number - 2].rstrip() + " "
                match = match if pattern.match(before + (begin + rest)[match.start():], len(before)) else None
            if match and match.start() < len(begin):
                print(f"{file}:{number}: '{match.group()}': write {better}")
                found += 1
if found:
    sys.exit(f"{found} phrases that readers stumble over")
print(f"{len(files)} files, {len(rules)} rules: nothing found")
