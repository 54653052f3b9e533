"""Many questions of the line protocol at once: a struct of arrays, with offsets where a row's answer has no fixed size."""

from __future__ import annotations

import json

import numpy as np

from ._core import ERRORS
from ._errors import number_array, refused
from ._queries import CONTACTS, Batch, _rows, _threads
from ._shapes import pose_fields, shape_fields

#: Fields that are one vector a row: columns of [n, d]. Every other list is joined, with offsets.
_VECTORS = {"normal", "translation", "witness_a", "witness_b", "direction", "point"}
_CODES = {name: index for index, name in enumerate(ERRORS)}


class RowBatch(Batch):
    """Answers of many questions, one row each, in the order asked (of poses with more dimensions: C order).

    Numbers are columns [n] and vectors [n, d]. They are NaN (or 0, False, "") where the row was refused. `contact` is an
    index into pdepth.CONTACTS.

    A list without a fixed size, such as `vertices`, is one array of the items of all rows. Row i has the items from
    vertices_offsets[i] to vertices_offsets[i + 1]. A list of lists, such as `facets`, is an array of all numbers:
    facets_loops says where each list begins, and facets_offsets which lists belong to row i. `of_row` cuts a row out.
    """

    def __init__(self, fields):
        for name, column in fields.items():
            setattr(self, name, column)
        self._names = tuple(fields)

    def of_row(self, i):
        """One row as a dictionary: numbers, arrays, lists of lists."""
        row = {}
        for name in self._names:
            if name.endswith(("_offsets", "_loops")):
                continue
            if f"{name}_offsets" not in self._names:
                row[name] = self[name][i]
                continue
            row_of = range(len(self))[i]
            begin, end = self[f"{name}_offsets"][row_of:row_of + 2]
            if f"{name}_loops" in self._names:
                loops = self[f"{name}_loops"]
                row[name] = [self[name][loops[k]:loops[k + 1]].tolist() for k in range(begin, end)]
            else:
                row[name] = self[name][begin:end]
        return row

    def __repr__(self):
        failed = int(np.count_nonzero(self.error))
        return f"<RowBatch of {self.error.size} rows{f', {failed} refused' if failed else ''}: {', '.join(self._names)}>"


def _offsets(lists):
    return np.concatenate([[0], np.cumsum([len(each) for each in lists], dtype=np.int64)]).astype(np.int64)


def _joined(name, lists, like):
    """Lists of numbers, words, or equal lists as one array; lists of unequal lists with their own beginnings."""
    items = [item for each in lists for item in each]
    columns = {f"{name}_offsets": _offsets(lists)}
    if not isinstance(like[0], list):
        columns[name] = np.array(items, dtype=None if items else np.array(like).dtype)
        return columns
    if name == "facets" or len({len(item) for item in items}) > 1:
        columns[f"{name}_loops"] = _offsets(items)
        items = [number for item in items for number in item]
        columns[name] = np.array(items, dtype=None if items else np.array(like[0]).dtype)
    else:
        columns[name] = np.array(items, dtype=np.array(like[0]).dtype).reshape(len(items), len(like[0]))
    return columns


def _column(name, values, like):
    """A field of all rows as named arrays; None where a row has none."""
    if name == "class":
        return {"contact": np.array([0 if each is None else CONTACTS.index(each) for each in values], dtype=np.uint8)}
    if isinstance(like, (bool, int, str)):
        return {name: np.array([type(like)() if each is None else each for each in values])}
    if isinstance(like, float):
        return {name: np.array([np.nan if each is None else each for each in values], dtype=float)}
    if name in _VECTORS:
        return {name: np.array([[np.nan] * len(like) if each is None else each for each in values], dtype=float)}
    return _joined(name, [each or [] for each in values], like)


def _has_column(value):
    """Numbers, words and lists of them; not the counts of `stats`, nor features, which are objects."""
    if isinstance(value, list):
        return bool(value) and not isinstance(value[0], dict)
    return isinstance(value, (bool, int, float, str))


def batch_of(answers, errors, like=None):
    """A struct of arrays of answers by name, None for refused rows. like: an answer whose fields are always there."""
    kinds = dict(like or {})
    for answer in answers:
        for name, value in (answer or {}).items():
            if name not in kinds and name != "id" and _has_column(value):
                kinds[name] = value
    fields = {"error": np.asarray(errors, dtype=np.uint8)}
    for name, kind in kinds.items():
        fields.update(_column(name, [answer.get(name) if answer else None for answer in answers], kind))
    return RowBatch(fields)


def ask_lines(lines, threads, like=None):
    """Answers lines of the protocol on many threads, the interpreter's lock released. A line that is an index into ERRORS
    is a row that was refused before it could be asked."""
    from . import _protocol

    asked = [line for line in lines if isinstance(line, str)]
    found = iter(_protocol.answer_many(asked, _threads(threads)))
    answers, errors = [], []
    for row, line in enumerate(lines):
        answer = json.loads(next(found)) if isinstance(line, str) else None
        error = answer.get("error") if answer else None
        if error and error["code"] not in _CODES:  # the question itself cannot be read
            where = f"rows[{row}]{'.' + error['where'] if error.get('where') else ''}"
            raise refused(f"{where}: {error['message']} ({error['code']})")
        answers.append(None if error else answer)
        errors.append(_CODES[error["code"]] if error else (0 if answer else line))
    return batch_of(answers, errors, like)


def line_of(query, parts):
    """A line of texts of JSON by key, or the error of the first that is an index into ERRORS."""
    for part in parts.values():
        if isinstance(part, int):
            return part
    return "".join([f'{{"query":"{query}"', *(f',"{name}":{part}' for name, part in parts.items()), "}"])


def texts(values):
    """Numbers or arrays as JSON; the error of what is not finite."""
    return [json.dumps(each) if np.isfinite(each).all() else _CODES["non_finite"] for each in values.tolist()]


def spread(values, count):
    return values if len(values) == count else values * count


def bodies(a, b, pose_a, pose_b):
    """Shapes and poses of every row as JSON, and the number of rows; b may be None."""
    (shapes_a, shapes_b, poses_a, poses_b), _, count = _rows(a, a if b is None else b, pose_a, pose_b)
    known = {}

    def told(shapes):
        for shape in shapes:
            if id(shape) not in known:
                known[id(shape)] = json.dumps(shape_fields(shape, "a, b"))
        return spread([known[id(shape)] for shape in shapes], count)

    def placed(poses):
        if poses.dtype == object:
            return spread([json.dumps(pose_fields(pose)) for pose in poses], count)
        whole = (np.asarray(poses)[:, 3] == [0, 0, 0, 1]).all(axis=1)
        made = []
        for matrix, right in zip(np.asarray(poses, dtype=float), whole):
            if not np.isfinite(matrix).all():
                made.append(_CODES["non_finite"])
            elif not right:
                made.append(_CODES["bad_value"])
            else:
                numbers = {"rotation_row_major": matrix[:3, :3].ravel().tolist(), "translation": matrix[:3, 3].tolist()}
                made.append(json.dumps(numbers))
        return spread(made, count)

    parts = {"a": told(shapes_a), "pose_a": placed(poses_a)}
    if b is not None:
        parts.update(b=told(shapes_b), pose_b=placed(poses_b))
    return parts, count


def rows_of(value, count, size, name):
    """One number or vector for all rows, or one a row, as JSON."""
    single = (size,) if size else ()
    array = number_array(value, name, f"{list(single)} or {[count, *single]}").astype(float)
    if array.shape not in (single, (count, *single)):
        raise refused(f"{name}: has shape {array.shape}, needs {single} or {(count, *single)} (bad_value)")
    return spread(texts(array.reshape((-1, *single))), count)


def ask_rows(query, parts, count, threads, like=None):
    """parts: by key, one text of JSON a row."""
    names = list(parts)
    lines = [line_of(query, dict(zip(names, row))) for row in zip(*parts.values())] if names else []
    assert len(lines) == count
    return ask_lines(lines, threads, like)
