"""One source for each text: pages of the site take theirs from the READMEs, and links follow.

A line of its own in a page:
    {{ include FILE }}            the file, from the project's root, without its first heading
    {{ include FILE # HEADING }}  one section of it, without its heading
    {{ opening FILE }}            what stands between its first heading and its first section
    {{ code FILE }}               the file as a block of code
Links to files of the project become links to the page that shows the file, pictures come along, and what no page shows
is named instead of linked. A link to nothing ends the build.
"""
import os
import posixpath
import re
from pathlib import Path

from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File

ROOT = Path(__file__).resolve().parents[2]
# Which page shows a file.
SHOWN = {
    "README.md": "index.md",
    "engine_glue/README.md": "bullet.md",
    "demos/audit/README.md": "accuracy.md",
    "demos/python/README.md": "python.md",
    "pd_core/README.md": "papers.md",
    "pd_core/docs/one_query.md": "one_query.md",
    "pd_core/docs/search_trace.md": "search_trace.md",
}
# Pages whose file need not be there: a part of the project that was left out.
OPTIONAL = {"python.md": "demos/python/README.md"}
DIRECTIVE = re.compile(r"^\{\{ (include|opening|code) ([^#}]+?)(?: # ([^}]+?))? \}\}$", re.M)
LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^)\s]+)\)")
FENCE = re.compile(r"^(```.*?^```$)", re.M | re.S)


def left_out():
    return {page for page, source in OPTIONAL.items() if not (ROOT / source).exists()}


def on_config(config):
    gone = left_out()
    config["nav"] = [entry for entry in config["nav"] if not gone.intersection(entry.values())]
    return config


def on_files(files, config):
    for name in left_out():
        page = files.get_file_from_path(name)
        if page:
            files.remove(page)
    for picture in sorted((ROOT / "demos/pictures").glob("*.png")):
        path = picture.relative_to(ROOT).as_posix()
        files.append(File(path, str(ROOT), config["site_dir"], config["use_directory_urls"]))
    return files


def outside_code(text, change):
    """The text with `change` applied to what is not in a fenced block."""
    parts = FENCE.split(text)
    return "".join(part if i % 2 else change(part) for i, part in enumerate(parts))


def section_of(text, heading, name):
    lines, kept, depth, fenced = text.split("\n"), [], 0, False
    for line in lines:
        fenced ^= line.startswith("```")
        found = None if fenced else re.match(r"(#+) (.*)", line)
        if depth and found and len(found[1]) <= depth:
            break
        if depth:
            kept.append(line)
        elif found and found[2] == heading:
            depth = len(found[1])
    if not depth:
        raise PluginError(f"{name} has no section '{heading}'")
    return "\n".join(kept)


def linked_from(text, folder, page):
    """Links of a text that stands in a folder of the project, as links of a page."""

    def replaced(match):
        picture, words, target = match.groups()
        if re.match(r"[a-z]+:|#", target):
            return match[0]
        path, _, anchor = target.partition("#")
        path = posixpath.normpath(posixpath.join(folder, path))
        if not (ROOT / path).exists():
            raise PluginError(f"{page}: {target} names nothing (looked for {path})")
        if picture:
            return f"![{words}]({path})"
        if path in SHOWN and SHOWN[path] not in left_out():
            return f"[{words}]({SHOWN[path]}{'#' + anchor if anchor else ''})"
        return words if words.strip("`") == path else f"{words} (`{path}`)"

    return outside_code(text, lambda part: LINK.sub(replaced, part))


def on_page_markdown(markdown, page, config, files):
    def expanded(match):
        kind, name, heading = match.groups()
        source = ROOT / name
        if not source.exists():
            raise PluginError(f"{page.file.src_path}: there is no {name}")
        text = source.read_text()
        if kind == "code":
            language = {".cpp": "cpp", ".h": "c", ".py": "python"}[source.suffix]
            return f"```{language}\n{text.rstrip()}\n```"
        if heading:
            text = section_of(text, heading, name)
        else:
            text = re.sub(r"\A# .*\n", "", text)
        if kind == "opening":
            text = re.split(r"^## ", text, flags=re.M)[0]
        return linked_from(text, os.path.dirname(name), page.file.src_path)

    return DIRECTIVE.sub(expanded, markdown)
