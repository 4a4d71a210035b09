#!/usr/bin/env python3
"""Gate: every file of ours that a comment or a page names exists, and every heading to which a page links.

A name counts as ours if it is a link of a page, begins with a folder of the repository, is a header (*.hpp, *.ipp,
*.inc) or a page (*.md). It is looked for from the root, from include/ and include/motionlang/, and beside the file that
names it. A name without a folder may be anywhere. Lines with #include are the compiler's business. links_others.txt
lists the files of other projects.

    python3 tests/gates/links.py [FILE ...]
"""
import pathlib
import re
import sys

from files import root, tracked

known = set(tracked())
known |= {str(parent) for name in known for parent in pathlib.PurePath(name).parents}
basenames = {pathlib.PurePath(name).name for name in known}
others = {line for line in (root / "tests/gates/links_others.txt").read_text(encoding="utf-8").splitlines() if line and line[0] != "#"}

folders = r"(?:include|examples|tests|single_include|\.ci|\.github)"
word = re.compile(rf"(?<![\w./*-])((?:{folders}/[\w./-]*[\w])|(?:[\w][\w./-]*\.(?:hpp|ipp|inc|md)))(?![\w*/-])")
page_link = re.compile(r"\]\(([^)#\s]*)(?:#([^)]*))?\)")


def headings(page):
    """The anchors of a page, as GitHub makes them of its headings."""
    lines = re.findall(r"^#+ +(.*)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", line.lower()).replace(" ", "-") for line in lines}


def exists(name, beside):
    name = name.rstrip("./")
    if name in others or ("/" not in name and name in basenames):
        return True
    places = [root, root / "include", root / "include/motionlang", beside]
    for place in places:
        path = (place / name).resolve()
        if path.is_relative_to(root) and str(path.relative_to(root)) in known:
            return True
    return False


files = [pathlib.Path(name).resolve() for name in sys.argv[1:]]
if not files:
    files = [root / name for name in tracked(
        "*.hpp", "*.ipp", "*.inc", "*.cpp", "*.h", "*.c", "*.md", "*.sh", "*.cmake", "*CMakeLists.txt", "*.py",
        "!single_include", "!tests/gates", "!tests/fuzz/corpus")]
missing = checked = 0
for file in files:
    page = file.suffix == ".md"
    whole = page or file.suffix == ".py"  # strings of Python are comments, too
    for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), 1):
        if not whole:
            comment = re.search(r"//|/\*|^\s*\*|#(?!include|if|define|undef|elif|else|endif|pragma|error)", line)
            if comment is None:
                continue
            line = line[comment.start():]
        names = word.findall(line)
        if page:
            for name, heading in page_link.findall(line):
                target = (file.parent / name).resolve() if name else file
                if "://" not in name and name:
                    names.append(name)
                if heading and target.suffix == ".md" and target.is_file() and heading not in headings(target):
                    print(f"{file}:{number}: {target.name} has no heading #{heading}")
                    missing += 1
        for name in names:
            checked += 1
            if not exists(name, file.parent):
                print(f"{file}:{number}: there is no {name}")
                missing += 1
if missing:
    sys.exit(f"{missing} names of files or headings that do not exist")
print(f"{checked} names of files in {len(files)} files: all exist")
