"""One source for each text: pages of the site take theirs from the READMEs, and links follow.

A page is Markdown that reads well in the repository, too. A link on a line of its own whose title is one of these words becomes, on the site:
    [words](FILE "include")            the file without its first heading
    [words](FILE#section "include")    one section of it, without its heading
    [words](FILE "opening")            what stands between its first heading and its first section
    [words](FILE "code")               the file as a block of code
    [words](FOLDER "python reference") every public name of the Python package, from its docstrings
The comment `chart KIND WORDS` behind a table draws the table as a chart (chart.py).
Links to public headers lead to the reference of the C++ headers, and a link to a folder of headers to the list of them all.
Doxygen writes the reference into the site's folder api, where it is installed; without it the words stand alone.
Links to other files of the project become links to the page that shows the file, pictures come along, and what no page shows
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
PAGES = "pd_core/docs/pages"
HEADER = re.compile(r"(?:^|/)include/(pd\w*(?:/.*)?)$")
DIRECTIVE = re.compile(r"^\[[^\]]*\]\(([^)\s#]+)(?:#([^)\s]+))? \"([^\"]*)\"\)$", re.M)
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


def api_link(words, path):
    """The page that Doxygen makes of a public header, or its list of files for a folder of headers."""
    if not DOXYGEN:
        return words
    if (ROOT / path).is_dir():
        return f'<a href="api/files.html">{words}</a>'
    name = posixpath.basename(path)
    namesakes = [found.relative_to(ROOT).as_posix() for rooms in ("*", "engine_glue/*") for found in ROOT.glob(f"{rooms}/include/pd*/**/{name}")]
    # Doxygen names a page by its file, or where several have the same name by its path below their common folder, and escapes what
    # is no letter.
    page = name if len(namesakes) == 1 else posixpath.relpath(path, posixpath.commonpath(namesakes))
    page = page.replace("_", "__").replace(".", "_8").replace("/", "_2") + ".html"
    return f'<a href="api/{page}">{words}</a>'


def outside_code(text, change):
    """The text with `change` applied to what is not in a fenced block."""
    parts = FENCE.split(text)
    return "".join(part if i % 2 else change(part) for i, part in enumerate(parts))


def anchor_of(heading):
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def section_of(text, anchor, name):
    lines, kept, depth, fenced = text.split("\n"), [], 0, False
    for line in lines:
        fenced ^= line.startswith("```")
        found = None if fenced else re.match(r"(#+) (.*)", line)
        if depth and found and len(found[1]) <= depth:
            break
        if depth:
            kept.append(line)
        elif found and anchor_of(found[2]) == anchor:
            depth = len(found[1])
    if not depth:
        raise PluginError(f"{name} has no section '{anchor}'")
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
            return f"![{words}]({path.removeprefix(f'{PAGES}/')})"
        if HEADER.search(path):
            return api_link(words, path)
        if re.match(rf"{PAGES}/\w+\.md$", path):
            return f"[{words}]({posixpath.basename(path)}{'#' + anchor if anchor else ''})"
        if path in SHOWN and SHOWN[path] not in left_out():
            return f"[{words}]({SHOWN[path]}{'#' + anchor if anchor else ''})"
        return words if words.strip("`") == path else f"{words} (`{path}`)"

    return outside_code(text, lambda part: LINK.sub(replaced, part))


def included(kind, name, anchor, page):
    """The text that stands on the site in place of a link to a file."""
    source = ROOT / name
    if not source.exists():
        raise PluginError(f"{page}: there is no {name}")
    if kind == "python reference":
        try:
            return python_reference.page(ROOT)
        except python_reference.Missing as missing:
            raise PluginError(str(missing))
    text = source.read_text()
    if kind == "code":
        language = {".cpp": "cpp", ".h": "c", ".py": "python", ".yml": "yaml"}[source.suffix]
        return f"```{language}\n{text.rstrip()}\n```"
    text = section_of(text, anchor, name) if anchor else re.sub(r"\A# .*\n", "", text)
    if kind == "opening":
        text = re.split(r"^## ", text, flags=re.M)[0]
    elif kind != "include":
        raise PluginError(f"{page}: a link may not have the title '{kind}'")
    return linked_from(text, os.path.dirname(name), page)


def on_page_markdown(markdown, page, config, files):
    name = page.file.src_path

    def expanded(match):
        path, anchor, kind = match.groups()
        return included(kind, posixpath.normpath(posixpath.join(PAGES, path)), anchor, name)

    text = DIRECTIVE.sub(expanded, linked_from(markdown, PAGES, name))
    return chart.with_charts(text) + f"\n\n<small>Source of this page: {source_of(name)}</small>\n"


def source_of(name):
    """The file that a reader changes to change the page."""
    shown = [file for file, page in SHOWN.items() if page == name and name != "index.md"]
    return ", ".join(f"<code>{file}</code>" for file in [f"{PAGES}/{name}", *shown])
