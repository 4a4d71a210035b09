#!/usr/bin/python3
"""Our programs and PyTorch in turns, in one run: for each work the median times and their ratio.

usage: run.py BUILD_FOLDER [--threads 2] [--rounds 3] [mdm_step mdm_ragged train_mdm fk smpl distilbert clip_text search search_faiss
                                                           tmr_encoder temos_decoder actor_decoder train_tmr]
Debian: python3-torch, libopenblas0-openmp, for search_faiss python3-faiss. torch runs with the settings that are fastest for it: all candidates are tried once.
"""
import argparse, collections, csv, io, os, pathlib, statistics, subprocess, sys

HERE = pathlib.Path(__file__).parent
OPENBLAS = "/usr/lib/x86_64-linux-gnu/openblas-openmp"
PROGRAM = {"fk": "bench_kinematics", "smpl": "bench_body", "distilbert": "bench_text", "clip_text": "bench_text",
           "search": "bench_search", "search_faiss": "bench_search", "tmr_encoder": "bench_vae", "temos_decoder": "bench_vae",
           "actor_decoder": "bench_vae", "train_tmr": "bench_vae"}  # all others: bench_denoiser
TARGET = {"mdm_step": 1.0, "train_mdm": 1.0, "fk": 0.1, "smpl": 0.3, "distilbert": 0.9, "clip_text": 0.9, "search": 0.6, "search_faiss": 1.1,
          "tmr_encoder": 0.75, "temos_decoder": 0.9, "actor_decoder": 0.9, "train_tmr": 0.7}


def rows(command, environment=None):
    out = subprocess.run(command, capture_output=True, text=True, env={**os.environ, **(environment or {})})
    if out.returncode:
        sys.exit(f"{' '.join(map(str, command))}: exit {out.returncode}\n{out.stderr[-2000:]}")
    return {(r[0], r[1], r[2]): float(r[5]) for r in csv.reader(io.StringIO(out.stdout)) if len(r) > 5}


def torch_rows(threads, works, environment):
    best = {}
    for (work, config, _), ms in rows(["/usr/bin/python3", "-W", "ignore", HERE / "peer_torch.py", threads, *works], environment).items():
        best[work, config] = min(ms, best.get((work, config), ms))
    return best


def fastest_environment(threads):
    base = {"LD_LIBRARY_PATH": OPENBLAS, "OMP_PROC_BIND": "close", "OMP_PLACES": "cores"}
    candidates = [{**base, "OPENBLAS_CORETYPE": core, "ATEN_CPU_CAPABILITY": vectors}
                  for core, vectors in (("Haswell", "avx2"), ("Zen", "avx2"), ("SkylakeX", "avx512"))]
    times = [(sum(torch_rows(threads, ["mdm_step"], c).values()), i) for i, c in enumerate(candidates)]
    return candidates[min(times)[1]]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--threads", default="2")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("works", nargs="*", default=[])
    a = parser.parse_intermixed_args()
    works = a.works or ["mdm_step", "mdm_ragged", "train_mdm", "fk", "smpl", "distilbert", "clip_text", "search", "search_faiss",
                        "tmr_encoder", "temos_decoder", "actor_decoder", "train_tmr"]
    environment = fastest_environment(a.threads)
    print("torch with", {k: v for k, v in environment.items() if k.startswith(("OPENBLAS_", "ATEN"))})
    ours, theirs = collections.defaultdict(list), collections.defaultdict(list)
    for _ in range(a.rounds):
        for work in works:
            for (name, config, _), ms in rows([a.build / "tests/bench" / PROGRAM.get(work, "bench_denoiser"), a.threads, work]).items():
                ours[name, config].append(ms)
            for key, ms in torch_rows(a.threads, [work], environment).items():
                theirs[key].append(ms)
    print(f"{'work':12} {'shape':48} {'ours ms':>9} {'torch ms':>9} {'ratio':>6}  target")
    for (work, config), mine in ours.items():
        peer = theirs.get((work, config))
        if peer is None:
            print(f"{work:12} {config:48} {statistics.median(mine):9.2f}")
            continue
        ratio = statistics.median(m / p for m, p in zip(mine, peer))
        target = f"<= {TARGET[work]}" if work in TARGET else ""
        print(f"{work:12} {config:48} {statistics.median(mine):9.2f} {statistics.median(peer):9.2f} {ratio:6.2f}  {target}")


main()
