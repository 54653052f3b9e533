"""XML files of robots as trees whose nodes know their line: every refusal names the file and the line."""

from __future__ import annotations

import os
import stat
from xml.parsers import expat

import numpy as np

from ._core import Refused
from ._errors import refused

#: A robot's description is text; one of this size is a mistake.
_MOST_BYTES = 32 << 20


class Node:
    """An element: tag, attributes, children, text, and where it begins."""

    __slots__ = ("tag", "attributes", "children", "text", "where")

    def __init__(self, tag, attributes, where):
        self.tag, self.attributes, self.where = tag, attributes, where
        self.children, self.text = [], ""

    def all(self, tag):
        return [child for child in self.children if child.tag == tag]

    def first(self, tag):
        return next((child for child in self.children if child.tag == tag), None)

    def need(self, tag):
        return self.first(tag) or self.refuse(f"<{self.tag}> needs a <{tag}>", "missing_field")

    def refuse(self, told, code="bad_value"):
        raise refused(f"{self.where}: {told} ({code})")

    def attempt(self, make):
        """make(), whose refusal is told with this element's line, unless it has one."""
        try:
            return make()
        except Refused as error:
            if " line " in error.where:
                raise
            self.refuse(f"<{self.tag}>: {str(error)[:-len(error.code) - 3]}", error.code)

    def word(self, attribute):
        """An attribute that must be there."""
        if not self.attributes.get(attribute):
            self.refuse(f"<{self.tag}> needs the attribute {attribute}=\"...\"", "missing_field")
        return self.attributes[attribute]

    def numbers(self, attribute, count, default=None):
        """`count` numbers of an attribute, or the default where the attribute is missing."""
        if attribute not in self.attributes and default is not None:
            return np.array(default, dtype=float)
        return self.numbers_of(self.word(attribute), count, f"{attribute} of <{self.tag}>")

    def content(self, count):
        """`count` numbers of the element's text."""
        return self.numbers_of(self.text, count, f"<{self.tag}>")

    def numbers_of(self, text, count, name):
        try:
            if "_" in text or not text.isascii():  # Python's float takes 1_0, and digits of other alphabets
                raise ValueError
            values = np.array([float(word) for word in text.split()])
        except ValueError:
            self.refuse(f"{name} must be numbers with blanks between them, not {text[:60]!r}")
        if len(values) != count:
            self.refuse(f"{name} must be {count} number{'s' * (count > 1)}, not {text[:60]!r}")
        if not np.isfinite(values).all():
            self.refuse(f"{name} must be finite, not {text[:60]!r}", "non_finite")
        return values


def read_xml(path, root_tag):
    """The root node of an XML file. A document type is refused: its entities could grow without bound, or name files."""
    path, name = os.fspath(path), os.path.basename(os.fspath(path))
    try:
        found = os.stat(path)
        if not stat.S_ISREG(found.st_mode):
            raise refused(f"{path}: must be a regular file (unreadable_file)")
        if found.st_size > _MOST_BYTES:
            raise refused(f"{path}: has {found.st_size} bytes, and {_MOST_BYTES} are read (limit_exceeded)")
        with open(path, "rb") as file:
            text = file.read()
    except OSError as error:
        raise refused(f"{path}: {error.strerror} (unreadable_file)") from None
    parser = expat.ParserCreate()
    parser.buffer_text = True
    top = Node("", {}, name)
    open_nodes = [top]

    def begin(tag, attributes):
        node = Node(tag, attributes, f"{name} line {parser.CurrentLineNumber}")
        open_nodes[-1].children.append(node)
        open_nodes.append(node)

    def doctype(*_):
        told = "a document type is not read, since its entities may grow without bound; remove <!DOCTYPE ...>"
        raise refused(f"{name} line {parser.CurrentLineNumber}: {told} (unsupported)")

    def characters(text):
        open_nodes[-1].text += text

    parser.StartElementHandler, parser.EndElementHandler = begin, lambda tag: open_nodes.pop()
    parser.CharacterDataHandler, parser.StartDoctypeDeclHandler = characters, doctype
    try:
        parser.Parse(text, True)
    except expat.ExpatError as error:
        raise refused(f"{name} line {error.lineno}: no XML: {expat.ErrorString(error.code)} (unreadable_file)") from None
    except Refused:
        raise
    except (LookupError, ValueError) as error:
        raise refused(f"{name} line {parser.CurrentLineNumber}: no XML: {error} (unreadable_file)") from None
    root = top.children[0]
    if root.tag != root_tag:
        root.refuse(f"must be a <{root_tag}>, not a <{root.tag}>")
    return root


def rotation_of(rpy):
    """Roll about x, then pitch about y, then yaw about z, all fixed axes."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(rpy), np.sin(rpy)
    return np.array([[cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
                     [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
                     [-sp, cp * sr, cp * cr]])


def matrix_of(xyz, rpy):
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = rotation_of(rpy), xyz
    return matrix
