"""The stubs name what the package has, and nothing else; everything public has a docstring."""
import ast
import inspect
import pathlib
import pydoc
import re

import pdepth

STUB = pathlib.Path(__file__).resolve().parents[2] / "demos" / "python" / "pdepth" / "__init__.pyi"
TREE = ast.parse(STUB.read_text())


def public_names():
    return {name for name in vars(pdepth) if not name.startswith("_") and not inspect.ismodule(getattr(pdepth, name))}


def test_stubs_name_what_there_is():
    stubs = {node.name for node in TREE.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
    stubs |= {node.target.id for node in TREE.body if isinstance(node, ast.AnnAssign)} - {"__version__"}
    assert stubs == public_names()


def test_functions_have_the_parameters_of_their_stubs():
    for node in TREE.body:
        if isinstance(node, ast.FunctionDef):
            names = [arg.arg for arg in node.args.args + node.args.kwonlyargs]
            names += [arg.arg for arg in (node.args.vararg, node.args.kwarg) if arg]
            assert names == list(inspect.signature(getattr(pdepth, node.name)).parameters), node.name


def test_classes_have_the_members_of_their_stubs():
    of_objects = {"Answer", "DirectionalDepth", "Manifold", "Derivatives", "Batch", "Sweep", "Refused", "Robot",
                  "RobotDistances"}  # set when made
    for node in TREE.body:
        if isinstance(node, ast.ClassDef) and node.name not in of_objects:
            for member in node.body:
                name = getattr(member, "name", None) or getattr(getattr(member, "target", None), "id", None)
                assert hasattr(getattr(pdepth, node.name), name), (node.name, name)


def test_everything_public_says_what_it_is():
    for name in public_names() - {"ERRORS", "CONTACTS", "FEATURES"}:
        assert inspect.getdoc(getattr(pdepth, name)), name


def test_help_of_the_package_shows_all_of_it():
    assert set(pdepth.__all__) == public_names()
    told = pydoc.render_doc(pdepth, renderer=pydoc.plaintext)
    for name in public_names():
        assert re.search(rf"^ +(class )?{name}\b", told, re.MULTILINE), name


def test_help_shows_the_packages_own_arguments():
    for name in public_names() - {"ERRORS", "CONTACTS", "FEATURES"}:
        told = pydoc.render_doc(getattr(pdepth, name), renderer=pydoc.plaintext)
        assert "_core.Shape, kind" not in told, name
    for shape in (pdepth.Box, pdepth.Sphere, pdepth.Cone, pdepth.Compound, pdepth.StarBody, pdepth.ConvexPolytope):
        assert "Raises Refused" in inspect.getdoc(shape), shape
