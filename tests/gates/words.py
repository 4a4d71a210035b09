#!/usr/bin/env python3
"""Gate: no text of ours has a word or phrase of words.txt.

    python3 tests/gates/words.py [FILE ...]
"""
import pathlib
import re
import sys

from files import root, tracked

rules = []
for line in (root / "tests/gates" / "words.txt").read_text(encoding="utf-8").splitlines():
    if line and not line.startswith("#"):
        pattern, better = line.split("\t")
        rules.append((re.compile(pattern), better))

files = sys.argv[1:]
if not files:
    files = [root / name for name in tracked(
        "*.hpp", "*.ipp", "*.inc", "*.cpp", "*.h", "*.c", "*.md", "*.sh", "*.cmake", "*.txt", "*.py",
        "!single_include", "!tests/gates", "!tests/fuzz/corpus", "!tests/golden/cases")]

found = 0
for file in files:
    for number, line in enumerate(pathlib.Path(file).read_text(encoding="utf-8").splitlines(), 1):
        for pattern, better in rules:
            if match := pattern.search(line):
                print(f"{file}:{number}: '{match.group()}': write {better}")
                found += 1
if found:
    sys.exit(f"{found} phrases that readers stumble over")
print(f"{len(files)} files, {len(rules)} rules: nothing found")
