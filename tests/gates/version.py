#!/usr/bin/env python3
"""Gate: every file that states the version states that of include/motionlang/version.hpp.

    python3 tests/gates/version.py [FOLDER]     # another folder instead of the repository
"""
import json
import pathlib
import re
import sys

from files import root

if len(sys.argv) > 1:
    root = pathlib.Path(sys.argv[1])


def found(name, pattern):
    match = re.search(pattern, (root / name).read_text(encoding="utf-8"), re.MULTILINE)
    return match.group(1) if match else None


header = "include/motionlang/version.hpp"
version = found(header, r'^#define MOTIONLANG_VERSION "(.+)"')
parts = [found(header, rf"^#define MOTIONLANG_VERSION_{part} (\d+)") or "?" for part in ("MAJOR", "MINOR", "PATCH")]
stated = {
    f"{header}, its three parts": ".".join(parts),
    "CITATION.cff": found("CITATION.cff", r"^version: (\S+)$"),
    "CHANGELOG.md, the first heading": found("CHANGELOG.md", r"\A(?:(?!^## )[\s\S])*^## ([\d.]+)"),
    "vcpkg.json": json.loads((root / "vcpkg.json").read_text(encoding="utf-8")).get("version"),
}
wrong = [f"{place}: {text}, not {version}" for place, text in stated.items() if text != version]
for name, pattern in [("CMakeLists.txt", r"(project\(motionlang VERSION \$\{version\})"),
                      ("conanfile.py", r"(self\.version = re\.search)")]:
    if found(name, pattern) is None:
        wrong.append(f"{name}: does not read the version from {header}")
if wrong:
    sys.exit("\n".join(wrong))
print(f"version {version} in {len(stated) + 2} files")
