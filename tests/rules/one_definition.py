#!/usr/bin/env python3
"""Names that stand for two things in one namespace.

Two translation units may each define a type or an inline function `pd::detail::Edge`, and the linker takes the code of
one of them for both without a word. This test reads every header and source and refuses a second definition with the
same namespace and name (and, for functions, the same parameters), unless both stand in one file.

usage: one_definition.py ROOT
"""
import collections
import pathlib
import re
import sys

FOLDERS = ("pd_core", "engine_glue", "render", "demos", "tests")
TOKEN = re.compile(r"[A-Za-z_]\w*|::|[{}();=<>,&*\[\]]|\S")


def without_text(source):
    """The source without comments, literals, preprocessor lines and attributes."""
    source = re.sub(r'R"(\w*)\((?:.|\n)*?\)\1"', '""', source)
    source = re.sub(r"//[^\n]*|/\*(?:.|\n)*?\*/", " ", source)
    source = re.sub(r'"(?:\\.|[^"\\\n])*"', '""', source)
    source = re.sub(r"(?<![0-9a-fA-F])'(?:\\.|[^'\\\n])+'", "0", source)
    source = re.sub(r"(?<=[0-9a-fA-F])'(?=[0-9a-fA-F])", "", source)
    source = re.sub(r"^[ \t]*#(?:[^\n\\]|\\\n|\\.)*", "", source, flags=re.M)
    return re.sub(r"\[\[(?:[^\]])*\]\]", " ", source)


def matching(tokens, at, opening, closing):
    depth = 0
    while at < len(tokens):
        depth += (tokens[at] == opening) - (tokens[at] == closing)
        if depth == 0:
            return at
        at += 1
    return at


def statement(tokens, at):
    """The tokens up to the body or the end of a declaration, and where that stands."""
    head = []
    while at < len(tokens) and tokens[at] not in "{;}":
        if tokens[at] == "(":
            close = matching(tokens, at, "(", ")")
            head += tokens[at:close + 1]
            at = close + 1
        else:
            head.append(tokens[at])
            at += 1
    return head, at


def definition(head):
    """Kind and name of what a head with a body defines, or None."""
    while head[:1] == ["template"]:
        depth, at = 0, 1
        while at < len(head):
            depth += (head[at] == "<") - (head[at] == ">")
            at += 1
            if depth == 0:
                break
        head = head[at:]
    if head[:1] and head[0] in ("struct", "class", "union", "enum"):
        rest = [t for t in head[1:] if t not in ("class", "struct", "final", "alignas")]
        if rest and "(" not in head and (len(rest) == 1 or rest[1] in (":", "<")):
            special = "<" in rest[1:2]
            return None if special else ("type", rest[0])
        if "(" not in head:
            return None
    if "(" in head and "=" not in head[:head.index("(")]:
        at = head.index("(")
        if at == 0 or not re.match(r"[A-Za-z_]\w*$", head[at - 1]) or "::" in head[:at][-2:-1] or "operator" in head:
            return None
        close = matching(head, at, "(", ")")
        return ("function", head[at - 1] + " ".join(parameters(head[at + 1:close])))
    return None


def parameters(tokens):
    """The types of the parameters: names and default values are left out."""
    types, depth, one = [], 0, []
    for t in tokens + [","]:
        depth += (t in "<([{") - (t in ">)]}")
        if t == "," and depth == 0:
            if "=" in one:
                one = one[:one.index("=")]
            if len(one) > 1 and re.match(r"[A-Za-z_]\w*$", one[-1]) and one[-2] != "::" and one[-2] != "const":
                one = one[:-1]
            types.append("".join(one))
            one = []
        else:
            one.append(t)
    return types


def definitions(path):
    tokens = TOKEN.findall(without_text(path.read_text(encoding="utf-8")))
    found, spaces, at = [], [], 0
    while at < len(tokens):
        if tokens[at] == "}":
            if spaces:
                spaces.pop()
            at += 1
            continue
        if tokens[at] == ";":
            at += 1
            continue
        if tokens[at] in ("namespace", "inline") and "namespace" in tokens[at:at + 2]:
            brace = tokens.index("{", at) if "{" in tokens[at:] else len(tokens)
            name = tokens[at:brace]
            if "=" in name or ";" in name:
                at = tokens.index(";", at) + 1
                continue
            name = name[name.index("namespace") + 1:]
            spaces.append("".join(name))
            at = brace + 1
            continue
        if tokens[at] == "extern" and tokens[at + 1:at + 4] == ['"', '"', "{"]:
            spaces.append("")
            at += 4
            continue
        head, end = statement(tokens, at)
        if end < len(tokens) and tokens[end] == "{":
            what = definition(head)
            anonymous = "" in spaces or head[:1] == ["static"]
            if what and not anonymous:
                found.append(("::".join(spaces),) + what)
            close = matching(tokens, end, "{", "}")
            at = close + 1
        else:
            at = end + (end < len(tokens) and tokens[end] == ";")
            if not head and at == end:
                at += 1
    return found


def main():
    root = pathlib.Path(sys.argv[1])
    where = collections.defaultdict(set)
    files = 0
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in (".hpp", ".cpp", ".h") and path.is_file():
                files += 1
                for name in definitions(path):
                    where[name].add(str(path.relative_to(root)))
    entries = ("main", "LLVMFuzzerTestOneInput")  # of programs, one each
    twice = {n: p for n, p in where.items() if len(p) > 1 and not n[2].startswith(entries)}
    for (space, kind, name), paths in sorted(twice.items()):
        print(f"{space}::{name} is a {kind} of {' and of '.join(sorted(paths))}")
    if len(where) < 1000:
        print(f"only {len(where)} definitions were found in {files} files: the reader of this test is broken")
        return 1
    print(f"{len(where)} definitions in {files} files, {len(twice)} of them twice")
    return 1 if twice else 0


if __name__ == "__main__":
    sys.exit(main())
