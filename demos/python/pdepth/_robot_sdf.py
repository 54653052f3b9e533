"""SDF files as models of robots: one model, its frames resolved where all joints are at zero."""

from __future__ import annotations

import numpy as np

from ._robot_model import WITH_AXIS, Joint, Link, Model
from ._robot_motion import compose
from ._robot_urdf import positive, unit
from ._robot_xml import matrix_of, read_xml
from ._shapes import Box, Capsule, Cone, Cylinder, Ellipsoid, Sphere

#: The model's own frame, and a link without a shape on which links without a joint stand.
_MODEL = "__model__"
_KINDS = ("fixed", "revolute", "continuous", "prismatic", "ball")


class _Frames:
    """Poses of links, joints and frames in the model's frame, each by way of the one that it is given in."""

    def __init__(self, root):
        self._given, self._found = {}, {_MODEL: np.eye(4), "world": np.eye(4)}
        for node in root.children:
            if node.tag in ("link", "frame", "joint"):
                base = {"link": _MODEL, "frame": node.attributes.get("attached_to") or _MODEL}.get(node.tag)
                self._given[node.word("name")] = (node, base or node.need("child").text.strip())

    def of(self, name, node):
        """The pose of a frame; node: who asks."""
        chain, seen = [], set()
        while name not in self._found:
            if name not in self._given or name in seen:
                node.refuse(f"the frame {name!r} " + ("is given by itself" if name in seen else "is not there"))
            seen.add(name)
            node, base = self._given[name]
            chain.append((name, node))
            pose = node.first("pose")
            name = base if pose is None else pose.attributes.get("relative_to") or base
        place = self._found[name]
        for name, node in reversed(chain):
            place = self._found[name] = compose(place, _pose(node))
        return place

    def link(self, name, node):
        """The link that a frame is attached to."""
        seen = set()
        while name != "world" and name in self._given and self._given[name][0].tag != "link":
            if name in seen:
                node.refuse(f"the frame {name!r} is attached to itself")
            seen.add(name)
            name = self._given[name][1]
        return name


def _pose(node):
    pose = node.first("pose")
    if pose is None or not pose.text.strip():
        return np.eye(4)
    if pose.attributes.get("rotation_format", "euler_rpy") != "euler_rpy":
        pose.refuse("poses are read with roll, pitch and yaw", "unsupported")
    numbers = pose.content(6)
    turn = np.radians(numbers[3:]) if pose.attributes.get("degrees") in ("true", "1") else numbers[3:]
    return matrix_of(numbers[:3], turn)


def _inverse(matrix):
    back = np.eye(4)
    back[:3, :3] = matrix[:3, :3].T
    back[:3, 3] = -(matrix[:3, :3].T @ matrix[:3, 3])
    return back


def read_sdf(path, meshes):
    top = read_xml(path, "sdf")
    models = top.all("model") or [model for world in top.all("world") for model in world.all("model")]
    if len(models) != 1:
        top.refuse(f"holds {len(models)} models; one is read", "missing_field" if not models else "unsupported")
    root = models[0]
    for node in root.children:
        if node.tag in ("model", "include"):
            node.refuse(f"<{node.tag}> inside of a model is not read; write one flat model", "unsupported")
    frames = _Frames(root)
    parts = [(link, part) for link in root.all("link") for part in link.all("collision")]
    found = [mesh for _, part in parts for mesh in part.need("geometry").all("mesh")]
    meshes.locate([(mesh, mesh.need("uri").text.strip()) for mesh in found])
    links = {id(node): Link(node.word("name"), node.where) for node in root.all("link")}
    meshes.check_links([link.name for link in links.values()])
    for link, part in parts:
        into = links[id(link)]
        place = _pose(part)
        relative = part.first("pose").attributes.get("relative_to") if part.first("pose") is not None else None
        if relative:
            place = compose(compose(_inverse(frames.of(into.name, part)), frames.of(relative, part)), place)
        geometry = part.need("geometry")
        into.parts.append((geometry.attempt(lambda: _shape(geometry, into.name, meshes)), place))
    if not links:
        root.refuse("has no <link>", "missing_field")
    old = tuple(int(x) for x in top.attributes.get("version", "1.7").split(".")[:2] if x.isdigit()) < (1, 5)
    joints = [_joint(node, frames, old) for node in root.all("joint")]
    model = Model(root.attributes.get("name", ""), list(links.values()), joints)
    if any(joint.parent == "world" for joint in joints):
        model.links.insert(0, Link("world", root.where))
    _stand(model, frames, root)
    return model


def _stand(model, frames, root):
    """Links without a joint above stand in the model's frame."""
    moved = {joint.child for joint in model.joints}
    free = [link.name for link in model.links if link.name not in moved]
    if len(free) == 1 and (frames.of(free[0], root) == np.eye(4)).all():
        return
    model.links.insert(0, Link(_MODEL, root.where))
    for name in free:
        model.joints.append(Joint(f"{_MODEL}{name}", "fixed", _MODEL, name, frames.of(name, root), np.zeros(3), root.where))


def _joint(node, frames, old):
    name, kind = node.word("name"), node.word("type")
    if kind not in _KINDS:
        node.refuse(f"joint {name!r} has the type {kind!r}; known: {', '.join(_KINDS)}", "unsupported")
    parent, child = (frames.link(node.need(end).text.strip(), node) for end in ("parent", "child"))
    place, axis, limits, mimic = frames.of(name, node), np.array([0.0, 0.0, 1.0]), (-np.inf, np.inf), None
    along = node.first("axis")
    if along is not None and kind in WITH_AXIS:
        xyz = along.first("xyz")
        if xyz is not None:
            axis = unit(xyz, xyz.content(3), name)
            by_model = old or (along.first("use_parent_model_frame") or node).text.strip() in ("1", "true")
            frame = xyz.attributes.get("expressed_in") or (_MODEL if by_model else None)
            if frame:
                axis = place[:3, :3].T @ (frames.of(frame, node)[:3, :3] @ axis)
        limits, mimic = _limits(along, kind), _mimic(along)
    return Joint(name, kind, parent, child, compose(_inverse(frames.of(parent, node)), place), axis, node.where,
                 compose(_inverse(place), frames.of(child, node)), limits, mimic)


def _number(node, tag, default):
    child = node.first(tag) if node is not None else None
    return default if child is None else child.content(1).item()


def _limits(axis, kind):
    limit = axis.first("limit")
    low, high = _number(limit, "lower", -np.inf), _number(limit, "upper", np.inf)
    # SDF writes 1e16 for a joint without a limit.
    return (-np.inf, np.inf) if kind == "continuous" else (low if low > -1e16 else -np.inf, high if high < 1e16 else np.inf)


def _mimic(axis):
    mimic = axis.first("mimic")
    if mimic is None:
        return None
    if _number(mimic, "reference", 0):
        mimic.refuse("a mimic with a reference is not read; take it into the offset", "unsupported")
    return mimic.word("joint"), _number(mimic, "multiplier", 1.0), _number(mimic, "offset", 0.0)


def _sizes(node, *tags):
    return positive(node, [node.need(tag).content(1).item() for tag in tags])


def _shape(geometry, link, meshes):
    for node in geometry.children:
        if node.tag == "box":
            return Box(positive(node, node.need("size").content(3)) / 2)
        if node.tag == "sphere":
            return Sphere(*_sizes(node, "radius"))
        if node.tag in ("cylinder", "capsule", "cone"):
            radius, length = _sizes(node, "radius", "length")
            return {"cylinder": Cylinder, "capsule": Capsule, "cone": Cone}[node.tag](radius, length / 2)
        if node.tag == "ellipsoid":
            return Ellipsoid(positive(node, node.need("radii").content(3)))
        if node.tag == "mesh":
            if node.first("submesh") is not None:
                node.refuse("a submesh is not read; write a file of its own", "unsupported")
            scale = node.first("scale")
            return meshes.shape(node, np.ones(3) if scale is None else scale.content(3), link, False)
        node.refuse(f"<{node.tag}> is no shape that is read; known: box, sphere, cylinder, capsule, cone, ellipsoid, mesh",
                    "unsupported")
    geometry.refuse("<geometry> is empty; it needs a shape such as <box>", "missing_field")
