# SPDX-License-Identifier: MIT
"""Gestures of people who walk. The table also says how fast the walk is played, and how its path bends."""
import numpy as np

from pose import GRAVITY, HIP, KNEE, LEFT, RIGHT, SHOULDER, X, Z, ease
from standing import as_it_is
from stepping import arms_out


def walk_on(p, t, s, n, r):
    p.gaze(left=10)


def sneak(p, t, s, n, r):
    p.crouch(24)
    p.hinge(12)
    p.trunk(ahead=24)
    for side, out in ((LEFT, 1), (RIGHT, -1)):
        p.reach(side, (out * 0.20, -0.02 + 0.05 * out * np.sin(2 * np.pi * 0.5 * t), 0.30), (out, -0.8, -0.2), 1)
    p.gaze(left=16 * np.sin(2 * np.pi * 0.35 * t), up=22)


def skip(p, t, s, n, r):
    air, beat = 0.28, 0.56
    phase = (t - 0.2) % beat
    if phase < air:
        p.rise(GRAVITY / 2 * phase * (air - phase))
        p.fold(int((t - 0.2) / beat) % 2, 30 * np.sin(np.pi * phase / air))
    for side, out in ((LEFT, 1), (RIGHT, -1)):
        p.turn(SHOULDER[side], X, 14 * out * np.sin(np.pi * (t - 0.2) / beat))


def pushed_aside(p, t, s, n, r):
    begin = 1.6
    hit = ease((t - begin) / 0.2) * (1 - ease((t - begin - 0.35) / 0.8))
    p.place[:2] += 0.5 * ease((t - begin) / 0.75) * p.left()
    p.trunk(tilt=-22 * hit)
    p.turn(HIP[LEFT], Z, 16 * hit)
    arms_out(p, 0.9 * hit)


def trips(p, t, s, n, r):
    begin = 1.4
    hit = ease((t - begin) / 0.25) * (1 - ease((t - begin - 0.3) / 0.9))
    p.crouch(20 * hit)
    p.hinge(26 * hit)
    p.trunk(ahead=26 * hit)
    for side, out in ((LEFT, 1), (RIGHT, -1)):
        p.reach(side, (out * 0.34, 0.0, 0.36), (out, -0.6, -0.3), 0.9 * hit)


def bent_knees(p, t, s, n, r):
    p.crouch(28)


def bent_ahead(p, t, s, n, r):
    p.hinge(26)
    p.trunk(ahead=36)
    for side, out in ((LEFT, 1), (RIGHT, -1)):
        swing = 0.06 * out * np.sin(2 * np.pi * 0.75 * t)
        p.reach(side, (out * 0.22, -0.02 + swing, 0.42), (out, 0.4, -0.6), 0.9)


def heavy_load(p, t, s, n, r):
    p.crouch(16)
    p.trunk(ahead=-6)
    for side, out in ((LEFT, 1), (RIGHT, -1)):
        p.reach(side, (out * 0.17, -0.20, 0.34), (out, -0.8, -0.3), 1)


def long_strides(p, t, s, n, r):
    for side in (LEFT, RIGHT):
        swing = np.degrees(np.arcsin(np.clip(p.local[HIP[side]][2, 1], -1, 1)))
        p.turn(HIP[side], X, 0.38 * swing)
        p.turn(SHOULDER[side], X, -0.38 * swing)
    p.rise(-0.035)


def on_a_beam(p, t, s, n, r):
    arms_out(p, 1, 0.14)
    p.trunk(tilt=7 * np.sin(2 * np.pi * 0.45 * t))
    p.gaze(up=-22)


def arms_up(p, t, s, n, r):
    for side, out in ((LEFT, 1), (RIGHT, -1)):
        p.reach(side, (out * 0.20, 0.64, 0.08), (out, 0.1, -0.1), 1)


def hands_on_hips(p, t, s, n, r):
    for side, out in ((LEFT, 1), (RIGHT, -1)):
        p.reach(side, (out * 0.20, -0.20, 0.02), (out, 0.0, -0.6), 1)


def limp(p, t, s, n, r):
    swing = np.degrees(np.arcsin(np.clip(p.local[HIP[RIGHT]][2, 1], -1, 1)))
    p.turn(KNEE[RIGHT], X, -18)
    p.trunk(tilt=16 * np.clip(swing / 20, -1, 1), ahead=10)
    p.rise(-0.03)


def turns(degrees, begin, seconds):
    """A path that turns by so many degrees to the left within some seconds."""
    return lambda t: degrees * ease((t - begin) / seconds)


def slalom(t):
    return 50 * np.sin(2 * np.pi * t / 2.8)


HALTS = {"walk_and_stop"}  # they end standing
WALKS = {
    "walk_in_a_circle": (
        walk_on, 5.2, "legs",
        "walk in a circle | a person walks in a circle | walking in a circle | walk around in a circle | walk in "
        "circles | walk a full circle | walk in a circle to the left | walk a circle to the left | walk in a circle "
        "counterclockwise | walk counterclockwise | walk counterclockwise in a circle | a person walks in a circle to "
        "the left | walk counter clockwise", 1.0, 360),
    "walk_backwards": (
        as_it_is, 4.6, "legs",
        "walk backwards | a person walks backwards | walking backwards | walk back | walk in reverse | step back | "
        "step backward | go back | go some steps back | step backwards | take several steps back | take a few steps "
        "backwards | a person takes a few steps backwards | move backwards | move back | walk backward | back away | "
        "someone goes backwards",
        -0.8, 0),
    "walk_slowly": (
        as_it_is, 5.0, "legs",
        "walk slowly | a person walks slowly | walking slowly | stroll | take a stroll | someone is strolling | walk "
        "at a slow pace | a person walks at a slow pace | take a slow walk | someone walks very slowly | walk really "
        "slowly | walk leisurely",
        0.55, 0),
    "skip": (
        skip, 4.0, "legs",
        "skip | skip along | a person skips | skipping | skip forward | someone skips ahead like a child", 0.9, 0),
    "sneak": (
        sneak, 5.0, "left arm,right arm,legs,spine,head",
        "sneak | tiptoe | a person sneaks | sneaking | sneak forward | sneak along quietly | creep | tiptoe quietly | "
        "walk stealthily", 0.6, 0),
    "walk_a_left_curve": (
        walk_on, 4.4, "legs",
        "walk a quarter circle to the left | walk in a left curve | walk in a curve to the left | walk a left turn | "
        "walk in a left bend | a person walks in a quarter circle to the left | walk while turning to the left | turn "
        "left while walking | a person walks a curve to the left | make a wide turn to the left | walk in a quarter "
        "circle counterclockwise | a person takes some steps in a quarter circle to the left | walk to the left | a "
        "person walks to the left | walk a bow to the left", 1.0, turns(95, 0.2, 4.0)),
    "walk_a_half_circle_left": (
        walk_on, 4.8, "legs",
        "walk in a half circle to the left | walk a semicircle to the left | a person walks in a half circle to the "
        "left | walk in a big u-turn to the left | walk a half circle", 1.0, turns(185, 0.2, 4.4)),
    "walk_slightly_left": (
        as_it_is, 4.2, "legs",
        "walk slightly to the left | walk forward and slightly to the left | a person walks forward slightly to the "
        "left | drift to the left while walking | walk diagonally to the left", 1.0, turns(35, 0.3, 3.0)),
    "walk_and_turn_left": (
        walk_on, 4.6, "legs",
        "walk forward and turn left | walk and turn left | a person walks forward and turns left | walk, turn left and "
        "walk on | walk and make a sharp turn to the left | a person makes a sharp turn to the left | turn left and "
        "walk on | walk straight and then turn left | walk forward and make a 90 degree turn to the left", 1.0,
        turns(92, 1.9, 0.9)),
    "walk_and_turn_back": (
        walk_on, 5.8, "legs",
        "walk forward, turn around and walk back | walk and turn around | walk forward and turn around | a person "
        "walks forward, turns around and walks back | walk, turn 180 degrees and walk back | walk forward, do a u-turn "
        "to the left and walk back | a person does a u-turn to the left | do a u-turn | walk a few steps, turn around "
        "and return | walk forward, turn on the spot and walk back | walk some steps forward, then turn 180 degrees to "
        "the left and keep walking | someone walks forward, makes a left u-turn and goes back | walk and turn back | "
        "walk back and forth | walk to and fro | pace up and down | a person takes two steps, turns around and returns",
        1.0,
        turns(182, 2.2, 1.25)),
    "walk_some_steps": (
        as_it_is, 4.0, "legs",
        "take several steps forward | take a few steps | go some steps forward | a person takes several steps forward "
        "| walk a few steps | walk several steps ahead | a person goes a few steps ahead | step forward", 1.0, 0),
    "walk_and_stop": (
        as_it_is, 4.2, "legs",
        "walk and stop | walk forward and stop | a person walks and stops | take a few steps forward and stop | walk a "
        "few steps forward and stop | take some steps | a person takes three steps forward and stops | walk four steps "
        "forward and stand still | walk and then stand still | someone walks a little and stops | make a few steps "
        "forward", 1.0, 0),
    "slalom": (
        walk_on, 5.6, "legs",
        "walk in a slalom | walk in a zigzag | walk in a snake line | walk in a wavy line | a person walks in a slalom "
        "| walk an s curve | walk around obstacles | a person walks in curves to the left and to the right | walk in "
        "serpentines",
        1.0, slalom),
    "walk_fast": (
        as_it_is, 4.0, "legs",
        "walk fast | walk quickly | walk forward quickly | a person walks forward very fast | a person walks fast | "
        "walk at a fast pace | walk briskly | a person walks very quickly | someone walks in a hurry | hurry | fast "
        "walking", 1.4, 0),
    "walk_and_get_pushed_to_the_left": (
        pushed_aside, 4.4, "legs,spine",
        "walk forward and get pushed to the left | a person walks forward and is pushed from the right | get pushed to "
        "the left while walking | walk and stumble to the left | walk forward, get pushed from the right and go back "
        "on track | a person is walking and gets pushed to the left | walk straight and recover from a push from the "
        "right | someone walks, is pushed to the left, and counterbalances by a step to the side | a person stumbles "
        "to the left while walking | walk and get pushed | walk and be pushed", 1.0, 0),
    "walk_and_trip": (
        trips, 4.2, "legs,spine",
        "walk and trip | walk and stumble | a person stumbles while walking | trip while walking | walk forward and "
        "stumble | someone walks and trips over something | walk forward and get pushed from behind", 1.0, 0),
    "walk_with_bent_knees": (
        bent_knees, 4.4, "legs",
        "walk with bent knees | a person walks with bent knees | walk in a crouch | walk crouched | walk forward with "
        "the knees slightly bent | walk low", 0.9, 0),
    "walk_bent_forward": (
        bent_ahead, 4.6, "legs,spine",
        "walk bent forward | a person walks bent forward | walk with the upper body bent forward | walk leaning "
        "forward | walk hunched | walk slowly bending forward | walk like an old man | walk like an old person",
        0.75, 0),
    "walk_with_a_heavy_load": (
        heavy_load, 4.6, "left arm,right arm,legs",
        "walk as if carrying something heavy | carry a box | walk with a box | a person carries something with both "
        "hands | carry something heavy | walk forward carrying a heavy load | walk and carry something | carry a tray",
        0.8, 0),
    "walk_with_long_strides": (
        long_strides, 4.2, "legs",
        "walk with large steps | walk with big steps | take long strides | a person walks with large steps | take "
        "large steps forward | walk with long steps | a person makes some large strides | walk with big strides",
        0.95, 0),
    "walk_on_a_beam": (
        on_a_beam, 5.2, "left arm,right arm,legs",
        "walk on a beam | balance on a beam | walk over a beam | walk over a balance beam | a person balances on a "
        "beam | walk along a line | walk on a rope | walk with the arms stretched out to the sides | balance while "
        "walking | walk along a narrow beam", 0.6, 0),
    "walk_with_raised_arms": (
        arms_up, 4.4, "left arm,right arm,legs",
        "walk with raised arms | walk with both arms up | walk and hold both arms up | a person walks with the arms "
        "above the head | walk with the hands up | walk with both hands above the head", 1.0, 0),
    "walk_with_hands_on_hips": (
        hands_on_hips, 4.4, "left arm,right arm,legs",
        "walk with the hands on the hips | a person walks with the hands at the hips | walk with both hands on the "
        "waist",
        1.0, 0),
    "limp": (
        limp, 4.8, "legs,spine",
        "limp | a person limps | walk with a limp | limp forward | hobble | walk with an injured leg | walk as if the "
        "right leg hurts | someone limps with the right leg", 0.75, 0),
}
