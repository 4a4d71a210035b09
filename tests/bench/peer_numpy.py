#!/usr/bin/python3
"""HumanML3D's 263 numbers from joints in NumPy: the peer of features.cpp. Same output format.

numpy: all frames and bones at once, and no rotation where they cancel; numpy-chains: all frames at once, bone after bone along
the chains, onto the reference skeleton by inverse and forward kinematics, as published.

usage: peer_numpy.py [FRAMES ...]
Debian: python3-numpy.
"""
import sys, time
import numpy as np

CHAINS = [[0, 2, 5, 8, 11], [0, 1, 4, 7, 10], [0, 3, 6, 9, 12, 15], [9, 14, 17, 19, 21], [9, 13, 16, 18, 20]]
X, Y, Z = np.eye(3, dtype=np.float32)
DIRECTIONS = np.array([0 * X, X, -X, Y, -Y, -Y, Y, -Y, -Y, Y, Z, Z, Y, X, -X, Z, -Y, -Y, -Y, -Y, -Y, -Y], np.float32)
LENGTHS = np.array([0, 0.10307397, 0.10988337, 0.13156824, 0.3936232, 0.39018822, 0.14319022, 0.43243307, 0.42564335, 0.05736474,
                    0.14338182, 0.14941907, 0.21936005, 0.13748677, 0.14338283, 0.10303922, 0.13161404, 0.12298438, 0.25684,
                    0.26309174, 0.26601171, 0.2698764], np.float32)
BONES = [(joint, parent, 0 if k == 0 else parent) for chain in CHAINS for k, (parent, joint) in enumerate(zip(chain, chain[1:]))]
JOINT, PARENT, BEFORE = (np.array(column) for column in zip(*BONES))


def unit(v):
    return v / np.sqrt((v * v).sum(-1, keepdims=True))


def multiply(a, b):
    w, v, u, x = a[..., :1], a[..., 1:], b[..., :1], b[..., 1:]
    return np.concatenate([w * u - (v * x).sum(-1, keepdims=True), w * x + u * v + np.cross(v, x)], -1)


def inverse(q):
    return q * np.array([1, -1, -1, -1], np.float32)


def rotate(q, v):
    u = np.broadcast_to(q[..., 1:], v.shape)
    uv = np.cross(u, v)
    return v + 2 * (q[..., :1] * uv + np.cross(u, uv))


def between(a, b):
    w = np.sqrt((a * a).sum(-1, keepdims=True) * (b * b).sum(-1, keepdims=True)) + (a * b).sum(-1, keepdims=True)
    return unit(np.concatenate([w, np.cross(a, b)], -1))


def smooth(v, sigma):
    radius = int(4 * sigma + 0.5)
    kernel = np.exp(-0.5 * (np.arange(-radius, radius + 1) / sigma) ** 2)
    padded = np.pad(v, ((radius, radius), (0, 0)), "edge")
    return np.stack([np.convolve(column, kernel / kernel.sum(), "valid") for column in padded.T], -1)


def facing(p, legacy):
    hips = p[:, 2] - p[:, 1]
    return np.cross(Y, unit((-hips if legacy else hips) + p[:, 17] - p[:, 16]))


def two_columns(q):
    w, x, y, z = np.moveaxis(q, -1, 0)
    k = 2 / (q * q).sum(-1)
    return np.stack([1 - k * (y * y + z * z), k * (x * y + z * w), k * (x * z - y * w),
                     k * (x * y - z * w), 1 - k * (x * x + z * z), k * (y * z + x * w)], -1)


def uniform(p, scale):
    bone = p[:, JOINT] - p[:, PARENT]
    bone = bone * (LENGTHS[JOINT][:, None] / np.sqrt((bone * bone).sum(-1, keepdims=True)))
    x = np.empty_like(p)
    x[:, 0] = p[:, 0] * scale
    for k, (joint, parent, _) in enumerate(BONES):
        x[:, joint] = x[:, parent] + bone[:, k]
    return x


def inverse_kinematics(x, root):
    world = np.empty(x.shape[:2] + (4,), np.float32)
    world[:, 0] = root
    world[:, JOINT] = between(DIRECTIONS[JOINT], unit(x[:, JOINT] - x[:, PARENT]))
    local = np.empty_like(world)
    local[:, 0] = root
    local[:, JOINT] = multiply(inverse(world[:, BEFORE]), world[:, JOINT])
    return local


def uniform_by_chains(p, scale):
    q = inverse_kinematics_by_chains(p, roots(p, 0))
    x = np.empty_like(p)
    x[:, 0] = p[:, 0] * scale
    for chain in CHAINS:
        r = q[:, 0]
        for parent, joint in zip(chain, chain[1:]):
            r = multiply(r, q[:, joint])
            x[:, joint] = x[:, parent] + rotate(r, np.broadcast_to(LENGTHS[joint] * DIRECTIONS[joint], p[:, 0].shape))
    return x


def inverse_kinematics_by_chains(x, root):
    q = np.empty(x.shape[:2] + (4,), np.float32)
    q[:, 0] = root
    for chain in CHAINS:
        r = root
        for parent, joint in zip(chain, chain[1:]):
            v = unit(x[:, joint] - x[:, parent])
            q[:, joint] = multiply(inverse(r), between(np.broadcast_to(DIRECTIONS[joint], v.shape), v))
            r = multiply(r, q[:, joint])
    return q


def roots(x, sigma):
    forward = facing(x, True)
    root = between(unit(smooth(forward, sigma) if sigma else forward), Z).astype(np.float32)
    root[0] = 1, 0, 0, 0
    return root


def features(p, by_chains):
    scale = LENGTHS[[5, 8]].sum() / np.linalg.norm(p[0, [5, 8]] - p[0, [2, 5]], axis=-1).sum()
    x = (uniform_by_chains if by_chains else uniform)(p, scale)
    x -= np.array([x[0, 0, 0], x[..., 1].min(), x[0, 0, 2]])
    x = rotate(between(facing(x[:1], False), Z)[:, None], x)
    root = roots(x, 20)
    local = (inverse_kinematics_by_chains if by_chains else inverse_kinematics)(x, root)[:, 1:]

    turn = np.arcsin(multiply(root[1:], inverse(root[:-1]))[:, 2:3])
    moved = x[1:] - x[:-1]
    speed = rotate(root[1:], moved[:, 0])[:, [0, 2]]
    ground = x[:, :1] * np.array([1, 0, 1], np.float32)
    positions = rotate(root[:-1, None], (x - ground)[:-1, 1:])
    velocities = rotate(root[:-1, None], moved)
    contacts = ((moved * moved).sum(-1) < 0.002)[:, [7, 10, 8, 11]]
    rows = len(x) - 1
    return np.concatenate([turn, speed, x[:-1, 0, 1:2], positions.reshape(rows, -1), two_columns(local[:-1]).reshape(rows, -1),
                           velocities.reshape(rows, -1), contacts], -1).astype(np.float32)


def joints(frames):
    """The figure of features.cpp: its zero pose with waving bones, walking a circle."""
    t, j = np.arange(frames)[:, None], np.arange(22)[None]
    p = np.zeros((frames, 22, 3))
    p[:, 0] = np.stack([0.01 * np.sin(0.02 * t[:, 0]), 1 + 0 * t[:, 0], 0.02 * t[:, 0]], -1)
    for joint, parent, _ in BONES:
        wave = 0.3 * np.sin(0.1 * t[:, 0] + joint)
        d = DIRECTIONS[joint] + np.stack([wave, 0.2 + 0 * wave, wave], -1)
        p[:, joint] = p[:, parent] + 0.3 * d
    return p.astype(np.float32)


def main():
    for frames in map(int, sys.argv[1:] or ["60", "200", "1000"]):
        p = joints(frames)
        for variant in ("numpy", "numpy-chains"):
            times = []
            start = time.perf_counter()
            while len(times) < 5 or (time.perf_counter() - start < 2 and len(times) < 300):
                before = time.perf_counter()
                out = features(p, variant == "numpy-chains")
                times.append(time.perf_counter() - before)
            low, middle, high = np.percentile(np.array(times) * 1e3, [0, 50, 90])
            print(f"humanml3d,{frames} frames sum {np.abs(out).sum():.2f},{variant},1,{low:.3f},{middle:.3f},{high:.3f},0,0")


if __name__ == "__main__":
    main()
