"""The peer in PyTorch (for search also faiss): the same works as our programs, with random weights.

usage: peer_torch.py THREADS [--bf16] [WORK ...]      all works of the table WORKS at the end unless said;
       settings: what run.py chooses torch's settings by
Prints work,config,variant,threads,min_ms,median_ms for both memory layouts of torch's transformer; run.py takes the faster. Works that
are not times print their number in the place of the times. --bf16: under autocast, as torch's mixed precision is meant, and the denoising
step also with everything in bfloat16.
"""
import contextlib, os, subprocess, sys, tempfile, time
BFLOAT16 = "--bf16" in sys.argv
ARGUMENTS = [a for a in sys.argv[1:] if a != "--bf16"]
THREADS = ARGUMENTS[0] if ARGUMENTS else "1"
os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = THREADS
import torch
import torch.nn as nn
import torch.nn.functional as F
torch.set_num_threads(int(THREADS))

WIDTH, FEED_FORWARD, HEADS, LAYERS, FEATURES, TEXT = 512, 1024, 4, 8, 205, 512
LAYOUTS = [("sequence first", False), ("batch first", True)]


class Denoiser(nn.Module):
    """Time token, three text tokens and the frames through eight post-norm layers."""

    def __init__(self, batch_first):
        super().__init__()
        self.batch_first = batch_first
        self.embed, self.read = nn.Linear(FEATURES, WIDTH), nn.Linear(WIDTH, FEATURES)
        self.time = nn.Sequential(nn.Linear(WIDTH, WIDTH), nn.SiLU(), nn.Linear(WIDTH, WIDTH))
        self.text = nn.Linear(TEXT, WIDTH)
        layer = nn.TransformerEncoderLayer(WIDTH, HEADS, FEED_FORWARD, 0.1, "gelu", batch_first=batch_first)
        self.layers = nn.TransformerEncoder(layer, LAYERS)
        self.register_buffer("positions", torch.randn(1000, WIDTH))

    def forward(self, x, t, text, mask=None):
        tokens = torch.cat([self.time(self.positions[t])[:, None], self.text(text), self.embed(x)], 1)
        tokens = tokens + self.positions[: tokens.shape[1]]
        if self.batch_first:
            out = self.layers(tokens, src_key_padding_mask=mask)
        else:
            out = self.layers(tokens.transpose(0, 1), src_key_padding_mask=mask).transpose(0, 1)
        return self.read(out[:, 4:])


def precision():
    return torch.autocast("cpu", torch.bfloat16) if BFLOAT16 else contextlib.nullcontext()


@contextlib.contextmanager
def inference():
    """Autocast around all runs, not each: it keeps the weights that it has rounded until it ends."""
    with torch.no_grad(), precision():
        yield


def peak_memory():
    """In MB (1e6 bytes)."""
    with open("/proc/self/status") as status:
        return next(1.024e-3 * float(line.split()[1]) for line in status if line.startswith("VmHWM:"))


def report_value(work, config, variant, value):
    print(f"{work},{config},{variant},{THREADS},{value:.4f},{value:.4f}", flush=True)


def training_step(models, loss):
    adam = torch.optim.AdamW([p for m in models for p in m.parameters()], 1e-4)

    def step():
        adam.zero_grad(set_to_none=True)
        with precision():
            value = loss()
        value.backward()
        adam.step()

    return step


def memory_of_training(work, config, make):
    """Each layout in a process of its own, before torch has started threads."""
    for name, batch_first in LAYOUTS:
        child = os.fork()
        if child == 0:
            step = make(batch_first)
            for _ in range(3):
                step()
            report_value(work, config, name, peak_memory())
            os._exit(0)
        os.waitpid(child, 0)


def report(work, config, variant, run, seconds):
    start = time.perf_counter()
    try:
        run()
        if time.perf_counter() - start < seconds:
            run()
    except RuntimeError as e:  # torch 1.13's fused layer does not know autocast
        if not BFLOAT16:
            raise
        return print(f"{work} {config} {variant}: torch cannot: {e}", file=sys.stderr)
    times, start = [], time.perf_counter()
    while (len(times) < 5 and time.perf_counter() - start < 4 * seconds) or not times or (time.perf_counter() - start < seconds and len(times) < 300):
        before = time.perf_counter()
        run()
        times.append(time.perf_counter() - before)
    times.sort()
    print(f"{work},{config},{variant},{THREADS},{times[0] * 1e3:.3f},{times[len(times) // 2] * 1e3:.3f}", flush=True)


def mdm_step(batches=(1, 3, 8), seconds=3):
    for b in batches:
        for name, batch_first in LAYOUTS:
            model = Denoiser(batch_first).eval()
            x, t, text = torch.randn(2 * b, 200, FEATURES), torch.full((2 * b,), 50), torch.randn(2 * b, 3, TEXT)
            with inference():
                report("mdm_step", f"B={b} (2B crops) T=200", name, lambda: model(x, t, text), seconds)
            if BFLOAT16:  # all numbers in bfloat16 instead: faster in some shapes
                model, x, text = model.bfloat16(), x.bfloat16(), text.bfloat16()
                with torch.no_grad():
                    report("mdm_step", f"B={b} (2B crops) T=200", name + " cast", lambda: model(x, t, text), seconds)


def mdm_ragged():
    lengths = torch.tensor([200, 52, 163, 97, 71, 120, 44, 139] * 2)
    mask = torch.arange(204)[None] >= (lengths + 4)[:, None]
    for name, batch_first in LAYOUTS:
        model = Denoiser(batch_first).eval()
        x, t, text = torch.randn(16, 200, FEATURES), torch.full((16,), 50), torch.randn(16, 3, TEXT)
        with inference():
            report("mdm_ragged", "16 crops 40..200 frames (mean 111)", name, lambda: model(x, t, text, mask), 3)


def mdm_training(batch_first):
    model = Denoiser(batch_first).train()
    x, t, text = torch.randn(16, 200, FEATURES), torch.randint(0, 100, (16,)), torch.randn(16, 3, TEXT)
    return training_step([model], lambda: F.mse_loss(model(x, t, text), x))


def train_mdm():
    for name, batch_first in LAYOUTS:
        report("train_mdm", "B=16 T=200 dropout 0.1", name, mdm_training(batch_first), 12)


def first_step(path, start):
    """The end of the program that `start` starts. The whole module lies in the file: nothing is initialised in vain."""
    model = torch.load(path).eval()
    x, t, text = torch.randn(2, 200, FEATURES), torch.full((2,), 50), torch.randn(2, 3, TEXT)
    with torch.no_grad():
        model(x, t, text)
    report_value("start", "ms to the end of the first step", "torch", (time.monotonic() - float(start)) * 1e3)
    report_value("start", "MB of the program then", "torch", peak_memory())


def start():
    with tempfile.NamedTemporaryFile(suffix=".pt") as file:
        torch.save(Denoiser(True), file.name)
        for _ in range(5):
            subprocess.run([sys.executable, "-W", "ignore", __file__, THREADS, "first_step", file.name, str(time.monotonic())], check=True)


PARENTS = [-1, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 9, 9, 12, 13, 14, 16, 17, 18, 19, 20, 21]


def fk():
    frames, offsets, root = torch.randn(100000, 24, 6), torch.randn(24, 3), torch.randn(100000, 3)

    def run():
        a, b = frames[..., :3], frames[..., 3:]
        x = F.normalize(a, dim=-1)
        y = F.normalize(b - (x * b).sum(-1, keepdim=True) * x, dim=-1)
        rotations = torch.stack([x, y, torch.cross(x, y, dim=-1)], -2)
        world, joints = [rotations[:, 0]], [root]
        for j in range(1, 24):
            parent = PARENTS[j]
            joints.append(world[parent] @ offsets[j] + joints[parent])
            world.append(world[parent] @ rotations[:, j])
        return torch.stack(joints, 1)

    with inference():
        report("fk", "100000 frames 24 joints 6D", "torch", run, 5)


def rodrigues(v):
    """(N, 3) -> (N, 3, 3), as smplx."""
    angle = (v + 1e-8).norm(dim=1, keepdim=True)
    x, y, z = (v / angle).split(1, 1)
    c, s, o = torch.cos(angle)[..., None], torch.sin(angle)[..., None], torch.zeros_like(x)
    k = torch.cat([o, -z, y, z, o, -x, -y, x, o], 1).view(-1, 3, 3)
    return torch.eye(3)[None] + s * k + (1 - c) * torch.bmm(k, k)


def smpl_forward(template, shapes, poses, regressor, weights, betas, pose):
    """The formulation of the smplx package."""
    n = pose.shape[0]
    v = template + torch.einsum("bl,mkl->bmk", betas, shapes)
    joints = torch.einsum("bik,ji->bjk", v, regressor)
    rotations = rodrigues(pose.view(-1, 3)).view(n, 24, 3, 3)
    relative = joints.clone()
    relative[:, 1:] -= joints[:, PARENTS[1:]]
    local = torch.cat([F.pad(rotations.reshape(-1, 3, 3), [0, 0, 0, 1]), F.pad(relative.reshape(-1, 3, 1), [0, 0, 0, 1], value=1)], 2).view(n, 24, 4, 4)
    chain = [local[:, 0]]
    for i in range(1, 24):
        chain.append(chain[PARENTS[i]] @ local[:, i])
    world = torch.stack(chain, 1)
    v = v + ((rotations[:, 1:] - torch.eye(3)).reshape(n, -1) @ poses).view(n, -1, 3)
    skin = world - F.pad(world @ F.pad(joints[..., None], [0, 0, 0, 1]), [3, 0])
    per_vertex = (weights[None].expand(n, -1, -1) @ skin.view(n, 24, 16)).view(n, -1, 4, 4)
    return (per_vertex @ F.pad(v, [0, 1], value=1.0)[..., None])[:, :, :3, 0]


def smpl():
    vertices = 6890
    weights = torch.zeros(vertices, 24).scatter_(1, torch.randint(0, 24, (vertices, 4)), torch.rand(vertices, 4))
    model = (torch.randn(vertices, 3), torch.randn(vertices, 3, 10) * 0.01, torch.randn(207, vertices * 3) * 0.01,
             torch.rand(24, vertices) / vertices, weights / weights.sum(1, keepdim=True))
    with inference():
        for n in (200, 1):
            betas, pose = torch.randn(n, 10), torch.randn(n, 72) * 0.3
            report("smpl", f"B={n}", "torch", lambda: smpl_forward(*model, betas, pose), 4)


class TextEncoder(nn.Module):
    """DistilBERT on torch's own transformer, which takes its fused path here."""

    def __init__(self, batch_first):
        super().__init__()
        self.batch_first = batch_first
        self.words, self.positions, self.norm = nn.Embedding(30522, 768), nn.Embedding(512, 768), nn.LayerNorm(768)
        layer = nn.TransformerEncoderLayer(768, 12, 3072, 0.1, "gelu", batch_first=batch_first)
        self.layers = nn.TransformerEncoder(layer, 6)

    def forward(self, ids, mask=None):
        x = self.norm(self.words(ids) + self.positions.weight[: ids.shape[1]])
        if self.batch_first:
            return self.layers(x, src_key_padding_mask=mask)
        return self.layers(x.transpose(0, 1), src_key_padding_mask=mask).transpose(0, 1)


# Tokens of every 380th caption of KIT-ML, [CLS] and [SEP] included. The same numbers stand in text.cpp.
CAPTION_LENGTHS = [8, 8, 10, 14, 8, 10, 10, 29, 9, 10, 12, 9, 11, 16, 8, 13, 19, 11, 16, 23, 10, 12, 7, 16, 14, 17, 13, 6, 9, 7, 12, 17]


def distilbert():
    for name, batch_first in LAYOUTS:
        model = TextEncoder(batch_first).eval()
        with inference():
            for b in (1, 32):
                ids = torch.randint(0, 30000, (b, 32))
                report("distilbert", f"B={b} T=32", name, lambda: model(ids), 3)
            for width in (max(CAPTION_LENGTHS), 32):
                ids = torch.randint(0, 30000, (len(CAPTION_LENGTHS), width))
                mask = torch.arange(width)[None] >= torch.tensor(CAPTION_LENGTHS)[:, None]
                report("distilbert", f"32 captions (mean 12 tokens), peer padded to {width}", name, lambda: model(ids, mask), 3)


class ClipBlock(nn.Module):
    """As in OpenAI's CLIP."""

    def __init__(self, batch_first):
        super().__init__()
        self.attn, self.ln_1, self.ln_2 = nn.MultiheadAttention(512, 8, batch_first=batch_first), nn.LayerNorm(512), nn.LayerNorm(512)
        self.fc, self.proj = nn.Linear(512, 2048), nn.Linear(2048, 512)

    def forward(self, x, mask):
        y = self.ln_1(x)
        x = x + self.attn(y, y, y, need_weights=False, attn_mask=mask)[0]
        h = self.fc(self.ln_2(x))
        return x + self.proj(h * torch.sigmoid(1.702 * h))


class ClipText(nn.Module):
    """Its text tower, causal, without the last projection."""

    def __init__(self, batch_first):
        super().__init__()
        self.batch_first = batch_first
        self.words, self.positions = nn.Embedding(49408, 512), nn.Parameter(torch.randn(77, 512))
        self.blocks, self.last = nn.ModuleList(ClipBlock(batch_first) for _ in range(12)), nn.LayerNorm(512)
        self.register_buffer("mask", torch.full((77, 77), float("-inf")).triu(1))

    def forward(self, ids):
        x = self.words(ids) + self.positions
        x = x if self.batch_first else x.transpose(0, 1)
        for block in self.blocks:
            x = block(x, self.mask)
        return self.last(x)


def clip_text():
    for name, batch_first in LAYOUTS:
        model = ClipText(batch_first).eval()
        with inference():
            for b in (1, 8):
                ids = torch.randint(0, 49000, (b, 77))
                report("clip_text", f"B={b} T=77", name, lambda: model(ids), 3)


def gallery(queries):
    """1,000,000 vectors of length 1, and some queries."""
    torch.manual_seed(1)
    return F.normalize(torch.randn(1000000, 256), dim=1), F.normalize(torch.randn(queries, 256), dim=1)


def search():
    rows, queries = gallery(1000)

    def nearest(chunk=20000):
        scores, places = [], []
        for at in range(0, len(rows), chunk):
            s, i = (queries @ rows[at : at + chunk].t()).topk(10, 1)
            scores.append(s), places.append(i + at)
        s, i = torch.cat(scores, 1).topk(10, 1)
        return s, torch.cat(places, 1).gather(1, i)

    with inference():
        report("search", "1 query 1e6x256", "torch", lambda: (rows @ queries[0]).topk(10), 3)
        report("search", "1000 queries 1e6x256", "torch", nearest, 3)


def search_faiss():
    import faiss
    rows, queries = (t.numpy() for t in gallery(1000))
    faiss.omp_set_num_threads(int(THREADS))
    index = faiss.IndexFlatIP(256)
    index.add(rows)
    report("search", "1 query 1e6x256", "faiss", lambda: index.search(queries[:1], 10), 3)
    report("search", "1000 queries 1e6x256", "faiss", lambda: index.search(queries, 10), 3)


class SequenceEncoder(nn.Module):
    """Two tokens before the frames; what becomes of them is the distribution (TMR)."""

    def __init__(self, features, batch_first):
        super().__init__()
        self.batch_first = batch_first
        self.embed, self.tokens = nn.Linear(features, 256), nn.Parameter(torch.randn(2, 256))
        self.layers = nn.TransformerEncoder(nn.TransformerEncoderLayer(256, 4, 1024, 0.1, "gelu", batch_first=batch_first), 6)
        self.register_buffer("positions", torch.randn(1000, 256))

    def forward(self, x):
        x = torch.cat([self.tokens[None].expand(x.shape[0], -1, -1), self.embed(x)], 1)
        x = x + self.positions[: x.shape[1]]
        return self.layers(x)[:, :2] if self.batch_first else self.layers(x.transpose(0, 1))[:2].transpose(0, 1)


class SequenceDecoder(nn.Module):
    """Positions are the queries, one latent is the memory (TEMOS, TMR, ACTOR)."""

    def __init__(self, features, layers, batch_first):
        super().__init__()
        self.batch_first = batch_first
        self.layers = nn.TransformerDecoder(nn.TransformerDecoderLayer(256, 4, 1024, 0.1, "gelu", batch_first=batch_first), layers)
        self.read = nn.Linear(256, features)
        self.register_buffer("positions", torch.randn(1000, 256))

    def forward(self, z, frames):
        queries = self.positions[:frames][None].expand(z.shape[0], -1, -1)
        if self.batch_first:
            return self.read(self.layers(queries, z[:, None]))
        return self.read(self.layers(queries.transpose(0, 1), z[None]).transpose(0, 1))


def tmr_encoder():
    for b in (1, 32):
        for name, batch_first in LAYOUTS:
            model, x = SequenceEncoder(263, batch_first).eval(), torch.randn(b, 200, 263)
            with inference():
                report("tmr_encoder", f"B={b} T=200", name, lambda: model(x), 3)


def decoder(work, features, layers, frames):
    for b in (1, 32):
        for name, batch_first in LAYOUTS:
            model, z = SequenceDecoder(features, layers, batch_first).eval(), torch.randn(b, 256)
            with inference():
                report(work, f"B={b} T={frames}", name, lambda: model(z, frames), 3)


def tmr_training(batch_first):
    batch, frames, words = 32, 200, 32
    motions, texts, decode = SequenceEncoder(263, batch_first), SequenceEncoder(768, batch_first), SequenceDecoder(263, 6, batch_first)
    x, text = torch.randn(batch, frames, 263), torch.randn(batch, words, 768)

    def sample(tokens):
        mu, logvar = tokens[:, 0], tokens[:, 1]
        return mu + torch.randn_like(mu) * (0.5 * logvar).exp(), mu, logvar

    def kl(mu, logvar, mu2, logvar2):
        return 0.5 * ((logvar - logvar2).exp() + (mu - mu2) ** 2 * (-logvar2).exp() - 1 - logvar + logvar2).mean()

    def loss_of_batch():
        (z, *m), (y, *t) = sample(motions(x)), sample(texts(text))
        zero = torch.zeros_like(z)
        loss = F.smooth_l1_loss(decode(z, frames), x) + F.smooth_l1_loss(decode(y, frames), x) + 1e-5 * F.smooth_l1_loss(y, z)
        loss = loss + 1e-5 * (kl(*t, *m) + kl(*m, *t) + kl(*t, zero, zero) + kl(*m, zero, zero))
        s, own = F.normalize(y, dim=1) @ F.normalize(z, dim=1).t() / 0.1, torch.arange(batch)
        return loss + 0.1 * 0.5 * (F.cross_entropy(s, own) + F.cross_entropy(s.t(), own))

    return training_step([motions, texts, decode], loss_of_batch)


def train_tmr():
    for name, batch_first in LAYOUTS:
        report("train_tmr", "B=32 T=200 dropout 0.1", name, tmr_training(batch_first), 12)


class Stylization(nn.Module):
    def __init__(self):
        super().__init__()
        self.emb, self.norm, self.out = nn.Linear(2048, 1024), nn.LayerNorm(512), nn.Linear(512, 512)

    def forward(self, h, emb):
        scale, shift = self.emb(F.silu(emb))[:, None].chunk(2, 2)
        return self.out(F.silu(self.norm(h) * (1 + scale) + shift))


class EfficientAttention(nn.Module):
    """MotionDiffuse's, to the motion itself or to the text."""

    def __init__(self, source=512):
        super().__init__()
        self.norm, self.source_norm, self.style = nn.LayerNorm(512), nn.LayerNorm(source), Stylization()
        self.query, self.key, self.value = nn.Linear(512, 512), nn.Linear(source, 512), nn.Linear(source, 512)

    def forward(self, x, text, emb):
        n, heads = self.norm(x), (x.shape[0], -1, 8, 64)
        source = n if text is None else self.source_norm(text)
        q, k = F.softmax(self.query(n).view(heads), 3), F.softmax(self.key(source).view(heads), 1)
        a = torch.einsum("bnhd,bnhl->bhdl", k, self.value(source).view(heads))
        return x + self.style(torch.einsum("bnhd,bhdl->bnhl", q, a).reshape(x.shape), emb)


class MotionDiffuse(nn.Module):
    def __init__(self):
        super().__init__()
        self.time = nn.Sequential(nn.Linear(512, 2048), nn.SiLU(), nn.Linear(2048, 2048))
        self.embed, self.read, self.positions = nn.Linear(263, 512), nn.Linear(512, 263), nn.Parameter(torch.randn(196, 512))
        self.own, self.cross = (nn.ModuleList(EfficientAttention(w) for _ in range(8)) for w in (512, 256))
        self.feed = nn.ModuleList(nn.Sequential(nn.Linear(512, 1024), nn.GELU(), nn.Linear(1024, 512)) for _ in range(8))
        self.style = nn.ModuleList(Stylization() for _ in range(8))

    def forward(self, x, t, sentence, words):
        angles = t[:, None] * torch.exp(-9.21034 * torch.arange(256) / 256)
        emb, h = self.time(torch.cat([angles.cos(), angles.sin()], 1)) + sentence, self.embed(x) + self.positions
        for own, cross, feed, style in zip(self.own, self.cross, self.feed, self.style):
            h = cross(own(h, None, emb), words, emb)
            h = h + style(feed(h), emb)
        return self.read(h)


def motiondiffuse():
    model = MotionDiffuse().eval()
    with inference():
        for b in (1, 8):
            x, t, sentence, words = torch.randn(b, 196, 263), torch.full((b,), 50.0), torch.randn(b, 2048), torch.randn(b, 77, 256)
            report("motiondiffuse", f"B={b} T=196", "torch", lambda: model(x, t, sentence, words), 3)


class BiGru(nn.Module):
    """From rows to the common space of motions and texts (Guo et al.)."""

    def __init__(self, width, hidden):
        super().__init__()
        self.embed, self.gru = nn.Linear(width, hidden), nn.GRU(hidden, hidden, batch_first=True, bidirectional=True)
        self.start = nn.Parameter(torch.randn(2, 1, hidden))
        self.out = nn.Sequential(nn.Linear(2 * hidden, hidden), nn.LayerNorm(hidden), nn.LeakyReLU(0.2), nn.Linear(hidden, 512))

    def forward(self, x):
        lengths = torch.full((x.shape[0],), x.shape[1])
        rows = nn.utils.rnn.pack_padded_sequence(self.embed(x), lengths, batch_first=True)
        return self.out(torch.cat(tuple(self.gru(rows, self.start.expand(-1, x.shape[0], -1).contiguous())[1]), 1))


def guo_evaluator():
    slope = nn.LeakyReLU(0.2)
    movements = nn.Sequential(nn.Conv1d(259, 512, 4, 2, 1), slope, nn.Conv1d(512, 512, 4, 2, 1), slope).eval()
    out, motions, texts, tags = nn.Linear(512, 512), BiGru(512, 1024).eval(), BiGru(300, 512).eval(), nn.Linear(15, 300)
    x, words, kinds = torch.randn(32, 196, 259), torch.randn(32, 12, 300), torch.randn(32, 12, 15)
    with inference():
        report("guo_evaluator", "32 motions T=196", "torch", lambda: motions(out(movements(x.transpose(1, 2)).transpose(1, 2))), 3)
        report("guo_evaluator", "32 texts T=12", "torch", lambda: texts(words + tags(kinds)), 3)


class Tokenizer(nn.Module):
    """TM2T's."""

    class Residual(nn.Module):
        def __init__(self):
            super().__init__()
            self.model = nn.Sequential(nn.Conv1d(1024, 1024, 3, 1, 1), nn.LeakyReLU(0.2), nn.Conv1d(1024, 1024, 3, 1, 1))

        def forward(self, x):
            return x + self.model(x)

    def __init__(self):
        super().__init__()
        halve, same = (4, 2, 1), (3, 1, 1)
        self.encoder = nn.Sequential(*(m for width in (259, 1024) for m in (nn.Conv1d(width, 1024, *halve), nn.LeakyReLU(0.2), self.Residual())))
        self.decoder = nn.Sequential(*(self.Residual() for _ in range(3)),
                                     *(m for width in (1024, 263) for m in (nn.Upsample(scale_factor=2), nn.Conv1d(1024, width, *same), nn.LeakyReLU(0.2))),
                                     nn.Conv1d(263, 263, *same))
        self.codes = nn.Embedding(1024, 1024)

    @torch.no_grad()
    def nearest(self, z):
        rows, e = z.transpose(1, 2).reshape(-1, 1024), self.codes.weight
        return torch.argmin(rows.square().sum(1, keepdim=True) + e.square().sum(1) - 2 * rows @ e.t(), 1)

    def loss(self, x):
        z = self.encoder(x[:, :259])
        e = self.codes(self.nearest(z)).view(x.shape[0], -1, 1024).transpose(1, 2)
        return F.mse_loss(self.decoder(z + (e - z).detach()), x) + F.mse_loss(e, z.detach()) + F.mse_loss(z, e.detach())


def tm2t_tokenizer():
    model = Tokenizer().eval()
    with inference():
        for b in (1, 32):
            x, z = torch.randn(b, 259, 196), torch.randn(b, 1024, 49)
            report("tm2t_tokenizer", f"B={b} T=196 to tokens", "torch", lambda: model.nearest(model.encoder(x)), 3)
            report("tm2t_tokenizer", f"B={b} T=196 from tokens", "torch", lambda: model.decoder(z), 3)


def train_tokenizer():
    model, x = Tokenizer().train(), torch.randn(32, 263, 64)
    report("train_tokenizer", "B=32 T=64", "torch", training_step([model], lambda: model.loss(x)), 8)


class Writer(nn.Module):
    """TM2T's, from words to motion tokens."""

    def __init__(self):
        super().__init__()
        self.embed, self.read = nn.Linear(300, 512), nn.GRU(512, 512, batch_first=True, bidirectional=True)
        self.begin, self.tokens, self.gru = nn.Linear(1024, 1024), nn.Embedding(1027, 1024), nn.GRUCell(1024, 1024)
        self.query, self.key, self.value = nn.Linear(1024, 1024), nn.Linear(1024, 1024, bias=False), nn.Linear(1024, 1024)
        self.mix, self.norm = nn.Linear(2048, 1024), nn.LayerNorm(1024)

    def forward(self, words):
        rows, ends = self.read(self.embed(words))
        keys, values, h = self.key(rows).transpose(1, 2), self.value(rows), self.begin(torch.cat(tuple(ends), 1))
        last = torch.full((words.shape[0],), 1024)
        for _ in range(49):
            a = F.softmax(self.query(h)[:, None] @ keys / 32, 2) @ values
            h = self.gru(F.leaky_relu(self.norm(self.mix(torch.cat([a[:, 0], self.tokens(last)], 1))), 0.2), h)
            last = (h @ self.tokens.weight.t()).argmax(1)
        return last


def tm2t_write():
    model = Writer().eval()
    with inference():
        for b in (1, 32):
            words = torch.randn(b, 12, 300)
            report("tm2t_write", f"B={b} 49 tokens", "torch", lambda: model(words), 3)


class StGcnBlock(nn.Module):
    def __init__(self, width, out, stride, residual):
        super().__init__()
        self.graph, self.time = nn.Conv2d(width, 3 * out, 1), nn.Conv2d(out, out, (9, 1), (stride, 1), (4, 0))
        self.before, self.after = nn.BatchNorm2d(out), nn.BatchNorm2d(out)
        self.past = None
        if residual:
            same = width == out and stride == 1
            self.past = nn.Identity() if same else nn.Sequential(nn.Conv2d(width, out, 1, (stride, 1)), nn.BatchNorm2d(out))

    def forward(self, x, edges):
        parts = self.graph(x).unflatten(1, (3, -1))
        mixed = torch.einsum("nkctv,kvw->nctw", parts, edges).contiguous()
        y = self.after(self.time(F.relu(self.before(mixed))))
        return F.relu(y if self.past is None else y + self.past(x))


class StGcn(nn.Module):
    def __init__(self):
        super().__init__()
        widths, strides = [6] + [64] * 4 + [128] * 3 + [256] * 3, [1, 1, 1, 1, 2, 1, 1, 2, 1, 1]
        self.blocks = nn.ModuleList(StGcnBlock(widths[i], widths[i + 1], strides[i], i > 0) for i in range(10))
        self.edges, self.norm, self.read = nn.Parameter(torch.rand(10, 3, 24, 24)), nn.BatchNorm1d(144), nn.Linear(256, 40)

    def forward(self, x):
        n, frames, _ = x.shape
        x = self.norm(x.transpose(1, 2).contiguous()).view(n, 24, 6, frames).permute(0, 2, 3, 1).contiguous()  # the order that torch prefers
        for block, edges in zip(self.blocks, self.edges):
            x = block(x, edges)
        return self.read(x.mean((2, 3)))


def stgcn():
    model = StGcn().eval()
    with inference():
        for b in (1, 32):
            x = torch.randn(b, 60, 144)
            report("stgcn", f"B={b} T=60", "torch", lambda: model(x), 3)


def train_stgcn():
    model, x = StGcn().train(), torch.randn(16, 60, 144)
    report("train_stgcn", "B=16 T=60", "torch", training_step([model], lambda: model(x).square().mean()), 8)


WORKS = {"train_mdm_memory": lambda: memory_of_training("train_mdm_memory", "B=16 T=200 dropout 0.1", mdm_training),
         "train_tmr_memory": lambda: memory_of_training("train_tmr_memory", "B=32 T=200 dropout 0.1", tmr_training),
         "settings": lambda: mdm_step((1,), 1), "mdm_step": mdm_step, "mdm_ragged": mdm_ragged, "train_mdm": train_mdm, "fk": fk, "smpl": smpl,
         "distilbert": distilbert, "clip_text": clip_text, "search": search, "search_faiss": search_faiss,
         "tmr_encoder": tmr_encoder, "temos_decoder": lambda: decoder("temos_decoder", 263, 6, 200),
         "actor_decoder": lambda: decoder("actor_decoder", 150, 8, 60), "train_tmr": train_tmr, "start": start,
         "motiondiffuse": motiondiffuse, "guo_evaluator": guo_evaluator, "tm2t_tokenizer": tm2t_tokenizer, "train_tokenizer": train_tokenizer,
         "tm2t_write": tm2t_write, "stgcn": stgcn, "train_stgcn": train_stgcn}

if __name__ == "__main__":
    if ARGUMENTS[1:2] == ["first_step"]:
        first_step(*ARGUMENTS[2:])
    else:
        for wanted in ARGUMENTS[1:] or WORKS:
            WORKS[wanted]()
