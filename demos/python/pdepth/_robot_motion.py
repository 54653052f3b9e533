"""Motions of joints for many joint vectors at once, and the velocities that each coordinate gives.

Products are written out, so that their bits depend on no library for matrices.
"""

from __future__ import annotations

import numpy as np

#: Lengths beyond the largest double become infinite, and the pairs that they place are refused as rows.
QUIET = {"over": "ignore", "invalid": "ignore"}


def compose(a, b):
    """The product of poses [..., 4, 4]."""
    a, b = np.broadcast_arrays(a, b)
    product = np.zeros(a.shape)
    rotation, moved = a[..., :3, :3], a[..., :3, 3].copy()
    for k in range(3):
        product[..., :3, :3] += rotation[..., :, k, None] * b[..., k, None, :3]
        moved += rotation[..., :, k] * b[..., k, None, 3]
    product[..., :3, 3] = moved
    product[..., 3, 3] = 1
    return product


def turned(rotation, vector):
    """rotation [..., 3, 3] times vector [..., 3]."""
    return sum(rotation[..., :, k] * vector[..., k, None] for k in range(3))


def dot(a, b):
    return a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1] + a[..., 2] * b[..., 2]


def cross(a, b):
    a, b = np.broadcast_arrays(a, b)
    return np.stack([a[..., 1] * b[..., 2] - a[..., 2] * b[..., 1], a[..., 2] * b[..., 0] - a[..., 0] * b[..., 2],
                     a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]], axis=-1)


def _skew(w):
    matrix = np.zeros((*w.shape, 3))
    matrix[..., 2, 1], matrix[..., 0, 2], matrix[..., 1, 0] = w[..., 0], w[..., 1], w[..., 2]
    return matrix - np.swapaxes(matrix, -1, -2)


def _series(w, first, second):
    """The unit matrix + first [w]x + second [w]x^2, by the factors of each vector."""
    skew = _skew(w)
    square = w[..., :, None] * w[..., None, :] - dot(w, w)[..., None, None] * np.eye(3)
    return np.eye(3) + first[..., None, None] * skew + second[..., None, None] * square


def _rotation(w):
    """The rotation of each rotation vector [n, 3]."""
    angle = np.sqrt(dot(w, w))
    return _series(w, np.sinc(angle / np.pi), 0.5 * np.sinc(angle / (2 * np.pi)) ** 2)


def _rotation_rates(w):
    """[n, 3, 3]: column k is the angular velocity where coordinate k of the rotation vector grows at rate one."""
    angle = np.sqrt(dot(w, w))
    small = angle < 0.1
    square = np.where(small, angle, 0) ** 2  # the quotient loses its digits there, and the series has a last term of 1e-16
    series = 1 / 6 - square * (1 / 120 - square * (1 / 5040 - square / 362880))
    large = np.where(small, 1, angle)
    third = np.where(small, series, (large - np.sin(large)) / large ** 3)
    return _series(w, 0.5 * np.sinc(angle / (2 * np.pi)) ** 2, third)


def _plane(axis):
    """Two directions across the axis: x and y turned by the shortest way that takes z to the axis."""
    x, y, z = axis
    if z <= -1:
        return np.array([1.0, 0, 0]), np.array([0, -1.0, 0])
    return (np.array([1 - x * x / (1 + z), -x * y / (1 + z), -x]), np.array([-x * y / (1 + z), 1 - y * y / (1 + z), -y]))


def _split(joint, values):
    """Place [n, 3] and rotation vector [n, 3] of a joint's motion, which moves first and turns then."""
    count, zero = len(values), np.zeros((len(values), 3))
    if joint.kind in ("revolute", "continuous"):
        return zero, values * joint.axis
    if joint.kind == "prismatic":
        return values * joint.axis, zero
    if joint.kind == "planar":
        u, v = _plane(joint.axis)
        return values[:, :1] * u + values[:, 1:2] * v, values[:, 2:] * joint.axis
    if joint.kind == "ball":
        return zero, values
    if joint.kind == "floating":
        return values[:, :3], values[:, 3:]
    return np.zeros((count, 3)), zero


def motion(joint, values):
    """The motions of a joint for its coordinates [n, k]: [n, 4, 4]."""
    place, vector = _split(joint, values)
    moved = np.tile(np.eye(4), (len(values), 1, 1))
    moved[:, :3, :3], moved[:, :3, 3] = _rotation(vector), place
    return moved


def velocities(joint, values, base):
    """For each coordinate of a joint: angular velocity, velocity, and the point that has this velocity, all [n, 3].

    base: the joint's frame before its motion, [n, 4, 4].
    """
    rotation, place = base[:, :3, :3], base[:, :3, 3]
    shift, vector = _split(joint, values)
    centre, zero = place + turned(rotation, shift), np.zeros((len(values), 3))
    turn = turned(rotation, np.broadcast_to(joint.axis, zero.shape))
    if joint.kind in ("revolute", "continuous"):
        return [(turn, zero, centre)]
    if joint.kind == "prismatic":
        return [(zero, turn, centre)]
    if joint.kind == "planar":
        return [(zero, turned(rotation, np.broadcast_to(each, zero.shape)), centre) for each in _plane(joint.axis)] + [
            (turn, zero, centre)]
    shifts = [(zero, rotation[:, :, k], centre) for k in range(3)] if joint.kind == "floating" else []
    rates = _rotation_rates(vector)
    return shifts + [(turned(rotation, rates[:, :, k]), zero, centre) for k in range(3)]
