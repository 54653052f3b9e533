"""Refusals raised by the Python part, with the same attributes as those of the compiled part."""

from ._core import Refused


def refused(text):
    """A Refused of "where: what is wrong and what would be right (code)"."""
    error = Refused(text)
    error.where, rest = text.split(": ", 1)
    error.code = rest[rest.rindex("(") + 1:-1]
    return error
