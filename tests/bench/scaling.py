#!/usr/bin/env python3
"""How training scales over processes: measured on this machine, and a model of more.

    cmake --build build/release --target bench_scaling
    python3 tests/bench/scaling.py build/release                       # measures here, and writes both tables
    python3 tests/bench/scaling.py build/release --latency 2e-6 --bandwidth 12e9     # measures, with another network
    python3 tests/bench/scaling.py --assume tmr 0.25 0.05 16.1e6 32 --latency 50e-6 --bandwidth 1.1e9      # no measuring

The model of a step of p processes, for P parts of a batch:

    step(p)  = ceil(P / p) c + u + messages(p)
    c, u     seconds of a part, and of the optimiser. u is assumed, not measured: as long as a part's gradients take to
             be added, which is the difference of one process with P and with P / 2 parts. c is what is left of a step
             in one process, so there the model fits by construction, and the table has no error
    halves   2 r l + 2 (p - 1) / p G / b + (p - 1) / p G / a,  r = log2 p: if p and P are powers of two, p <= P
    tree     r (l + G / b) to rank 0, adding G / a each time, and r (l + G / b) back,  r = ceil(log2 p): else
    ring     2 (p - 1) (l + G / (p b)) + (p - 1) / p G / a: another order of sums, so not the same bits
    l, b     latency and bandwidth; G bytes of all gradients; a: bytes that are added in a second
    hidden   what an overlap with the backward pass could hide at most: the first half of the messages, as far as the
             backward pass of the last part (two thirds of c) is as long. The other half needs the sums

Where there are more processes than cores, c grows by their ratio. With --wire bf16, G is half as large.
"""

import argparse
import math
import os
import pathlib
import subprocess
import sys

WORKS = {"tmr": (32, 4), "mdm_smpl": (16, 2)}  # samples of a batch and of a part: eight parts


def rows_of(text):
    """Lines of names and numbers after a first word."""
    for line in text.splitlines():
        words = line.split()
        if len(words) > 2:
            yield words[0], {k: float(v) for k, v in zip(words[1::2], words[2::2])}


class Model:
    def __init__(self, part, rest, parts, gradient, latency, bandwidth, adding, cores):
        self.part, self.rest, self.parts, self.gradient = part, rest, parts, gradient
        self.latency, self.bandwidth, self.adding, self.cores = latency, bandwidth, adding, cores

    def messages(self, p, kind, parts=None):
        parts = parts or self.parts
        if p == 1:
            return 0.0
        g = self.gradient
        if kind == "ring":
            return 2 * (p - 1) * (self.latency + g / (p * self.bandwidth)) + (p - 1) / p * g / self.adding
        if kind == "halves" and p <= parts and p & (p - 1) == 0 and parts & (parts - 1) == 0:
            return (p - 1) / p * (2 * g / self.bandwidth + g / self.adding) + 2 * math.log2(p) * self.latency
        return math.ceil(math.log2(p)) * (2 * (self.latency + g / self.bandwidth) + g / self.adding)

    def hidden(self, p):
        if p == 1:
            return 0.0
        first = (p - 1) / p * (self.gradient / self.bandwidth + self.gradient / self.adding) + math.log2(p) * self.latency
        return min(first, 2 / 3 * self.part)

    def step(self, p, kind, parts=None):
        crowd = max(1.0, p / self.cores)
        return crowd * (math.ceil((parts or self.parts) / p) * self.part + self.rest) + self.messages(p, kind, parts)


def model_rows(work, model):
    """Strong scaling of a batch of P parts, and weak scaling: as many parts for each process."""
    print("| %s, ranks | batch | halves: step, share of messages, speed | tree | ring | hidden by an overlap |" % work)
    print("| --- | --- | --- | --- | --- | --- |")
    one = model.step(1, "tree")
    for p in (1, 2, 4, 8, 64, 512):
        for parts, name in ((model.parts, "%d parts" % model.parts), (model.parts * p, "%d parts for each" % model.parts)):
            if p == 1 and parts == model.parts * p and name.endswith("each"):
                continue
            columns = []
            for kind in ("halves", "tree", "ring"):
                t = model.step(p, kind, parts)
                columns.append("%.0f ms, %.1f %%, %.2f x" % (1000 * t, 100 * model.messages(p, kind, parts) / t,
                                                             one * parts / model.parts / t))
            if p <= parts:
                columns.append("%.1f %%" % (100 * model.hidden(p) / model.step(p, "halves", parts)))
            else:
                columns.append("")
            print("| %d | %s | %s |" % (p, name, " | ".join(columns)))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", nargs="?", help="folder of the build; none with --assume")
    parser.add_argument("--assume", nargs=5, metavar=("NAME", "PART", "REST", "PARAMETERS", "PARTS"),
                        help="the model alone, for these seconds c and u")
    parser.add_argument("--works", nargs="*", default=list(WORKS))
    parser.add_argument("--steps", type=int, default=3, help="steps of a turn")
    parser.add_argument("--rounds", type=int, default=3, help="turns of each row; the table has the medians")
    parser.add_argument("--mpirun", default="mpirun")
    parser.add_argument("--latency", type=float, help="seconds; the default is measured between two processes here")
    parser.add_argument("--bandwidth", type=float, help="bytes per second, likewise")
    parser.add_argument("--adding", type=float, default=4e9, help="bytes of gradients added in a second")
    parser.add_argument("--cores", type=int, default=len(os.sched_getaffinity(0)))
    o = parser.parse_args()
    if o.assume:
        if o.latency is None or o.bandwidth is None:
            sys.exit("--assume needs --latency and --bandwidth")
        name, (part, rest, parameters, parts) = o.assume[0], map(float, o.assume[1:])
        model_rows(name, Model(part, rest, int(parts), 4 * parameters, o.latency, o.bandwidth, o.adding, 1 << 30))
        return
    if o.build is None:
        sys.exit("the folder of the build is missing")
    program = str(pathlib.Path(o.build, "tests", "bench", "bench_scaling"))
    environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                       OMPI_MCA_rmaps_base_oversubscribe="1")

    def run(ranks, words, bound=True):
        line = [program] + [str(w) for w in words]
        if ranks > 1:
            here = ["--bind-to", "core"] if bound and ranks <= o.cores else ["--bind-to", "none"]
            line = [o.mpirun, "-n", str(ranks)] + here + line
        done = subprocess.run(line, capture_output=True, text=True, env=environment)
        if done.returncode != 0:
            sys.exit("%s\n%s%s" % (" ".join(line), done.stdout, done.stderr))
        return dict(list(rows_of(done.stdout))[-1][1], text=done.stdout)

    latency, bandwidth = o.latency, o.bandwidth
    if latency is None or bandwidth is None:
        times = {r["bytes"]: r["us"] * 1e-6 for _, r in rows_of(run(2, ["messages"])["text"])}
        large = max(times)
        print("messages between two processes here: %s" % ", ".join("%d bytes %.1f us" % (b, 1e6 * t)
                                                                    for b, t in times.items()))
        latency = latency or times[8]
        bandwidth = bandwidth or large / (times[large] - times[8])
    print("latency %.2g s, bandwidth %.3g bytes/s\n" % (latency, bandwidth))

    for work in o.works:
        batch, micro = WORKS[work]
        # Ranks, threads of each, samples of a part: 0 means that the batch is not divided.
        cases = [(1, 2, 0), (1, 2, micro), (2, 1, micro), (1, 1, micro), (1, 1, 2 * micro), (4, 1, micro)]
        found = {case: [] for case in cases}
        for _ in range(o.rounds):  # in turns, so that all see the same machine
            for ranks, threads, m in cases:
                found[ranks, threads, m].append(run(ranks, [work, threads, o.steps, batch, m]))
        median = {}
        print("| %s, batch %d | threads of each | part | step ms | in messages ms | share | MB sent in a step |"
              % (work, batch))
        print("| --- | --- | --- | --- | --- | --- | --- |")
        for case, turns in found.items():
            turns.sort(key=lambda r: r["step_ms"])
            row = median[case] = turns[len(turns) // 2]
            print("| %d processes | %d | %d | %.0f | %.0f | %.1f %% | %.1f |" %
                  (*case, row["step_ms"], row["messages_ms"], 100 * row["messages_ms"] / row["step_ms"],
                   row["sent_mb"]))
        parts = batch // micro
        ms = {case: row["step_ms"] / 1000 for case, row in median.items()}
        print("\ntwo processes of one thread have %.3f of the speed of one process of two threads "
              "(%.3f of one that does not divide the batch)\n" %
              (ms[1, 2, micro] / ms[2, 1, micro], ms[1, 2, 0] / ms[2, 1, micro]))
        # Twice as large parts are half as many, with the same samples: the difference is what a part costs beside them.
        beside = max(0.0, (ms[1, 1, micro] - ms[1, 1, 2 * micro]) / (parts / 2))
        row = median[1, 1, micro]
        gradient = 4 * row["parameters"]
        update = beside  # assumed: one pass over all parameters, like the sums of a part
        model = Model((ms[1, 1, micro] - update) / parts, update, parts, gradient, latency, bandwidth, o.adding, o.cores)
        print("| %s: model against measured | step | model | error |\n| --- | --- | --- | --- |" % work)
        for p in (1, 2, 4):
            real, said = ms[p, 1, micro], model.step(p, "halves")
            error = "%+.0f %%" % (100 * (said / real - 1)) if p > 1 else "fitted"
            print("| %d processes | %.0f ms | %.0f ms | %s |" % (p, 1000 * real, 1000 * said, error))
        print()
        far = Model(model.part, model.rest, parts, gradient, latency, bandwidth, o.adding, 1 << 30)
        model_rows(work, far)
        print()


if __name__ == "__main__":
    main()
