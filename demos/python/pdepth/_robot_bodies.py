"""Collision shapes of links: one shape and its place in the link's frame, and a ball around the two."""

from __future__ import annotations

import numpy as np

from ._core import Pose
from ._shapes import Box, Capsule, Compound, Cone, Cylinder, Ellipsoid, Sphere

_IDENTITY = np.eye(4)


def body_of(link):
    """A link's shape and place; None for a link without a shape. One convex shape stays itself, wherever it stands."""
    if not link.parts:
        return None
    if len(link.parts) == 1:
        return link.parts[0]
    return Compound([(shape, Pose(place)) for shape, place in link.parts]), _IDENTITY


def one_shape(body):
    """The body as one shape in the link's frame."""
    if body is None:
        return None
    shape, place = body
    return shape if (place == _IDENTITY).all() else Compound([(shape, Pose(place))])


def ball_of(body):
    """Centre, in the link's frame, and radius of a ball that holds the body."""
    shape, place = body
    centre, radius = _ball(shape)
    # Far more than the rounding of what follows.
    return place[:3, :3] @ centre + place[:3, 3], (1 + 1e-9) * radius + 1e-12 * np.abs(place[:3, 3]).max()


def _ball(shape):
    if isinstance(shape, Compound):
        balls = []
        for part, pose in shape._arguments["parts"]:
            centre, radius = _ball(part)
            balls.append((pose.rotation @ centre + pose.translation, radius))
        centre = (np.min([c - r for c, r in balls], axis=0) + np.max([c + r for c, r in balls], axis=0)) / 2
        return centre, max(np.linalg.norm(c - centre) + r for c, r in balls) + shape.margin
    centre, arguments = np.zeros(3), shape._arguments
    if isinstance(shape, Box):
        radius = np.linalg.norm(arguments["half_extents"])
    elif isinstance(shape, Sphere):
        radius = arguments["radius"]
    elif isinstance(shape, Capsule):
        radius = arguments["radius"] + arguments["half_height"]
    elif isinstance(shape, (Cylinder, Cone)):
        radius = np.hypot(arguments["radius"], arguments["half_height"])
    elif isinstance(shape, Ellipsoid):
        radius = max(arguments["radii"])
    else:
        vertices = shape.vertices
        centre = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
        radius = np.linalg.norm(vertices - centre, axis=1).max()
    return centre, radius + shape.margin
