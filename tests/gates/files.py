"""The files of the repository: those that git knows; in a copy without git, all but build/."""
import fnmatch
import pathlib
import subprocess

root = pathlib.Path(__file__).resolve().parents[2]


def tracked(*patterns):
    """Names from the root. A pattern is a shell's, of the name or of a path's end; `!` in front leaves out what begins so."""
    listed = subprocess.run(["git", "ls-files"], cwd=root, capture_output=True, text=True)
    names = listed.stdout.splitlines() or [
        str(path.relative_to(root)) for path in sorted(root.rglob("*")) if path.is_file()]
    left_out = tuple(p[1:] for p in patterns if p.startswith("!")) + ("build/", ".git/")
    wanted = [p for p in patterns if not p.startswith("!")] or ["*"]
    return [n for n in names if not n.startswith(left_out) and any(fnmatch.fnmatch(n, p) for p in wanted)]
