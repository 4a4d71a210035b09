#!/usr/bin/env python3
"""Counts the instructions of five kernels and compares with those of counts.json.

usage: count.py PROGRAM COMPILER MAJOR [--renew]

PROGRAM   instruction_counts, built by this project
COMPILER  GNU or Clang, and MAJOR its version: each has counts of its own. Where there are none, nothing is compared (exit 77)
--renew   writes what is counted into counts.json
Exit 0: all within 3 %. Exit 1: one is not.
"""
import json, os, pathlib, re, subprocess, sys, tempfile

KERNELS = ["gemm", "attention", "layer_norm", "gelu", "forward_kinematics"]
TOLERANCE = 0.03
SKIPPED = 77
FILE = pathlib.Path(__file__).with_name("counts.json")


def count(program, kernel):
    with tempfile.TemporaryDirectory() as folder:
        command = ["valgrind", "--tool=callgrind", f"--callgrind-out-file={folder}/out", "--toggle-collect=counted", program, kernel]
        out = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "MOTIONLANG_KERNELS": "avx2"})
        if out.returncode:
            sys.exit(f"{kernel}: exit {out.returncode}\n{out.stderr[-2000:]}")
        return int(re.search(r"^(?:totals|summary): (\d+)", pathlib.Path(folder, "out").read_text(), re.M)[1])


def main():
    arguments = [a for a in sys.argv[1:] if a != "--renew"]
    if len(arguments) != 3:
        sys.exit(__doc__)
    program, compiler = arguments[0], f"{arguments[1]}-{arguments[2]}"
    known = json.loads(FILE.read_text()) if FILE.exists() else {}
    renew = "--renew" in sys.argv
    if compiler not in known and not renew:
        print(f"{FILE.name} has no counts of {compiler}, only of {', '.join(sorted(known))}: nothing to compare with. To add them: --renew")
        sys.exit(SKIPPED)
    counts = {kernel: count(program, kernel) for kernel in KERNELS}
    if renew:
        known[compiler] = counts
        FILE.write_text(json.dumps(dict(sorted(known.items())), indent=1) + "\n")
    wrong = 0
    for kernel in KERNELS:
        before, now = known[compiler][kernel], counts[kernel]
        good = abs(now - before) <= TOLERANCE * before
        wrong += not good
        verdict = "" if good else "  more than 3 %: slower" if now > before else "  more than 3 %: faster, renew the counts"
        print(f"{kernel:20} {now:12} instructions, {before:12} before, {100 * (now / before - 1):+6.2f} %{verdict}")
    sys.exit(1 if wrong else 0)


main()
