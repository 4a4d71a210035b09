# SPDX-License-Identifier: MIT
"""Gestures of people who stand and act something out: music, work, sport, balance."""
import numpy as np

from pose import (ANKLE, COLLAR, HIP, KNEE, LEFT, RIGHT, SHOULDER, SHOULDER_AT, SPINE, X, Y, Z, ease, held, rotation,
                  unit)

BONE, FOOT = 0.41, np.array([0, -0.06, 0.14])  # thigh and shank, each, and the way from an ankle to the toes
HIP_AT, BACK = np.array([0.09, -0.06, 0]), (0.11, 0.13, 0.06)  # of the left hip, from the pelvis, and the spine's bones
WRIST = (20, 21)
BOTH = ((LEFT, 1), (RIGHT, -1))


def through(t, *keys):
    """The values at a time, smoothly through rows of a time and values."""
    rows = np.array(keys, float)
    times, values = rows[:, 0], rows[:, 1:]
    if t <= times[0] or t >= times[-1]:
        return values[0 if t <= times[0] else -1]
    ways = np.diff(values, axis=0) / np.diff(times)[:, None]
    turns = np.zeros_like(values)  # the speed at a row; none where a value rests or turns back
    turns[1:-1] = np.where(ways[1:] * ways[:-1] > 0, (values[2:] - values[:-2]) / (times[2:] - times[:-2])[:, None], 0)
    k = int(np.searchsorted(times, t, "right")) - 1
    long = times[k + 1] - times[k]
    u = (t - times[k]) / long
    return (values[k] * (1 + 2 * u) * (1 - u) ** 2 + values[k + 1] * (3 - 2 * u) * u**2
            + long * (turns[k] * u * (1 - u) ** 2 - turns[k + 1] * (1 - u) * u**2))


def around(turns, *points):
    """A place on a closed path through points, after so many turns."""
    at, points = turns * len(points), np.array(points, float)
    a, b, c, d = (points[(int(np.floor(at)) + k) % len(points)] for k in (-1, 0, 1, 2))
    u = at % 1.0
    return b + u / 2 * (c - a + u * (2 * a - 5 * b + 4 * c - d + u * (3 * b - a - 3 * c + d)))


def sway(t, beat):
    return np.sin(2 * np.pi * beat * t)


def paced(t, s, r):
    """The time of a movement that is faster or slower about its middle."""
    return s / 2 + (t - s / 2) * np.sqrt(r)


class Ground:
    """The floor under a figure: its feet stay there while the pelvis moves, and its hands reach for places above it.

    Places are metres to the left, up from the floor, and ahead of the middle between the ankles.
    """

    def __init__(self, p):
        self.p, self.left, self.ahead = p, np.append(p.left(), 0), np.append(p.ahead(), 0)
        self.axes = np.stack([self.left, Z, self.ahead], axis=1)
        self.legs = [self.leg(side) for side in (LEFT, RIGHT)]
        self.middle = (self.legs[LEFT][0] + self.legs[RIGHT][0]) / 2 * [1, 1, 0]

    def leg(self, side):
        """The place of the ankle, and the rotations of thigh, shank and foot in the world."""
        thigh = self.p.local[0] @ self.p.local[HIP[side]]
        shank = thigh @ self.p.local[KNEE[side]]
        ankle = self.hip(side) - BONE * (thigh @ Y + shank @ Y)
        return ankle, thigh, shank, shank @ self.p.local[ANKLE[side]], self.bend(self.hip(side), ankle, thigh)

    def hip(self, side):
        return self.p.place + self.p.local[0] @ (HIP_AT * [1 if side == LEFT else -1, 1, 1])

    def bend(self, hip, ankle, thigh):
        """Rotations of thigh and shank between hip and ankle; the knee bends about the axis of a thigh."""
        way = ankle - hip
        far = min(np.linalg.norm(way), 1.999 * BONE)
        way = unit(way)
        x = thigh @ X
        x = unit(x - way * (x @ way))
        half = np.arccos(far / (2 * BONE))
        return [np.stack([x, -y, np.cross(x, -y)], axis=1) for y in (rotation(x, -half) @ way, rotation(x, half) @ way)]

    def shift(self, left=0.0, up=0.0, ahead=0.0):
        """Moves the pelvis."""
        self.p.place += self.axes @ [left, up, ahead]

    def tip(self, left=0.0, ahead=0.0, turn=0.0):
        """Leans the pelvis, or turns it to the left, by degrees."""
        for axis, degrees in ((self.ahead, -left), (self.left, ahead), (Z, turn)):
            self.p.local[0] = rotation(axis, np.radians(degrees)) @ self.p.local[0]

    def foot(self, side, left=0.0, up=0.0, ahead=0.0, heel=0.0, out=0.0):
        """Sets a foot down so far away, its heel raised by degrees over the toes, the knee turned out."""
        ankle, thigh, shank, foot, rest = self.legs[side]
        pitch = rotation(self.left, np.radians(heel))
        spread = rotation(Z, np.radians(out if side == LEFT else -out))
        toes, local, hip = foot @ FOOT, self.p.local, self.hip(side)
        place = aim = ankle + self.axes @ [left, up, ahead] + toes - pitch @ toes
        for _ in range(3):  # knees are not perfect hinges, so the first aim misses a little
            goal = self.bend(hip, aim, spread @ thigh)
            upper, lower = (b @ a.T @ c for a, b, c in zip(rest, goal, (thigh, shank)))
            aim = aim + place - hip + BONE * (upper @ Y + lower @ Y)
        local[HIP[side]] = local[0].T @ upper
        local[KNEE[side]], local[ANKLE[side]] = upper.T @ lower, lower.T @ pitch @ foot

    def stand(self):
        """Puts both feet where they stood."""
        self.foot(LEFT)
        self.foot(RIGHT)

    def hand(self, side, place, elbow_towards, share):
        """Brings a wrist to a place above the floor."""
        turned, chest = self.p.local[0], self.p.place.copy()
        for joint, bone in zip(SPINE, BACK):
            chest = chest + turned @ (bone * Y)
            turned = turned @ self.p.local[joint]
        self.p.reach(side, turned.T @ (self.middle + self.axes @ place - chest), elbow_towards, share)


def both(p, wrist, elbow_towards, share):
    """Both arms, mirrored. The places are those of the left arm."""
    for side, out in BOTH:
        p.reach(side, np.array(wrist) * [out, 1, 1], np.array(elbow_towards) * [out, 1, 1], share)


def lean(p, share, hips=0.0, back=0.0, gaze=0.0):
    """Leans ahead over feet that stay: the pelvis goes back."""
    ground = Ground(p)
    ground.tip(ahead=hips * share)
    ground.shift(ahead=-0.0016 * hips * share, up=-0.0004 * hips * share)
    ground.stand()
    p.trunk(ahead=back * share)
    p.gaze(up=-gaze * share)
    return ground


def guitar(p, t, s, n, r):
    w, strum = held(t, s, 0.7, 0.7), sway(t, 1.7 * r)
    p.reach(LEFT, (0.43 + 0.04 * sway(t, 0.4), 0.06 + 0.03 * sway(t, 0.4), 0.24), (0.3, -1, 0.1), w)
    p.reach(RIGHT, (-0.10 - 0.03 * strum, -0.15 + 0.09 * n * strum, 0.19), (-1, -0.1, -0.3), w)
    p.turn(WRIST[RIGHT], Z, 14 * w * strum)
    p.trunk(left=6 * w, tilt=3 * w * sway(t, 0.85 * r))
    p.gaze(left=12 * w, up=-w * (14 + 6 * sway(t, 0.85 * r)))


def violin(p, t, s, n, r):
    w, bow = held(t, s, 0.8, 0.8), 0.5 - 0.5 * np.cos(2 * np.pi * 0.8 * r * t)
    p.reach(LEFT, (0.30, 0.22, 0.34), (0.4, -1, 0.1), w)
    p.reach(RIGHT, np.array([0.06, 0.22, 0.27]) + bow * n * np.array([-0.32, -0.17, 0.06]), (-1, -0.2, 0), w)
    p.gaze(left=24 * w, up=-8 * w, tilt=-14 * w)
    p.trunk(left=5 * w * sway(t, 0.4 * r), tilt=3 * w * sway(t, 0.4 * r))


def drum(p, t, s, n, r):
    w = held(t, s, 0.5, 0.5)
    aside = ease((t - s / 2 + 0.3) / 0.4) * (1 - ease((t - s / 2 - 0.6) / 0.4))
    for side, out in BOTH:
        beat = out * sway(t, 2.0 * r)
        p.reach(side, (out * 0.17 - 0.16 * aside * (side == RIGHT), -0.08 + 0.09 * n * beat, 0.31),
                (out, -0.8, -0.4), w)
        p.turn(WRIST[side], Z, out * 20 * w * beat)
    p.trunk(ahead=7 * w, left=-10 * aside * w)
    p.gaze(up=-w * (12 + 8 * sway(t, 2.0 * r)), left=-10 * aside)


def piano(p, t, s, n, r):
    w, along = held(t, s, 0.6, 0.6), 0.10 * n * sway(t, 0.4 * r)
    for side, out in BOTH:
        key = out * sway(t, 2.0 * r)
        p.reach(side, (out * 0.17 + along, -0.17 + 0.045 * key, 0.30), (out, -0.9, -0.3), w)
        p.turn(WRIST[side], Z, w * out * 18 * key)
    p.trunk(ahead=8 * w, tilt=-5 * w * sway(t, 0.4 * r))
    p.gaze(up=-22 * w)


def type_keys(p, t, s, n, r):
    w = held(t, s, 0.6, 0.6)
    for side, out in BOTH:
        key = sway(t + 0.1 * side, (2.6, 2.2)[side] * r)
        p.reach(side, (out * 0.12 + 0.02 * sway(t, 0.7 + 0.2 * side), -0.15 + 0.018 * n * key, 0.29), (out, -0.9,
                                                                                                       -0.3), w)
        p.turn(WRIST[side], Z, w * out * (-14 + 16 * key))
    p.gaze(up=-24 * w)


def conduct(p, t, s, n, r):
    w = held(t, s, 0.6, 0.6)
    x, y, z = around(t * 0.72 * r, (0.16, 0.32, 0.36), (0.18, 0.0, 0.38), (0.13, 0.10, 0.37), (0.44, 0.14, 0.30))
    both(p, (0.25 + n * (x - 0.25), 0.14 + n * (y - 0.14), z), (1, -0.5, -0.2), w)
    p.trunk(ahead=4 * w * sway(t, 0.72 * r))
    p.gaze(up=8 * w * sway(t, 0.72 * r))


def wipe_table(p, t, s, n, r):
    w, turn = held(t, s, 0.7, 0.7), 2 * np.pi * 0.9 * r * t
    ground = lean(p, w, 22, 20, 14)
    ground.hand(LEFT, (0.24, 0.93, 0.36), (1, 0.2, -0.5), w)
    ground.hand(RIGHT, (-0.10 + 0.18 * n * np.cos(turn), 0.93, 0.46 + 0.09 * n * np.sin(turn)), (-1, -0.2, -0.4), w)
    p.trunk(left=5 * w * np.cos(turn))


def stir(p, t, s, n, r):
    w, turn = held(t, s, 0.7, 0.7), 2 * np.pi * 1.1 * r * t
    p.reach(LEFT, (0.18, -0.20, 0.24), (1, -0.6, -0.2), w)
    p.reach(RIGHT, (-0.05 + 0.09 * n * np.cos(turn), -0.10, 0.31 + 0.09 * n * np.sin(turn)), (-1, -0.1, -0.3), w)
    p.trunk(ahead=8 * w)
    p.gaze(up=-22 * w)


def wipe_window(p, t, s, n, r):
    w, turn = held(t, s, 0.7, 0.7), 2 * np.pi * 0.75 * r * t
    p.reach(RIGHT, (-0.16 + 0.20 * n * np.cos(turn), 0.32 + 0.13 * n * np.sin(turn), 0.36), (-0.8, -1, -0.1), w)
    p.trunk(left=w * (4 + 7 * np.cos(turn)))
    p.gaze(up=8 * w)


def kicks(keys, pose):
    """A kick with the right foot: rows of a time and the degrees of hip and knee, of the leg aside, and of the lean."""
    def gesture(p, t, s, n, r):
        flex, knee, aside, leans = through(paced(t, s, r), *keys)
        w, ground = held(t, s, 0.5, 0.6), Ground(p)
        ground.shift(left=0.07 * w, up=-0.005 * w)
        pose(p, ground, w, leans)
        ground.foot(LEFT)
        p.turn(HIP[RIGHT], Z, -aside)
        p.turn(HIP[RIGHT], X, -min(flex * n, flex + 8) if flex > 0 else -flex)
        p.turn(KNEE[RIGHT], X, knee)
    return gesture


def ahead_kick(p, ground, w, leans):
    ground.tip(ahead=-leans)
    ground.shift(ahead=0.002 * leans, up=-0.0004 * abs(leans))
    p.trunk(left=0.4 * leans, ahead=0.3 * leans)
    p.reach(LEFT, (0.36, -0.05, 0.24), (1, -0.8, -0.3), w)
    p.reach(RIGHT, (-0.46, -0.12, -0.10), (-1, -0.4, -0.4), w)


def side_kick(p, ground, w, leans):
    ground.tip(left=leans)
    ground.shift(left=0.001 * leans, up=-0.0013 * leans)
    p.trunk(tilt=0.3 * leans)
    p.gaze(left=-1.2 * leans, tilt=0.6 * leans)
    both(p, (0.20, 0.06, 0.24), (1, -0.8, -0.2), w)


low_kick = kicks(((0.3, 0, 0, 0, 0), (0.7, -22, 32, 0, -4), (1.02, 47, 6, 0, 6), (1.2, 47, 6, 0, 6),
                  (1.75, 0, 0, 0, 0)), ahead_kick)
high_kick = kicks(((0.3, 0, 0, 0, 0), (0.7, -22, 35, 0, -6), (0.95, 70, 60, 0, 14), (1.15, 116, 4, 0, 30),
                   (1.25, 116, 4, 0, 30), (1.6, 55, 60, 0, 12), (2.05, 0, 0, 0, 0)), ahead_kick)
kick_aside = kicks(((0.3, 0, 0, 0, 0), (0.85, 62, 100, 12, 6), (1.15, 8, 6, 66, 28), (1.3, 8, 6, 66, 28),
                    (1.7, 45, 80, 12, 8), (2.2, 0, 0, 0, 0)), side_kick)


def knee_up(p, t, s, n, r):
    keys = (0.5, 0, 0), (0.95, 104, 112), (1.2, 104, 112), (1.7, 0, 0)
    flex, knee = through(paced(t, s, r), *keys)
    w, ground = held(t, s, 0.5, 0.6), Ground(p)
    ground.shift(left=0.07 * w, up=-0.003 * w)
    ground.foot(LEFT)
    p.turn(HIP[RIGHT], X, -flex)
    p.turn(KNEE[RIGHT], X, knee)
    p.turn(ANKLE[RIGHT], X, 0.2 * flex)
    up = flex / 104
    both(p, (0.18, 0.12 - 0.22 * up, 0.26), (1, -0.7, -0.3), w)
    p.trunk(ahead=9 * up - 3 * w)


def stomp(p, t, s, n, r):
    lift = through(paced(t, s, r), (0.3, 0), (0.75, 1), (0.85, 1), (1.05, 0), (1.25, 0), (1.65, 1), (1.75, 1),
                   (1.95, 0))[0]
    w, ground = held(t, s, 0.4, 0.5), Ground(p)
    ground.shift(left=0.06 * w * (0.4 + 0.6 * lift), up=-0.02 * w * (1 - 0.5 * lift))
    ground.foot(LEFT)
    ground.foot(RIGHT, up=0.30 * lift, ahead=0.10 * lift, heel=-6 * lift)
    both(p, (0.30, -0.20 + 0.10 * lift, 0.14), (1, -0.5, -0.6), 0.8 * w)
    p.trunk(ahead=10 * w - 8 * lift)
    p.gaze(up=-12 * w)


def wing(p, degrees, share, bent=0.0):
    """Both arms out to the sides, so many degrees over the height of the shoulders."""
    angle = np.radians(degrees)
    for side, out in BOTH:
        way = np.array([out * np.cos(angle), np.sin(angle), 0.06])
        p.reach(side, SHOULDER_AT * [out, 1, 1] + (0.50 - bent) * way, (0, -0.4, -1), share)


def raise_to_the_sides(p, t, s, n, r):
    wing(p, -82 + 82 * ease(t / 1.6), ease(t / 0.4))


def hold_to_the_sides(p, t, s, n, r):
    wing(p, 0, 1)


def flap(p, t, s, n, r):
    w, beat = held(t, s, 0.6, 0.6), sway(t, 1.0 * r)
    wing(p, w * 40 * beat * min(n, 1.1), w, 0.02 + 0.03 * np.cos(2 * np.pi * r * t))
    for side, out in BOTH:
        p.turn(WRIST[side], Z, out * 16 * w * np.cos(2 * np.pi * r * t))
    p.crouch(w * (8 - 6 * beat))
    p.trunk(ahead=6 * w)


def balance(p, t, s, n, r):
    w, ground, wobble = held(t, s, 1.0, 1.0), Ground(p), sway(t, 0.9 * r)
    lift = min(ease((t - 0.5) / 0.8), ease((s - 0.5 - t) / 0.8))
    ground.shift(left=w * 0.075 + 0.006 * lift * wobble, up=-0.002 * w)
    ground.tip(left=lift * (3 + 2 * wobble))
    ground.foot(LEFT)
    ground.foot(RIGHT, left=0.05 * lift, up=0.34 * lift, ahead=0.06 * lift, heel=10 * lift)
    for side, out in BOTH:
        angle = np.radians(-8 + 10 * out * wobble * n)
        p.reach(side, SHOULDER_AT * [out, 1, 1] + 0.5 * np.array([out * np.cos(angle), np.sin(angle), 0.08]),
                (0, -0.5, -1), w)
    p.trunk(tilt=-lift * (2 + 3 * wobble))


def tennis(p, t, s, n, r):
    x, y, z, turn = through(paced(t, s, r), (0.35, -0.30, -0.02, 0.25, 0), (1.0, -0.56, 0.08, -0.02, -36),
                            (1.15, -0.56, 0.06, -0.02, -36), (1.46, -0.36, 0.0, 0.30, -2), (1.78, 0.04, 0.16, 0.42, 26),
                            (2.1, 0.16, 0.30, 0.26, 34), (2.4, 0.14, 0.20, 0.26, 24), (2.8, -0.2, 0.0, 0.2, 0))
    n = min(n, 1.1)
    w, ground = held(t, s, 0.6, 0.7), Ground(p)
    ground.shift(left=0.001 * turn, up=-0.035 * w)
    ground.tip(turn=0.35 * turn * n)
    ground.foot(LEFT)
    ground.foot(RIGHT, heel=max(0, turn))
    p.reach(RIGHT, (x, y, z), (-1, -0.6, -0.4), w)
    p.reach(LEFT, (0.30, 0.06, 0.28), (1, -0.6, -0.2), w)
    p.trunk(left=0.65 * turn * n, ahead=8 * w)
    p.gaze(left=-0.7 * turn)


def swings(keys, hips, back, down):
    """Both hands swing something: rows of a time, the place of the left wrist, and the turn to the left in degrees."""
    def gesture(p, t, s, n, r):
        x, y, z, turn = through(paced(t, s, r), *keys)
        w, ground = held(t, s, 0.7, 0.7), Ground(p)
        turn = turn * w
        ground.tip(ahead=hips * w, turn=0.4 * turn)
        ground.shift(left=0.0012 * turn, up=-down * w, ahead=-0.0016 * hips * w)
        ground.foot(LEFT)
        ground.foot(RIGHT, heel=max(0, 0.9 * turn))
        p.trunk(ahead=back * w, left=0.6 * turn)
        p.gaze(left=-0.5 * turn, up=-0.5 * hips * w)
        p.reach(LEFT, (x, y, z), (0.3, -1, -0.2), w)
        p.reach(RIGHT, (x - 0.05, y + 0.02, z + 0.02), (-0.3, -1, -0.2), w)
    return gesture


golf = swings(((0.7, 0.03, -0.19, 0.28, 0), (0.9, 0.03, -0.19, 0.28, 0), (1.6, -0.24, 0.26, 0.20, -50),
               (1.75, -0.24, 0.26, 0.20, -50), (2.1, 0.03, -0.19, 0.29, 5), (2.45, 0.30, 0.26, 0.20, 60),
               (2.8, 0.30, 0.30, 0.16, 65), (3.5, 0.1, 0.0, 0.25, 0)), 20, 18, 0.035)
bat = swings(((0.5, -0.10, 0.16, 0.24, -20), (0.9, -0.18, 0.18, 0.16, -42), (1.2, -0.18, 0.18, 0.16, -42),
              (1.58, 0.06, 0.0, 0.44, 10), (1.88, 0.32, 0.10, 0.30, 48), (2.15, 0.30, 0.22, 0.18, 54),
              (2.8, 0.1, 0.0, 0.25, 0)), 8, 8, 0.05)


def swim(p, t, s, n, r):
    w = held(t, s, 0.6, 0.6)
    x, y, z = around(t * 0.72 * r, (0.06, 0.02, 0.20), (0.06, 0.12, 0.46), (0.34, 0.10, 0.40), (0.46, 0.0, 0.16),
                     (0.24, -0.06, 0.12))
    both(p, (x, y, z), (1, -0.2, -0.2), w)
    lean(p, w, 18, 10, -22)


def pour(p, t, s, n, r):
    w, tipped = held(t, s, 0.7, 0.7), min(ease((t - 0.9) / 0.6), ease((s - 0.9 - t) / 0.5))
    p.reach(LEFT, (0.15, -0.12, 0.28), (1, -0.8, -0.2), w)
    p.reach(RIGHT, (-0.20 + 0.10 * tipped, -0.06 + 0.18 * tipped, 0.28), (-1, -0.6 + 0.9 * tipped, -0.3), w)
    p.turn(WRIST[RIGHT], X, 50 * tipped)
    p.turn(WRIST[RIGHT], Z, 25 * tipped)
    p.gaze(up=-20 * w, left=6 * w)


def open_door(p, t, s, n, r):
    grasp, pull = held(t, s, 0.8, 0.8), ease((t - 1.2) / 0.8)
    press = ease((t - 0.85) / 0.25)
    ground = Ground(p)
    ground.shift(ahead=grasp * (0.03 - 0.08 * pull), up=-0.015 * grasp)
    ground.stand()
    p.reach(RIGHT, (-0.16 - 0.12 * pull, -0.08 - 0.05 * press, 0.42 - 0.30 * pull), (-0.8, -1, -0.4 - 0.6 * pull),
            grasp)
    p.turn(WRIST[RIGHT], X, 30 * grasp * press)
    p.trunk(left=grasp * (10 - 30 * pull * n), ahead=grasp * (6 - 8 * pull))


def knock(p, t, s, n, r):
    w = held(t, s, 0.6, 0.6)
    hit = 0.5 - 0.5 * np.cos(2 * np.pi * 1.9 * r * t)
    hit *= min(ease((t - 0.5) / 0.3), ease((s - 0.5 - t) / 0.3))
    p.reach(RIGHT, (-0.14, 0.18, 0.24 + 0.15 * hit * n), (-0.5, -1, 0), w)
    p.turn(WRIST[RIGHT], Y, 24 * w * (1 - hit))
    p.trunk(left=6 * w, ahead=4 * w)


def from_shelf(p, t, s, n, r):
    x, y, z, up = through(paced(t, s, r), (0.2, -0.22, 0.0, 0.30, 0), (1.1, -0.18, 0.62, 0.20, 1), (1.5, -0.18, 0.62,
                                                                                                    0.20, 1),
                          (2.3, -0.10, 0.02, 0.28, 0))
    w, ground = held(t, s, 0.6, 0.8), Ground(p)
    ground.shift(up=0.06 * up)
    ground.foot(LEFT, heel=32 * up)
    ground.foot(RIGHT, heel=32 * up)
    p.reach(RIGHT, (x, y, z), (-1, -0.6, 0), w)
    p.turn(COLLAR[RIGHT], Z, -16 * up)
    p.gaze(up=28 * up - 8 * w * (1 - up))


def put_down(p, t, s, n, r):
    down = through(paced(t, s, r), (0.7, 0), (1.5, 1), (1.9, 1), (2.6, 0))[0]
    w = held(t, s, 0.7, 0.8)
    ground = lean(p, down, 24, 20, 4)
    a, b = np.array((-0.12, 1.20, 0.28)), np.array((-0.12, 0.92, 0.56))
    ground.hand(RIGHT, a + (b - a) * down, (-1, -0.6, -0.2), w)
    p.gaze(up=-16 * w)


def arm_circles(sides):
    def gesture(p, t, s, n, r):
        share = np.clip((t - 0.3) / (s - 0.6), 0, 1)
        angle = 2 * np.pi * 2 * share * share * (3 - 2 * share)
        for side, out in BOTH:
            if side in sides:
                wrist = SHOULDER_AT * [out, 1, 1] + 0.5 * np.array([out * 0.30, -np.cos(angle), -np.sin(angle)])
                p.reach(side, wrist, (out, 0, 0), held(t, s, 0.3, 0.3))
        p.trunk(ahead=5 * np.sin(angle) * held(t, s, 0.3, 0.3))
    return gesture


def flat_circles(p, t, s, n, r):
    w, turn = held(t, s, 0.7, 0.7), 2 * np.pi * 0.75 * r * t
    p.reach(RIGHT, (-0.20 + 0.14 * n * np.cos(turn), -0.06, 0.30 + 0.12 * n * np.sin(turn)), (-1, -0.6, -0.4), w)


def duck(p, t, s, n, r):
    w, ground = through(paced(t, s, r), (0.5, 0), (0.9, 1), (1.15, 1), (1.8, 0))[0], Ground(p)
    guards = held(t, s, 0.5, 0.6)
    ground.shift(left=0.14 * w, up=-0.26 * w * min(1, n), ahead=-0.06 * w)
    ground.tip(ahead=22 * w, left=8 * w)
    ground.stand()
    p.trunk(ahead=34 * w, tilt=-16 * w)
    p.gaze(up=22 * w)
    both(p, (0.15, 0.14 + 0.10 * w, 0.20), (1, -1, -0.2), guards)


def uppercut(p, t, s, n, r):
    x, y, z, turn, low = through(paced(t, s, r), (0.4, -0.15, 0.12, 0.18, 0, 0), (0.85, -0.24, -0.12, 0.14, -22, 1),
                                 (0.95, -0.24, -0.12, 0.14, -22, 1), (1.3, -0.06, 0.32, 0.32, 22, 0),
                                 (1.45, -0.06, 0.34, 0.30, 22, 0), (1.95, -0.15, 0.12, 0.18, 0, 0))
    n = min(n, 1.1)
    w, ground = held(t, s, 0.45, 0.5), Ground(p)
    ground.shift(up=-0.02 * w - 0.07 * low)
    ground.tip(turn=0.3 * turn)
    ground.foot(LEFT)
    ground.foot(RIGHT, heel=max(0, turn))
    p.trunk(left=0.7 * turn * n, ahead=6 * w + 8 * low, tilt=8 * low)
    p.reach(LEFT, (0.14, 0.12, 0.18), (1, -1, -0.2), w)
    p.reach(RIGHT, (x, y, z), (-0.6, -1, -0.2), w)


def stride(ground, side, step, down, ahead, drop, heel):
    """A long step ahead with one foot, whose share is `step`, and the pelvis sinks by a share `down`."""
    ground.shift(ahead=ahead * (0.35 * step + 0.15 * down), up=-drop * down - 0.03 * step)
    ground.foot(side, ahead=ahead * step, up=0.10 * np.sin(np.pi * step))
    ground.foot(1 - side, heel=heel * max(0.4 * step, down), out=4 * down)


def lunge(p, t, s, n, r):
    step = min(ease((t - 0.2) / 0.8), ease((s - 0.2 - t) / 0.8))
    down = min(ease((t - 0.5) / 0.8), ease((s - 0.5 - t) / 0.8))
    stride(Ground(p), RIGHT, step, down, 0.84 * min(n, 1.05), 0.22, 48)
    p.trunk(ahead=5 * down)
    both(p, (0.24, -0.18, 0.10), (1, -0.2, -0.8), held(t, s, 0.6, 0.6))


def touch_toes(p, t, s, n, r):
    w = held(t, s, 1.2, 1.2)
    ground = lean(p, w, 78, 62, 16)
    for side, out in BOTH:
        ground.hand(side, (out * 0.11, 0.16, 0.16), (out, 0.2, 0.4), w)


def side_bend(p, t, s, n, r):
    w, ground = held(t, s, 0.9, 0.9) * min(n, 1.1), Ground(p)
    ground.shift(left=-0.05 * w, up=-0.004 * w)
    ground.stand()
    p.trunk(tilt=-40 * w)
    p.gaze(tilt=-12 * w)
    p.turn(SHOULDER[LEFT], Z, 26 * w)
    p.turn(SHOULDER[RIGHT], Z, 12 * w)


def hammer(p, t, s, n, r):
    w, up = held(t, s, 0.6, 0.6), (0.5 + 0.5 * np.cos(2 * np.pi * 1.3 * r * t)) ** 0.8
    p.reach(LEFT, (0.10, -0.18, 0.32), (1, -0.8, -0.2), w)
    p.reach(RIGHT, (-0.16 + 0.02 * up, -0.14 + 0.36 * up * min(n, 1.1), 0.34 - 0.12 * up), (-1, -0.8, -0.2), w)
    p.turn(WRIST[RIGHT], Z, w * (20 - 40 * up))
    p.trunk(ahead=w * (14 - 6 * up))
    p.gaze(up=-20 * w)


def saw(p, t, s, n, r):
    w, push = held(t, s, 0.6, 0.6), sway(t, 1.15 * r)
    lean(p, w, 20, 16, 14)
    p.reach(LEFT, (0.18, -0.14, 0.36), (1, -0.6, -0.3), w)
    p.trunk(left=w * 8 * push)
    p.reach(RIGHT, (-0.14, -0.11 - 0.04 * push, 0.24 + 0.15 * push * min(n, 1.1)), (-0.6, -0.9, -0.5), w)


def dig(p, t, s, n, r):
    x, y, z, hips, turn = around((t - 0.5) / 1.75, (0.0, -0.16, 0.36, 10, 0), (-0.02, -0.22, 0.30, 34, -6),
                                 (-0.02, -0.22, 0.26, 28, -6), (0.06, -0.06, 0.36, 6, 12), (0.18, 0.0, 0.38, 4, 34),
                                 (0.10, -0.08, 0.36, 6, 16))
    w = held(t, s, 0.6, 0.6)
    ground = Ground(p)
    ground.tip(ahead=hips * w, turn=0.3 * turn * w)
    ground.shift(up=-w * (0.03 + 0.004 * hips), ahead=-0.0016 * hips * w)
    ground.stand()
    p.trunk(ahead=w * (6 + 0.7 * hips), left=0.7 * turn * w)
    p.reach(LEFT, (x + 0.08, y, z), (1, -0.6, -0.2), w)
    p.reach(RIGHT, (x - 0.20, y + 0.14, z - 0.14), (-1, -0.3, -0.5), w)
    p.gaze(up=-14 * w)


def chop(p, t, s, n, r):
    w, up = held(t, s, 0.6, 0.6), 0.5 - 0.5 * np.cos(2 * np.pi * 2.1 * r * t)
    along = 0.06 * np.clip((t - 0.5) / (s - 1), 0, 1)
    p.reach(LEFT, (0.16 + along, -0.22, 0.30), (1, -0.6, -0.2), w)
    p.reach(RIGHT, (-0.06 + along, -0.21 + 0.13 * n * up, 0.29 - 0.03 * up), (-1, -0.3, -0.3), w)
    p.trunk(ahead=10 * w)
    p.gaze(up=-24 * w)


def brush_teeth(p, t, s, n, r):
    w, rub = held(t, s, 0.7, 0.7), sway(t, 2.4 * r)
    p.reach(RIGHT, (-0.17 + 0.035 * n * rub, 0.24, 0.19 - 0.01 * rub), (-1, -0.15, 0.2), w)
    p.gaze(up=-6 * w, left=-3 * w * rub)


def comb(p, t, s, n, r):
    w = held(t, s, 0.7, 0.7)
    wrist = around(t * 0.68 * r, (-0.17, 0.38, 0.15), (-0.18, 0.45, 0.05), (-0.20, 0.41, -0.07), (-0.24, 0.28, -0.06),
                   (-0.28, 0.31, 0.09))
    p.reach(RIGHT, wrist, (-1, 0.1, 0.3), w)
    p.gaze(tilt=6 * w)


def write_board(p, t, s, n, r):
    w, share = held(t, s, 0.7, 0.7), np.clip((t - 0.6) / (s - 1.3), 0, 1)
    p.reach(RIGHT, (0.02 - 0.30 * share + 0.03 * n * sway(t, 1.9 * r), 0.27 + 0.05 * n * sway(t, 2.3 * r), 0.38),
            (-0.6, -1, 0), w)
    p.gaze(up=4 * w, left=w * (8 - 20 * share))
    p.trunk(left=w * (8 - 10 * share))


def look_at_watch(p, t, s, n, r):
    w = held(t, s, 0.6, 0.6)
    p.reach(LEFT, (0.03, 0.06, 0.27), (1, -0.4, 0.1), w)
    p.gaze(up=-26 * w, left=6 * w)


def beckon(p, t, s, n, r):
    w, curl = held(t, s, 0.6, 0.6), 0.5 - 0.5 * np.cos(2 * np.pi * 1.1 * r * t)
    p.reach(RIGHT, (-0.26 + 0.05 * curl, 0.06 + 0.22 * curl * n, 0.44 - 0.26 * curl), (-0.5, -1, 0.1), w)
    p.turn(WRIST[RIGHT], Y, 50 * w * curl)
    p.gaze(up=3 * w * curl)


def hand_over(p, t, s, n, r):
    out = through(paced(t, s, r), (0.5, 0), (1.2, 1), (1.9, 1), (2.5, 0))[0]
    w = held(t, s, 0.6, 0.7)
    p.reach(RIGHT, (-0.14, -0.08 + 0.10 * out, 0.22 + 0.25 * out), (-0.6, -1, -0.3), w)
    p.trunk(left=10 * out, ahead=7 * out * n)


def receive(p, t, s, n, r):
    near = through(paced(t, s, r), (1.4, 0), (2.1, 1))[0]
    w = held(t, s, 0.7, 0.7)
    p.reach(RIGHT, (-0.14 + 0.05 * near, 0.02, 0.46 - 0.24 * near), (-0.7, -1, -0.3), w)
    p.trunk(left=w * 9 * (1 - near), ahead=w * 6 * (1 - near))
    p.gaze(up=-w * 16 * near)


def blow_kiss(p, t, s, n, r):
    away = through(paced(t, s, r), (1.3, 0), (1.75, 1))[0]
    w = held(t, s, 0.7, 0.7)
    p.reach(RIGHT, (-0.06 - 0.18 * away, 0.23 - 0.03 * away, 0.18 + 0.27 * away), (-0.7, -1, 0), w)
    p.turn(WRIST[RIGHT], X, -30 * w * away)
    p.trunk(ahead=7 * away * w * n)


def think(p, t, s, n, r):
    w = held(t, s, 0.8, 0.8)
    p.reach(LEFT, (-0.10, -0.10, 0.19), (1, -0.6, 0), w)
    p.reach(RIGHT, (-0.07, 0.17, 0.18), (-0.4, -1, 0.1), w)
    p.gaze(up=-w * (8 + 4 * sway(t, 0.3)), tilt=w * (8 + 5 * sway(t, 0.35 * r)), left=-6 * w)


def hands_on_hips(p, t, s, n, r):
    w = held(t, s, 0.7, 0.7)
    both(p, (0.20, -0.21, 0.04), (1, 0, -0.45), w)
    p.trunk(ahead=-3 * w, left=4 * w * sway(t, 0.4 * r))


def hands_behind(p, t, s, n, r):
    w = held(t, s, 0.9, 0.9)
    both(p, (0.07, -0.27, -0.16), (1, 0.1, -0.8), w)
    p.trunk(ahead=-4 * w)


def pray(p, t, s, n, r):
    w = held(t, s, 0.8, 0.8)
    both(p, (0.035, 0.06, 0.22), (1, -0.7, -0.2), w)
    p.gaze(up=-26 * w)
    p.trunk(ahead=w * (6 + 2 * sway(t, 0.4 * r)))


def karate_chop(p, t, s, n, r):
    x, y, z, down = through(paced(t, s, r), (0.4, -0.22, 0.2, 0.2, 0), (1.0, -0.26, 0.42, 0.14, -0.5),
                            (1.1, -0.26, 0.42, 0.14, -0.5), (1.5, -0.08, -0.02, 0.42, 1), (1.8, -0.08, -0.02, 0.42, 1),
                            (2.3, -0.2, -0.1, 0.25, 0))
    w, ground = held(t, s, 0.5, 0.6), Ground(p)
    ground.shift(up=-0.03 * w - 0.07 * max(0, down))
    ground.tip(ahead=5 * down)
    ground.stand()
    p.trunk(left=16 * down * n, ahead=11 * down)
    p.reach(RIGHT, (x, y, z), (-1, -0.7, -0.1), w)
    p.reach(LEFT, (0.20, -0.12, 0.14), (1, -0.4, -0.8), w)


def archery(p, t, s, n, r):
    draw = through(paced(t, s, r), (1.0, 0), (1.8, 1))[0]
    loosed = through(paced(t, s, r), (2.4, 0), (2.55, 1))[0]
    w = held(t, s, 0.8, 0.7)
    p.reach(LEFT, (0.56, 0.18, 0.34), (0.3, -1, 0), w)
    p.reach(RIGHT, (0.20 - 0.30 * draw - 0.12 * loosed, 0.18 + 0.05 * draw, 0.32 - 0.16 * draw - 0.08 * loosed),
            (-1, 0.15, -0.1 - 0.3 * draw), w)
    p.gaze(left=54 * w)
    p.trunk(left=-14 * w)


def lift_heavy(p, t, s, n, r):
    down = through(t, (0.1, 0), (1.2, 1), (1.6, 1), (2.7, 0))[0]
    grip, up = ease(t / 1.0), ease((t - 1.6) / 1.1)
    ground = Ground(p)
    ground.shift(up=-0.40 * down, ahead=-0.12 * down)
    ground.tip(ahead=46 * down)
    ground.stand()
    p.trunk(ahead=34 * down - 6 * up)
    p.gaze(up=14 * down)
    for side, out in BOTH:
        low, high = np.array([out * 0.20, 0.20, 0.30]), np.array([out * 0.17, 1.0, 0.32])
        ground.hand(side, low + (high - low) * up, (out, -0.3, -0.5), grip)


def hold_something(p, t, s, n, r):
    lift_heavy(p, 9, s, n, r)


def shoot_hoops(p, t, s, n, r):
    low, up = through(paced(t, s, r), (0.3, 0, 0), (0.9, 1, 0), (1.0, 1, 0), (1.4, -0.3, 1), (1.65, -0.3, 1), (2.3, 0,
                                                                                                               0.2))
    w, ground = held(t, s, 0.6, 0.7), Ground(p)
    ground.shift(up=-0.14 * max(0, low) + 0.05 * max(0, -low / 0.3))
    for side, _ in BOTH:
        ground.foot(side, heel=26 * max(0, -low / 0.3))
    p.trunk(ahead=14 * max(0, low))
    both(p, (0.11, 0.10 + 0.50 * up, 0.22 + 0.04 * up), (1, -0.7, 0.1), w)
    for side, out in BOTH:
        p.turn(WRIST[side], Y, -out * w * (-30 + 60 * up))
    p.gaze(up=16 * w)


def catch(p, t, s, n, r):
    near = through(paced(t, s, r), (1.1, 0), (1.4, 1))[0]
    w, ground = held(t, s, 0.6, 0.8), Ground(p)
    ground.shift(up=-w * (0.05 + 0.03 * near))
    ground.stand()
    both(p, (0.14 - 0.04 * near, 0.14 - 0.12 * near, 0.44 - 0.25 * near), (1, -0.8, -0.2), w)
    p.trunk(ahead=w * (8 + 6 * near))


def dribble(p, t, s, n, r):
    w, down = held(t, s, 0.5, 0.5), 0.5 - 0.5 * np.cos(2 * np.pi * 1.6 * r * t)
    ground = Ground(p)
    ground.shift(up=-w * (0.08 + 0.02 * down))
    ground.tip(ahead=10 * w)
    ground.stand()
    p.trunk(ahead=14 * w)
    p.reach(RIGHT, (-0.24, -0.01 - 0.19 * down * min(n, 1.1), 0.31), (-1, -0.4, -0.5), w)
    p.turn(WRIST[RIGHT], Z, w * (-14 + 34 * down))
    p.reach(LEFT, (0.30, -0.12, 0.20), (1, -0.6, -0.4), w)
    p.gaze(up=-8 * w)


def bowl(p, t, s, n, r):
    angle, near = through(paced(t, s, r), (0.2, 0, 0.8), (0.7, 25, 0.7), (1.3, -58, 1), (1.4, -58, 1), (1.75, 10, 1),
                          (2.05, 66, 1), (2.25, 66, 0.95), (2.9, 0, 0.95))
    step = min(ease((t - 0.8) / 0.7), ease((s - 0.3 - t) / 0.8))
    down = min(ease((t - 0.9) / 0.7), ease((s - 0.6 - t) / 0.8))
    ground = Ground(p)
    ground.tip(ahead=20 * down)
    stride(ground, LEFT, step, down, 0.55, 0.16, 30)
    p.trunk(ahead=26 * down, left=0.25 * angle * n)
    p.gaze(up=22 * down)
    a = np.radians(angle + 42 * down)
    p.reach(RIGHT, SHOULDER_AT * [-1, 1, 1] + 0.5 * near * np.array([-0.12, -np.cos(a), np.sin(a)]), (-1, -0.1, -0.1),
            held(t, s, 0.5, 0.6))
    p.reach(LEFT, (0.50, -0.02, 0.06), (1, -0.6, -0.4), down)


def shake_hands(p, t, s, n, r):
    w, shaken = held(t, s, 0.7, 0.7), sway(t, 1.8 * r) * min(ease((t - 0.6) / 0.3), ease((s - 0.6 - t) / 0.3))
    p.reach(RIGHT, (-0.10, -0.06 + 0.05 * n * shaken, 0.42), (-0.6, -1, -0.3), w)
    p.trunk(left=8 * w, ahead=6 * w)


def cheer(p, t, s, n, r):
    w, beat = held(t, s, 0.8, 0.8), 0.5 - 0.5 * np.cos(2 * np.pi * 1.5 * r * t)
    both(p, (0.30, 0.42 + 0.16 * n * beat, 0.12), (1, -0.5, 0.1), w)
    p.crouch(w * (12 - 10 * beat))
    p.gaze(up=12 * w)


def laugh(p, t, s, n, r):
    w = held(t, s, 0.6, 0.6)
    shaken = w * sway(t, 2.8 * r)
    bent = 0.5 - 0.5 * np.cos(2 * np.pi * t / s * 2)
    p.trunk(ahead=w * (-8 + 26 * bent * n) + 4 * shaken)
    p.gaze(up=w * (22 - 26 * bent) - 4 * shaken)
    p.reach(LEFT, (0.06, -0.15, 0.19), (1, -0.4, -0.2), w)
    p.reach(RIGHT, (-0.10, -0.18, 0.19), (-1, -0.4, -0.2), w)
    for side, out in BOTH:
        p.turn(COLLAR[side], Z, out * 4 * shaken)


def wipe_eyes(p, t, s, n, r):
    w, rub = held(t, s, 0.7, 0.7), sway(t, 1.5 * r)
    both(p, (0.13 + 0.035 * n * rub, 0.24 - 0.012 * rub, 0.18), (1, -0.7, 0.1), w)
    p.gaze(up=-20 * w)
    p.trunk(ahead=w * (8 + 2 * sway(t, 2.2 * r)))


def cough(p, t, s, n, r):
    w = held(t, s, 0.6, 0.6)
    jerk = sum(through(t, (at, 0), (at + 0.14, 1), (at + 0.5, 0))[0] for at in (0.8, 1.35, 1.9))
    p.reach(RIGHT, (-0.10, 0.22, 0.18), (-0.8, -1, 0.1), w)
    p.trunk(ahead=w * 4 + 15 * jerk * n)
    p.gaze(up=-8 * w - 12 * jerk)


def sneeze(p, t, s, n, r):
    w = held(t, s, 0.8, 0.7)
    head, jerk = through(t, (0.3, 0, 0), (1.2, 1, 0), (1.35, 1, 0), (1.55, 0, 1), (1.75, 0, 1), (2.4, 0, 0))
    p.reach(RIGHT, (-0.10, 0.23, 0.19), (-0.8, -1, 0.1), w)
    p.trunk(ahead=-9 * head + 32 * jerk * n)
    p.gaze(up=22 * head - 24 * jerk)
    p.crouch(8 * jerk)


def rub_belly(p, t, s, n, r):
    w, turn = held(t, s, 0.7, 0.7), 2 * np.pi * 0.9 * r * t
    p.reach(RIGHT, (-0.10 + 0.07 * n * np.cos(turn), -0.17 + 0.06 * n * np.sin(turn), 0.20), (-1, -0.3, -0.1), w)
    p.gaze(up=-12 * w)


def tie_shoes(p, t, s, n, r):
    step = min(ease((t - 0.1) / 0.8), ease((s - 0.1 - t) / 0.8))
    down = min(ease((t - 0.3) / 1.0), ease((s - 0.3 - t) / 1.0))
    ground = Ground(p)
    ground.tip(ahead=22 * down)
    stride(ground, LEFT, step, down, 0.62, 0.40, 62)
    p.trunk(ahead=56 * down)
    p.gaze(up=-4 * down)
    for side, out in BOTH:
        tug = 0.03 * sway(t, 1.4 * r)
        ground.hand(side, (0.11 + out * (0.07 + tug), 0.20 + tug, 0.66), (out, 0, -0.5), down)


ARM, ARMS = "right arm", "left arm,right arm"
# name: function, seconds, parts, captions
ACTING = {
    "play_the_guitar": (
        guitar, 4.2, ARMS,
        "play the guitar | play guitar | play air guitar | a person plays the guitar | someone plays the guitar | the "
        "person is playing the guitar | strum a guitar | a person strums a guitar | playing the air guitar | someone "
        "is playing an imaginary guitar"),
    "play_the_violin": (
        violin, 4.4, ARMS,
        "play the violin | play violin | play the fiddle | a person plays the violin | someone plays the violin | the "
        "person is playing the violin | playing an air violin | someone is playing an imaginary violin"),
    "wipe_a_table": (
        wipe_table, 4.0, "right arm,spine",
        "wipe a table | wipe the table | clean the table | a person wipes a table | someone wipes the table with the "
        "right hand | the person is wiping a table | wipe a surface with the right hand | a person cleans a table | "
        "polish a table"),
    "stir": (
        stir, 3.8, ARMS,
        "stir | stir in a pot | stir the soup | stir something in a bowl | a person stirs in a pot | someone stirs "
        "with the right hand | the person is stirring something | mix something in a bowl | a person mixes dough in a "
        "bowl"),
    "wipe_a_window": (
        wipe_window, 3.8, ARM,
        "wipe a window | clean the window | wash a window | a person wipes a window | someone cleans a window with the "
        "right hand | the person is cleaning a window | wipe a wall with the right hand | wipe the mirror"),
    "low_kick": (
        low_kick, 2.4, "legs",
        "kick low | do a low kick | low kick | kick low with the right foot | a person kicks low | a person kicks "
        "something low with the right foot | a person performs a low kick with the right leg | someone kicks against "
        "the shin"),
    "high_kick": (
        high_kick, 2.6, "legs,spine",
        "high kick | kick up high | kick high with the right foot | a person kicks high | a person performs a high "
        "kick with the right leg | someone kicks at head height | kick to the head | karate kick | a person does a "
        "high karate kick"),
    "kick_to_the_side": (
        kick_aside, 2.6, "legs,spine",
        "kick to the side | side kick | do a side kick | kick sideways | kick to the right side with the right foot | "
        "a person kicks to the side | a person performs a side kick with the right leg | someone kicks sideways to the "
        "right"),
    "drum": (
        drum, 3.8, ARMS,
        "drum | play the drums | play drums | a person plays the drums | someone plays the drums | the person is "
        "playing the drums | drumming | a person drums with both hands | beat a drum | play air drums"),
    "raise_the_arms_to_the_side": (
        raise_to_the_sides, 2.2, ARMS,
        "raise the arms to the side | raise both arms to the sides | stretch the arms out to the sides | lift the arms "
        "sideways | a person raises the arms to the sides | someone stretches both arms out to the side | spread the "
        "arms | a person spreads the arms | make a T pose | raise the arms sideways to shoulder height"),
    "hold_t_pose": (
        hold_to_the_sides, 3.0, ARMS,
        "stand with the arms stretched out to the sides | stand with the arms raised to the sides | hold the arms at "
        "shoulder height | hold the arms to the side | a person holds both arms out to the sides | hold a T pose | "
        "stand in a T pose | keep the arms stretched out to the sides | a person stands with the arms out to the sides "
        "| hold the arms out to the sides"),
    "flap_the_arms": (
        flap, 3.8, ARMS,
        "flap the arms | flap the arms like a bird | fly like a bird | a person flaps the arms | someone flaps the "
        "arms like wings | the person is flapping the arms up and down | pretend to fly | act like a bird | flap your "
        "wings"),
    "balance": (
        balance, 4.2, "left arm,right arm,legs",
        "stand on one leg | balance on one leg | balance | a person stands on one leg | a person balances on the left "
        "foot | someone balances on one leg with the arms out to the sides | stand on the left leg and lift the right "
        "foot | keep the balance on one foot"),
    "tennis": (
        tennis, 3.2, "right arm,spine",
        "play tennis | hit a tennis ball | swing a tennis racket | a person plays tennis | a person performs a "
        "forehand | forehand | a tennis forehand with the right hand | someone hits a ball with a racket | the person "
        "is playing tennis"),
    "golf": (
        golf, 4.0, "left arm,right arm,spine",
        "play golf | golf swing | hit a golf ball | swing a golf club | a person plays golf | a person performs a golf "
        "swing | someone swings a golf club | the person is playing golf"),
    "baseball": (
        bat, 3.2, "left arm,right arm,spine",
        "swing a baseball bat | swing a bat | play baseball | hit a baseball | a person swings a bat | a person swings "
        "a baseball bat with both hands | someone hits a ball with a bat | the person is batting | hit something with "
        "a stick in both hands"),
    "swim": (
        swim, 4.2, ARMS,
        "swim | breaststroke | swim breaststroke | do swimming strokes with the arms | a person swims | a person makes "
        "swimming motions with both arms | someone pretends to swim | the person is swimming in the air | move the "
        "arms like swimming breaststroke"),
    "pour": (
        pour, 3.8, ARMS,
        "pour | pour water into a glass | pour a drink | pour from a bottle into a cup | a person pours something into "
        "a cup | someone pours water from a bottle | the person is pouring a drink | a person fills a glass | pour tea "
        "with the right hand"),
    "open_a_door": (
        open_door, 3.6, "right arm,spine",
        "open a door | open the door | pull a door open | a person opens a door | someone opens a door with the right "
        "hand | the person is opening a door | grab the door handle and pull | pull something with the right hand | a "
        "person pulls at a door"),
    "knock": (
        knock, 3.0, ARM,
        "knock | knock at the door | knock on a door | a person knocks at a door | someone knocks with the right hand "
        "| the person is knocking on the door | knocking"),
    "take_from_a_shelf": (
        from_shelf, 3.6, ARM,
        "take something from a high shelf | take something from a shelf | reach up and take something down | a person "
        "takes something from a high shelf | someone grabs something from above with the right hand | get a book from "
        "the top shelf | reach for something high up | a person reaches up for something"),
    "put_down": (
        put_down, 3.2, "right arm,spine",
        "put something down on a table | put something on the table | place something on a table | set a cup down | a "
        "person puts something on a table | someone places an object on the table with the right hand | put down a "
        "glass"),
    "conduct": (
        conduct, 4.3, ARMS,
        "conduct an orchestra | conduct | a person conducts an orchestra | someone conducts an orchestra with both "
        "arms | the person is conducting | act like a conductor | conducting music"),
    "play_the_piano": (
        piano, 4.0, ARMS,
        "play the piano | play piano | a person plays the piano | someone plays the piano | the person is playing the "
        "piano | play a keyboard with both hands | playing the air piano | a pianist plays"),
    "arm_circles": (
        arm_circles((LEFT, RIGHT)), 3.4, ARMS,
        "circle both arms | circle the arms | arm circles | swing both arms in circles | do arm circles | a person "
        "circles both arms | a person swings the arms in big circles | someone rotates both arms | windmill with both "
        "arms"),
    "circle_right_arm": (
        arm_circles((RIGHT,)), 3.4, ARM,
        "circle the right arm | swing the right arm in a circle | rotate the right arm | a person circles the right "
        "arm | a person swings the right arm in big circles | someone makes large circles with the right arm | circle "
        "one arm"),
    "flat_circles": (
        flat_circles, 3.8, ARM,
        "draw circles with the right hand parallel to the floor | a person moves the right hand in a horizontal circle "
        "| make horizontal circles with the right hand | move one hand in circles parallel to the ground | a person "
        "circles with the right hand in front of the belly | circle with the right hand"),
    "duck": (
        duck, 2.6, "legs,spine",
        "duck | dodge | evade | dodge a punch | a person ducks | a person dodges to the left | someone ducks away | "
        "the person evades something | duck and come back up | avoid a thrown ball"),
    "stomp": (
        stomp, 2.6, "legs",
        "stomp | stomp with the right foot | stamp the foot | stamp on the floor | a person stomps with the right foot "
        "| someone stamps the right foot on the ground | the person is stomping | stomp twice on the ground"),
    "uppercut": (
        uppercut, 2.5, "right arm,spine",
        "uppercut | do an uppercut | punch upwards | an uppercut with the right hand | a person throws an uppercut | a "
        "person punches upwards with the right fist | someone hits upwards from below"),
    "raise_the_knee": (
        knee_up, 2.3, "legs",
        "raise the right knee | lift the right knee | lift the knee | knee strike | a person lifts the right knee | a "
        "person performs a knee strike with the right leg | someone pulls the right knee up | lift one leg with the "
        "knee bent | hit with the knee"),
    "lunge": (
        lunge, 3.4, "legs",
        "lunge | do a lunge | lunge forward | lunge forward with the right leg | a person does a lunge | a person "
        "performs a lunge with the right leg and comes back | someone makes a long step forward and returns | step "
        "into a lunge"),
    "touch_the_toes": (
        touch_toes, 4.0, "spine,left arm,right arm",
        "touch the toes | touch your toes | touch the feet with the hands | bend down and touch the toes | a person "
        "touches the toes | a person bends forward until the hands reach the feet | someone touches the feet with "
        "straight legs | reach down to the feet"),
    "bend_to_the_left": (
        side_bend, 3.4, "spine",
        "lean to the left | bend to the left | bend to the left side | lean sideways to the left | a person leans to "
        "the left | a person bends the upper body to the left | someone tilts the upper body to the left side | do a "
        "side bend to the left"),
    "hammer": (
        hammer, 3.6, ARM,
        "hammer | hammer a nail | hit something with a hammer | a person hammers | a person hammers a nail with the "
        "right hand | someone uses a hammer | the person is hammering | drive a nail in with a hammer"),
    "saw": (
        saw, 3.8, "right arm,spine",
        "saw | saw wood | saw a board | a person saws wood | a person saws with the right hand | someone saws through "
        "a plank | the person is sawing | cut wood with a saw"),
    "dig": (
        dig, 4.4, "left arm,right arm,spine",
        "dig | dig a hole | dig with a shovel | shovel | shovel snow | a person digs a hole | a person shovels with "
        "both hands | someone digs with a spade | the person is digging | shovel sand"),
    "chop": (
        chop, 3.4, ARMS,
        "chop vegetables | cut vegetables | chop onions with a knife | a person chops vegetables | someone cuts "
        "something with a knife | the person is cutting vegetables | cut bread on a table | slice something with the "
        "right hand"),
    "brush_the_teeth": (
        brush_teeth, 3.6, ARM,
        "brush the teeth | brush your teeth | a person brushes the teeth | someone brushes the teeth with the right "
        "hand | the person is brushing the teeth | brushing teeth | clean the teeth with a toothbrush"),
    "comb_the_hair": (
        comb, 3.6, ARM,
        "comb the hair | comb your hair | brush the hair | a person combs the hair | someone combs the hair with the "
        "right hand | the person is combing the hair | a person brushes the hair"),
    "write_on_a_board": (
        write_board, 4.2, ARM,
        "write on a board | write on a blackboard | write something on the wall | a person writes on a board | someone "
        "writes on a whiteboard with the right hand | the person is writing on a blackboard | a teacher writes on the "
        "board"),
    "type_on_a_keyboard": (
        type_keys, 3.6, ARMS,
        "type on a keyboard | type | write on a computer | a person types on a keyboard | someone types with both "
        "hands | the person is typing | typing a text"),
    "look_at_the_watch": (
        look_at_watch, 2.8, "left arm,head",
        "look at the watch | check the time | look at the wristwatch | a person looks at the watch | someone checks "
        "the watch on the left wrist | the person is looking at the watch | check the wristwatch"),
    "beckon": (
        beckon, 3.4, ARM,
        "beckon | call somebody over | beckon with the right hand | wave someone closer | a person beckons | a person "
        "calls somebody over with the right hand | someone signals to come closer | come here"),
    "hand_over": (
        hand_over, 3.0, ARM,
        "hand something over | give something to someone | hand over an object | a person hands something over | a "
        "person gives something to someone with the right hand | someone offers something with the right hand | give "
        "someone a present"),
    "receive": (
        receive, 3.0, ARM,
        "receive something | take something from someone | take an object from in front | a person takes something "
        "with the right hand | a person receives something from someone | someone grabs something in front and takes "
        "it | reach out and take something"),
    "blow_a_kiss": (
        blow_kiss, 2.8, ARM,
        "blow a kiss | throw a kiss | blow a kiss with the right hand | a person blows a kiss | someone throws a kiss "
        "| the person is blowing a kiss to someone"),
    "think": (
        think, 4.0, ARMS,
        "think | think about something | put the hand on the chin | a person thinks | a person puts the right hand on "
        "the chin and thinks | someone is thinking | the person is thinking hard | ponder with the hand at the chin"),
    "hands_on_the_hips": (
        hands_on_hips, 3.6, ARMS,
        "put the hands on the hips | hands on the hips | stand with the hands on the hips | a person puts both hands "
        "on the hips | someone rests the hands on the hips | place both hands at the waist | stand with arms akimbo"),
    "hands_behind_the_back": (
        hands_behind, 3.6, ARMS,
        "put the hands behind the back | hands behind the back | stand with the hands behind the back | a person puts "
        "both hands behind the back | someone folds the hands behind the back | hide the hands behind the back"),
    "pray": (
        pray, 4.0, ARMS,
        "pray | fold the hands | fold the hands and pray | a person prays | someone folds the hands in front of the "
        "chest | the person is praying | put the palms together in prayer"),
    "karate_chop": (
        karate_chop, 2.8, "right arm,spine",
        "karate chop | do a karate chop | chop with the right hand from above | a person performs a karate chop | a "
        "person strikes downward with the right hand | someone breaks a board with the hand | hit downward with the "
        "edge of the right hand"),
    "archery": (
        archery, 3.6, ARMS,
        "shoot a bow and arrow | shoot an arrow | draw a bow | archery | a person shoots an arrow | a person draws a "
        "bow and shoots | someone shoots with a bow and arrow | the person is shooting a bow"),
    "lift_something_heavy": (
        lift_heavy, 3.0, "left arm,right arm,legs,spine",
        "lift something heavy | lift a heavy box | pick up a box with both hands | lift a box from the floor | a "
        "person lifts something heavy from the floor with both hands | a person picks up a heavy box | someone lifts a "
        "crate | the person lifts a box from the ground"),
    "hold_something_with_both_hands": (
        hold_something, 3.0, ARMS,
        "hold something with both hands | hold a box | hold a box with both hands | stand and hold a box | a person "
        "holds something with both hands | someone holds a heavy box in front of the belly"),
    "shoot_a_basketball": (
        shoot_hoops, 2.8, ARMS,
        "shoot a basketball | play basketball | throw a basketball | throw with both hands | throw a ball with both "
        "hands over the head | a person shoots a basketball | a person throws a ball upwards with both hands | someone "
        "throws a ball at the basket | the person is playing basketball"),
    "catch_a_ball": (
        catch, 2.6, ARMS,
        "catch a ball | catch | catch something | catch a ball with both hands | a person catches a ball | a person "
        "catches something with both hands | someone catches a ball in front of the chest | the person is catching a "
        "ball"),
    "bounce_a_ball": (
        dribble, 3.6, ARM,
        "bounce a ball | dribble a ball | dribble a basketball | dribble | a person dribbles a ball | a person bounces "
        "a ball with the right hand | someone dribbles a basketball on the spot | the person is bouncing a ball"),
    "bowl": (
        bowl, 3.4, "right arm,legs,spine",
        "bowl | go bowling | throw a bowling ball | roll a ball | throw underarm | a person throws a bowling ball | a "
        "person throws a ball underarm with the right hand | someone rolls a ball over the floor | the person is "
        "bowling"),
    "shake_hands": (
        shake_hands, 3.2, ARM,
        "shake hands | shake hands with someone | give a handshake | a person shakes hands | a person shakes hands "
        "with someone with the right hand | someone shakes a hand | the person is shaking hands | greet someone with a "
        "handshake"),
    "cheer": (
        cheer, 3.8, ARMS,
        "cheer | celebrate | celebrate a victory | raise the fists and cheer | a person cheers | a person cheers with "
        "both fists in the air | someone celebrates | the person is cheering | rejoice | pump both fists in the air"),
    "laugh": (
        laugh, 3.8, "left arm,right arm,spine,head",
        "laugh | laugh out loud | laugh and hold the belly | a person laughs | someone laughs hard | the person is "
        "laughing | laughing"),
    "wipe_the_eyes": (
        wipe_eyes, 3.6, ARMS,
        "wipe the eyes | rub the eyes | wipe the tears from the eyes | a person cries | someone rubs the eyes with "
        "both hands | the person is crying | weep | a person wipes away tears"),
    "cough": (
        cough, 3.4, "right arm,spine",
        "cough | cough into the hand | a person coughs | someone coughs into the right hand | the person is coughing | "
        "coughing | cough with the hand before the mouth"),
    "sneeze": (
        sneeze, 3.0, "right arm,spine,head",
        "sneeze | sneeze into the hand | a person sneezes | someone sneezes into the right hand | the person is "
        "sneezing | sneezing"),
    "rub_the_belly": (
        rub_belly, 3.6, ARM,
        "rub the belly | rub the stomach | pat the belly | a person rubs the belly | someone rubs the stomach with the "
        "right hand | the person is rubbing the belly | stroke the tummy"),
    "tie_the_shoes": (
        tie_shoes, 4.4, "left arm,right arm,legs,spine",
        "tie the shoes | lace the shoes | tie your shoelaces | tie a shoe | a person ties the shoes | someone kneels "
        "down and ties a shoelace | the person is tying the laces | kneel and lace the shoe"),
}

ACTING_HELD = {"raise_the_arms_to_the_side", "lift_something_heavy"}  # gestures whose last pose may be held
