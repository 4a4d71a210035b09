"""The peer ONNX Runtime: the denoising step and the text networks of peer_torch.py, written as ONNX files and run by peer_onnx.mjs.

usage: peer_onnx.py THREADS [mdm_step distilbert clip_text]       ONNX_FOLDER: where `npm install onnxruntime-node` was done, and for the files
"""
import json, os, pathlib, subprocess, sys
import torch
import peer_torch

FOLDER = pathlib.Path(os.environ.get("ONNX_FOLDER", "."))


def models():
    """(work, config, module, inputs) of each model."""
    for b in (1, 3, 8):
        inputs = torch.randn(2 * b, 200, peer_torch.FEATURES), torch.full((2 * b,), 50), torch.randn(2 * b, 3, peer_torch.TEXT)
        yield "mdm_step", f"B={b} (2B crops) T=200", peer_torch.Denoiser(False), inputs
    for b in (1, 32):
        yield "distilbert", f"B={b} T=32", peer_torch.TextEncoder(False), (torch.randint(0, 30000, (b, 32)),)
    for b in (1, 8):
        yield "clip_text", f"B={b} T=77", peer_torch.ClipText(False), (torch.randint(0, 49000, (b, 77)),)


def write(path, module, inputs):
    for p in module.eval().parameters():  # torch's encoder copies one layer: they must differ, else the file has only one
        if p.dim() > 1:
            p.data = torch.randn_like(p) / p.shape[-1] ** 0.5
    with torch.no_grad():
        torch.onnx.export(module, inputs, path, opset_version=14, do_constant_folding=True)


def main():
    wanted = peer_torch.ARGUMENTS[1:] or ["mdm_step", "distilbert", "clip_text"]
    listed = []
    for i, (work, config, module, inputs) in enumerate(models()):
        if work not in wanted:
            continue
        path = FOLDER / f"motionlang_peer_{i}.onnx"
        if not path.exists():
            write(path, module, inputs)
        listed.append({"work": work, "config": config, "file": str(path.resolve()),
                       "inputs": [{"shape": list(x.shape), "whole": not x.is_floating_point()} for x in inputs]})
    script = pathlib.Path(__file__).with_suffix(".mjs").resolve()
    sys.exit(subprocess.run(["node", script, peer_torch.THREADS, json.dumps(listed)], cwd=FOLDER).returncode)


main()
