# SPDX-License-Identifier: MIT
"""Gestures of people who stand: nods, looks, claps, kicks, jumping jacks, sitting down.

A gesture is a function of a pose `p`, a time `t` and the length `s` in seconds, a strength `n` and a rate `r`, both
about 1. It says where a wrist goes, as seen from the chest in metres (x left, y up, z ahead), by how many degrees a
joint turns, or how deep the knees bend.
"""
import numpy as np

from pose import (ANKLE, COLLAR, GRAVITY, HIP, KNEE, LEFT, LEG, RIGHT, SHOULDER, SHOULDER_AT, SPINE, X, Y, Z,
                  ease, held)
from stepping import leap, spin, turn_around, turn_left


def as_it_is(p, t, s, n, r):
    """The person alone."""


def nod(p, t, s, n, r):
    down = held(t, s, 0.3, 0.3) * n * np.sin(2 * np.pi * 1.3 * r * t)
    p.gaze(up=-held(t, s, 0.3, 0.3) * n * 10 - 16 * down)
    p.trunk(ahead=4 * down)


def shake(p, t, s, n, r):
    left = held(t, s, 0.3, 0.3) * n * np.sin(2 * np.pi * 1.1 * r * t)
    p.gaze(left=32 * left)
    p.trunk(left=16 * left)


def look_left(p, t, s, n, r):
    w = held(t, s, 0.6 / r, 0.6 / r) * n
    p.gaze(left=50 * w)
    p.trunk(left=14 * w)


def look_up(p, t, s, n, r):
    p.gaze(up=held(t, s, 0.6 / r, 0.6 / r) * n * 38)


def look_down(p, t, s, n, r):
    p.gaze(up=-held(t, s, 0.6 / r, 0.6 / r) * n * 42)


def tilt(p, t, s, n, r):
    p.gaze(tilt=held(t, s, 0.5 / r, 0.5 / r) * n * 28)


def look_around(p, t, s, n, r):
    left = held(t, s, 0.4, 0.6) * n * np.sin(3 * np.pi * t / s)
    p.gaze(left=45 * left, up=6 * np.sin(2 * np.pi * t / s * 2))
    p.trunk(left=42 * left)


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
    w = held(t, s, 0.5 / r, 0.5 / r)
    p.reach(RIGHT, (-0.16, 0.36, 0.13), (-1, 0.1, 0.1), w)
    p.trunk(left=11 * w * np.sin(2 * np.pi * 0.5 * r * t))


def wave(p, t, s, n, r):
    swing = 0.13 * n * np.sin(2 * np.pi * 1.4 * r * t)
    p.reach(RIGHT, (-0.36 + swing, 0.34 - 0.4 * swing**2, 0.14), (-0.8, -1, 0.1), held(t, s, 0.5, 0.5))


def wave_both(p, t, s, n, r):
    swing = 0.15 * n * np.sin(2 * np.pi * 1.2 * r * t)
    for side, out in ((LEFT, 1), (RIGHT, -1)):
        p.reach(side, (out * 0.30 + swing, 0.56, 0.10), (out, 0.1, 0), held(t, s, 0.6, 0.6))


def point_ahead(p, t, s, n, r):
    w, again = held(t, s, 0.5 / r, 0.5 / r), np.sin(2 * np.pi * 1.3 * r * t)
    p.reach(RIGHT, (-0.14, 0.15 + 0.03 * again, 0.47 + 0.05 * again), (-0.4, -1, 0), w)
    p.trunk(left=w * (10 + 8 * again), ahead=5 * w)


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
    p.trunk(left=9 * w * np.sin(2 * np.pi * 0.5 * r * t), tilt=3 * w * np.sin(2 * np.pi * 0.3 * r * t))


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


def strike(t, begin, out, back):
    """From 0 to 1 in `out` seconds from `begin` on, and back in `back` seconds."""
    return ease((t - begin) / out) * (1 - ease((t - begin - out - 0.05) / back))


def guard(p, side, ahead, w):
    """A fist before the chin, which goes ahead by a share."""
    out = 1 if side == LEFT else -1
    p.reach(side, (out * (0.14 - 0.05 * ahead), 0.12 + 0.03 * ahead, 0.17 + 0.34 * ahead), (out * 0.7, -1, -0.2), w)


def punch(p, t, s, n, r):
    w, hit = held(t, s, 0.45, 0.6), strike(t, 0.75, 0.2 / r, 0.35)
    guard(p, LEFT, 0, w)
    guard(p, RIGHT, hit, w)
    p.trunk(left=22 * n * hit - 8 * w * (1 - hit), ahead=6 * w)
    p.crouch(10 * w)


def box(p, t, s, n, r):
    w = held(t, s, 0.5, 0.6)
    hits = [0.0, 0.0]
    for k, begin in enumerate(np.arange(0.6, s - 1.0, 0.42 / r)):
        hits[k % 2] = max(hits[k % 2], strike(t, begin, 0.17, 0.25))
    guard(p, LEFT, hits[LEFT], w)
    guard(p, RIGHT, hits[RIGHT], w)
    p.trunk(left=18 * n * (hits[RIGHT] - hits[LEFT]), ahead=8 * w)
    p.crouch(w * (12 + 4 * np.sin(2 * np.pi * 1.2 * r * t)))


def throw(p, t, s, n, r):
    back, ahead = ease(t / 0.8) * (1 - ease((t - 1.0) / 0.2)), strike(t, 1.0, 0.22 / r, 0.9)
    w = held(t, s, 0.6, 0.7)
    x, y, z = np.array([-0.42, 0.30, -0.16]) * (1 - ahead) + np.array([-0.12, 0.10, 0.48]) * ahead
    p.reach(RIGHT, (x, y, z), (-1, -0.3, -0.3), w)
    p.reach(LEFT, (0.26, 0.05, 0.30), (1, -0.8, 0), w * back)
    p.trunk(left=32 * n * ahead - 28 * n * back, ahead=14 * ahead - 6 * back)
    p.crouch(14 * max(back, ahead))


def stretch(p, t, s, n, r):
    w = held(t, s, 1.0 / r, 1.0 / r)
    side = np.sin(2 * np.pi * (t - 1.0) / (s - 2.0)) if 1.0 < t < s - 1.0 else 0.0
    for arm_side, out in ((LEFT, 1), (RIGHT, -1)):
        p.reach(arm_side, (out * 0.16, 0.66, -0.02), (out, 0.1, 0.2), w)
    p.trunk(ahead=-10 * n * w, tilt=20 * n * side)
    p.gaze(up=14 * w)


def kick(p, t, s, n, r):
    back, out = ease(t / 0.7) * (1 - ease((t - 0.8) / 0.15)), strike(t, 0.8, 0.25 / r, 0.55)
    p.turn(HIP[RIGHT], X, 20 * back - 78 * n * out)
    p.turn(KNEE[RIGHT], X, 26 * back + 14 * out)
    p.fold(LEFT, 8 * max(back, out))
    p.rise(-2 * LEG * (1 - np.cos(np.radians(8 * max(back, out)))))
    p.trunk(ahead=8 * back - 12 * out, left=10 * out)
    for side, away in ((LEFT, 1), (RIGHT, -1)):
        p.reach(side, (away * 0.36, -0.12, 0.20 * (1 if side == LEFT else -0.4)), (away, -0.6, -0.5), max(back, out))


def dance(p, t, s, n, r):
    w, beat = held(t, s, 0.4, 0.5), 2 * np.pi * 1.15 * r * t
    sway = np.sin(beat)
    p.place[:2] += w * 0.05 * sway * p.left()
    for side, out in ((LEFT, 1), (RIGHT, -1)):
        p.fold(side, w * n * 48 * max(0.0, out * sway) ** 0.8)
        p.reach(side, (out * 0.36, 0.12 + 0.24 * out * sway, 0.22 + 0.08 * np.cos(beat)), (out, -0.8, -0.2), w)
    p.trunk(left=16 * w * sway, tilt=8 * w * sway, ahead=4 * w * np.cos(2 * beat))
    p.gaze(tilt=8 * w * sway)


def squat(p, t, s, n, r):
    knees_bent(p, held(t, s, 1.0 / r, 1.0 / r), n)


def two_squats(p, t, s, n, r):
    knees_bent(p, held(t % (s / 2), s / 2, 1.0, 1.0), n)


def knees_bent(p, w, n):
    p.crouch(62 * min(1, n) * w)
    p.hinge(14 * w)
    p.trunk(ahead=16 * w)
    for side, out in ((LEFT, 1), (RIGHT, -1)):
        p.reach(side, (out * 0.16, 0.02, 0.46), (out * 0.4, -1, 0), w)


def pick_up(p, t, s, n, r):
    w = held(t, s, 1.1 / r, 1.1 / r)
    p.crouch(66 * w)
    p.hinge(38 * w)
    p.trunk(ahead=48 * w)
    p.reach(RIGHT, (-0.10, -0.38, 0.28), (-1, 0, -0.2), w)
    p.gaze(up=-10 * w)


def jump_up_and_down(p, t, s, n, r):
    arms = leap(p, t, 0.6 if t < 1.5 else 2.0, 0.36, 38)
    for side, out in ((LEFT, 1), (RIGHT, -1)):
        p.reach(side, (out * 0.28, 0.0, 0.26), (out, -0.6, -0.4), 0.8 * arms)


def hop(p, t, s, n, r):
    w = held(t, s, 0.4, 0.4)
    p.turn(HIP[RIGHT], X, -20 * w)
    p.turn(KNEE[RIGHT], X, 80 * w)
    for begin in (0.8, 1.5, 2.2):
        if begin - 0.35 <= t < begin + 0.35:
            flight = (t - begin) / 0.28
            if 0 <= flight < 1:
                p.rise(GRAVITY / 2 * 0.28**2 * flight * (1 - flight))
            else:
                away = (begin - t) / 0.35 if t < begin else (t - begin - 0.28) / 0.07
                bend = 16 * np.sin(np.pi * np.clip(away, 0, 1))
                p.fold(LEFT, bend)
                p.rise(-2 * LEG * (1 - np.cos(np.radians(bend))))
    for side, out in ((LEFT, 1), (RIGHT, -1)):
        p.reach(side, (out * 0.40, -0.10, 0.10), (out, -0.6, -0.4), 0.8 * w)
    p.trunk(ahead=6 * w)


def jumping_jacks(p, t, s, n, r):
    beats, air = np.arange(0.4, s - 0.7, 0.5), 0.28
    apart = 0.0
    for k, begin in enumerate(beats):
        share = ease((t - begin) / air)
        apart = share if k % 2 == 0 and t >= begin else 1 - share if t >= begin else apart
        if begin <= t < begin + air:
            p.rise(GRAVITY / 2 * (t - begin) * (begin + air - t))
        for edge in (begin, begin + air):
            p.crouch(9 * max(0.0, 1 - abs(t - edge) / 0.11))
    if len(beats) % 2:
        apart *= 1 - ease((t - s + 0.5) / 0.4)
    for side, out in ((LEFT, 1), (RIGHT, -1)):
        p.turn(HIP[side], Z, out * 15 * apart)
        p.turn(ANKLE[side], Z, -out * 15 * apart)
        up = 160 * apart  # of the arm, from hanging
        angle = np.radians(up - 82)
        wrist = SHOULDER_AT * [out, 1, 1] + 0.48 * np.array([out * np.cos(angle), np.sin(angle), 0.12])
        p.reach(side, wrist, (out * 0.2, 0.3, -1), held(t, s, 0.3, 0.3))
    p.rise(-2 * LEG * (1 - np.cos(np.radians(15 * apart))))


def raised(p, sides, share):
    """Arms on their way up: first ahead of the chest, then above the head."""
    for side in sides:
        out = 1 if side == LEFT else -1
        low, high = np.array([out * 0.30, 0.06, 0.36]), np.array([out * 0.20, 0.64, 0.08])
        p.reach(side, low + (high - low) * max(0, 2 * share - 1), (out, -0.6, -0.3), min(1, 2 * share))


def raise_both_arms(p, t, s, n, r):
    raised(p, (LEFT, RIGHT), ease(t / 1.6))


def hold_both_arms_up(p, t, s, n, r):
    raised(p, (LEFT, RIGHT), 1)


def raise_right_arm(p, t, s, n, r):
    raised(p, (RIGHT,), ease(t / 1.6))


def hold_right_arm_up(p, t, s, n, r):
    raised(p, (RIGHT,), 1)


def seat(p, share):
    """Sits on a stool that is as high as the knees: the shanks stay where they are."""
    bent = np.radians(86 * share)
    for side in (LEFT, RIGHT):
        p.turn(HIP[side], X, -86 * share)
        p.turn(KNEE[side], X, 86 * share)
    p.place[:2] -= LEG * np.sin(bent) * p.ahead()
    p.rise(-LEG * (1 - np.cos(bent)))


def sit(p, t, s, n, r):
    sit_down(p, ease((t - 0.2) / 1.5))


def sit_down(p, share):
    seat(p, share)
    p.trunk(ahead=38 * np.sin(np.pi * share) + 4 * share)
    for side, out in ((LEFT, 1), (RIGHT, -1)):
        p.reach(side, (out * 0.16, -0.22, 0.34), (out, -0.6, -0.3), share)


def sit_down_and_stand_up(p, t, s, n, r):
    sit_down(p, ease((t - 0.2) / 1.5) * (1 - ease((t - 2.7) / 1.5)))


def stay_seated(p, t, s, n, r):
    sit(p, 9, s, n, r)


def kneel(p, t, s, n, r):
    share = ease((t - 0.2) / 1.6)
    p.turn(HIP[LEFT], X, -88 * share)
    p.turn(KNEE[LEFT], X, 88 * share)
    p.turn(HIP[RIGHT], X, 4 * share)
    p.turn(KNEE[RIGHT], X, 92 * share)
    p.turn(ANKLE[RIGHT], X, 40 * share)
    p.rise(-0.42 * (1 - np.cos(np.pi / 2 * share)))
    p.trunk(ahead=18 * np.sin(np.pi * share) + 5 * share)


def stay_kneeling(p, t, s, n, r):
    kneel(p, 9, s, n, r)


def lean_forward(p, t, s, n, r):
    w = held(t, s, 1.0 / r, 1.0 / r)
    p.hinge(38 * w)
    p.trunk(ahead=36 * w)
    p.gaze(up=-8 * w)


def jump_forward(p, t, s, n, r):
    begin, air, way = 1.2, 0.42, 0.75 * min(1.1, n)
    into, after = ease((t - 0.2) / 0.85), 1 - ease((t - begin - air - 0.1) / 1.1)
    if begin <= t < begin + air:
        p.rise(GRAVITY / 2 * (t - begin) * (begin + air - t))
    elif t < begin:
        p.crouch(46 * into * (1 - ease((t - begin + 0.15) / 0.15)))
    else:
        p.crouch(40 * ease((t - begin - air) / 0.12) * after)
    arms, swing = into * after, ease((t - begin + 0.25) / 0.3)
    flown = np.clip((t - begin) / air, 0, 1)
    p.place[:2] += way * flown * p.ahead()
    bent = np.sin(np.pi * flown) * 30
    for side, out in ((LEFT, 1), (RIGHT, -1)):
        p.fold(side, bent)
        p.turn(HIP[side], X, -14 * np.sin(np.pi * flown))
        p.reach(side, (out * 0.30, -0.20 + 0.25 * swing, -0.25 + 0.61 * swing), (out, -0.6, -0.4), 0.9 * arms)
    p.trunk(ahead=16 * arms)


ARMS, HEADS, TRUNK = "left arm,right arm", "head", "spine,head"
# name: function, seconds, parts, captions
STANDING = {
    "nod": (
        nod, 2.6, HEADS,
        "nod | nod the head | nod yes | a person nods | someone nods the head | nodding | say yes with the head"),
    "shake_the_head": (
        shake, 2.8, HEADS,
        "shake the head | shake your head | say no | a person shakes the head | shaking the head | say no with the "
        "head | someone shakes the head no"),
    "look_to_the_left": (
        look_left, 3.0, HEADS,
        "look to the left | look left | turn the head to the left | a person looks to the left | looking left | "
        "someone turns the head left"),
    "look_up": (
        look_up, 3.0, HEADS,
        "look up | raise the head and look up | a person looks up | looking up | look at the sky | someone looks up at "
        "the sky"),
    "look_down": (
        look_down, 3.0, HEADS,
        "look down | lower the head | a person looks down | looking down | look at the floor | someone lowers the head",
        ),
    "tilt_the_head": (
        tilt, 2.8, HEADS,
        "tilt the head to the right | a person tilts the head to the right | lean the head to the right | tilting the "
        "head right"),
    "look_around": (
        look_around, 4.0, HEADS,
        "look around | look around in the room | look about | a person looks around | looking around | look to the "
        "left and to the right | someone looks around"),
    "twist": (
        twist, 3.6, TRUNK,
        "twist the upper body | twist the trunk | a person twists the upper body | twisting the torso | turn the upper "
        "body from side to side | rotate the torso left and right"),
    "bow": (
        bow, 4.0, TRUNK,
        "bow | take a bow | a person bows | bowing | bow politely | someone bows to the audience"),
    "clap": (
        clap, 3.2, ARMS,
        "clap | clap twice | clap your hands | clap the hands | a person claps | a person is clapping | clapping | "
        "applaud | someone applauds"),
    "salute": (
        salute, 3.6, "right arm",
        "salute | salute with the right hand | a person salutes | saluting | a soldier salutes | raise the right hand "
        "to the forehead in a salute"),
    "wave": (
        wave, 3.2, "right arm",
        "wave | wave hello | give a small wave | give a wave | wave the hand | wave to someone | wave with the right "
        "hand | a person waves with the right hand | waving | wave goodbye | say hello with the right hand | greet "
        "someone"),
    "wave_both": (
        wave_both, 3.4, ARMS,
        "wave with both arms | wave both hands overhead | a person waves with both arms | waving both arms above the "
        "head | signal with both arms | wave with both hands | wave both hands | a person waves with both hands | "
        "someone waves with both hands"),
    "point_forward": (
        point_ahead, 2.8, "right arm",
        "point forward | point ahead | point forward with the right hand | a person points forward | pointing | point "
        "at something | point at something in front"),
    "point_to_the_right": (
        point_aside, 2.8, "right arm,head",
        "point to the right | a person points to the right | pointing to the right with the right hand | point to the "
        "right side"),
    "point_up": (
        point_up, 2.8, "right arm",
        "point up | point at the sky | a person points up with the right hand | pointing up"),
    "drink": (
        drink, 3.4, "right arm",
        "drink | drink from a cup | a person drinks | drinking from a glass with the right hand | take a sip | someone "
        "drinks water"),
    "phone": (
        phone, 4.0, "right arm",
        "talk on the phone | make a phone call | a person talks on the phone | hold a phone to the right ear | phoning "
        "| answer the phone"),
    "scratch_the_head": (
        scratch, 3.4, "right arm",
        "scratch the head | scratch your head | a person scratches the head | scratching the head with the right hand"),
    "hands_on_head": (
        hands_on_head, 3.4, ARMS,
        "put both hands on the head | hands on the head | a person puts the hands on the head | place both hands on "
        "top of the head | holding the head with both hands"),
    "cover_face": (
        cover_face, 3.2, ARMS,
        "cover the face | cover the face with both hands | a person covers the face | covering the eyes | hide the "
        "face in the hands | cry"),
    "cross_arms": (
        cross_arms, 3.8, ARMS,
        "cross the arms | fold the arms | cross your arms | a person crosses the arms | folding both arms in front of "
        "the chest | stand with crossed arms"),
    "shrug": (
        shrug, 2.6, ARMS,
        "shrug | shrug the shoulders | a person shrugs | shrugging | raise both shoulders and open the hands | someone "
        "shrugs the shoulders"),
    "push": (
        push, 2.8, ARMS,
        "push | push a door | push something | push something away | push with both hands | a person pushes with both "
        "hands | pushing | push forward with both hands"),
    "punch": (
        punch, 2.2, "right arm,spine",
        "punch | punch with the right hand | a person punches | punching | throw a punch | someone punches ahead | the "
        "person throws a punch | a person punches with the right hand | box with the right fist | punch forward | "
        "punch someone | punch hard | hit someone with the fist"),
    "box": (
        box, 4.0, ARMS,
        "box | a person boxes | boxing | shadow boxing | throw punches | fight with the fists | someone is boxing"),
    "throw": (
        throw, 2.6, "right arm,spine",
        "throw a ball | throw | throw something | a person throws a ball | throwing a ball with the right hand | throw "
        "a stone with the right hand | throw a stone | throw a ball with the right hand | toss something far away | "
        "toss a ball | toss | a person throws something | throw something far away"),
    "stretch": (
        stretch, 4.4, "left arm,right arm,spine",
        "stretch | stretch the arms | stretch both arms upward | a person stretches | stretching | stretch the whole "
        "body | someone stretches after sleeping"),
    "kick": (
        kick, 2.2, "legs",
        "kick | kick a ball | kick with the right foot | a person kicks a ball | a person kicks | kicking | give a "
        "kick | kick something | kick a door open | kick forward | kick high | kick hard | do a high kick | someone "
        "kicks with the right leg | kick with the right leg | a person kicks with the right foot | do a kick with the "
        "right foot | kick in the air"),
    "dance": (
        dance, 4.4, "left arm,right arm,legs,spine",
        "dance | dance around | dance with the whole body | a person dances | dancing | dance on the spot | someone "
        "dances to music | do a dance"),
    "squat": (
        squat, 3.4, "legs",
        "squat | do a squat | squat down and up | a person squats | squatting | squat "
        "and come up again | do a knee bend | bend the knees | go into the knees | a person does a squat"),
    "pick_up": (
        pick_up, 3.4, "right arm,spine,legs",
        "pick something up | pick up | grab something from the floor | pick up an object | pick up something from the "
        "floor | a person picks something up | picking up an object from the ground | lift something from the floor"),
    "jump_up_and_down": (
        jump_up_and_down, 3.0, "legs",
        "jump up and down | jump on the spot | a person jumps up and down | jumping up and down | jump twice"),
    "hop": (
        hop, 3.0, "legs",
        "hop on one leg | hop | hop on the spot | hop up and down | hop on the left foot | a person hops on one leg | "
        "hopping on one foot"),
    "jumping_jacks": (
        jumping_jacks, 3.7, "left arm,right arm,legs",
        "do jumping jacks | jumping jacks | jumping jack | a person does jumping jacks | doing jumping jacks"),
    "turn_around": (
        turn_around, 2.7, "legs",
        "turn around | turn round | turn 180 degrees | a person turns around | turning around | turn to look back | "
        "turn halfway round | turn 180 degrees to the left | turn on the spot | a person turns on the spot | make a "
        "half turn"),
    "spin": (
        spin, 3.6, "legs",
        "spin around | spin | rotate | rotate all the way round | a person spins around | spinning around | turn in a "
        "full circle | turn all the way round on the spot"),
    "stand_still": (
        as_it_is, 4.4, "left arm,right arm,legs,spine,head",
        "stand still | do not move | stand motionless | stay where you are | remain standing | a person stands still | "
        "someone does not move"),
    "lean_forward": (
        lean_forward, 3.2, "spine",
        "lean forward | a person leans forward | leaning forward | bend forward | bend over | bend the upper body "
        "forward | bend forward at the hips | a person bends forward | someone bends down | a person bends down | bend "
        "the upper body down | bow deeply"),
    "jump_forward": (
        jump_forward, 3.2, "legs",
        "jump forward | jump forwards | jump ahead | leap forward | jump to the front | a person jumps forward | a "
        "person jumps ahead | someone leaps ahead | someone leaps forward | do a long jump | jump far | make a jump "
        "forward | jump forward with both legs | hop forward | one jump forward"),
    "turn_left": (
        turn_left, 2.6, "legs",
        "turn left | turn to the left | turning left | someone turns left | rotate to the left | a person rotates to "
        "the left | make a left turn on the spot | turn 90 degrees to the left | make a turn to the left | do a left "
        "turn | turn on the left foot | a person turns left | a person makes a left turn"),
    "raise_both_arms": (
        raise_both_arms, 2.2, ARMS,
        "raise both arms | raise both hands | both hands up | put both hands up | arms up | lift both arms | a person "
        "raises both arms | someone puts the hands up"),
    "hold_both_arms_up": (
        hold_both_arms_up, 3.0, ARMS, "keep both hands up | hold both arms up | hold both hands up"),
    "raise_right_arm": (
        raise_right_arm, 2.2, "right arm",
        "raise the right arm | raise the right hand | right arm up | the right hand goes up | put the right hand up | "
        "lift the right arm | lift the right hand | a person raises the right arm"),
    "hold_right_arm_up": (
        hold_right_arm_up, 3.0, "right arm", "keep the right hand up | hold the right arm up | hold the right hand up"),
    "sit_on_a_chair": (
        sit, 2.0, "legs,spine",
        "sit | sit down | a person sits down | sit down on a chair | sit on a chair | sit on the chair | sit on a stool | "
        "someone sits on a chair | take a seat on the chair | seat yourself on a chair | a person sits on a chair"),
    "stay_seated": (
        stay_seated, 3.0, "legs,spine", "stay on the chair | remain on the chair | keep sitting on the chair"),
    "kneel": (
        kneel, 2.2, "legs",
        "kneel down | kneel | kneel on one knee | a person kneels down | kneeling down | go down on one knee | kneel "
        "down on the right knee | a person goes down on one knee"),
    "stay_kneeling": (
        stay_kneeling, 3.0, "legs", "stay on one knee | remain on one knee | keep kneeling on one knee"),
    "march": (
        march, 4.2, "left arm,right arm,legs",
        "march | march in place | march on the spot | a person marches on the spot | marching | a soldier marches in "
        "place | lift the knees in turn"),
}

# These come last, so the random numbers of the other gestures stay the same.
AGAIN = {
    "two_squats": (
        two_squats, 4.8, "legs",
        "do squats | do two squats | doing two squats | squat twice | a person does two squats | a person does squats "
        "| do several squats | squat down two times"),
    "sit_down_and_stand_up": (
        sit_down_and_stand_up, 4.6, "legs,spine",
        "sit down and stand up | sit down and stand up again | sit down and get up again | a person sits down and "
        "stands up again | a person sits down on a chair and stands up | sit down on a chair and get up again | sit "
        "on a chair and then stand up"),
}
HELD = {"raise_both_arms", "raise_right_arm", "sit_on_a_chair", "kneel"}  # gestures whose last pose may be held
