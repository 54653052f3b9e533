"""The queries that the line protocol answers, called in this process: same code as the command `pdepth query`."""

from __future__ import annotations

import json
import os
import tempfile

import numpy as np

from ._core import Pose, Refused, Shape
from ._errors import refused
from ._queries import Fields, cores
from ._shapes import _plain, pose_fields

#: Fields that hold lists of unequal lengths, or of words: they stay lists.
_RAGGED = {"facets", "facet_kinds", "classes", "levels", "size_classes", "indices_of_parts", "slots", "feature", "stats"}


class Answer(Fields):
    """An answer of the line protocol: its fields as attributes, lists of numbers as arrays."""


def _value(name, value):
    if name not in _RAGGED and isinstance(value, list) and value and isinstance(value[0], (int, float, list, bool)):
        try:
            return np.asarray(value)
        except ValueError:
            return value
    return value


def _field(name, value):
    if isinstance(value, Shape):
        return value.protocol()
    if isinstance(value, Pose) or name.startswith("pose_"):
        return pose_fields(value, name)
    if isinstance(value, dict):
        return {key: _field(key, each) for key, each in value.items()}
    if isinstance(value, (list, tuple)) and value and isinstance(value[0], dict):
        return [_field(name, each) for each in value]
    return _plain(value)


def query(name, **fields):
    """Any query of the line protocol by its name; fields are its keys, shapes and poses may be objects.

        pdepth.query("hull", a=pdepth.Box([1, 1, 1])).facets

    Raises Refused with the protocol's code and path.
    """
    from . import _protocol

    line = {"query": name, **{key: _field(key, value) for key, value in fields.items() if value is not None}}
    try:
        text = json.dumps(line, allow_nan=False)
    except ValueError:
        raise refused(f"{name}: a number is not finite; give finite ones (non_finite)") from None
    answer = json.loads(_protocol.answer(text))
    if "error" in answer:
        error = answer["error"]
        raise refused(f"{error.get('where') or name}: {error['message']} ({error['code']})")
    answer.pop("id", None)
    return Answer({key: _value(key, value) for key, value in answer.items()})


def width(a, pose_a=None, *, method=None, delta=None):
    """The least distance of two parallel planes that hold the body between them: width, lower, upper, normal."""
    if pose_a is not None:
        return query("width", a=a, pose_a=pose_a, method=method, delta=delta)
    return query("width", a=a, method=method, delta=delta)


def minkowski_difference(a, b, pose_a=None, pose_b=None):
    """P = B + (-A), built: vertices [n, 3], facets (loops of rows of vertices), facet_kinds, K."""
    return query("minkowski_difference", a=a, b=b, pose_a=pose_a, pose_b=pose_b)


def hull(a, pose_a=None):
    """The posed hull: vertices [n, 3], vertex_ids, facets (loops of rows of vertices), affine_dim."""
    return query("hull", a=a, pose_a=pose_a)


def time_of_impact(a, b, pose_a=None, pose_b=None, *, velocity_a=None, angular_velocity_a=None, velocity_b=None,
                   angular_velocity_b=None, duration=1.0, tolerance=None):
    """The first contact of two moving bodies within duration: hit, time, certified, and depth's fields at that time.

    Velocities in units of length and radians per unit of time, about each body's own origin, constant.
    """
    return query("time_of_impact", a=a, b=b, pose_a=pose_a, pose_b=pose_b, velocity_a=velocity_a,
                 angular_velocity_a=angular_velocity_a, velocity_b=velocity_b, angular_velocity_b=angular_velocity_b,
                 duration=duration, tolerance=tolerance)


def polygon_depth(p, q, **options):
    """Depth of two polygons in the plane; q moves. p, q: [n, 2] outlines, or {"outer": ..., "holes": [...]}.

    options: direction, complete, direction_set, placements, slots, method: see the protocol's planar queries.
    """
    def polygon(value):
        return value if isinstance(value, dict) else {"outer": value}

    return query("polygon_depth", p=polygon(p), q=polygon(q), **options)


def audit(records, *, tolerance=None, worst=5, fail_on=None, threads=None):
    """Judges contact records (the protocol's "Contact records") against the exact answer.

    records: a path, or an iterable of lines: dictionaries, JSON texts; shapes and poses may be pdepth objects.
    Answers the judge's JSON as an object (contacts, judged, missed, phantom, depth_error, ..., worst), with `table` for
    people. fail_on: e.g. "missed=0,phantom=0,depth_error=1e-4"; then `fail_on` says which hold and `ok` whether all do.
    Raises Refused at the first line that cannot be read.
    """
    from . import _protocol

    if isinstance(records, (str, os.PathLike)):
        return _audit_file(_protocol, os.fspath(records), tolerance, worst, fail_on, threads)
    with tempfile.NamedTemporaryFile("w", suffix=".jsonl") as file:
        for i, record in enumerate(records):
            try:
                text = record if isinstance(record, str) else json.dumps(_record(record), allow_nan=False)
            except ValueError:
                raise refused(f"records[{i}]: a number is not finite; give finite ones (non_finite)") from None
            file.write(text.rstrip("\n") + "\n")
        file.flush()
        return _audit_file(_protocol, file.name, tolerance, worst, fail_on, threads)


def _record(record):
    return {key: _field(key, value) for key, value in record.items()}


def _audit_file(compiled, path, tolerance, worst, fail_on, threads):
    text, table, refusals = compiled.audit(path, tolerance or 0.0, threads or cores(), worst, fail_on or "")
    if refusals:
        line, code, message, where = refusals[0]
        raise refused(f"records[{line - 1}]{'.' + where if where else ''}: {message} ({code})")
    answer = Answer(json.loads(text))
    answer.table = table
    answer.ok = all(each.get("holds", True) for each in answer.fail_on)
    return answer
