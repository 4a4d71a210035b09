#!/usr/bin/env python3
"""Kills a random process of a training at a random moment, again and again, and lets the training go on.

    python3 tests/program/kill_processes.py build/ci/examples/motionlang --kills 100

The end must have the bits of a run in one process that nobody killed: losses, weights and moments. Each time the
number of processes is drawn anew, from 1, 2 and 4. After each kill all processes must end by themselves, and the
checkpoint must be whole and have no fewer steps than before. A training that ends before the last kill is
compared, too, and another one begins.
"""

import argparse
import json
import os
import pathlib
import random
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time

CAPTIONS = ["a person walks", "someone turns left", "someone walks", "a person jumps", "someone sits down"]
SMALL = """data.validation_share=0.2 data.test_share=0.2 optimiser.batch=4 optimiser.schedule=constant
validation.every=0 network.latent_dim=8 network.ff_size=8 network.num_layers=1 network.num_heads=2 text.width=8
text.vocabulary=60 data.mirror=false""".split()


def write_npy(path, values, shape):
    header = "{'descr': '<f4', 'fortran_order': False, 'shape': %s, }" % (tuple(shape),)
    header = header.ljust(117) + "\n"
    path.write_bytes(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header.encode()
                     + struct.pack("<%df" % len(values), *values))


def write_data(folder):
    """Motions of noise in the form of HumanML3D."""
    rng = random.Random(5)
    for sub in ("new_joint_vecs", "texts"):
        (folder / sub).mkdir(parents=True)
    ids = ["%06d" % i for i in range(12)]
    for i, name in enumerate(ids):
        frames = 40 + 3 * (i * 5 % 12)
        write_npy(folder / "new_joint_vecs" / (name + ".npy"), [rng.gauss(0, 1) for _ in range(frames * 263)],
                  (frames, 263))
        (folder / "texts" / (name + ".txt")).write_text(CAPTIONS[i % 5] + "#x/NOUN#0.0#0.0\n")
    (folder / "train.txt").write_text("\n".join(ids[:8]) + "\n")
    (folder / "val.txt").write_text("\n".join(ids[8:10]) + "\n")
    (folder / "test.txt").write_text("\n".join(ids[10:]) + "\n")


def steps_of(checkpoint):
    """Reads the whole file: a torn one is an error."""
    data = checkpoint.read_bytes()
    size = struct.unpack("<Q", data[:8])[0]
    tensors = json.loads(data[8:8 + size])
    end = max(t["data_offsets"][1] for name, t in tensors.items() if name != "__metadata__")
    if len(data) != 8 + size + end:
        sys.exit("%s is torn: it has %d bytes, its head names %d" % (checkpoint, len(data), 8 + size + end))
    return tensors["losses"]["shape"][0]


def children(pid):
    found = []
    for task in pathlib.Path("/proc/%d/task" % pid).glob("*/children"):
        try:
            found += [int(c) for c in task.read_text().split()]
        except OSError:
            pass
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--kills", type=int, default=5)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--mpirun", default="mpirun")
    parser.add_argument("--steps-each", type=int, default=60, help="steps of the training for each kill")
    o = parser.parse_args()
    rng = random.Random(o.seed)
    program = str(pathlib.Path(o.program).resolve())
    environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                       OMPI_MCA_rmaps_base_oversubscribe="1", OMPI_MCA_mpi_yield_when_idle="1",
                       PRTE_MCA_rmaps_default_mapping_policy=":oversubscribe")
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        write_data(folder / "data")

        def command(processes, out):
            line = [o.mpirun, "-n", str(processes)] if processes > 1 else []
            line += [program, "train-tmr", "--data", "data", "--splits", "data", "--preset", "small", "--threads", "1",
                     "--micro-batch", "1", "--save-minutes", "0.001", "--out", out]
            for setting in SMALL + ["optimiser.epochs=%d" % (o.kills * o.steps_each // 2)]:  # of two batches
                line += ["--set", setting]
            return line

        def finish(processes, out):
            done = subprocess.run(command(processes, out), cwd=folder, env=environment, capture_output=True, text=True)
            if done.returncode != 0:
                sys.exit("the run in %s ended with %d:\n%s%s" % (out, done.returncode, done.stdout, done.stderr))

        began = time.monotonic()
        finish(1, "whole")
        alone = time.monotonic() - began
        whole = (folder / "whole" / "checkpoint.safetensors").read_bytes()
        checkpoint = folder / "killed" / "checkpoint.safetensors"
        kills, trainings, steps, seen = 0, 0, 0, {}

        def compare():
            if checkpoint.read_bytes() != whole:
                sys.exit("training %d ended with OTHER BITS" % (trainings + 1))

        while kills < o.kills:
            processes = rng.choice([1, 2, 4])
            run = subprocess.Popen(command(processes, "killed"), cwd=folder, env=environment, start_new_session=True,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            # Some die before MPI has started, some in the middle of a step, some while the checkpoint is written.
            time.sleep(rng.uniform(0, 0.4) + rng.uniform(0, 1.6 * alone / o.kills))
            ranks = children(run.pid) if processes > 1 else [run.pid]
            if ranks and run.poll() is None:
                rank = rng.randrange(len(ranks))
                try:
                    os.kill(ranks[rank], signal.SIGKILL)
                    kills += 1
                    seen[processes] = seen.get(processes, 0) + 1
                except ProcessLookupError:
                    pass
            try:
                code = run.wait(timeout=60)
            except subprocess.TimeoutExpired:
                os.killpg(run.pid, signal.SIGKILL)
                sys.exit("a rank of %d was killed; the others still ran a minute later" % processes)
            if code == 0:  # the training was faster than the kills: another one follows
                compare()
                shutil.rmtree(folder / "killed")
                trainings, steps = trainings + 1, 0
                if trainings > 4 * o.kills:
                    sys.exit("%d trainings ended before a kill: more --steps-each are needed" % trainings)
                continue
            if checkpoint.exists():
                now = steps_of(checkpoint)
                if now < steps:
                    sys.exit("the checkpoint has %d steps after it had %d" % (now, steps))
                steps = now
        finish(1, "killed")
        compare()
        print("%d kills %s in %d trainings; all ended with the same bits; the last one had %d of %d steps when it was "
              "last killed" % (kills, ", ".join("%d in %d processes" % (n, p) for p, n in sorted(seen.items())),
                               trainings + 1, steps, steps_of(checkpoint)))


if __name__ == "__main__":
    main()
