"""Exact and certified penetration depth of convex bodies, and of unions of them.

    import pdepth
    die = pdepth.Box([1, 1, 1])
    ball = pdepth.Sphere(1.0)
    found = pdepth.depth(die, ball, pose_b=pdepth.Pose(translation=[1.5, 0, 0]))
    found.depth, found.translation        # 0.5 [-0.5 0. 0.]: A moves, B stays

Lengths are in the unit of the input, points and directions in the frame that the two poses share. Bad input raises
pdepth.Refused, a ValueError that says which argument, which index, and what would be right.
"""

from . import record
from ._core import ERRORS, Depth, Pose, Refused, Warm
from ._line_batches import RowBatch
from ._lines import Answer, audit, hull, minkowski_difference, polygon_depth, query, query_many, time_of_impact, width
from ._picture_call import picture, save_picture
from ._queries import (CONTACTS, FEATURES, Batch, Derivatives, DirectionalDepth, Manifold, contact_manifold, cores, depth,
                       derivatives, directional_depth, distance, intersects)
from ._robot import Robot
from ._robot_distances import RobotDistances
from ._shapes import (Box, Capsule, Compound, Cone, ConvexPolytope, Cylinder, Ellipsoid, Shape, Sheet, Sphere, SphereHull,
                      StarBody)
from ._sweep import Sweep, sweep

__version__ = "0.1.0"

# Named, so that help(pdepth) shows them all.
__all__ = [
    "Answer", "Batch", "Box", "CONTACTS", "Capsule", "Compound", "Cone", "ConvexPolytope", "Cylinder", "Depth",
    "Derivatives", "DirectionalDepth", "ERRORS", "Ellipsoid", "FEATURES", "Manifold", "Pose", "Refused", "Robot",
    "RobotDistances", "RowBatch", "Shape", "Sheet", "Sphere", "SphereHull", "StarBody", "Sweep", "Warm", "audit",
    "contact_manifold", "cores", "depth", "derivatives", "directional_depth", "distance", "hull", "intersects",
    "minkowski_difference", "picture", "polygon_depth", "query", "query_many", "save_picture", "sweep", "time_of_impact",
    "width",
]
