"""Holds documents to the files that they name: `check_paths.py ROOT`.

Every relative link leads to a file that is there, and to a heading of it. In the maps of the core every source that is named lies where
the map says: below the page's bases, or, where a cell names it without a folder, beside the file that the cell named before.
"""
import posixpath
import re
import subprocess
import sys
from pathlib import Path

MAPS = ("pd_core/README.md", "pd_core/docs/algorithms.md", "pd_core/docs/departures.md", "pd_core/docs/one_query.md")
BASES = ("", "pd_core/", "pd_core/include/pd/", "pd_core/src/", "tests/")
FENCE = re.compile(r"^```.*?^```", re.M | re.S)
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)(?: \"[^\"]*\")?\)")
SOURCE = re.compile(r"`((?:[a-z_0-9.]+/)*[a-z_0-9]+\.[hc]pp)`")


def anchors(text):
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in re.findall(r"^#+ (.*)", FENCE.sub("", text), re.M)}


def dead_links(root, name, text):
    for target in LINK.findall(FENCE.sub("", text)):
        path, _, anchor = target.partition("#")
        if re.match(r"[a-z]+:", target):
            continue
        file = root / posixpath.normpath(posixpath.join(posixpath.dirname(name), path)) if path else root / name
        if not file.exists():
            yield f"{target} names nothing"
        elif anchor and file.suffix == ".md" and anchor not in anchors(file.read_text()):
            yield f"{target}: no such heading"


def lost_sources(files, text):
    for cell in re.split(r" \| |\n\n", FENCE.sub("", text)):
        folder = ""
        for named in SOURCE.findall(cell):
            path = posixpath.normpath(posixpath.join("pd_core", named)) if named.startswith("../") else named
            if "/" in path:
                folder = posixpath.dirname(path)
            beside = posixpath.join(folder, posixpath.basename(path))
            if not (any(base + beside in files for base in BASES) if folder else any(file.endswith("/" + path) for file in files)):
                yield f"{named} does not lie there"


def main(root):
    files = set(subprocess.run(["git", "-c", f"safe.directory={root}", "-C", str(root), "ls-files"], capture_output=True, text=True,
                               check=True).stdout.split("\n"))
    pages = sorted(file for file in files if file.endswith(".md"))
    complaints = 0
    for name in pages:
        text = (root / name).read_text()
        for complaint in [*dead_links(root, name, text), *(lost_sources(files, text) if name in MAPS else ())]:
            complaints += 1
            print(f"{name}: {complaint}")
    print(f"{len(pages)} documents, {complaints} complaints")
    return 0 if pages and not complaints else 1


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve()))
