#!/usr/bin/python3
"""Our programs and their peers in turns, in one run: the table of README.md.

usage: run.py BUILD_FOLDER [--threads 2] [--rounds 3 | --quick] [--python PYTHON] [--json FILE] [--svg FILE] [WORK ...]

BUILD_FOLDER  where `cmake --build ... --target bench` was done
--quick       one round instead of three
--python      the Python that has the peers torch and faiss (default /usr/bin/python3, which has Debian's packages)
WORK          only these rows of the table TABLE below
A peer that is not installed is left out, with the name of its package. torch runs with the settings that are fastest for it: all
candidates are tried once. Work by work, the rows are printed and written when all its rounds are done.
ONNX_FOLDER (default ~/.cache/motionlang-bench) is where `npm install onnxruntime-node` was done.
"""
import argparse, collections, csv, dataclasses, datetime, io, json, os, pathlib, platform, statistics, subprocess, sys
from xml.sax.saxutils import escape

HERE = pathlib.Path(__file__).resolve().parent
OPENBLAS = "/usr/lib/x86_64-linux-gnu/openblas-openmp"
ONNX_FOLDER = pathlib.Path(os.environ.get("ONNX_FOLDER", pathlib.Path.home() / ".cache/motionlang-bench"))

# Which program of ours does a work; bench_denoiser does those that are not listed.
PROGRAM = {"product": "products", "product_gelu": "products", "product_batched": "products", "xtensor": "xtensor",
           "tmr_encoder": "vae", "temos_decoder": "vae", "actor_decoder": "vae", "train_tmr": "vae", "train_tmr_memory": "vae",
           "distilbert": "text", "clip_text": "text", "fk": "kinematics", "smpl": "body", "search": "search", "search_bf16": "search",
           **dict.fromkeys(("motiondiffuse", "guo_evaluator", "tm2t_tokenizer", "train_tokenizer", "tm2t_write", "stgcn", "train_stgcn"), "networks"),
           "start": "generate", "stmc_full": "generate", "stmc_bundled": "generate"}
# How to install each peer. WORK_OF_PEER has the works that have another name there.
PACKAGE = {"torch": "Debian: python3-torch libopenblas0-openmp", "faiss": "Debian: python3-faiss",
           "onnx": f"npm install --ignore-scripts --prefix {ONNX_FOLDER} onnxruntime-node (and torch, which writes the models)",
           "onednn": "Debian: libdnnl-dev, before CMake; target bench_products_onednn", "native": "target bench_products_native"}
PINNED = {"OMP_PROC_BIND": "close", "OMP_PLACES": "cores"}
WORK_OF_PEER = {("search", "faiss"): "search_faiss", ("search_bf16", "faiss"): "search_faiss", ("search_bf16", "torch"): "search"}


@dataclasses.dataclass(frozen=True)
class Row:
    """A row of the table: "<= bar" bounds ours / peer (times, memory), ">= bar" the share of the peer's speed, or of the peak.
    A peer of None: the number itself is bounded. `config` is how the configurations begin that the row is about; "median": the median
    of all of them."""
    work: str
    config: str
    peer: str
    bar: str = ""          # empty: shown only
    precision: str = "fp32"
    peer_precision: str = ""  # empty: the same
    kernels: str = ""         # of ours (MOTIONLANG_KERNELS); empty: the best


def peaks(work, precision, each, median, kernels=""):
    rows = [Row(work, "", "peak", each, precision, kernels=kernels)]
    return rows + ([Row(work, "median", "peak", median, precision, kernels=kernels)] if median else [])


# The bars of products in bfloat16 are shares of the peak of vdpbf16ps. Where the best kernels are those of AMX, they are shown beside it.
PROCESSOR = pathlib.Path("/proc/cpuinfo")
HAS_AMX = PROCESSOR.exists() and "amx_bf16" in PROCESSOR.read_text().split()
PRODUCTS_BF16 = peaks("product", "bf16", ">= 0.90", ">= 0.94", "avx512_bf16" if HAS_AMX else "")
BF16X3 = []  # without AMX it is fp32
if HAS_AMX:
    PRODUCTS_BF16 += peaks("product", "bf16", "", "")
    BF16X3 += [Row(work, "", "peak", "", "bf16x3") for work in ("product", "product_gelu", "mdm_step")]
    BF16X3 += [Row(work, "", "torch", "", "bf16x3", "fp32") for work in ("mdm_step", "mdm_ragged", "tmr_encoder", "distilbert", "clip_text")]


TABLE = [
    *peaks("product", "fp32", ">= 0.90", ">= 0.95"), *PRODUCTS_BF16,
    Row("product", "", "native"), Row("product", "median", "native", ">= 0.97"),
    Row("product", "", "onednn"), Row("product", "median", "onednn"), Row("product", "", "onednn", "", "bf16", kernels="avx512_bf16" if HAS_AMX else ""),
    Row("product_gelu", "", "onednn"), Row("product_batched", "", "onednn"),
    *BF16X3,
    *peaks("product_gelu", "fp32", ">= 0.88", ""), *peaks("product_batched", "fp32", "", ""),
    Row("xtensor", "", "eigen", "<= 1.03"),
    Row("mdm_step", "B=1", "torch", "<= 0.76"), Row("mdm_step", "B=3", "torch", "<= 0.82"), Row("mdm_step", "B=8", "torch", "<= 0.74"),
    Row("mdm_step", "", "onnx", "<= 0.72"), Row("mdm_step", "", "peak", ">= 0.88"),
    Row("mdm_step", "B=1", "torch", "<= 0.66", "bf16"), Row("mdm_step", "B=3", "torch", "<= 0.60", "bf16"),
    Row("mdm_step", "B=8", "torch", "<= 0.55", "bf16"),
    Row("mdm_step", "", "torch", "<= 0.39", "bf16", "fp32"),
    Row("mdm_ragged", "", "torch", "<= 0.35"), Row("mdm_ragged", "", "torch", "<= 0.18", "bf16", "fp32"),
    Row("tmr_encoder", "B=1 ", "torch", "<= 0.56"), Row("tmr_encoder", "B=32", "torch", "<= 0.54"),
    Row("distilbert", "B=1 ", "torch", "<= 0.44"), Row("distilbert", "B=32", "torch", "<= 0.90"),
    Row("distilbert", "32 captions", "torch", "<= 0.50"), Row("distilbert", "B=", "onnx", "<= 0.90"),
    Row("clip_text", "B=1 ", "torch", "<= 0.50"), Row("clip_text", "B=8", "torch", "<= 0.78"),
    Row("clip_text", "", "onnx", "<= 0.90"),
    Row("temos_decoder", "B=1 ", "torch", "<= 0.55"), Row("temos_decoder", "B=32", "torch", "<= 0.44"),
    Row("actor_decoder", "B=1 ", "torch", "<= 0.35"), Row("actor_decoder", "B=32", "torch", "<= 0.56"),
    Row("train_mdm", "", "torch", "<= 0.62"), Row("train_tmr", "", "torch", "<= 0.45"),
    Row("train_mdm_memory", "", "torch", "<= 0.45"), Row("train_tmr_memory", "", "torch", "<= 0.45"),
    Row("motiondiffuse", "", "torch", "<= 1"), Row("guo_evaluator", "", "torch", "<= 1"), Row("tm2t_tokenizer", "", "torch", "<= 1"),
    Row("tm2t_write", "", "torch", "<= 1"), Row("stgcn", "", "torch", "<= 1"), Row("train_tokenizer", "", "torch", "<= 1"),
    Row("train_stgcn", "", "torch", "<= 1"),
    Row("fk", "", "torch", "<= 0.015"), Row("smpl", "B=200", "torch", "<= 0.08"), Row("smpl", "B=1", "torch"),
    Row("search", "1 query", "torch", "<= 0.85"), Row("search", "1000 queries", "torch", "<= 0.60"),
    Row("search", "1000 queries", "faiss", "<= 0.84"),
    Row("search_bf16", "1 query", "torch", "<= 0.45", peer_precision="fp32"), Row("search_bf16", "1000 queries", "faiss", "<= 0.46"),
    Row("start", "ms", "torch", "<= 0.08"), Row("start", "MB", "torch", "<= 0.30"),
    Row("stmc_full", "real-time", None, "", "fp32"), Row("stmc_full", "real-time", None, "< 1", "bf16"),
    Row("stmc_full", "MB", None, "<= 150"), Row("stmc_full", "MB", None, "<= 150", "bf16"),
    Row("stmc_bundled", "real-time", None, "< 1"), Row("stmc_bundled", "MB", None, "<= 200"),
]


class Failed(Exception):
    pass


@dataclasses.dataclass
class Measured:
    value: float       # milliseconds, or what else the work is about; the median
    gflops: float = 0  # and the peak beside them, of the turn whose share is the median
    peak: float = 0


def run(command, environment=None):
    """The lines that a program prints, by (config, variant)."""
    print(f"\r\x1b[K{' '.join(str(word).split('/')[-1] for word in command)}"[:110], end="", file=sys.stderr, flush=True)
    out = subprocess.run([str(word) for word in command], capture_output=True, text=True, env={**os.environ, **(environment or {})})
    if out.returncode:
        last = (out.stderr.strip().splitlines() or ["nothing on stderr"])[-1]
        raise Failed(f"{' '.join(map(str, command))}: exit {out.returncode}: {last[:300]}")
    found = collections.defaultdict(list)
    for r in csv.reader(io.StringIO(out.stdout)):
        if len(r) > 5:
            found[r[1], r[2]].append(Measured(*(float(r[i]) if len(r) > i else 0 for i in (5, 8, 9))))
    return {key: sorted(all_of_it, key=lambda m: m.value)[len(all_of_it) // 2] for key, all_of_it in found.items()}


def fastest(found):
    """Of several variants of a peer, by config."""
    best = {}
    for (config, _), m in found.items():
        if config not in best or m.value < best[config].value:
            best[config] = m
    return best


class Programs:
    """Runs ours and the peers, each once per round, and remembers who is not there."""

    def __init__(self, build, threads, python):
        self.bench, self.threads, self.python = build / "tests/bench", threads, python
        self.missing, self.torch_environment = {}, {}
        self.arguments = lambda precision: [] if precision == "fp32" else [f"--{precision}"]

    def ours(self, work, precision, kernels):
        command = [self.bench / f"bench_{PROGRAM.get(work, 'denoiser')}", self.threads, *self.arguments(precision), work]
        return run(command, {"MOTIONLANG_KERNELS": kernels} if kernels else None)

    def peer(self, name, work, precision, kernels=""):
        work = WORK_OF_PEER.get((work, name), work)
        if name in ("torch", "faiss"):
            command = [self.python, "-W", "ignore", HERE / "peer_torch.py", self.threads, *self.arguments(precision), work]
            return fastest(run(command, self.torch_environment))
        if name == "onnx":
            ONNX_FOLDER.mkdir(parents=True, exist_ok=True)
            return fastest(run([self.python, "-W", "ignore", HERE / "peer_onnx.py", self.threads, work], {"ONNX_FOLDER": str(ONNX_FOLDER)}))
        environment = dict(PINNED) if name == "onednn" else {}
        if name == "onednn" and kernels:  # as far as our kernels may go
            environment["DNNL_MAX_CPU_ISA"] = kernels.upper().replace("AVX512_", "AVX512_CORE_")
        return fastest(run([self.bench / f"bench_products_{name}", self.threads, *self.arguments(precision), work], environment))

    def look_for(self, peers):
        checks = {"torch": [self.python, "-c", "import torch"], "faiss": [self.python, "-c", "import torch, faiss"],
                  "onnx": ["node", "-e", f"require({json.dumps(str(ONNX_FOLDER / 'node_modules/onnxruntime-node'))})"],
                  **{name: ["test", "-x", self.bench / f"bench_products_{name}"] for name in ("native", "onednn")}}
        for name in peers & checks.keys():
            try:
                run(checks[name])
            except (Failed, FileNotFoundError):
                self.missing[name] = PACKAGE[name]

    def tune_torch(self):
        base = {"LD_LIBRARY_PATH": OPENBLAS, **PINNED}
        candidates = [{**base, "OPENBLAS_CORETYPE": core, "ATEN_CPU_CAPABILITY": vectors}
                      for core, vectors in (("Haswell", "avx2"), ("Zen", "avx2"), ("SkylakeX", "avx512"))]

        def time_with(environment):
            self.torch_environment = environment
            return sum(m.value for m in self.peer("torch", "settings", "fp32").values())

        self.torch_environment = min(candidates, key=time_with)


def meets(value, bar):
    sign, limit = bar.split()
    return {"<=": value <= float(limit), "<": value < float(limit), ">=": value >= float(limit)}[sign]


def one_round(programs, table, note):
    """{row: {config: (value, ours, peer's)}} of one round."""
    ours, peers, results = {}, {}, {}

    def once(store, key, measure):
        if key not in store:
            try:
                store[key] = measure()
            except (Failed, FileNotFoundError) as e:
                note(str(e))
                store[key] = {}
        return store[key]

    for row in table:
        if row.peer in programs.missing:
            continue
        all_of_it = once(ours, (row.work, row.precision, row.kernels), lambda: programs.ours(row.work, row.precision, row.kernels))
        mine = {config: m for (config, variant), m in all_of_it.items() if variant == "motionlang"}
        if row.peer == "peak":
            theirs = mine
        elif row.peer == "eigen":
            theirs = {config: m for (config, variant), m in all_of_it.items() if variant == "eigen"}
        elif row.peer:
            precision = row.peer_precision or row.precision
            theirs = once(peers, (row.peer, row.work, precision, row.kernels), lambda: programs.peer(row.peer, row.work, precision, row.kernels))
        wanted = "" if row.config == "median" else row.config
        results[row] = {}
        for config, m in mine.items():
            if not config.startswith(wanted):
                continue
            if row.peer is None:
                results[row][config] = (m.value, m.value, None)
            elif row.peer == "peak":
                if m.peak > 0:
                    results[row][config] = (m.gflops / m.peak, m.gflops, m.peak)
            elif config in theirs:
                peer = theirs[config].value
                share = row.bar.startswith(">") or row.peer in ("native", "onednn")
                results[row][config] = (peer / m.value if share else m.value / peer, m.value, peer)
    return results


def rows_wide(config):
    """Rows of a product; the goal speaks of 32 or more."""
    first = config.split("x")[0]
    return int(first) if first.isdigit() else 32


def gather(table, rounds):
    """One line for each row and configuration, with medians over the rounds."""
    lines = []
    for row in table:
        by_config = collections.defaultdict(list)
        for results in rounds:
            for config, values in results.get(row, {}).items():
                if not (row.work.startswith("product") and rows_wide(config) < 32 and row.config == "median"):
                    by_config[config].append(values)
        if row.config == "median" and by_config:
            middle = [statistics.median(v[0] for v in values) for values in by_config.values()]
            by_config = {"median of all": [(statistics.median(middle), None, None)]}
        for config, values in by_config.items():
            value, mine, theirs = (None if values[0][i] is None else statistics.median(v[i] for v in values) for i in range(3))
            bar = "" if row.work.startswith("product") and rows_wide(config) < 32 else row.bar
            lines.append({"work": row.work, "config": config, "precision": row.precision, "kernels": row.kernels, "peer": row.peer,
                          "peer_precision": row.peer_precision, "value": value, "ours": mine, "theirs": theirs,
                          "rounds": [v[0] for v in values], "bar": bar, "met": meets(value, bar) if bar else None})
    return lines


def title(line):
    return f"{line['work']}{'' if line['precision'] == 'fp32' else ' ' + line['precision']}"


def against(line):
    return " ".join(word for word in (line["peer"], line["peer_precision"], line["kernels"]) if word)


def print_head():
    print(f"{'work':18} {'shape':48} {'against':16} {'ours':>10} {'theirs':>10} {'value':>7}  bar")


def print_lines(lines):
    print("\r\x1b[K", end="", file=sys.stderr, flush=True)
    for l in lines:
        ours, theirs = (f"{l[k]:10.2f}" if l[k] is not None else " " * 10 for k in ("ours", "theirs"))
        verdict = {True: "met", False: "missed", None: ""}[l["met"]]
        print(f"{title(l):18} {l['config']:48} {against(l):16} {ours} {theirs} {l['value']:7.3f}  {l['bar']:8} {verdict}", flush=True)


def svg(lines, about):
    """A bar for each line, as long as its value relative to the bar that it is held against, which is the line down the picture."""
    high, left, middle, right = 16, 470, 360, 130
    colours = {True: "#3a7d44", False: "#b5483a", None: "#8a8f98"}
    out, y = [], 44
    for l in lines:
        limit = float(l["bar"].split()[1]) if l["bar"] else 1.0
        length = min(1.6, l["value"] / limit) / 1.6 * middle
        label = f"{title(l)}: {l['config']}" + (f" / {against(l)}" if l["peer"] else "")
        out.append(f'<text x="{left - 8}" y="{y + 12}" text-anchor="end">{escape(label)}</text>'
                   f'<rect x="{left}" y="{y + 2}" width="{length:.1f}" height="{high - 4}" fill="{colours[l["met"]]}"/>'
                   f'<text x="{left + middle + 8}" y="{y + 12}">{l["value"]:.3f}  {escape(l["bar"])}</text>')
        y += high
    at = left + middle / 1.6
    out.append(f'<line x1="{at}" y1="40" x2="{at}" y2="{y + 4}" stroke="black" stroke-dasharray="3 2"/>')
    head = (f'<svg xmlns="http://www.w3.org/2000/svg" width="{left + middle + right}" height="{y + 16}" font-family="sans-serif" font-size="11">'
            f'<rect width="100%" height="100%" fill="white"/><text x="8" y="18" font-size="13">{escape(about)}</text>'
            f'<text x="{at}" y="36" text-anchor="middle">the bar (grey: none, 1)</text>')
    return head + "\n".join(out) + "</svg>\n"


def write(path, text):
    """Under a temporary name first, so that a run that is cut off leaves a whole file."""
    if path:
        temporary = path.with_name(path.name + ".tmp")
        temporary.write_text(text)
        temporary.replace(path)


def processor():
    try:
        with open("/proc/cpuinfo") as info:
            return next(line.split(":")[1].strip() for line in info if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--threads", default="2")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--python", default="/usr/bin/python3")
    parser.add_argument("--json", type=pathlib.Path)
    parser.add_argument("--svg", type=pathlib.Path)
    parser.add_argument("works", nargs="*")
    a = parser.parse_intermixed_args()
    if unknown := set(a.works) - {row.work for row in TABLE}:
        parser.error(f"no such work: {', '.join(sorted(unknown))}; there are {', '.join(dict.fromkeys(row.work for row in TABLE))}")
    table = [row for row in TABLE if not a.works or row.work in a.works]
    programs = Programs(a.build.resolve(), a.threads, a.python)
    programs.look_for({row.peer for row in table if row.peer})
    for name, package in programs.missing.items():
        print(f"{name} is left out, it is not installed: {package}")
    if "torch" not in programs.missing and any(row.peer == "torch" for row in table):
        programs.tune_torch()
        print("torch with", {k: v for k, v in programs.torch_environment.items() if k.startswith(("OPENBLAS_", "ATEN"))})
    notes, lines, load = {}, [], os.getloadavg()[0]
    count = 1 if a.quick else a.rounds
    print_head()
    works = list(dict.fromkeys(row.work for row in table))
    for work in works:
        rows, rounds = [row for row in table if row.work == work], []
        for _ in range(count):
            rounds.append(one_round(programs, rows, lambda text: notes.setdefault(text)))
            load = max(load, os.getloadavg()[0])
        more = gather(rows, rounds)
        print_lines(more)
        lines += more
        about = (f"{processor()}, {a.threads} threads, {count} round{'s' if count > 1 else ''}, {datetime.date.today()}; "
                 f"load of the machine at most {load:.1f} (a quiet one has at most {a.threads})"
                 + ("" if work == works[-1] else f"; cut off after {work}"))
        write(a.json, json.dumps({"about": about, "torch": programs.torch_environment, "missing": programs.missing,
                                  "failed": list(notes), "rows": lines}, indent=1) + "\n")
        write(a.svg, svg(lines, about))
    judged = [l["met"] for l in lines if l["met"] is not None]
    print(f"{sum(judged)} of {len(judged)} bars met")
    for text in notes:
        print("failed:", text)
    print(about)
    sys.exit(1 if notes else 0)


main()
