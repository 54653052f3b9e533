"""URDF and SRDF files as models of robots."""

from __future__ import annotations

import numpy as np

from ._errors import refused
from ._robot_model import COORDINATES, WITH_AXIS, Joint, Link, Model
from ._robot_xml import matrix_of, read_xml
from ._shapes import Box, Capsule, Cylinder, Ellipsoid, Sphere


def read_urdf(path, meshes):
    root = read_xml(path, "robot")
    if any(node.tag.startswith("xacro:") for node in root.children):
        root.refuse("has xacro macros; run xacro on the file and give what it prints", "unsupported")
    nodes = [(link, part) for link in root.all("link") for part in link.all("collision")]
    meshes.locate([(mesh, mesh.word("filename")) for _, part in nodes for mesh in part.need("geometry").all("mesh")])
    links = {id(node): Link(node.word("name"), node.where) for node in root.all("link")}
    meshes.check_links([link.name for link in links.values()])
    for link, part in nodes:
        into = links[id(link)]
        geometry = part.need("geometry")
        shape = geometry.attempt(lambda: _shape(geometry, into.name, meshes))
        into.parts.append((shape, _origin(part)))
    if not links:
        root.refuse("has no <link>", "missing_field")
    model = Model(root.attributes.get("name", ""), list(links.values()), [_joint(node) for node in root.all("joint")])
    _require_one_root(model)
    return model


def _require_one_root(model):
    """A link that no joint holds would stand at the root's place. Joints of links that are not there are told later."""
    links, held = {link.name: link for link in model.links}, {joint.child for joint in model.joints}
    roots = [link for link in links.values() if link.name not in held]
    if len(roots) > 1 and held <= links.keys():
        told = f"no joint holds link {roots[1].name!r}, and {roots[0].name!r} is a root already; a robot has one root"
        raise refused(f"{roots[1].where}: {told} (bad_value)")


def _origin(node):
    origin = node.first("origin")
    if origin is None:
        return np.eye(4)
    return matrix_of(origin.numbers("xyz", 3, (0, 0, 0)), origin.numbers("rpy", 3, (0, 0, 0)))


def _shape(geometry, link, meshes):
    for node in geometry.children:
        kind = node.tag.removeprefix("drake:")
        if kind == "box":
            return Box(positive(node, node.numbers("size", 3)) / 2)
        if kind == "sphere":
            return Sphere(positive(node, node.numbers("radius", 1))[0])
        if kind in ("cylinder", "capsule"):  # a capsule's length is that of its axis, without the caps
            radius, length = positive(node, [*node.numbers("radius", 1), *node.numbers("length", 1)])
            return (Cylinder if kind == "cylinder" else Capsule)(radius, length / 2)
        if kind == "ellipsoid":
            return Ellipsoid(positive(node, [node.numbers(name, 1)[0] for name in "abc"]))
        if kind == "mesh":
            convex = node.first("drake:declare_convex") is not None
            return meshes.shape(node, node.numbers("scale", 3, (1, 1, 1)), link, convex)
        node.refuse(f"<{node.tag}> is no shape that is read; known: box, sphere, cylinder, capsule, ellipsoid, mesh",
                    "unsupported")
    geometry.refuse("<geometry> is empty; it needs a shape such as <box size=\"1 1 1\"/>", "missing_field")


def positive(node, sizes):
    if not (np.asarray(sizes) > 0).all():
        node.refuse(f"the sizes of <{node.tag}> must be positive")
    return sizes


def _joint(node):
    name, kind = node.word("name"), node.word("type")
    if kind not in COORDINATES:
        node.refuse(f"joint {name!r} has the type {kind!r}; known: {', '.join(COORDINATES)}", "unsupported")
    axis, along = np.array([1.0, 0.0, 0.0]), node.first("axis")
    if along is not None and kind in WITH_AXIS:
        axis = unit(along, along.numbers("xyz", 3), name)
    parent, child = (node.need(end).word("link") for end in ("parent", "child"))
    joint = Joint(name, kind, parent, child, _origin(node), axis, node.where)
    limit = node.first("limit")
    if kind in ("revolute", "prismatic") and limit is not None:
        joint.limits = (limit.numbers("lower", 1, (0,)).item(), limit.numbers("upper", 1, (0,)).item())
        if joint.limits[0] > joint.limits[1]:
            limit.refuse(f"the lower limit {joint.limits[0]:g} of joint {name!r} is greater than the upper one, {joint.limits[1]:g}")
    mimic = node.first("mimic")
    if mimic is not None:
        factor, offset = mimic.numbers("multiplier", 1, (1,)).item(), mimic.numbers("offset", 1, (0,)).item()
        joint.mimic = (mimic.word("joint"), factor, offset)
    return joint


def unit(node, axis, name):
    if not axis.any():
        node.refuse(f"the axis of joint {name!r} must have a length other than zero", "zero_direction")
    if not 0 < np.linalg.norm(axis) < np.inf:  # squares out of the range of doubles
        axis = axis / np.abs(axis).max()
    return axis / np.linalg.norm(axis)


def read_srdf(path, model):
    """Adds the pairs of links that an SRDF file disables to a model."""
    root, known = read_xml(path, "robot"), {link.name for link in model.links}

    def link(node, attribute):
        name = node.word(attribute)
        if name not in known:
            node.refuse(f"<{node.tag}> names the link {name!r}, which the robot {model.name!r} has not")
        return name

    for node in root.all("disable_default_collisions"):
        name = link(node, "link")
        model.disabled |= {frozenset((name, other)) for other in known - {name}}
    for node in root.all("enable_collisions"):
        model.disabled.discard(frozenset((link(node, "link1"), link(node, "link2"))))
    for node in root.all("disable_collisions"):
        model.disabled.add(frozenset((link(node, "link1"), link(node, "link2"))))
