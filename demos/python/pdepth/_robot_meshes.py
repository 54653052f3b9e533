"""Meshes that a robot names: found inside of given folders alone, read once, as solids or as hulls."""

from __future__ import annotations

import os
import urllib.parse

import numpy as np

from . import _core
from ._errors import file_name, length, refused
from ._shapes import Compound, ConvexPolytope

#: Ways to take a mesh.
WISHES = ("solid", "hull", "parts")


class Meshes:
    """Meshes of one robot's file. package_roots: {package: its folder}, or folders that hold packages."""

    def __init__(self, path, package_roots, wish, tolerance):
        self._wishes = wish if isinstance(wish, dict) else {None: wish}
        for link, each in self._wishes.items():
            if each not in WISHES:
                where = "meshes" if link is None else f"meshes[{link!r}]"
                raise refused(f"{where}: must be one of {', '.join(map(repr, WISHES))}, not {each!r} (bad_value)")
        self._tolerance = length(tolerance, "tolerance")
        self._home = os.path.realpath(os.path.dirname(os.fspath(path)) or ".")
        self._packages, self._folders = _roots(package_roots)
        self._paths, self._shapes = {}, {}

    def locate(self, named):
        """Finds the files of all meshes, so that packages that are missing are named together. named: (node, its URI)."""
        missing = {}
        for node, name in named:
            scheme, _, rest = name.partition("://")
            if not rest:
                self._paths[node] = self._inside(node, name, os.path.join(self._home, name))
            elif scheme == "file":
                self._paths[node] = self._inside(node, name, urllib.parse.unquote(rest))
            elif scheme in ("package", "model"):
                package, _, rest = rest.partition("/")
                root = self._package(package)
                if root is None:
                    missing.setdefault(package, (node, name))
                else:
                    self._paths[node] = self._inside(node, name, os.path.join(root, rest))
            else:
                node.refuse(f"{name!r}: meshes come from files, package:// and model://", "unsupported")
        if missing:
            node, name = next(iter(missing.values()))
            given = ", ".join(f"{package!r}: \"/folder/of/it\"" for package in missing)
            raise refused(f"package_roots: no folder is known of {', '.join(missing)} ({name!r} in {node.where}); "
                          f"give package_roots={{{given}}}, or the folder that holds them (missing_field)")

    def _package(self, package):
        if package in self._packages:
            return self._packages[package]
        found = (os.path.join(folder, package) for folder in self._folders)
        return next((each for each in found if os.path.isdir(each)), None)

    def _inside(self, node, name, path):
        """The file, which lies below the robot's own folder or a root, links followed."""
        if "\0" in path:
            node.refuse(f"{name!r}: a file's name holds no zero byte")
        path = os.path.realpath(path)
        for folder in (self._home, *self._packages.values(), *self._folders):
            if os.path.commonpath((folder, path)) == folder:
                return path
        node.refuse(f"{name!r} leads out of the robot's folder; name the folder in package_roots if the file is meant",
                    "unreadable_file")

    def check_links(self, links):
        """Refuses a wish for a link that is not there."""
        for link in self._wishes:
            if link is not None and link not in links:
                raise refused(f"meshes[{link!r}]: the robot has no such link; its links: {', '.join(links)} (bad_value)")

    def shape(self, node, scale, link, convex):
        """The shape of a mesh that was located, in the unit of the robot."""
        if not scale.all():
            node.refuse("the scale of a mesh must differ from zero along each axis")
        wish = "hull" if convex else self._wishes.get(link, self._wishes.get(None, "solid"))
        key = (self._paths[node], tuple(scale), wish)
        if key not in self._shapes:
            try:
                self._shapes[key] = _read(self._paths[node], scale, wish, self._tolerance)
            except _core.Refused as error:
                told = str(error)[len(error.where) + 2:-len(error.code) - 3].removeprefix(f"{self._paths[node]}: ")
                node.refuse(f"{os.path.basename(self._paths[node])}: {told}", error.code)
        return self._shapes[key]


def _roots(given):
    if given is None:
        return {}, ()
    if isinstance(given, dict):
        packages, folders = {name: os.path.realpath(os.fspath(folder)) for name, folder in given.items()}, ()
    else:
        folders = (given,) if isinstance(given, (str, os.PathLike)) else given
        packages, folders = {}, tuple(os.path.realpath(os.fspath(folder)) for folder in folders)
    for folder in (*packages.values(), *folders):
        if not os.path.isdir(folder):
            raise refused(f"package_roots: {folder!r} is no folder (bad_value)")
    return packages, folders


def _read(path, scale, wish, tolerance):
    from . import _protocol

    path = file_name(path)
    if wish == "hull":
        return ConvexPolytope(_protocol.mesh_points(path, False)[0] * scale)
    connected = wish == "parts"
    found = _protocol.connected_parts(path, scale) if connected else _protocol.solid_parts(path, scale, tolerance)
    parts = [ConvexPolytope(points) for points in found]
    return parts[0] if len(parts) == 1 else Compound(parts)
