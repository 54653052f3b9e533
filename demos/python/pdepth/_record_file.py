"""A contact record that grows by whole states: "pdepth-contacts/1", one JSON object a line."""

from __future__ import annotations

import json
import os

from ._errors import refused

#: Of files that this process wrote: their size then, engine, ids of shapes by their text, and number of contacts.
_written = {}


def _text(value):
    return json.dumps(value, separators=(",", ":"), default=float)


def _reason(error):
    return f"{error.strerror or error} (unreadable_file)"


class RecordFile:
    """Shapes and contacts to be added to a file by `write`, whole or not at all."""

    def __init__(self, path, engine, scalar):
        self._path, self._engine = os.path.realpath(os.fspath(path)), engine
        try:
            size = os.path.getsize(self._path) if os.path.exists(self._path) else 0
            known = _written.get(self._path)
            if size == 0:
                self._shapes, self._contacts = {}, 0
                head = {"record": "pdepth-contacts/1", "engine": engine, "scalar": scalar, "unit": "m"}
                self._lines = [_text(head)]
            elif known and known[:2] == (size, engine):
                self._shapes, self._contacts, self._lines = dict(known[2]), known[3], []
            else:
                self._read()
        except OSError as error:
            raise refused(f"{self._path}: {_reason(error)}") from None

    def _read(self):
        """Takes up a record that another process began."""
        self._shapes, self._contacts, self._lines, line = {}, 0, [], ""
        with open(self._path, encoding="utf-8", errors="replace") as file:
            first = file.readline()
            try:
                engine = json.loads(first)["engine"]
            except (ValueError, KeyError, TypeError):
                raise refused(f"{self._path}: is no contact record; give another path (unreadable_file)") from None
            if engine != self._engine:
                told = f"is a record of {engine!r}, not of {self._engine!r}; give another path"
                raise refused(f"{self._path}: {told} (bad_value)")
            for line in file:
                if line.startswith('{"shape"') and line.endswith("\n"):
                    self._take_shape(line)
                self._contacts += line.startswith('{"contact"')
        if not (line or first).endswith("\n"):
            raise refused(f"{self._path}: ends within a line; give another path, or remove that line (unreadable_file)")

    def _take_shape(self, line):
        try:
            shape = json.loads(line)
            self._shapes[_text(shape["is"])] = shape["shape"]
        except (ValueError, KeyError):
            raise refused(f"{self._path}: a shape cannot be read: {line[:60]!r} (unreadable_file)") from None

    def shape(self, shape):
        """The id of a shape of pdepth, or of one as the record writes it; a new one is written."""
        text = _text(shape if isinstance(shape, dict) else shape.protocol())
        if text not in self._shapes:
            self._shapes[text] = f"s{len(self._shapes)}"
            self._lines.append(f'{{"shape":"{self._shapes[text]}","is":{text}}}')
        return self._shapes[text]

    def contact(self, time, a, b, reported):
        """a, b: (id of a shape, matrix)."""
        line = {"contact": self._contacts, **({} if time is None else {"time": time})}
        for name, (shape, matrix) in (("a", a), ("b", b)):
            rotation = matrix[:3, :3].ravel().tolist()
            line.update({name: shape, f"pose_{name}": {"translation": matrix[:3, 3].tolist(), "rotation_row_major": rotation}})
        self._lines.append(_text({**line, "reported": reported}))
        self._contacts += 1

    def write(self):
        try:
            with open(self._path, "ab") as file:
                file.write("".join(f"{line}\n" for line in self._lines).encode())
                size = file.tell()
        except OSError as error:
            raise refused(f"{self._path}: {_reason(error)}") from None
        _written[self._path] = (size, self._engine, self._shapes, self._contacts)
