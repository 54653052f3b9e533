"""The queries that the line protocol answers, called in this process: same code as the command `pdepth query`."""

from __future__ import annotations

import json
import os
import tempfile

import numpy as np

from ._core import ERRORS, Pose, Refused, Shape, Sheet
from ._errors import file_name, number_array, real_number, refused, whole_number
from ._line_batches import ask_lines, ask_rows, bodies, rows_of, spread
from ._queries import Fields, _is_batch, _threads
from ._shapes import _plain, pose_fields

#: Fields that hold lists of unequal lengths, or of words: they stay lists.
_RAGGED = {"facets", "facet_kinds", "classes", "levels", "size_classes", "indices_of_parts", "slots", "seat_points",
           "feature", "stats"}

#: Fields that place a body.
_POSES = {"pose", "pose_a", "pose_b"}


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
    if isinstance(value, Sheet):
        raise refused(f"{name}: contact_manifold alone takes a Sheet; a line names a mesh by its file (unsupported)")
    if isinstance(value, Pose) or (name in _POSES and not isinstance(value, dict)):
        return pose_fields(value, name)
    if isinstance(value, dict):  # the protocol's own form, of a pose, too
        return {key: _field(key, each) for key, each in value.items()}
    if isinstance(value, (list, tuple)) and value and isinstance(value[0], dict):
        return [_field(name, each) for each in value]
    return _plain(value)


def _fault(value, path):
    """Names the place and the fault of the first value that is no JSON, or answers None."""
    if isinstance(value, dict):
        inner = ((f"{path}.{key}" if path else key, each) for key, each in value.items())
    elif isinstance(value, list):
        inner = ((f"{path}[{i}]", each) for i, each in enumerate(value))
    elif value is None or isinstance(value, (str, bool, int)):
        return None
    elif isinstance(value, float):
        return None if np.isfinite(value) else f"{path}: must be finite (non_finite)"
    else:
        told = f"takes numbers, words, lists, dictionaries, shapes and poses, not a {type(value).__name__}"
        return f"{path}: {told} (bad_value)"
    return next(filter(None, (_fault(each, key) for key, each in inner)), None)


def _text(line, path=""):
    """A line of JSON. Raises Refused with the place of what is none."""
    try:
        return json.dumps(line, allow_nan=False)
    except (TypeError, ValueError):
        raise refused(_fault(line, path) or f"{path or 'query'}: a name of a field must be a word (bad_value)") from None


def query(name, **fields):
    """Any query of the line protocol by its name; fields are its keys, shapes and poses may be objects.

        pdepth.query("hull", a=pdepth.Box([1, 1, 1])).facets

    Raises Refused with the protocol's code and path.
    """
    from . import _protocol

    line = {"query": name, **{key: _field(key, value) for key, value in fields.items() if value is not None}}
    answer = json.loads(_protocol.answer(_text(line)))
    if "error" in answer:
        error = answer["error"]
        raise refused(f"{error.get('where') or name}: {error['message']} ({error['code']})")
    answer.pop("id", None)
    return Answer({key: _value(key, value) for key, value in answer.items()})


_MEETING = {"class": "separated", "depth": 0.0, "lower": 0.0, "upper": 0.0, "distance": 0.0, "distance_lower": 0.0,
            "distance_upper": 0.0, "translation": [0.0] * 3, "normal": [0.0] * 3, "witness_a": [0.0] * 3, "witness_b": [0.0] * 3}
_WIDTH = {"width": 0.0, "lower": 0.0, "upper": 0.0, "normal": [0.0] * 3}
_SUM = {"vertices": [[0.0] * 3], "facets": [[0]], "K": 0, "facet_kinds": [""]}
_HULL = {"vertices": [[0.0] * 3], "vertex_ids": [0], "facets": [[0]], "affine_dim": 0}
_IMPACT = {"hit": False, "time": 0.0, "certified": 0.0, **_MEETING}
_PLANAR = {"class": "separated", "depth": 0.0, "lower": 0.0, "upper": 0.0, "translation": [0.0] * 2, "normal": [0.0] * 2,
           "seat": False}
#: Answers by the query's name, so that a batch has its columns even if every row is refused.
_LIKE = {"depth": _MEETING, "width": _WIDTH, "minkowski_difference": _SUM, "hull": _HULL, "time_of_impact": _IMPACT}


def query_many(name, rows, *, threads=None):
    """Many questions of one query of the line protocol: a RowBatch, answered on `threads` cores (all of them by default)
    with the interpreter's lock released.

        pdepth.query_many("approx_width", [{"a": {"points": p}, "epsilon": 0.1} for p in clouds]).width

    rows: dictionaries of the query's fields; shapes and poses may be objects.

    A refusal of a row's bodies is that row's `error`, an index into pdepth.ERRORS. A row that is no such question raises
    Refused. `stats` and features are left out.
    """
    return ask_lines([_row_line(name, row, f"rows[{i}]") for i, row in enumerate(rows)], threads, _LIKE.get(name))


def _row_line(name, row, path):
    """A row's line, or an index into ERRORS for a row with a number that is not finite."""
    if not isinstance(row, dict):
        raise refused(f"{path}: must be a dictionary of the query's fields, not a {type(row).__name__} (bad_value)")
    line = {"query": name, **{key: _field(key, value) for key, value in row.items() if value is not None}}
    try:
        return _text(line, path)
    except Refused as error:
        if error.code != "non_finite":
            raise
        return ERRORS.index("non_finite")


def _options(parts, count, options):
    for key, value in options.items():
        if value is not None:
            parts[key] = [_text(_plain(value), key)] * count
    return parts


def width(a, pose_a=None, *, method=None, delta=None, threads=None):
    """The least distance of two parallel planes that hold the body between them: width, lower, upper, normal.

    A list of shapes, or poses [n, 4, 4], answer a RowBatch.
    """
    if _is_batch(a, a, pose_a, None):
        parts, count = bodies(a, None, pose_a, None)
        return ask_rows("width", _options(parts, count, {"method": method, "delta": delta}), count, threads, _WIDTH)
    return query("width", a=a, pose_a=pose_a, method=method, delta=delta)


def minkowski_difference(a, b, pose_a=None, pose_b=None, *, threads=None):
    """P = B + (-A), built: vertices [n, 3], facets (loops of rows of vertices), facet_kinds, K.

    Lists of shapes, or poses [n, 4, 4], answer a RowBatch: arrays of all rows with offsets; rows of vertices in facets
    are those of the row's own.
    """
    if _is_batch(a, b, pose_a, pose_b):
        return ask_rows("minkowski_difference", *bodies(a, b, pose_a, pose_b), threads, _SUM)
    return query("minkowski_difference", a=a, b=b, pose_a=pose_a, pose_b=pose_b)


def hull(a, pose_a=None, *, threads=None):
    """The posed hull: vertices [n, 3], vertex_ids, facets (loops of rows of vertices), affine_dim.

    A list of shapes, or poses [n, 4, 4], answer a RowBatch: arrays of all rows with offsets.
    """
    if _is_batch(a, a, pose_a, None):
        return ask_rows("hull", *bodies(a, None, pose_a, None), threads, _HULL)
    return query("hull", a=a, pose_a=pose_a)


def time_of_impact(a, b, pose_a=None, pose_b=None, *, velocity_a=None, angular_velocity_a=None, velocity_b=None,
                   angular_velocity_b=None, duration=1.0, tolerance=None, threads=None):
    """The first contact of two moving bodies within duration: hit, time, certified, and depth's fields at that time.

    Velocities in units of length and radians per unit of time, about each body's own origin, constant. Lists of shapes,
    or poses [n, 4, 4], answer a RowBatch; velocities are then [3] or [n, 3], duration and tolerance numbers or [n].
    """
    vectors = {"velocity_a": velocity_a, "angular_velocity_a": angular_velocity_a, "velocity_b": velocity_b,
               "angular_velocity_b": angular_velocity_b}
    if not _is_batch(a, b, pose_a, pose_b):
        return query("time_of_impact", a=a, b=b, pose_a=pose_a, pose_b=pose_b, **vectors, duration=duration,
                     tolerance=tolerance)
    parts, count = bodies(a, b, pose_a, pose_b)
    for name, value, size in [*((*each, 3) for each in vectors.items()), ("duration", duration, 0), ("tolerance", tolerance, 0)]:
        if value is not None:
            parts[name] = rows_of(value, count, size, name)
    return ask_rows("time_of_impact", parts, count, threads, _IMPACT)


def _depth(value):
    """How many lists deep a value's first numbers lie."""
    return np.ndim(value) if isinstance(value, np.ndarray) else 1 + _depth(value[0]) if isinstance(value, (list, tuple)) and value else 0


def polygon_depth(p, q, *, threads=None, **options):
    """Depth of two polygons in the plane; q moves. p, q: [n, 2] outlines, or {"outer": ..., "holes": [...], "margin": r}.

    A disc of the radius "margin" sweeps the polygon; an outline of one point with a margin is a disc.

    options: direction, complete, direction_set, placements, slots, method: see the protocol's planar queries. `seat` says
    that q fits exactly; slots=True lists all such places. Lists of polygons (one for all, or one a row) answer a RowBatch;
    the options then hold for every row.
    """
    def listed(value):
        if isinstance(value, (list, tuple)) and value:
            return isinstance(value[0], dict) or _depth(value[0]) == 2
        return isinstance(value, np.ndarray) and value.ndim == 3 and len(value) > 0

    def polygon(value, name):
        if isinstance(value, dict):
            return value
        outline = number_array(value, name, "[n, 2]")
        if outline.ndim == 2 and outline.shape[0] == 2 < outline.shape[1]:
            raise refused(f"{name}: has shape {outline.shape}, needs [n, 2]; it looks transposed: pass its .T (bad_value)")
        return {"outer": value}

    if not (listed(p) or listed(q)):
        return query("polygon_depth", p=polygon(p, "p"), q=polygon(q, "q"), **options)
    sides = [list(each) if listed(each) else [each] for each in (p, q)]
    count = max(len(each) for each in sides)
    if any(len(each) not in (1, count) for each in sides):
        raise refused(f"polygons: as many of each, or one for all; got {len(sides[0])} and {len(sides[1])} (bad_value)")
    rows = enumerate(zip(*(spread(each, count) for each in sides)))
    lines = [_row_line("polygon_depth", {"p": polygon(one, f"p[{i}]"), "q": polygon(other, f"q[{i}]"), **options}, f"rows[{i}]")
             for i, (one, other) in rows]
    plain = not {"direction", "direction_set", "placements", "slots", "complete"} & options.keys()
    return ask_lines(lines, threads, _PLANAR if plain else None)


def audit(records, *, tolerance=None, worst=5, fail_on=None, threads=None):
    """Judges contact records (the protocol's "Contact records") against the exact answer.

    records: a path, or an iterable of lines: dictionaries, JSON texts; shapes and poses may be pdepth objects.
    fail_on: conditions such as "missed=0,phantom=0,depth_error=1e-4". The answer's `fail_on` then says which of them hold,
    and `ok` is True where all do.

    Answers the judge's JSON as an object (contacts, judged, missed, phantom, depth_error, ..., worst), with `table` for
    people.
    Raises Refused at the first line that cannot be read.
    """
    from . import _protocol

    if not isinstance(records, (str, os.PathLike)) and not hasattr(records, "__iter__"):
        raise TypeError(f"records: must be a path or an iterable of lines, not {type(records).__name__}")
    if tolerance is not None and not 1e-15 <= real_number(tolerance, "tolerance") <= 1:
        raise refused(f"tolerance: must lie in [1e-15, 1], not {tolerance!r} (bad_value)")
    if not isinstance(fail_on, (str, type(None))):
        raise refused(f"fail_on: must be a word such as 'missed=0,depth_error=1e-4', not {fail_on!r} (bad_value)")
    how = (0.0 if tolerance is None else float(tolerance), _threads(threads), whole_number(worst, "worst", 0, 1 << 20),
           fail_on or "")
    if isinstance(records, (str, os.PathLike)):
        return _judged(_protocol.audit(file_name(records, "records"), *how))
    with tempfile.NamedTemporaryFile("w", suffix=".jsonl") as file:
        for i, record in enumerate(records):
            text = record if isinstance(record, str) else _text(_record(record, i), f"records[{i}]")
            file.write(text.rstrip("\n") + "\n")
        file.flush()
        text, table, refusals = _protocol.audit(file_name(file.name), *how)
        return _judged((text, table.replace(file.name, "records", 1), refusals))


def _record(record, i):
    if not isinstance(record, dict):
        raise TypeError(f"records[{i}]: must be a dictionary or a line of JSON, not {type(record).__name__}")
    return {key: _field(key, value) for key, value in record.items()}


def _judged(found):
    text, table, refusals = found
    if refusals:
        line, code, message, where = refusals[0]
        raise refused(f"records[{line - 1}]{'.' + where if where else ''}: {message} ({code})")
    answer = Answer(json.loads(text))
    answer.table = table
    answer.ok = all(each.get("holds", True) for each in answer.fail_on)
    return answer
