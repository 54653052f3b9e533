"""Checks a built site: `check_site.py FOLDER`. Every link, picture, style and script of every page names a file that is
there, every anchor an element of its page; nothing but links that a reader clicks leads to another host, and no style
asks for a font of the web. No chart of a page is left undrawn.
"""
import re
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


class Page(HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.links, self.ids = [], set()
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        for key, value in attributes:
            if key in ("id", "name") and value:
                self.ids.add(value)
            elif key in ("href", "src") and value is not None:
                self.links.append((tag, value))


def check_link(root, pages, path, tag, link):
    parts = urlsplit(link)
    if parts.scheme in ("data", "mailto"):
        return None
    if parts.scheme or parts.netloc:
        return None if tag == "a" else f"<{tag}> loads {link}"
    target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
    if target.is_dir():
        target = target / "index.html"
    if not target.is_relative_to(root) or not target.exists():
        return f"{link} names nothing"
    if parts.fragment and target in pages and unquote(parts.fragment) not in pages[target].ids:
        return f"{link}: no such place on that page"
    return None


def main(root):
    # Doxygen's pages link each other rightly; they are looked at as the targets of links alone.
    texts = {path: path.read_text() for path in sorted(root.rglob("*.html")) if root / "api" not in path.parents}
    pages = {path: Page(text) for path, text in texts.items()}
    complaints, links = [], 0
    for path, page in pages.items():
        if path.name == "404.html":  # its links stand for any depth
            continue
        if "<!-- chart" in texts[path]:
            complaints.append(f"{path.name}: a chart that nobody drew")
        for tag, link in page.links:
            links += 1
            complaint = check_link(root, pages, path, tag, link)
            if complaint:
                complaints.append(f"{path.name}: {complaint}")
    for style in root.rglob("*.css"):
        for address in re.findall(r"(?:url\(|@import\s+)[\"']?(https?:[^\"')]+)", style.read_text()):
            complaints.append(f"{style.name}: asks for {address}")
    print("\n".join(complaints))
    print(f"{len(pages)} pages, {links} links, {len(complaints)} complaints")
    return 1 if complaints or len(pages) < 10 else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve()))
