"""Makes the page of reference of the Python package from its docstrings and its stub file.

`pages(root)` returns the Markdown. Signatures come from `__init__.pyi`, docstrings from the package's sources, and those of
the types that the compiled module makes from the bindings. A public name without a docstring ends the build.
"""
import ast
import re
from html import escape

PACKAGE = "demos/python/pdepth"
GROUPS = (
    ("Pairs", ("depth", "distance", "intersects", "directional_depth", "derivatives", "contact_manifold", "time_of_impact")),
    ("Bodies and one body's queries", ("hull", "width", "minkowski_difference", "polygon_depth")),
    ("Shapes and poses", ("Shape", "ConvexPolytope", "Box", "Sphere", "Ellipsoid", "Capsule", "Cylinder", "Cone", "SphereHull",
                          "Compound", "StarBody", "Sheet", "Pose")),
    ("Robots", ("Robot", "RobotDistances")),
    ("Lines of the protocol", ("query", "query_many", "Answer", "RowBatch")),
    ("Judge, sweep, see", ("audit", "record.mujoco", "record.pybullet", "sweep", "Sweep", "picture", "save_picture")),
    ("Answers and errors", ("Depth", "DirectionalDepth", "Derivatives", "Manifold", "Batch", "Warm", "Refused", "ERRORS", "CONTACTS",
                            "FEATURES", "cores")),
)
# The values among the names of the stub have no docstring: this text says what they hold.
VALUES = {
    "ERRORS": "The names of the errors of a batch: `found.error` holds indices into it; 0 means that the row is answered.",
    "CONTACTS": "The classes, in the order of a batch's `contact`: separated, touching, overlapping.",
    "FEATURES": "The kinds of features of a batch: none, vertex, edge, facet.",
}


class Missing(Exception):
    """A public name of the package that the reference cannot show."""


def documented(folder):
    """Names, `Class.method` among them, with their docstrings, from the Python sources."""
    found = {}
    for path in sorted(folder.glob("*.py")):
        for node in ast.parse(path.read_text()).body:
            if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
                name = ("record." if path.stem == "record" else "") + node.name
                if ast.get_docstring(node):
                    found[name] = ast.get_docstring(node)
                for inner in getattr(node, "body", ()) if isinstance(node, ast.ClassDef) else ():
                    if isinstance(inner, ast.FunctionDef) and ast.get_docstring(inner):
                        found[f"{name}.{inner.name}"] = ast.get_docstring(inner)
    return found


STRINGS = r'((?:\s*"(?:[^"\\]|\\.)*")+)'


def joined(strings):
    return "".join(re.findall(r'"((?:[^"\\]|\\.)*)"', strings)).replace("\\n", "\n").replace('\\"', '"')


def bound(folder):
    """Docstrings of the types that the compiled module makes, and of their attributes as `Type.attribute`."""
    found = {}
    for path in sorted(folder.parent.glob("*.cpp")):
        for part in re.split(r"py::class_<", path.read_text()):
            name = re.match(r'[^;{]*?>\s+\w+\(\s*module,\s*"(\w+)",(?:\s*py::dynamic_attr\(\),)?' + STRINGS, part)
            if name:
                found[name[1]] = joined(name[2])
                for member in re.finditer(r'def_property_readonly\(\s*"(\w+)",(?:(?!def_property_readonly).)*?,' + STRINGS + r"\)", part, re.S):
                    found[f"{name[1]}.{member[1]}"] = joined(member[2])
            for made in re.finditer(r'"pdepth\.(\w+)",' + STRINGS, part):
                found[made[1]] = joined(made[2])
    return found


def signatures(folder):
    """Returns for each name what the stub holds: a function's head, or a class with its members."""
    functions, classes = {}, {}
    modules = [("", (folder / "__init__.pyi").read_text()), ("record.", (folder / "record.py").read_text())]
    for prefix, text in modules:
        for node in ast.parse(text).body:
            if isinstance(node, ast.FunctionDef) and not node.name.startswith("_"):
                functions.setdefault(prefix + node.name, node)
            elif isinstance(node, ast.ClassDef) and not prefix:
                classes[node.name] = node
    return functions, classes


def head(node, name, own=False):
    """`depth(a, b, pose_a=None, *, threads=None)`: names and which of them may be left out."""
    positional = node.args.posonlyargs + node.args.args
    words = [a.arg for a in positional]
    for k in range(len(node.args.defaults)):
        words[len(words) - 1 - k] += "=..."
    if own:
        words = words[1:]
    if node.args.vararg:
        words.append("*" + node.args.vararg.arg)
    elif node.args.kwonlyargs:
        words.append("*")
    words += [a.arg + ("=..." if default is not None else "") for a, default in zip(node.args.kwonlyargs, node.args.kw_defaults)]
    if node.args.kwarg:
        words.append("**" + node.args.kwarg.arg)
    return f"{name}({', '.join(words)})"


def decorated(node, word):
    return any(getattr(d, "id", "") == word for d in node.decorator_list)


def signature(words):
    return f'<pre class="pd-head"><code>{escape(words)}</code></pre>'


def block(text):
    """A docstring as paragraphs; a line that begins with names and a colon tells of arguments, and begins anew."""
    paragraphs = []
    for part in re.split(r"\n\s*\n", text.strip()):
        words = ""
        for line in (line.strip() for line in part.split("\n")):
            words += ("<br>" if re.match(r"[\w*]+(, [\w*]+)*: ", line) and words else " ") + re.sub(r"`([^`]*)`", r"<code>\1</code>", escape(line, quote=False))
        paragraphs.append(f"<p>{words.strip()}</p>")
    return "".join(paragraphs)


def class_text(name, node, docs):
    begin = next((f for f in node.body if isinstance(f, ast.FunctionDef) and f.name == "__init__"), None)
    lines = [signature(head(begin, name, own=True) if begin else f"class {name}"), "", block(docs[name])]
    values = [f.target.id for f in node.body if isinstance(f, ast.AnnAssign)]
    values += [f.name for f in node.body if isinstance(f, ast.FunctionDef) and decorated(f, "property")]
    told = {v: " ".join(docs[f"{name}.{v}"].split()) for v in values if f"{name}.{v}" in docs}
    if told:
        lines += ["", "| attribute | |", "|---|---|"] + [f"| `{v}` | {told[v].replace('|', '&#124;')} |" for v in told]
    if plain := [f"`{v}`" for v in values if v not in told]:
        lines += ["", ("Further attributes: " if told else "Attributes: ") + ", ".join(plain) + "."]
    for f in node.body:
        if isinstance(f, ast.FunctionDef) and not f.name.startswith("_") and not decorated(f, "property"):
            lines += ["", signature(head(f, f"{name}.{f.name}", own=True))]
            if f"{name}.{f.name}" in docs:
                lines += ["", block(docs[f"{name}.{f.name}"])]
    return lines


def page(root):
    folder = root / PACKAGE
    docs = {**bound(folder), **documented(folder)}
    functions, classes = signatures(folder)
    public = set(ast.literal_eval(next(node.value for node in ast.parse((folder / "__init__.py").read_text()).body
                                       if isinstance(node, ast.Assign) and node.targets[0].id == "__all__")))
    shown = {name for _, names in GROUPS for name in names}
    if public - shown:
        raise Missing(f"{sorted(public - shown)} stand in no group of python_reference.py")
    lines = []
    for title, names in GROUPS:
        lines += ["", f"## {title}", ""]
        for name in names:
            lines += ["", f"### {name}", ""]
            if name in VALUES:
                lines.append(VALUES[name])
            elif name not in docs:
                raise Missing(f"pdepth.{name} has no docstring")
            elif name in functions:
                lines += [signature(head(functions[name], f"pdepth.{name}")), "", block(docs[name])]
            else:
                lines += class_text(name, classes[name], docs)
    return "\n".join(lines)
