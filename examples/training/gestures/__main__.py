#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Movements laid by hand over people who stand or walk: nods, claps, kicks, turns, pushes, music, sport.

    gestures STANDING... [--walking WALKING...] FOLDER
    gestures --captions STANDING [WALKING]      how many people stand and walk; prints the lines of a table

STANDING are AMASS files (.npz) of people who stand still, at 20 frames per second on the 24 joints of motionlang. Each
is at least as long as the longest gesture. WALKING are files of people who walk ahead.
FOLDER receives one .npz for every gesture and person, and the standing itself, which may follow a gesture.

A gesture says where a wrist goes, by how many degrees a joint turns, how deep the knees bend, or how the figure steps
and turns. All else, breath and sway, is the person's. standing.py, acting.py, stepping.py and walking.py have a table.
examples/training/clips.sh calls this program for the training, and remember.sh for the memory of the bundled weights.
"""
import os
import sys
from pathlib import Path

import numpy as np

from acting import ACTING, ACTING_HELD
from pose import ANKLE, FPS, HIP, KNEE, Pose, Z, between, ease, from_vector, rotation, to_vector
from standing import AGAIN, HELD, STANDING
from stepping import GOES_ON, ONE_STEP, STEPPED
from walking import HALTS, WALKS

GESTURES = {**STANDING, **STEPPED, **ACTING, **AGAIN, **ONE_STEP}


def person_of(path, gestures):
    """The arrays of a file. It is refused at another rate, or if a gesture is longer."""
    with np.load(path) as file:
        person = dict(file)
    rate = float(person.get("mocap_frame_rate", person.get("mocap_framerate", 0)))
    if rate != FPS:
        sys.exit(f"{path}: {rate:g} frames per second, expected {FPS}")
    frames, least = len(person["poses"]), max(int(seconds * FPS) for _, seconds, *_ in gestures.values())
    if frames < least:
        sys.exit(f"{path}: {frames} frames, the longest gesture has {least}")
    return person


def part_of(person, first, count):
    """Every array with a row for each frame, cut to some of them."""
    frames = len(person["poses"])
    return {key: x[first : first + count] if x.shape[:1] == (frames,) else x for key, x in person.items()}


def write(path, arrays):
    """The file appears when it is whole."""
    written = path.with_suffix(".tmp.npz")
    np.savez_compressed(written, **arrays)
    os.replace(written, path)


def slower(person, speed, count):
    """`count` frames of a clip that is played at a share of its speed, from its end if that is below 0."""
    at = np.arange(count) * abs(speed)
    at = at[::-1] if speed < 0 else at
    before, share = at.astype(int), (at % 1.0)[:, None]
    after = np.minimum(before + 1, len(person["poses"]) - 1)
    poses, places = person["poses"], person["trans"]
    mixed = poses[before].copy()
    for f in range(count):
        rows = [[from_vector(v) for v in poses[i, :72].reshape(24, 3)] for i in (before[f], after[f])]
        mixed[f, :72] = np.array([to_vector(between(x, y, share[f, 0])) for x, y in zip(*rows)]).ravel()
    return {**part_of(person, 0, count), "poses": mixed, "trans": (1 - share) * places[before] + share * places[after]}


def heading(ways):
    return np.arctan2(*ways.sum(axis=0)[1::-1])


def halted(clip, height):
    """The walk ends where the legs pass each other, 2.2 to 3 s after its begin, and the figure stands."""
    poses, places = clip["poses"].copy(), clip["trans"].copy()
    hips = poses[:, 3:9:3]  # how far each hip is turned ahead
    end = min(range(int(2.2 * FPS), int(3.0 * FPS)), key=lambda f: abs(hips[f, 0] - hips[f, 1]))
    speed = places[end] - places[end - 1]
    for f in range(end + 1, len(poses)):
        share, after = ease((f - end) / 9), (f - end) / FPS
        poses[f], places[f] = poses[end], places[end]
        rows = [from_vector(v) for v in poses[f, :72].reshape(24, 3)]
        for joint in HIP + KNEE + ANKLE:
            rows[joint] = between(rows[joint], np.eye(3), share)
        poses[f, :72] = np.array([to_vector(m) for m in rows]).ravel()
        places[f] += speed * FPS * 0.12 * (1 - np.exp(-after / 0.12)) * [1, 1, 0]
        places[f, 2] += share * (height - places[end, 2])
    return {**clip, "poses": poses, "trans": places}


def bend(poses, places, degrees):
    """Turns a path to the left by so many degrees in all, evenly, or by those that a function gives for a time."""
    ways, count = np.diff(places, axis=0), len(places)
    drift = np.degrees(heading(ways[-FPS:]) - heading(ways[:FPS]))
    drift -= 360 * np.round(drift / 360)
    for f in range(1, count):
        share = f / (count - 1)
        by = (degrees(f / FPS) if callable(degrees) else degrees * share) - drift * share
        turn = rotation(Z, np.radians(by))
        poses[f, :3] = to_vector(turn @ from_vector(poses[f, :3]))
        places[f] = places[f - 1] + turn @ ways[f - 1]


def lay(part, gesture, strength, rate):
    """A gesture over a clip of its length."""
    poses, places = part["poses"].copy(), part["trans"].copy()
    for f in range(len(poses)):
        pose = Pose(poses[f, :72].reshape(24, 3), places[f])
        gesture(pose, f / FPS, len(poses) / FPS, strength, rate)
        poses[f, :72] = pose.rows().ravel()
    return {**part, "poses": poses, "trans": places}


def main(arguments):
    *clips, folder = arguments
    standing, walking = (clips[: clips.index("--walking")], clips[clips.index("--walking") + 1 :]) \
        if "--walking" in clips else (clips, [])
    folder = Path(folder)
    people = [person_of(path, GESTURES) for path in standing]
    walkers = [person_of(path, WALKS) for path in walking]
    folder.mkdir(parents=True, exist_ok=True)
    for k, person in enumerate(people):
        frames = len(person["poses"])
        write(folder / f"stand_{k}.npz", part_of(person, 0, 4 * FPS))
        for number, (name, (gesture, seconds, _, _)) in enumerate(GESTURES.items()):
            rng = np.random.default_rng([k, number])
            strength, rate = rng.uniform(0.85, 1.2), rng.uniform(0.85, 1.2)
            count = int(seconds * FPS)
            first = int(rng.integers(0, max(1, frames - count)))
            write(folder / f"{name}_{k}.npz", lay(part_of(person, first, count), gesture, strength, rate))
    for k, person in enumerate(walkers):
        for name, (gesture, seconds, _, _, speed, degrees) in WALKS.items():
            clip = lay(slower(person, speed, int(seconds * FPS)), gesture, 1.0, 1.0)
            bend(clip["poses"], clip["trans"], degrees)
            if name in HALTS:
                clip = halted(clip, np.mean(people[k % len(people)]["trans"][:, 2]))
            write(folder / f"{name}_{k}.npz", clip)


def captions(people, walkers=0):
    """The lines of captions.tsv for the gestures."""
    for count, table in ((people, GESTURES), (walkers, WALKS)):
        for name, (_, seconds, parts, texts, *_) in table.items():
            for k in range(count):
                then = "\thold" if name in HELD | ACTING_HELD else f"\tthen gestures/stand_{k}"
                if table is WALKS and name not in HALTS or name in GOES_ON or name.startswith(("hold_", "stay_")):
                    then = ""
                yield f"gestures/{name}_{k}\t0\t{seconds}\t{parts}\t{texts}{then}"


if __name__ == "__main__":
    if len(sys.argv) in (3, 4) and sys.argv[1] == "--captions":
        print("\n".join(captions(*map(int, sys.argv[2:]))))
    elif len(sys.argv) > 2:
        main(sys.argv[1:])
    else:
        sys.exit(__doc__)
