"""One source for each text: pages of the site take theirs from the READMEs, and links follow.

A line of its own in a page:
    {{ include FILE }}            the file, from the project's root, without its first heading
    {{ include FILE # HEADING }}  one section of it, without its heading
    {{ opening FILE }}            what stands between its first heading and its first section
    {{ code FILE }}               the file as a block of code
    {{ python reference }}        every public name of the Python package, from its docstrings
    {{ chart KIND WORDS }}        the table before it as a chart (chart.py)
In a line: {{ api WORDS }} links to the reference of the C++ headers, and {{ api WORDS # FILE.hpp }} to one header's page there.
Doxygen writes the reference into the site's folder api, where it is installed; without it the words stand alone.
Links to files of the project become links to the page that shows the file, pictures come along, and what no page shows
is named instead of linked. A link to nothing ends the build.
"""
import json
import logging
import os
import posixpath
import re
import shutil
import subprocess
import sys
from pathlib import Path

from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File
from mkdocs.structure.nav import Link

# mkdocs loads this file by its path, and leaves its neighbours where no import finds them.
sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent))
import chart  # noqa: E402
import python_reference  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
# Which page shows a file.
SHOWN = {
    "README.md": "index.md",
    "engine_glue/README.md": "bullet.md",
    "engine_glue/mujoco/README.md": "mujoco.md",
    "engine_glue/fcl/README.md": "fcl.md",
    "engine_glue/ode/README.md": "ode.md",
    "engine_glue/dart/README.md": "dart.md",
    "demos/audit/README.md": "accuracy.md",
    "demos/python/README.md": "python.md",
    "pd_core/README.md": "papers.md",
    "pd_core/docs/algorithms.md": "algorithms.md",
    "pd_core/docs/departures.md": "departures.md",
    "pd_core/docs/one_query.md": "one_query.md",
    "pd_core/docs/search_trace.md": "search_trace.md",
}
# Pages whose file need not be there: a part of the project that was left out.
OPTIONAL = {"python.md": "demos/python/README.md", "python_api.md": "demos/python/README.md"}
# The page to play with, where packaging/wasm.sh has made it.
PLAY = ROOT / "build/npm/play.html"
DOXYGEN = shutil.which("doxygen")
API = re.compile(r"\{\{ api ([^#}]+?)(?: # ([\w./]+))? \}\}")
DIRECTIVE = re.compile(r"^\{\{ (include|opening|code) ([^#}]+?)(?: # ([^}]+?))? \}\}$", re.M)
LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^)\s]+)\)")
FENCE = re.compile(r"^(```.*?^```$)", re.M | re.S)
CELL = re.compile(r"<td\b.*?</td>", re.S)
CODE = re.compile(r"<code>[^<]*</code>")


def left_out():
    return {page for page, source in OPTIONAL.items() if not (ROOT / source).exists()}


def version():
    return re.search(r"^project\(pdepth VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text(), re.M)[1]


def commit():
    if not shutil.which("git"):
        return ""
    asked = subprocess.run(["git", "-c", f"safe.directory={ROOT}", "-C", str(ROOT), "rev-parse", "--short=12", "HEAD"], capture_output=True,
                           text=True, check=False)
    return f", commit {asked.stdout.strip()}" if asked.returncode == 0 else ""


def kept(entries, gone):
    """The entries of the navigation, without the pages that are left out."""
    for entry in entries:
        (title, target), = entry.items()
        if isinstance(target, list):
            yield {title: list(kept(target, gone))}
        elif target not in gone:
            yield entry


def on_config(config):
    config["nav"] = list(kept(config["nav"], left_out()))
    config["copyright"] = f"pdepth {version()}{commit()}"
    return config


def on_files(files, config):
    for name in left_out():
        page = files.get_file_from_path(name)
        if page:
            files.remove(page)
    for picture in sorted(path for ending in ("png", "webp") for path in (ROOT / "demos/pictures").glob(f"*.{ending}")):
        path = picture.relative_to(ROOT).as_posix()
        files.append(File(path, str(ROOT), config["site_dir"], config["use_directory_urls"]))
    return files


def on_nav(nav, config, files):
    if PLAY.exists():
        nav.items.append(Link("Play with two bodies", PLAY.name))
    if DOXYGEN:
        nav.items.append(Link("Reference of the headers", "api/index.html"))
    return nav


# A page that was opened from the disk may neither fetch the index of the search nor start the theme's worker. It finds both in
# a script, as the theme allows.
SEARCH = """if (location.protocol === "file:") {
  var __search = {index: Promise.resolve(%s), worker: URL.createObjectURL(new Blob([%s]))}
}
"""


def on_post_page(output, page, config):
    before = '<script src="assets/javascripts/bundle'
    if output.count(before) != 1:
        raise PluginError(f"{page.file.src_path}: the theme starts its script otherwise, so that searching from the disk would fail")
    output = output.replace(before, '<script src="search/offline.js"></script>' + before)
    return CELL.sub(lambda cell: CODE.sub(breakable, cell[0]), output)


def breakable(code):
    """A name in a narrow column of a table: broken behind a slash or an underscore, not within a word."""
    return re.sub(r"(?<=[^</])([/_])(?=\w)", r"\1<wbr>", code[0])


def write_offline_search(site):
    worker, = (site / "assets/javascripts/workers").glob("search.*.min.js")
    index = json.dumps(json.loads((site / "search/search_index.json").read_text())).replace("</", "<\\/")
    (site / "search/offline.js").write_text(SEARCH % (index, json.dumps(worker.read_text())))


def on_post_build(config):
    write_offline_search(Path(config["site_dir"]))
    if PLAY.exists():
        shutil.copy(PLAY, config["site_dir"])
    else:
        logging.getLogger("mkdocs.hooks").info("The page to play with is left out: packaging/wasm.sh was not run")
    if not DOXYGEN:
        logging.getLogger("mkdocs.hooks").info("The reference of the C++ headers is left out: doxygen is not installed")
        return
    settings = (ROOT / "pd_core/docs/Doxyfile").read_text()
    settings += f"PROJECT_NUMBER = {version()}\nOUTPUT_DIRECTORY = \"{Path(config['site_dir']).resolve()}\"\n"
    done = subprocess.run([DOXYGEN, "-"], input=settings, cwd=ROOT, capture_output=True, text=True)
    if done.returncode or done.stderr:
        raise PluginError(f"doxygen: {done.stderr}")


def api_link(match):
    """The page that Doxygen makes of a header; a name that no public header has ends the build."""
    words, header = match.groups()
    name = (header or "").split("/")[-1]
    namesakes = [path.relative_to(ROOT).as_posix() for rooms in ("*", "engine_glue/*") for path in ROOT.glob(f"{rooms}/include/pd*/**/{name}")]
    meant = [path for path in namesakes if header and path.endswith("/" + header)]
    if header and len(meant) != 1:
        raise PluginError(f"{header} names no public header, or several: a folder before it tells which")
    if not DOXYGEN:
        return words
    # Doxygen names a page by its file, or where several have the same name by its path below their common folder, and escapes what
    # is no letter.
    page = "files" if not header else name if len(namesakes) == 1 else posixpath.relpath(meant[0], posixpath.commonpath(namesakes))
    page = page.replace("_", "__").replace(".", "_8").replace("/", "_2") + ".html"
    return f'<a href="api/{page}">{words}</a>'


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
        if re.match(r"pd_core/docs/pages/\w+\.md$", path):
            return f"[{words}]({posixpath.basename(path)}{'#' + anchor if anchor else ''})"
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
            language = {".cpp": "cpp", ".h": "c", ".py": "python", ".yml": "yaml"}[source.suffix]
            return f"```{language}\n{text.rstrip()}\n```"
        if heading:
            text = section_of(text, heading, name)
        else:
            text = re.sub(r"\A# .*\n", "", text)
        if kind == "opening":
            text = re.split(r"^## ", text, flags=re.M)[0]
        return linked_from(text, os.path.dirname(name), page.file.src_path)

    text = DIRECTIVE.sub(expanded, markdown)
    if "{{ python reference }}" in text:
        try:
            text = text.replace("{{ python reference }}", python_reference.page(ROOT))
        except python_reference.Missing as missing:
            raise PluginError(str(missing))
    text = outside_code(chart.with_charts(text), lambda part: API.sub(api_link, part))
    return text + f"\n\n<small>Source of this page: {source_of(page.file.src_path)}</small>\n"


def source_of(name):
    """The file that a reader changes to change the page."""
    shown = [file for file, page in SHOWN.items() if page == name and name != "index.md"]
    return ", ".join(f"<code>{file}</code>" for file in [f"pd_core/docs/pages/{name}", *shown])
