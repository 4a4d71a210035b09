#!/usr/bin/env python3
"""Writes motions by the program, reads the files with other programs, and compares where the joints are.

    python3 tests/round_trips/run.py <program> [--rig character.glb] [--keep folder]

Readers: three.js and three-vrm (node and npm; MOTIONLANG_NODE_MODULES names a folder that has them already), Blender,
and numpy. A reader that is missing is skipped with a line. Exit status: 0 passed, 1 failed, 77 nothing could be read.

The motions: the bundled model's timeline, a random skeleton that no table knows, a random dance of Mixamo's joints, and
both bodies on a character (--rig), in units of their own below an armature that lies. Places of the first two come from
.npy files or a calculation of our own; on a character those of the program's BVH (--skeleton) are compared.
"""
import argparse
import json
import math
import os
import pathlib
import random
import shutil
import struct
import subprocess
import sys
import tempfile

try:
    import numpy as np
except ImportError:
    print("skipped: no numpy (python3-numpy)")
    sys.exit(77)

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
TOLERANCE = 1e-4  # metres
FRAMES = 12  # that are compared, spread over a motion


def turn(axis, degrees):
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    out = np.eye(3)
    i, j = [(1, 2), (2, 0), (0, 1)][axis]
    out[i, i] = out[j, j] = c
    out[i, j], out[j, i] = -s, s
    return out


class Bvh:
    """A BVH file, and where its joints are: a calculation by 4 x 4 matrices."""

    def __init__(self, text):
        words = iter(text.split())
        self.names, self.parents, self.offsets, self.channels = [], [], [], []
        stack = []
        for word in words:
            if word in ("ROOT", "JOINT"):
                self.names.append(next(words))
                self.parents.append(stack[-1] if stack else -1)
                self.offsets.append(None)
                self.channels.append([])
                stack.append(len(self.names) - 1)
            elif word == "End":
                stack.append(None)
            elif word == "OFFSET":
                offset = [float(next(words)) for _ in range(3)]
                if stack[-1] is not None:
                    self.offsets[stack[-1]] = offset
            elif word == "CHANNELS":
                self.channels[stack[-1]] = [next(words) for _ in range(int(next(words)))]
            elif word == "}":
                stack.pop()
            elif word == "MOTION":
                break
        next(words)
        frames = int(next(words))
        next(words), next(words)
        self.seconds = float(next(words))
        self.rows = np.array([float(w) for w in words]).reshape(frames, -1)

    def places(self, frame, unit=0.01):
        values = iter(self.rows[frame])
        world, out = [], {}
        for name, parent, offset, channels in zip(self.names, self.parents, self.offsets, self.channels):
            place, rotation = list(offset), np.eye(3)
            for channel in channels:
                axis = "XYZ".index(channel[0])
                if channel.endswith("position"):
                    place[axis] = next(values)
                else:
                    rotation = rotation @ turn(axis, next(values))
            local = np.eye(4)
            local[:3, :3], local[:3, 3] = rotation, unit * np.array(place)
            world.append(local if parent < 0 else world[parent] @ local)
            out[name] = world[-1][:3, 3]
        return out


MIXAMO = {"Hips": ("", 0, .95, 0), "Spine": ("Hips", 0, .1, 0), "Spine1": ("Spine", 0, .12, 0),
          "Spine2": ("Spine1", 0, .13, 0), "Neck": ("Spine2", 0, .15, 0), "Head": ("Neck", 0, .1, .02)}
for side, x in (("Left", 1), ("Right", -1)):
    MIXAMO |= {side + "Shoulder": ("Spine2", x * .06, .1, 0), side + "Arm": (side + "Shoulder", x * .12, 0, 0),
               side + "ForeArm": (side + "Arm", x * .27, 0, 0), side + "Hand": (side + "ForeArm", x * .25, 0, 0),
               side + "UpLeg": ("Hips", x * .09, -.06, 0), side + "Leg": (side + "UpLeg", 0, -.41, 0),
               side + "Foot": (side + "Leg", 0, -.4, 0), side + "ToeBase": (side + "Foot", 0, -.06, .14)}


def bvh_text(joints, frames, seconds, rng):
    """A dance of joints {name: (parent, offset)}, in centimetres, with curves of its own for each angle."""
    lines = ["HIERARCHY"]
    order = []

    def add(name, depth):
        parent, *offset = joints[name]
        channels = rng.sample(["Xrotation", "Yrotation", "Zrotation"], 3)
        order.append((name, parent, offset))
        lines.append("\t" * depth + ("JOINT " if parent else "ROOT ") + name)
        lines.append("\t" * depth + "{")
        lines.append("\t" * depth + "\tOFFSET " + " ".join(f"{100 * x:.6f}" for x in offset))
        kept = channels if parent else ["Xposition", "Yposition", "Zposition"] + channels
        lines.append("\t" * depth + f"\tCHANNELS {len(kept)} " + " ".join(kept))
        children = [n for n in joints if joints[n][0] == name]
        for child in children:
            add(child, depth + 1)
        if not children:
            lines.append("\t" * depth + "\tEnd Site")
            lines.append("\t" * depth + "\t{")
            lines.append("\t" * depth + "\t\tOFFSET 0 5 0")
            lines.append("\t" * depth + "\t}")
        lines.append("\t" * depth + "}")

    add(next(iter(joints)), 0)
    curves = [[(rng.uniform(5, 45), rng.uniform(0.5, 4), rng.uniform(0, 6)) for _ in range(3)] for _ in order]
    lines += ["MOTION", f"Frames: {frames}", f"Frame Time: {seconds:.9f}"]
    for f in range(frames):
        t, row = f * seconds, []
        for (_, parent, offset), angles in zip(order, curves):
            if not parent:
                row += [100 * offset[0] + 60 * t, 100 * offset[1] + 3 * math.sin(5 * t), 100 * offset[2] + 90 * t]
            row += [size * math.sin(rate * t + start) for size, rate, start in angles]
        lines.append(" ".join(f"{x:.6f}" for x in row))
    return "\n".join(lines) + "\n"


def random_joints(rng, count):
    joints = {"bone_0": ("", 0.1, 1.0, -0.2)}
    for i in range(1, count):
        joints[f"bone_{i}"] = (f"bone_{rng.randrange(max(0, i - 4), i)}", *(rng.uniform(-.3, .3) for _ in range(3)))
    return joints


def quaternion(m):
    """x, y, z, w of a rotation, by its largest component."""
    squares = [1 + m[0, 0] - m[1, 1] - m[2, 2], 1 - m[0, 0] + m[1, 1] - m[2, 2], 1 - m[0, 0] - m[1, 1] + m[2, 2],
               1 + m[0, 0] + m[1, 1] + m[2, 2]]
    k = int(np.argmax(squares))
    rows = [[squares[0], m[0, 1] + m[1, 0], m[0, 2] + m[2, 0], m[2, 1] - m[1, 2]],
            [m[0, 1] + m[1, 0], squares[1], m[1, 2] + m[2, 1], m[0, 2] - m[2, 0]],
            [m[0, 2] + m[2, 0], m[1, 2] + m[2, 1], squares[2], m[1, 0] - m[0, 1]],
            [m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], squares[3]]]
    q = np.array(rows[k])
    return (q / np.linalg.norm(q)).tolist()


def glb_bytes(document, binary):
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(binary), 0x004E4942) + binary
    return struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks


def rig_bytes(joints, names, rng, unit=100.0, lying=True, front=1, extensions=None):
    """A character: joints with axes of their own, in centimetres below an armature with Z up, and a skin.

    front: -1 turns it to face -Z, as characters of VRM 0.x do. extensions(nodes by joint) -> JSON
    """
    armature = turn(0, -90) if lying else np.eye(3)
    nodes = [{"name": "Armature", "rotation": quaternion(armature), "scale": [1 / unit] * 3, "children": [1]}]
    world, places, binds = {"": armature}, {"": np.zeros(3)}, []
    number = {}
    for name, (parent, *offset) in joints.items():
        offset = np.array([front * offset[0], offset[1], front * offset[2]])
        own = turn(1, rng.uniform(-180, 180)) @ turn(0, rng.uniform(-180, 180)) if lying else np.eye(3)
        place = places[parent] + offset
        nodes.append({"name": names(name), "rotation": quaternion(world[parent].T @ own),
                      "translation": (unit * world[parent].T @ offset).tolist()})
        number[name] = len(nodes) - 1
        if parent:
            nodes[number[parent]].setdefault("children", []).append(number[name])
        world[name], places[name] = own, place
        bind = np.eye(4)
        bind[:3, :3], bind[:3, 3] = own.T * unit, -unit * own.T @ place
        binds.append(bind.T)
    corners, bound, weights = [], [], []
    for k, name in enumerate(joints):
        for corner in ((-.04, 0, 0), (.04, 0, 0), (0, .06, 0)):
            corners.append(places[name] + corner)
            bound.append([k, 0, 0, 0])
            weights.append([1, 0, 0, 0])
    parts = [np.array(binds, "<f4"), np.array(corners, "<f4"), np.array(bound, "<u2"), np.array(weights, "<f4"),
             np.array([[0], [1]], "<f4"), np.array(2 * [nodes[1]["rotation"]], "<f4")]  # of an animation: it stands
    views, at = [], 0
    for part in parts:
        views.append({"buffer": 0, "byteOffset": at, "byteLength": part.nbytes})
        at += part.nbytes
    accessors = [{"bufferView": i, "componentType": 5123 if i == 2 else 5126, "count": len(p),
                  "type": ["MAT4", "VEC3", "VEC4", "VEC4", "SCALAR", "VEC4"][i]} for i, p in enumerate(parts)]
    for i in (1, 4):
        accessors[i] |= {"min": parts[i].min(0).tolist(), "max": parts[i].max(0).tolist()}
    nodes.append({"name": "Body", "mesh": 0, "skin": 0})
    document = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, len(nodes) - 1]}], "nodes": nodes,
                "meshes": [{"primitives": [{"attributes": {"POSITION": 1, "JOINTS_0": 2, "WEIGHTS_0": 3}}]}],
                "skins": [{"joints": list(range(1, len(joints) + 1)), "inverseBindMatrices": 0}],
                "animations": [{"name": "still", "channels": [{"sampler": 0, "target": {"node": 1, "path": "rotation"}}],
                                "samplers": [{"input": 4, "output": 5}]}],
                "accessors": accessors, "bufferViews": views, "buffers": [{"byteLength": at}]}
    if extensions:
        document["extensions"] = extensions(number)
        document["extensionsUsed"] = list(document["extensions"])
    return glb_bytes(document, b"".join(p.tobytes() for p in parts))


VRM = {"Hips": "hips", "Spine": "spine", "Spine1": "chest", "Spine2": "upperChest", "Neck": "neck", "Head": "head"}
for side in ("Left", "Right"):
    VRM |= {side + mixamo: side.lower() + bone for mixamo, bone in
            (("Shoulder", "Shoulder"), ("Arm", "UpperArm"), ("ForeArm", "LowerArm"), ("Hand", "Hand"),
             ("UpLeg", "UpperLeg"), ("Leg", "LowerLeg"), ("Foot", "Foot"), ("ToeBase", "Toes"))}


def vrm_1(number):
    return {"VRMC_vrm": {"specVersion": "1.0", "humanoid": {
        "humanBones": {j: {"node": n} for j, n in number.items()}},
        "meta": {"name": "test", "authors": ["a test"], "licenseUrl": "https://vrm.dev/licenses/1.0/"}}}


def vrm_0(number):
    return {"VRM": {"specVersion": "0.0", "meta": {"title": "test"}, "humanoid": {
        "humanBones": [{"bone": j, "node": n, "useDefaultValues": True} for j, n in number.items()]},
        "firstPerson": {}, "blendShapeMaster": {"blendShapeGroups": []},
        "secondaryAnimation": {"boneGroups": [], "colliderGroups": []}, "materialProperties": []}}


SMPL = {"pelvis": "hips", "spine1": "spine", "spine2": "chest", "spine3": "upperChest", "neck": "neck", "head": "head"}
for side in ("left", "right"):
    SMPL |= {f"{side}_{smpl}": side + bone for smpl, bone in
             (("collar", "Shoulder"), ("shoulder", "UpperArm"), ("elbow", "LowerArm"), ("wrist", "Hand"),
              ("hip", "UpperLeg"), ("knee", "LowerLeg"), ("ankle", "Foot"), ("foot", "Toes"))}
ROLES = SMPL | VRM


class Check:
    """A file, some frames of it, and where its joints should be: [{joint: place}] for each of them."""

    def __init__(self, what, file, rate, frames, expected, character=None, blender=True, moved=False):
        self.what, self.file, self.rate, self.frames, self.expected = what, str(file), rate, frames, expected
        self.character, self.blender, self.moved = character, blender, moved


def compare(check, reader, places):
    """Prints the farthest joint; True if it is near enough. Names that a program may not keep are compared as it has
    them: three.js leaves out some characters."""
    plain = lambda name: "".join(c for c in name if c.isalnum() or c == "_")
    places = {plain(name): rows for name, rows in places.items()}
    worst, where, missing = 0.0, "", []
    for k, expected in enumerate(check.expected):
        shift = np.zeros(3)
        if check.moved:  # heights of rest poses differ: what the root does not share is compared
            root = plain(next(iter(expected)))
            shift = np.array(places[root][k]) - expected[next(iter(expected))]
            shift[[0, 2]] = 0
        for joint, place in expected.items():
            if plain(joint) not in places:
                missing.append(joint)
                continue
            distance = float(np.linalg.norm(np.array(places[plain(joint)][k]) - place - shift))
            if not distance <= worst:
                worst, where = distance, f"{joint} in frame {check.frames[k]}"
    passed = not missing and worst <= TOLERANCE
    print(f"{'ok    ' if passed else 'FAILED'} {reader:8} {check.what}: {len(check.expected[0])} joints, "
          f"{len(check.frames)} frames, at most {worst:.1e} m off"
          + (f" ({where})" if not passed else "") + (f", without {sorted(set(missing))[:4]}" if missing else ""))
    return passed


def spread(count):
    return sorted({round(i * (count - 1) / (FRAMES - 1)) for i in range(FRAMES)})


class Writer:
    """Runs the program, and collects what is to be checked."""

    def __init__(self, program, folder):
        self.program, self.folder, self.checks = program, folder, []

    def run(self, *arguments):
        arguments = [str(a) for a in arguments]
        done = subprocess.run([self.program, *arguments], capture_output=True, text=True)
        if done.returncode != 0:
            raise SystemExit(f"{' '.join(arguments)}: {done.stdout}{done.stderr}")

    def check(self, what, file, truth, rename=None, **more):
        """truth: a Bvh with the same joints"""
        frames = spread(len(truth.rows))
        expected = [{(rename or {}).get(n, n): p for n, p in truth.places(f).items()} for f in frames]
        self.checks.append(Check(what, file, 1 / truth.seconds, frames, expected, **more))

    def motion(self, what, source, truth, rigs, vrm):
        """All files of one motion. source: its file; rigs: characters; vrm: makes VRM characters for .vrma"""
        stem = self.folder / what
        for kind in (".bvh", ".glb"):
            self.run("convert", source, f"{stem}_out{kind}")
            self.check(f"{what}{kind}", f"{stem}_out{kind}", truth)
        for name, rig in rigs.items():
            self.run("convert", source, f"{stem}_{name}.glb", "--rig", rig, "--drop-animations")
            self.run("convert", source, f"{stem}_{name}.bvh", "--skeleton", rig)
            self.check(f"{what} on {name}", f"{stem}_{name}.glb", Bvh(pathlib.Path(f"{stem}_{name}.bvh").read_text()))
        if not vrm:
            return
        self.run("convert", source, f"{stem}.vrma")
        self.run("convert", f"{stem}.vrma", f"{stem}_vrma.bvh")
        read = Bvh(pathlib.Path(f"{stem}_vrma.bvh").read_text())
        joints = humanoid(pathlib.Path(f"{stem}.vrma").read_bytes())
        for version, bytes_of in vrm.items():  # a character as large as the file
            character = pathlib.Path(f"{stem}_{version}.vrm")
            character.write_bytes(bytes_of(joints))
            self.check(f"{what}.vrma on VRM {version}", f"{stem}.vrma", read, character=str(character), blender=False)
        # joints are where the motion has them, at the height of the T-pose
        frames = spread(len(truth.rows))
        roles = {name: role for name, role in ROLES.items() if name in truth.names}
        expected = [{roles[n]: p for n, p in truth.places(f).items() if n in roles} for f in frames]
        self.checks.append(Check(f"{what}.vrma as nodes", f"{stem}.vrma", 1 / truth.seconds, frames, expected,
                                 blender=False, moved=True))


def humanoid(glb):
    """The bones of a .vrma file at rest: {name: (parent, x, y, z)}, parents first."""
    size = struct.unpack("<I", glb[12:16])[0]
    document = json.loads(glb[20:20 + size])
    bones = document["extensions"]["VRMC_vrm_animation"]["humanoid"]["humanBones"]
    name = {bone["node"]: key for key, bone in bones.items()}
    parent = {child: n for n, node in enumerate(document["nodes"]) for child in node.get("children", [])}
    return {name[n]: (name.get(parent.get(n), ""), *document["nodes"][n].get("translation", [0, 0, 0]))
            for n in sorted(name)}


def check_arrays(writer, source, truth):
    """.npz and .npy through numpy: an .npz file's rotations on SMPL's offsets are where the .npy file has the joints."""
    writer.run("convert", source, writer.folder / "arrays.npz")
    writer.run("convert", source, writer.folder / "arrays.npy")
    writer.run("convert", source, writer.folder / "arrays.bvh", "--smpl")
    joints = np.load(writer.folder / "arrays.npy")
    body = np.load(writer.folder / "arrays.npz")
    smpl = Bvh((writer.folder / "arrays.bvh").read_text())
    frames = len(truth.rows)
    poses = body["poses"].reshape(frames, -1, 3)
    names = ("pelvis left_hip right_hip spine1 left_knee right_knee spine2 left_ankle right_ankle spine3 left_foot "
             "right_foot neck left_collar right_collar head left_shoulder right_shoulder left_elbow right_elbow "
             "left_wrist right_wrist").split()
    turned = lambda p: np.array([p[0], -p[2], p[1]])  # Y up to Z up
    worst = {".npy": 0.0, ".npz": 0.0}
    for f in spread(frames):
        world, places = {}, {}
        for j, name in enumerate(names):
            n = smpl.names.index(name)
            parent = smpl.parents[n]
            axis = poses[f, j]
            angle = np.linalg.norm(axis)
            k = np.cross(np.eye(3), axis / angle if angle > 0 else axis)
            own = np.eye(3) + math.sin(angle) * k + (1 - math.cos(angle)) * k @ k
            if parent < 0:
                world[name] = own
                places[name] = body["trans"][f]
            else:
                above = smpl.names[parent]
                world[name] = world[above] @ own
                # offsets are Y up; the root's rotation turns them to Z up
                places[name] = places[above] + world[above] @ (0.01 * np.array(smpl.offsets[n]))
        at = smpl.places(f)
        for j, name in enumerate(names):
            worst[".npy"] = max(worst[".npy"], float(np.linalg.norm(joints[f, j] - turned(at[name]))))
            seen = places[name] - places["pelvis"] - turned(at[name] - at["pelvis"])
            worst[".npz"] = max(worst[".npz"], float(np.linalg.norm(seen)))
    path = body["trans"][-1] - body["trans"][0] - turned(smpl.places(frames - 1)["pelvis"] - smpl.places(0)["pelvis"])
    worst[".npz"] = max(worst[".npz"], float(np.linalg.norm(path)))
    for kind, off in worst.items():
        print(f"{'ok    ' if off <= TOLERANCE else 'FAILED'} numpy    dance{kind}: 22 joints, at most {off:.1e} m off")
    rate = float(body["mocap_framerate"])
    same = abs(rate - 1 / truth.seconds) < 1e-3 and body["poses"].shape == (frames, 156) and joints.ndim == 3
    print(f"{'ok    ' if same else 'FAILED'} numpy    dance.npz: {rate:g} frames per second, shapes of AMASS")
    return same and max(worst.values()) <= TOLERANCE


def node_modules(folder):
    """Where three.js and three-vrm are; None without them, after a line that says so."""
    if not shutil.which("node"):
        return print("skipped: three.js (no node)")
    known = os.environ.get("MOTIONLANG_NODE_MODULES")
    if known:
        return known
    if not shutil.which("npm"):
        return print("skipped: three.js (no npm, and MOTIONLANG_NODE_MODULES names no folder)")
    packages = ["three@0.187.0", "@pixiv/three-vrm@3.5.5", "@pixiv/three-vrm-animation@3.5.5"]
    try:
        done = subprocess.run(["npm", "install", "--silent", "--no-audit", "--no-fund", "--prefix", str(folder),
                               *packages], capture_output=True, text=True, timeout=180)
    except subprocess.TimeoutExpired:
        return print("skipped: three.js (npm takes too long)")
    if done.returncode != 0:
        return print(f"skipped: three.js (npm: {done.stderr.strip().splitlines()[-1:]})")
    return folder / "node_modules"


def read_by(command, folder, jobs):
    (folder / "jobs.json").write_text(json.dumps(jobs))
    done = subprocess.run([*command, str(folder / "jobs.json"), str(folder / "places.json")], capture_output=True,
                          text=True)
    if done.returncode != 0 or not (folder / "places.json").exists():
        raise SystemExit(f"{command[0]}: {done.stdout[-2000:]}{done.stderr[-2000:]}")
    places = json.loads((folder / "places.json").read_text())
    (folder / "places.json").unlink()
    return places


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--rig", help="a character besides the one that is made here")
    parser.add_argument("--keep", help="folder in which the files stay")
    options = parser.parse_args()
    folder = pathlib.Path(options.keep or tempfile.mkdtemp()).resolve()
    folder.mkdir(exist_ok=True)
    try:
        return check_all(options, folder)
    finally:
        if not options.keep:
            shutil.rmtree(folder)


def check_all(options, folder):
    rng = random.Random(7)
    writer = Writer(str(pathlib.Path(options.program).resolve()), folder)
    rigs = {"rig": folder / "rig.glb"}
    (folder / "rig.glb").write_bytes(rig_bytes(MIXAMO, lambda n: "mixamorig:" + n, rng))
    if options.rig:
        rigs["character"] = pathlib.Path(options.rig).resolve()
    vrm = {"1.0": lambda joints: rig_bytes(joints, lambda n: "J_" + n, rng, 100, True, 1, vrm_1),
           "0.x": lambda joints: rig_bytes(joints, lambda n: "J_" + n, rng, 1, False, -1, vrm_0)}

    writer.run("generate", "--timeline", ROOT / "examples/timelines/walk_and_raise_arms.txt", "--seed", 3, "--out", folder)
    generated = next(folder.glob("*.bvh"))
    writer.motion("timeline", generated, Bvh(generated.read_text()), rigs, vrm)
    for name, joints, rate in (("random", random_joints(rng, 31), 24), ("dance", MIXAMO, 60)):
        source = folder / f"{name}.bvh"
        source.write_text(bvh_text(joints, 2 * rate, 1 / rate, rng))
        known = name == "dance"
        writer.motion(name, source, Bvh(source.read_text()), rigs if known else {}, vrm if known else {})

    passed = check_arrays(writer, folder / "dance.bvh", Bvh((folder / "dance.bvh").read_text()))
    modules = node_modules(folder)
    if modules:
        jobs = [{"file": c.file, "times": [f / c.rate for f in c.frames], "character": c.character}
                for c in writer.checks]
        for check, places in zip(writer.checks, read_by(["node", str(HERE / "three.mjs"), str(modules)], folder, jobs)):
            passed = compare(check, "three.js", places) and passed
    blender = os.environ.get("MOTIONLANG_BLENDER") or shutil.which("blender")
    if blender:
        checks = [c for c in writer.checks if c.blender]
        jobs = [{"file": c.file, "rate": c.rate, "frames": c.frames} for c in checks]
        command = [blender, "--background", "--factory-startup", "--python", str(HERE / "blender.py"), "--"]
        for check, places in zip(checks, read_by(command, folder, jobs)):
            passed = compare(check, "Blender", places) and passed
    else:
        print("skipped: Blender (no program blender)")
    print("passed" if passed else "failed")
    return 0 if passed else 1


sys.exit(main())
