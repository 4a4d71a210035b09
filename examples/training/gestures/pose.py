# SPDX-License-Identifier: MIT
"""A frame of a motion whose joints a gesture turns, and curves over time."""
import numpy as np

FPS = 20
LEG = 0.40  # thigh and shank, each
GRAVITY = 9.81
HIP, KNEE, ANKLE, SPINE = (1, 2), (4, 5), (7, 8), (3, 6, 9)
NECK, COLLAR, HEAD, SHOULDER, ELBOW = 12, (13, 14), 15, (16, 17), (18, 19)
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
    """Local rotations of one frame and the place of the pelvis (z up), changed by a gesture."""

    def __init__(self, rows, place):
        self.local = [from_vector(v) for v in rows]
        self.place = place

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

    def trunk(self, left=0.0, ahead=0.0, tilt=0.0):
        """Turns the chest to the left, bends it ahead and to the right, by degrees in all."""
        for joint in SPINE:
            self.turn(joint, X, ahead / 3)
            self.turn(joint, Z, tilt / 3)
            self.turn(joint, Y, left / 3)

    def fold(self, side, degrees):
        """Bends a leg, so that the foot comes up under the hip and stays flat."""
        self.turn(HIP[side], X, -degrees)
        self.turn(KNEE[side], X, 2 * degrees)
        self.turn(ANKLE[side], X, -degrees)

    def rise(self, height):
        self.place[2] += height

    def crouch(self, degrees):
        """Bends both legs over feet that stay where they are."""
        for side in (LEFT, RIGHT):
            self.fold(side, degrees)
        self.rise(-2 * LEG * (1 - np.cos(np.radians(degrees))))

    def left(self):
        """The direction over the floor."""
        return unit((self.local[0] @ X)[:2])

    def hinge(self, degrees):
        """Leans the figure ahead from the hips; the legs stay as they are."""
        self.local[0] = rotation(np.append(self.left(), 0), np.radians(degrees)) @ self.local[0]
        for side in (LEFT, RIGHT):
            self.turn(HIP[side], X, -degrees)

    def ahead(self):
        """The same of its heading."""
        x, y = self.left()
        return np.array([y, -x])

    def yaw(self, degrees):
        """Turns the whole figure to the left."""
        self.local[0] = rotation(Z, np.radians(degrees)) @ self.local[0]

    def rows(self):
        return np.array([to_vector(m) for m in self.local])
