"""Counts what makes English hard to read, in documents, public headers and docstrings: `english.py ROOT [--list]`.

Counted are comments that begin with a word that no sentence should begin with, sentences of more than 35 words, and decimals
without a leading zero. Each count has a limit below. The limits only go down. A page that readers meet has a limit of words, too.
"""
import ast
import re
import subprocess
import sys
from pathlib import Path

LIMITS = {"openings": 0, "long sentences": 0, "decimals": 0}
# A guide is read in one sitting. Other pages of the site are guides.
PAGES = {"README.md": 1000, "engine_glue/README.md": 1800, "engine_glue/mujoco/README.md": 600, "engine_glue/fcl/README.md": 600,
         "engine_glue/ode/README.md": 600, "engine_glue/dart/README.md": 600,
         "demos/python/README.md": 1500}
GUIDES, GUIDE = "pd_core/docs/pages/", 1500
OPENING = re.compile(r"(Of|As|The same|What|Whether|Where)\b")
DECIMAL = re.compile(r"(?<![\w.\])}/*-])-?\.\d")
MARK = re.compile(r"^\s*//[/!]?<?\s?|\s+//[/!]?<\s?")
WORDS = 35


def documents(root):
    """The pages that a reader meets; the notebook, results and the changelog are records."""
    names = subprocess.run(["git", "-c", f"safe.directory={root}", "-C", str(root), "ls-files", "*.md", "*.hpp", "*.h", "demos/python/pdepth/*.py"],
                           capture_output=True, text=True, check=True).stdout.split()
    for name in names:
        record = name.startswith(("tests/", "CHANGELOG"))
        header = name.endswith((".hpp", ".h"))
        if not record and (not header or "/include/" in name):
            yield name


def comments(text):
    """The comments of a header, each as (line, text): runs of whole lines, and those behind code."""
    run, start = [], 0
    for number, line in enumerate(text.split("\n"), 1):
        whole = re.match(r"\s*//[/!]?<? ?(.*)", line)
        if whole:
            if not run:
                start = number
            run.append(whole[1])
            continue
        if run:
            yield start, "\n".join(run)
            run = []
        behind = re.search(r"[;,{}()] +///?<? (.*)", line)
        if behind:
            run, start = [behind[1]], number
    if run:
        yield start, "\n".join(run)


def docstrings(text):
    """The docstrings of a module, as (line, text); an argument on a line of its own is a paragraph."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef)) and ast.get_docstring(node):
            words = re.sub(r"\n(?=[\w*]+(?:, [\w*]+)*: )", "\n\n", ast.get_docstring(node))
            yield getattr(node, "lineno", 1), words


def prose(text):
    """The text without code, tables, formulas, links and lists' marks."""
    text = re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)
    lines = [line for line in text.split("\n") if not re.match(r"\s*(\||#|!\[|    |@file)", line)]
    text = re.sub(r"^\s*([-*]|\d+\.) ", "\n\n", "\n".join(lines), flags=re.M)
    text = re.sub(r"`[^`]*`", "Code", text)
    text = re.sub(r"\]\([^)]*\)", "]", text)
    return re.sub(r"@(param|return)\b(\[\w+\])?", "\n\n", text)


def sentences(text):
    for paragraph in re.split(r"\n\s*\n", prose(text)):
        yield from (part.strip() for part in re.split(r"(?<=[.!?:])\s+(?=[A-Z`(\[])", " ".join(paragraph.split())) if part.strip())


def findings(name, text):
    header = not name.endswith(".md")
    blocks = [(1, text)]
    if header:
        blocks = list(docstrings(text) if name.endswith(".py") else comments(text))
    for line, block in blocks:
        first = re.sub(r"^\s*@file\b\s*", "", block).lstrip()
        if header and OPENING.match(first):
            yield "openings", line, first.split("\n")[0]
        for sentence in sentences(block):
            if len(sentence.split()) > WORDS:
                yield "long sentences", line, sentence
        shown = prose(block) if header else re.sub(r"^```.*?^```|`[^`]*`", "", block, flags=re.M | re.S)
        for found in DECIMAL.finditer(shown):
            yield "decimals", line, shown[max(0, found.start() - 20):found.end() + 10].replace("\n", " ")


def main(root, listed):
    counts, words = dict.fromkeys(LIMITS, 0), 0
    for name in documents(root):
        text = (root / name).read_text()
        words += len(text.split())
        for kind, line, shown in findings(name, text):
            counts[kind] += 1
            if listed:
                print(f"{name}:{line}: {kind}: {shown}")
    over = [kind for kind in LIMITS if counts[kind] > LIMITS[kind]]
    for name in documents(root):
        limit = PAGES.get(name, GUIDE if name.startswith(GUIDES) else None)
        length = len((root / name).read_text().split())
        if limit and length > limit:
            over.append(name)
            print(f"{name}: {length} words, at most {limit}")
    for kind, count in counts.items():
        print(f"{kind}: {count}, at most {LIMITS[kind]}")
    print(f"in {words} words of documents, public headers and docstrings")
    return not over


if __name__ == "__main__":
    sys.exit(0 if main(Path(sys.argv[1]).resolve(), "--list" in sys.argv[2:]) else 1)
