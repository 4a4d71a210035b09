#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Gestures that no free clip shows, laid by hand over people who stand: nods, looks, claps, salutes, shrugs.

    gestures.py STANDING... FOLDER

STANDING are AMASS files (.npz) of people who stand still, at 20 frames per second on the 24 joints of motionlang. Each
is at least as long as the longest gesture.
FOLDER receives one .npz for every gesture and person, and the standing itself, which may follow a gesture.

A gesture says where a wrist goes, as seen from the chest in metres (x left, y up, z ahead), or by how many degrees a
joint turns. Legs, breath and sway are those of the recorded person. examples/training/clips.sh calls this program.
"""
import os
import sys
from pathlib import Path

import numpy as np

FPS = 20
HIP, KNEE, SPINE, NECK, COLLAR, HEAD, SHOULDER, ELBOW = (1, 2), (4, 5), (3, 6, 9), 12, (13, 14), 15, (16, 17), (18, 19)
SHOULDER_AT, UPPER, FORE = np.array([0.18, 0.16, 0.0]), 0.27, 0.25  # of the left arm, from the chest
LEFT, RIGHT = 0, 1
X, Y, Z = np.eye(3)


def rotation(axis, angle):
    """The matrix of a rotation by `angle` radians."""
    x, y, z = axis
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


def from_vector(v):
    angle = np.linalg.norm(v)
    return np.eye(3) if angle < 1e-12 else rotation(v / angle, angle)


def to_vector(m):
    angle = np.arccos(np.clip((np.trace(m) - 1) / 2, -1, 1))
    if angle < 1e-9:
        return np.zeros(3)
    if angle > np.pi - 1e-4:  # the axis is the largest column of m + 1
        columns = m + np.eye(3)
        axis = columns[:, np.argmax(np.linalg.norm(columns, axis=0))]
        return angle * axis / np.linalg.norm(axis)
    return angle / (2 * np.sin(angle)) * np.array([m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]])


def between(a, b, share):
    return a @ from_vector(share * to_vector(a.T @ b))


def unit(v):
    return v / np.linalg.norm(v)


def arm(side, wrist, elbow_towards):
    """Rotations of shoulder and elbow that bring the wrist to a place, with the elbow bent towards a direction."""
    out = 1 if side == LEFT else -1
    shoulder = SHOULDER_AT * [out, 1, 1]
    way = np.asarray(wrist, float) - shoulder
    far = min(np.linalg.norm(way), 0.999 * (UPPER + FORE))
    way = unit(way)
    along = (far**2 + UPPER**2 - FORE**2) / (2 * far)
    aside = np.asarray(elbow_towards, float)
    aside = unit(aside - way * (aside @ way))
    upper = unit(along * way + np.sqrt(max(UPPER**2 - along**2, 0)) * aside)
    fore = unit(far * way - UPPER * upper)
    x = out * upper
    z = unit(fore - upper * (fore @ upper))
    bend = np.arccos(np.clip(upper @ fore, -1, 1))
    return np.stack([x, np.cross(z, x), z], axis=1), rotation(Y, -out * bend)


def ease(t):
    t = np.clip(t, 0, 1)
    return t * t * t * (10 - 15 * t + 6 * t * t)


def held(t, seconds, rise, fall):
    """From 0 to 1 in `rise` seconds, and back in the last `fall` seconds."""
    return min(ease(t / rise), ease((seconds - t) / fall))


class Pose:
    """Local rotations of one frame, changed by a gesture."""

    def __init__(self, rows):
        self.local = [from_vector(v) for v in rows]

    def turn(self, joint, axis, degrees):
        self.local[joint] = rotation(axis, np.radians(degrees)) @ self.local[joint]

    def reach(self, side, wrist, elbow_towards, share):
        """Moves an arm by a share of its way to a place."""
        if share <= 0:
            return
        for joint, goal in zip((SHOULDER[side], ELBOW[side]), arm(side, wrist, elbow_towards)):
            self.local[joint] = between(self.local[joint], goal, share)
        self.local[COLLAR[side]] = between(self.local[COLLAR[side]], np.eye(3), share)

    def gaze(self, left=0.0, up=0.0, tilt=0.0):
        for joint in (NECK, HEAD):
            self.turn(joint, X, -up / 2)
            self.turn(joint, Z, tilt / 2)
            self.turn(joint, Y, left / 2)

    def rows(self):
        return np.array([to_vector(m) for m in self.local])


# A gesture: seconds, and what it does to a pose at a time. `n`: strength, about 1; `r`: rate, about 1.
def nod(p, t, s, n, r):
    p.gaze(up=-held(t, s, 0.3, 0.3) * n * (10 + 14 * np.sin(2 * np.pi * 1.3 * r * t)))


def shake(p, t, s, n, r):
    p.gaze(left=held(t, s, 0.3, 0.3) * n * 28 * np.sin(2 * np.pi * 1.1 * r * t))


def look_left(p, t, s, n, r):
    p.gaze(left=held(t, s, 0.6 / r, 0.6 / r) * n * 55)


def look_up(p, t, s, n, r):
    p.gaze(up=held(t, s, 0.6 / r, 0.6 / r) * n * 38)


def look_down(p, t, s, n, r):
    p.gaze(up=-held(t, s, 0.6 / r, 0.6 / r) * n * 42)


def tilt(p, t, s, n, r):
    p.gaze(tilt=held(t, s, 0.5 / r, 0.5 / r) * n * 28)


def look_around(p, t, s, n, r):
    p.gaze(left=held(t, s, 0.4, 0.6) * n * 55 * np.sin(2 * np.pi * t / s), up=6 * np.sin(2 * np.pi * t / s * 2))


def twist(p, t, s, n, r):
    for joint in SPINE:
        p.turn(joint, Y, held(t, s, 0.5, 0.5) * n * 14 * np.sin(2 * np.pi * t / s))


def bow(p, t, s, n, r):
    w = held(t, s, 0.9 / r, 0.9 / r) * n
    for joint in SPINE:
        p.turn(joint, X, 17 * w)
    p.gaze(up=-15 * w)


def clap(p, t, s, n, r):
    w, apart = held(t, s, 0.5, 0.5), 0.065 + 0.07 * n * (1 - np.cos(2 * np.pi * 2.0 * r * t))
    for side, out in ((LEFT, 1), (RIGHT, -1)):
        p.reach(side, (out * apart, 0.0, 0.30), (out, -0.8, -0.3), w)


def salute(p, t, s, n, r):
    p.reach(RIGHT, (-0.16, 0.36, 0.13), (-1, 0.1, 0.1), held(t, s, 0.5 / r, 0.5 / r))


def wave(p, t, s, n, r):
    swing = 0.13 * n * np.sin(2 * np.pi * 1.4 * r * t)
    p.reach(RIGHT, (-0.36 + swing, 0.34 - 0.4 * swing**2, 0.14), (-0.8, -1, 0.1), held(t, s, 0.5, 0.5))


def wave_both(p, t, s, n, r):
    swing = 0.15 * n * np.sin(2 * np.pi * 1.2 * r * t)
    for side, out in ((LEFT, 1), (RIGHT, -1)):
        p.reach(side, (out * 0.30 + swing, 0.56, 0.10), (out, 0.1, 0), held(t, s, 0.6, 0.6))


def point_ahead(p, t, s, n, r):
    p.reach(RIGHT, (-0.14, 0.15, 0.52), (-0.4, -1, 0), held(t, s, 0.5 / r, 0.5 / r))


def point_aside(p, t, s, n, r):
    w = held(t, s, 0.5 / r, 0.5 / r)
    p.reach(RIGHT, (-0.68, 0.16, 0.12), (0, -1, -0.2), w)
    p.gaze(left=-40 * w)


def point_up(p, t, s, n, r):
    p.reach(RIGHT, (-0.22, 0.66, 0.10), (-1, 0, 0.3), held(t, s, 0.6 / r, 0.6 / r))


def drink(p, t, s, n, r):
    w = held(t, s, 0.7 / r, 0.7 / r)
    p.reach(RIGHT, (-0.10, 0.27, 0.17), (-0.6, -1, 0), w)
    p.gaze(up=14 * w)


def phone(p, t, s, n, r):
    p.reach(RIGHT, (-0.15, 0.29, 0.06), (-0.7, -1, 0.3), held(t, s, 0.6 / r, 0.6 / r))


def scratch(p, t, s, n, r):
    rub = 0.025 * n * np.sin(2 * np.pi * 2.2 * r * t)
    p.reach(RIGHT, (-0.15, 0.42 + rub, 0.02 + rub), (-1, 0.2, 0.2), held(t, s, 0.6, 0.6))


def hands_on_head(p, t, s, n, r):
    for side, out in ((LEFT, 1), (RIGHT, -1)):
        p.reach(side, (out * 0.13, 0.45, 0.02), (out, 0.2, -0.1), held(t, s, 0.7 / r, 0.7 / r))


def cover_face(p, t, s, n, r):
    w = held(t, s, 0.6 / r, 0.6 / r)
    for side, out in ((LEFT, 1), (RIGHT, -1)):
        p.reach(side, (out * 0.08, 0.25, 0.17), (out * 0.7, -1, 0.1), w)
    p.gaze(up=-12 * w)


def cross_arms(p, t, s, n, r):
    w = held(t, s, 0.7 / r, 0.7 / r)
    p.reach(LEFT, (-0.08, 0.0, 0.20), (0.8, -1, 0), w)
    p.reach(RIGHT, (0.08, 0.03, 0.24), (-0.8, -1, 0), w)


def shrug(p, t, s, n, r):
    w = held(t, s, 0.5 / r, 0.5 / r) * n
    for side, out in ((LEFT, 1), (RIGHT, -1)):
        p.reach(side, (out * 0.40, -0.10, 0.20), (out * 0.3, -1, -0.6), min(1, w))
        p.turn(COLLAR[side], Z, out * 17 * w)
    p.gaze(tilt=8 * w)


def push(p, t, s, n, r):
    w, ahead = held(t, s, 0.5, 0.6), ease((t - 0.5) / (0.6 / r))
    for side, out in ((LEFT, 1), (RIGHT, -1)):
        p.reach(side, (out * 0.15, 0.08, 0.18 + 0.29 * ahead), (out, -0.7, -0.2), w)


def march(p, t, s, n, r):
    for side, out in ((LEFT, 1), (RIGHT, -1)):
        step = held(t, s, 0.4, 0.4) * np.sin(2 * np.pi * 0.95 * r * t) * out
        lift = max(0.0, step) * n
        p.turn(HIP[side], X, -78 * lift)
        p.turn(KNEE[side], X, 82 * lift)
        p.turn(SHOULDER[side], X, 30 * step)  # the arm swings against its leg


ARMS, HEADS, TRUNK = "left arm,right arm", "head", "spine,head"
# name: function, seconds, parts, captions
GESTURES = {
    "nod": (
        nod, 2.6, HEADS,
        "nod | nod the head | nod yes | a person nods | someone nods the head | nodding | say yes with the head"),
    "shake_the_head": (
        shake, 2.8, HEADS,
        "shake the head | shake your head | a person shakes the head | shaking the head | say no with the head | "
        "someone shakes the head no"),
    "look_to_the_left": (
        look_left, 3.0, HEADS,
        "look to the left | look left | turn the head to the left | a person looks to the left | looking left | "
        "someone turns the head left"),
    "look_up": (
        look_up, 3.0, HEADS,
        "look up | raise the head and look up | a person looks up | looking up | look at the sky | "
        "someone looks up at the sky"),
    "look_down": (
        look_down, 3.0, HEADS,
        "look down | lower the head | a person looks down | looking down | look at the floor | "
        "someone lowers the head"),
    "tilt_the_head": (
        tilt, 2.8, HEADS,
        "tilt the head to the right | a person tilts the head to the right | lean the head to the right | "
        "tilting the head right"),
    "look_around": (
        look_around, 4.0, HEADS,
        "look around | look about | a person looks around | looking around | look to the left and to the right | "
        "someone looks around"),
    "twist": (
        twist, 3.6, TRUNK,
        "twist the upper body | twist the trunk | a person twists the upper body | twisting the torso | "
        "turn the upper body from side to side | rotate the torso left and right"),
    "bow": (
        bow, 3.2, TRUNK,
        "bow | take a bow | a person bows | bowing | bow politely | someone bows to the audience"),
    "clap": (
        clap, 3.2, ARMS,
        "clap | clap your hands | clap the hands | a person claps | a person is clapping | clapping | applaud | "
        "someone applauds"),
    "salute": (
        salute, 2.8, "right arm",
        "salute | salute with the right hand | a person salutes | saluting | a soldier salutes | "
        "raise the right hand to the forehead in a salute"),
    "wave": (
        wave, 3.2, "right arm",
        "wave | wave hello | wave with the right hand | a person waves with the right hand | waving | "
        "wave goodbye | say hello with the right hand | greet someone"),
    "wave_both": (
        wave_both, 3.4, ARMS,
        "wave with both arms | wave both hands overhead | a person waves with both arms | "
        "waving both arms above the head | signal with both arms"),
    "point_forward": (
        point_ahead, 2.8, "right arm",
        "point forward | point ahead | point forward with the right hand | a person points forward | pointing | "
        "point at something | point at something in front"),
    "point_to_the_right": (
        point_aside, 2.8, "right arm,head",
        "point to the right | a person points to the right | pointing to the right with the right hand | "
        "point to the right side"),
    "point_up": (
        point_up, 2.8, "right arm",
        "point up | point at the sky | a person points up with the right hand | pointing up"),
    "drink": (
        drink, 3.4, "right arm",
        "drink | drink from a cup | a person drinks | drinking from a glass with the right hand | take a sip | "
        "someone drinks water"),
    "phone": (
        phone, 4.0, "right arm",
        "talk on the phone | make a phone call | a person talks on the phone | hold a phone to the right ear | "
        "phoning | answer the phone"),
    "scratch_the_head": (
        scratch, 3.4, "right arm",
        "scratch the head | scratch your head | a person scratches the head | "
        "scratching the head with the right hand"),
    "hands_on_head": (
        hands_on_head, 3.4, ARMS,
        "put both hands on the head | hands on the head | a person puts the hands on the head | "
        "place both hands on top of the head | holding the head with both hands"),
    "cover_face": (
        cover_face, 3.2, ARMS,
        "cover the face | cover the face with both hands | a person covers the face | covering the eyes | "
        "hide the face in the hands | cry"),
    "cross_arms": (
        cross_arms, 3.8, ARMS,
        "cross the arms | fold the arms | cross your arms | a person crosses the arms | "
        "folding both arms in front of the chest | stand with crossed arms"),
    "shrug": (
        shrug, 2.6, ARMS,
        "shrug | shrug the shoulders | a person shrugs | shrugging | raise both shoulders and open the hands | "
        "someone shrugs the shoulders"),
    "push": (
        push, 2.8, ARMS,
        "push something | push something away | push with both hands | a person pushes with both hands | pushing | "
        "push forward with both hands"),
    "march": (
        march, 4.2, "left arm,right arm,legs",
        "march | march in place | march on the spot | a person marches on the spot | marching | "
        "a soldier marches in place | lift the knees in turn"),
}


def person_of(path):
    """The arrays of a file of STANDING. It is refused at another rate, or if a gesture is longer."""
    with np.load(path) as file:
        person = dict(file)
    rate = float(person.get("mocap_frame_rate", person.get("mocap_framerate", 0)))
    if rate != FPS:
        sys.exit(f"{path}: {rate:g} frames per second, expected {FPS}")
    frames, least = len(person["poses"]), max(int(seconds * FPS) for _, seconds, _, _ in GESTURES.values())
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


def main(arguments):
    *standing, folder = arguments
    folder = Path(folder)
    people = [person_of(path) for path in standing]
    folder.mkdir(parents=True, exist_ok=True)
    for k, person in enumerate(people):
        frames = len(person["poses"])
        write(folder / f"stand_{k}.npz", part_of(person, 0, 4 * FPS))
        for number, (name, (gesture, seconds, _, _)) in enumerate(GESTURES.items()):
            rng = np.random.default_rng([k, number])
            strength, rate = rng.uniform(0.85, 1.2), rng.uniform(0.85, 1.2)
            count = int(seconds * FPS)
            first = int(rng.integers(0, max(1, frames - count)))
            part = part_of(person, first, count)
            poses = part["poses"].copy()
            for f in range(count):
                pose = Pose(poses[f, :72].reshape(24, 3))
                gesture(pose, f / FPS, count / FPS, strength, rate)
                poses[f, :72] = pose.rows().ravel()
            write(folder / f"{name}_{k}.npz", {**part, "poses": poses})


def captions(people):
    """The lines of captions.tsv for the gestures."""
    for name, (_, seconds, parts, texts) in GESTURES.items():
        for k in range(people):
            yield f"gestures/{name}_{k}\t0\t{seconds}\t{parts}\t{texts}\tthen gestures/stand_{k}"


if __name__ == "__main__":
    if len(sys.argv) == 3 and sys.argv[1] == "--captions":
        print("\n".join(captions(int(sys.argv[2]))))
    elif len(sys.argv) > 2:
        main(sys.argv[1:])
    else:
        sys.exit(__doc__)
