"""Pictures of bodies and answers, by the project's own renderer (off screen, no display needed)."""

from __future__ import annotations

import json
import os
import tempfile

import numpy as np

from ._errors import file_name, real_number, refused, whole_number
from ._shapes import pose_fields, shape_fields


def _compiled():
    try:
        from . import _picture
    except ImportError as error:
        raise refused(f"picture: this build cannot draw ({error}); it needs the renderer's packages (unsupported)") from error
    return _picture


def picture(a, b=None, pose_a=None, pose_b=None, *, size=(960, 540), azimuth=-58.0, elevation=20.0, difference=False):
    """Draws one body, or two with what parts them, as [height, width, 3] uint8 (sRGB).

    A is blue, B amber. The arrow is the translation that frees A, its label the depth and its certified bracket.

    azimuth, elevation: the view, in degrees.
    difference: True draws the Minkowski difference P = B + (-A) beside two polytopes.

    Raises Refused 'unsupported' where OSMesa (Debian: libosmesa6) or the renderer is missing.
    """
    if b is None and difference:
        raise refused("b: a difference needs two bodies (missing_field)")
    line = {"a": shape_fields(a, "a"), "pose_a": pose_fields(pose_a, "pose_a")}
    if b is not None:
        line.update(b=shape_fields(b, "b"), pose_b=pose_fields(pose_b, "pose_b"))
    if not isinstance(size, (tuple, list, np.ndarray)) or len(size) != 2:
        raise refused(f"size: must be (width, height), not {size!r} (bad_value)")
    pixels = [whole_number(each, "size", 16, 8192) for each in size]
    view = real_number(azimuth, "azimuth"), real_number(elevation, "elevation")
    return _compiled().picture(json.dumps(line), *pixels, *view, bool(difference))


def save_picture(path, rgb):
    """Writes a picture as a PNG: rgb is [height, width, 3] uint8, and the file's name ends in .png."""
    shape, dtype = getattr(rgb, "shape", ()), getattr(rgb, "dtype", None)
    if len(shape) != 3 or shape[2] != 3 or dtype != np.uint8:
        raise refused(f"rgb: has shape {shape} and dtype {dtype}, needs [height, width, 3] uint8 (bad_value)")
    if 0 in shape:
        raise refused(f"rgb: has no pixels: its shape is {shape} (bad_value)")
    name = file_name(path)
    if not name.lower().endswith(b".png"):
        raise refused(f"path: {path!r}: pictures are written as PNG: name it *.png (bad_value)")
    _compiled().write_png(rgb, name)


def png(rgb):
    """A picture as the bytes of a PNG."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "picture.png")
        save_picture(path, rgb)
        with open(path, "rb") as file:
            return file.read()
