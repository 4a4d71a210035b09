# SPDX-License-Identifier: MIT
"""Gestures of people who stand, and then step, jump or crawl: turns on the spot, side steps, pushes, a waltz."""
import numpy as np

from pose import ANKLE, GRAVITY, HIP, KNEE, LEFT, LEG, RIGHT, X, Y, Z, ease, held


def steps_round(p, t, s, degrees, step):
    """Turns on the spot by steps: the figure turns steadily, and each foot stands while the other one steps."""
    rest = 0.3
    turn = lambda at: degrees * ease_in((at - rest) / (s - 2 * rest))
    p.yaw(turn(t))
    begins = np.arange(rest, s - rest - 0.5 * step, step)
    for side, out in ((LEFT, 1), (RIGHT, -1)):
        foot, lift = 0.0, 0.0
        for k, begin in enumerate(begins):
            if k % 2 != (0 if degrees > 0 else 1) ^ side:
                continue
            end = begin + step
            goal = degrees if k >= len(begins) - 2 else turn(min(s, end + 0.5 * step))
            if t >= begin:
                foot += (goal - foot) * ease((t - begin) / step)
            if begin < t < end:
                lift = np.sin(np.pi * (t - begin) / step)
        behind = np.radians(foot - turn(t))
        shift = out * 0.09 * np.array([np.cos(behind) - 1, -np.sin(behind)])  # to the left and ahead
        reach = 2 * LEG
        p.fold(side, 24 * lift)
        p.turn(HIP[side], Y, np.degrees(behind))
        p.turn(HIP[side], X, -np.degrees(shift[1] / reach))
        p.turn(HIP[side], Z, np.degrees(shift[0] / reach))
    p.gaze(left=np.sign(degrees) * 8 * held(t, s, 0.4, 0.6))


def ease_in(t):
    """From 0 to 1, steady in the middle."""
    t = np.clip(t, 0, 1)
    return t * t * (3 - 2 * t)


def turn_left(p, t, s, n, r):
    steps_round(p, t, s, 90, 0.45)


def turn_around(p, t, s, n, r):
    steps_round(p, t, s, 180, 0.42)


def spin(p, t, s, n, r):
    steps_round(p, t, s, 360, 0.34)
    for side, out in ((LEFT, 1), (RIGHT, -1)):
        p.reach(side, (out * 0.50, 0.02, 0.10), (out * 0.3, -1, -0.3), held(t, s, 0.6, 0.7))


def steps(p, t, begin, way, count, step=0.4, first=LEFT, lift=22, from_place=(0.0, 0.0)):
    """Goes `way` metres (to the left, ahead) in `count` steps; each foot stands while the other one steps."""
    way, start = np.asarray(way, float), np.asarray(from_place, float)
    seconds = count * step
    at = lambda when: start + way * ease_in((when - begin) / seconds)
    body = at(t)
    p.place[:2] += body[0] * p.left() + body[1] * p.ahead()
    lowest = 0.0
    for side in (LEFT, RIGHT):
        foot, up = start, 0.0
        for k in range(count):
            if (k + first) % 2 != side:
                continue
            rise = begin + k * step
            goal = start + way if k >= count - 2 else at(rise + 1.5 * step)
            foot = foot + (goal - foot) * ease((t - rise) / step)
            if rise < t < rise + step:
                up = np.sin(np.pi * (t - rise) / step)
        behind = np.degrees((foot - body) / (2 * LEG))
        p.fold(side, lift * up)
        p.turn(HIP[side], X, -behind[1])
        p.turn(HIP[side], Z, behind[0])
        p.turn(ANKLE[side], Z, -behind[0])
        lowest = max(lowest, 1 - np.cos(np.radians(np.hypot(*behind))))
    p.rise(-2 * LEG * lowest)


def arms_out(p, share, up=0.0):
    """The arms keep the balance at both sides."""
    for side, out in ((LEFT, 1), (RIGHT, -1)):
        p.reach(side, (out * 0.56, -0.04 + up, 0.10), (out * 0.3, -1, -0.3), share)


def pushed(left, ahead):
    """A push in a direction: the trunk gives way, and quick steps catch the fall."""

    def gesture(p, t, s, n, r):
        begin = 0.7
        hit = ease((t - begin) / 0.2) * (1 - ease((t - begin - 0.3) / 0.7))
        steps(p, t, begin + 0.05, (0.62 * left * n, 0.62 * ahead * n), 3, 0.27, RIGHT if left < 0 else LEFT, 28)
        p.trunk(tilt=-20 * left * hit, ahead=22 * ahead * hit)
        p.gaze(up=-12 * hit)
        arms_out(p, 0.9 * ease((t - begin) / 0.25) * (1 - ease((t - begin - 0.6) / 0.8)))

    return gesture


def stepping_to(left, ahead, count, step=0.45):
    def gesture(p, t, s, n, r):
        steps(p, t, 0.3, (left, ahead), count, step, RIGHT if left < 0 else LEFT)

    return gesture


def waltz(p, t, s, n, r):
    """A box step, with the arms around a partner."""
    begin, step = 0.3, 0.4
    box = ((0.0, 0.42), (0.34, 0.0), (0.0, -0.42), (-0.34, 0.0))
    place, now = np.zeros(2), min(3, max(0, int((t - begin) / (2 * step))))
    for way in box[:now]:
        place = place + way
    steps(p, t, begin + 2 * step * now, box[now], 2, step, LEFT if now != 3 else RIGHT, 16, place)
    w = held(t, s, 0.5, 0.5)
    p.reach(LEFT, (0.48, 0.20, 0.26), (0.6, -1, 0), w)
    p.reach(RIGHT, (-0.12, 0.06, 0.34), (-1, -0.4, 0), w)
    p.trunk(tilt=6 * np.sin(np.pi * (t - begin) / step) * w)


def leap(p, t, begin, air, degrees, dip=0.3, rise=0.35, calm=0.4):
    """A jump on the spot: down in `dip` seconds, up into the air for `air` seconds from `begin` on, down again into the
    knees, and up in `rise` seconds. The share of the arms, which calm down in `calm` seconds."""
    into, flown = ease((t - begin + dip + 0.15) / dip), (t - begin) / air
    if flown < 0:
        p.crouch(degrees * into * (1 - ease((t - begin + 0.15) / 0.15)))
    elif flown < 1:
        p.rise(GRAVITY / 2 * (t - begin) * (begin + air - t))
    else:
        after = t - begin - air
        p.crouch(0.8 * degrees * ease(after / 0.12) * (1 - ease((after - 0.12) / rise)))
    return into * (1 - ease((t - begin - air) / calm))


def jumping(left=0.0, ahead=0.0, degrees=0.0):
    """One jump, to a place and turned by some degrees to the left."""

    def gesture(p, t, s, n, r):
        begin, air = 0.9, 0.44
        arms = leap(p, t, begin, air, 44, dip=0.35, rise=0.4, calm=0.5)
        for side, out in ((LEFT, 1), (RIGHT, -1)):
            up = 0.02 + 0.3 * ease((t - begin + 0.2) / 0.3)
            p.reach(side, (out * 0.30, up, 0.28), (out, -0.6, -0.4), 0.8 * arms)
        flown = np.clip((t - begin) / air, 0, 1)
        p.place[:2] += flown * (left * p.left() + ahead * p.ahead())
        p.yaw(degrees * flown)
        for side in (LEFT, RIGHT):
            p.fold(side, 18 * np.sin(np.pi * flown))

    return gesture


def crawl(p, t, s, n, r):
    """On hands and knees: a hand and the knee of the other side go ahead together."""
    cycle, swing = 1.2, 0.13
    p.place[:2] += 4 * swing / cycle * t * p.ahead()
    p.place[2] += 0.06 - 2 * LEG + 0.30
    p.hinge(80)
    for side, out in ((LEFT, 1), (RIGHT, -1)):
        turn = (t / cycle + (0.0 if side == LEFT else 0.5)) % 1.0
        standing = turn < 0.5  # of the hand; the knee of this side moves then
        hand = swing * (1 - 4 * turn) if standing else swing * (4 * turn - 3)
        knee = -hand
        lift = 0.0 if standing else 0.07 * np.sin(2 * np.pi * (turn - 0.5))
        p.turn(HIP[side], X, -np.degrees(knee / LEG))
        p.turn(KNEE[side], X, 90 + np.degrees(knee / LEG) + (8 * np.sin(2 * np.pi * turn) if standing else 0))
        p.turn(ANKLE[side], X, 55)
        p.reach(side, (out * 0.20, 0.14 + hand, 0.47 - lift), (out, 0.0, -0.3), 1)
    p.gaze(up=30)


STEPPED = {
    "pushed_to_the_left": (
        pushed(1, 0), 3.0, "legs,spine",
        "get pushed to the left | be pushed from the right | a person is pushed from the right | a person is pushed "
        "from right | someone is pushed from the right side | stand still and get pushed to the left | get pushed from "
        "the right and recover | a person takes a step to the left after a push | someone is shoved to the left | a "
        "person sways to the left and catches the balance | a person is pushed to the left | someone gets pushed from "
        "the right | the person gets a push from the right and steps to the left | stumble to the left | stagger to "
        "the left | a person loses balance to the left | take recovery steps to the left | get shoved from the right"),
    "pushed_ahead": (
        pushed(0, 1), 3.0, "legs,spine",
        "get pushed forward | get pushed from behind | stand still and get pushed from behind | a person gets pushed "
        "from the back | a person is pushed forward | a person stumbles forward | be pushed from the back | a person "
        "is pushed from behind | someone gets a push from the back and steps forward | stumble forward | stumble | a "
        "person stumbles | lose balance | someone loses balance and catches it again | trip | trip over something"),
    "pushed_back": (
        pushed(0, -1), 3.0, "legs,spine",
        "get pushed backwards | get pushed from the front | stand still and get pushed from the front | a person gets "
        "pushed from the front | a person is pushed backwards | a person stumbles backwards | someone stumbles a few "
        "steps back | be pushed from the front | a person is pushed from the front | someone gets pushed back and "
        "steps backwards | stumble backwards | stagger back | a person loses balance to the back | recover from a push "
        "from the front | a person gets pushed | someone is pushed"),
    "step_left": (
        stepping_to(0.40, 0, 2), 2.2, "legs",
        "step to the left | take a step to the left | a person steps to the left | side step to the left | one step to "
        "the left | a person makes a step to the left side"),
    "walk_sideways_to_the_left": (
        stepping_to(1.5, 0, 8), 4.4, "legs",
        "walk sideways to the left | a person walks sideways to the left | sidestep to the left several times | move "
        "sideways to the left | take side steps to the left | walk sideways | side steps"),
    "waltz": (
        waltz, 3.9, "legs,left arm,right arm",
        "dance a waltz | dance the waltz | a person dances the waltz | waltz | someone dances with a partner | dance "
        "with a partner | a person does dance steps in a square | ballroom dancing"),
    "jump_once": (
        jumping(), 2.4, "legs",
        "jump | a person jumps | jump once | jump straight up | a person jumps once | jump upwards | jump up in the "
        "air | a person jumps up | jump as high as you can | do one jump on the spot | someone jumps upright | a "
        "person performs one jump"),
    "jump_to_the_left": (
        jumping(left=0.55), 2.4, "legs",
        "jump to the left | jump sideways to the left | a person jumps to the left | jump to the left side | leap to "
        "the left | hop to the left | make a jump to the left | jump sideways"),
    "jump_back": (
        jumping(ahead=-0.45), 2.4, "legs",
        "jump backwards | jump back | a person jumps backwards | leap backwards | hop backwards with both feet | "
        "hop back | hop backwards | make a jump backwards"),
    "jump_and_turn": (
        jumping(degrees=180), 2.4, "legs",
        "jump and turn around | jump and turn 180 degrees | a person jumps and turns in the air | jump with half a "
        "turn | a person performs a 180 degree jump to the left | turn while jumping"),
    "jump_a_quarter": (
        jumping(degrees=90), 2.4, "legs",
        "jump and turn 90 degrees to the left | a person jumps and turns left | jump with a quarter turn to the left | "
        "a person performs a 90 degree jump to the left"),
    "jump_whole_turn": (
        jumping(degrees=360), 2.4, "legs",
        "jump and turn 360 degrees to the left | jump with a full turn | a person spins once in the air | a person "
        "performs a 360 degree jump to the left"),
    "crawl": (
        crawl, 4.2, "left arm,right arm,legs,spine,head",
        "crawl | crawl on all fours | crawl on hands and knees | a person crawls | crawl forward | a person crawls on "
        "the floor | someone crawls on all fours | move on hands and knees | go on all fours | crawl like a baby"),
}
# As AGAIN of standing.py, these come last.
ONE_STEP = {
    "step_back_once": (
        stepping_to(0, -0.55, 2, 0.5), 2.4, "legs",
        "take a step back | take one step back | step back once | a person takes a step back | take a large step back "
        "| make a big step backwards | one step backwards | take a quick step back | a person makes a step backwards"),
    "step_ahead_once": (
        stepping_to(0, 0.55, 2, 0.5), 2.4, "legs",
        "take a step forward | take one step forward | step forward once | a person takes a step forward | take a "
        "large step forward | make a big step ahead | one step ahead | a person makes one step forward"),
}
GOES_ON = {"crawl", "stand_still"}  # gestures that nothing follows; also all hold_ and stay_
