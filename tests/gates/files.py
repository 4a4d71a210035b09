"""The files of the repository: those that git does not ignore; in a copy without git, all except build/.

    python3 tests/gates/files.py        prints the sources of C and C++, except what is generated or broken on purpose
"""
import fnmatch
import pathlib
import subprocess

root = pathlib.Path(__file__).resolve().parents[2]


def tracked(*patterns):
    """Names from the root. A pattern is a shell's, of the name or of a path's end; `!` in front leaves out what begins so."""
    listed = subprocess.run(["git", "ls-files", "--cached", "--others", "--exclude-standard"], cwd=root, capture_output=True,
                            text=True)
    names = [name for name in listed.stdout.splitlines() if (root / name).exists()] or [
        str(path.relative_to(root)) for path in sorted(root.rglob("*")) if path.is_file()]
    left_out = tuple(p[1:] for p in patterns if p.startswith("!")) + ("build/", ".git/")
    wanted = [p for p in patterns if not p.startswith("!")] or ["*"]
    found = [n for n in names if not n.startswith(left_out) and any(fnmatch.fnmatch(n, p) for p in wanted)]
    if len(found) < 100:
        raise SystemExit(f"only {len(found)} files found in {root}")
    return found


if __name__ == "__main__":
    print(*tracked("*.hpp", "*.ipp", "*.inc", "*.cpp", "*.h", "*.c", "!single_include", "!tests/gates/broken"), sep="\n")
