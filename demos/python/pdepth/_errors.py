"""Refusals raised by the Python part, with the same attributes as those of the compiled part, and arguments read by name."""

import operator
import os

import numpy as np

from ._core import Refused


def refused(text):
    """A Refused of "where: what is wrong and what would be right (code)"."""
    error = Refused(text)
    error.where, rest = text.split(": ", 1)
    error.code = rest[rest.rindex("(") + 1:-1]
    return error


def whole_number(value, argument, least, most=None):
    """An integer of any kind, numpy's among them."""
    try:
        number = None if isinstance(value, bool) else operator.index(value)
    except TypeError:
        number = None
    if number is None or number < least or most is not None and number > most:
        told = f"from {least}" if most is None else f"from {least} to {most}"
        raise refused(f"{argument}: must be an integer {told}, not {value!r} (bad_value)")
    return number


def real_number(value, argument):
    """A finite number of any kind, numpy's among them; words are none."""
    try:
        number = np.nan if isinstance(value, (str, bytes, bool)) else float(value)
    except (TypeError, ValueError, OverflowError):
        number = np.nan
    if not np.isfinite(number):
        raise refused(f"{argument}: must be a finite number, not {value!r} (bad_value)")
    return number


def length(value, argument):
    """A finite length, 0 among them."""
    number = real_number(value, argument)
    if number < 0:
        raise refused(f"{argument}: must be a length >= 0, not {value!r} (bad_value)")
    return number


def file_name(path, argument="path"):
    """A file's name as the bytes that the system takes."""
    name = os.fsencode(path)
    if b"\0" in name:
        raise refused(f"{argument}: {path!r}: a file's name holds no zero byte (bad_value)")
    return name


def number_array(value, argument, needs):
    """Numbers as an array. needs: the shape that would be right, in words."""
    try:
        array = np.asarray(value)
    except ValueError:
        raise refused(f"{argument}: rows of different lengths; give {needs} (bad_value)") from None
    if array.dtype.kind not in "fiu" or array.dtype.itemsize > 8:
        raise refused(f"{argument}: dtype {array.dtype} is not taken; give float64 (bad_value)")
    return array
