"""A table of a page as a chart, drawn when the site is built, so that figures stand in one place.

    <!-- chart lines WORDS -->   after a table: both axes logarithmic, the first column along x, a line for each further column
    <!-- chart bars WORDS -->    after a table: a bar for each number, rows by the first column
    <!-- chart ratios WORDS -->  the same with a line at 1

WORDS name the axis of the figures. A cell that is not a number leaves a gap. Colours follow the page, light or dark.
"""
import math
import re
from html import escape

# Told apart by eyes that do not tell red from green.
COLOURS = ("#3b7dd8", "#e08a1e", "#2a9d6f", "#a05bb0", "#c0504d")
WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 680, 330, 64, 16, 34, 46
TABLE = re.compile(r"((?:^\|.*\|\n)+)\n<!-- chart (lines|bars|ratios) (.+?) -->$", re.M)


def number(cell):
    text = cell.replace(",", "").replace("*", "").strip()
    try:
        return float(text)
    except ValueError:
        return None


def rows_of(table):
    rows = [[cell.strip() for cell in line.strip().strip("|").split("|")] for line in table.strip().split("\n")]
    return rows[0], [row for row in rows[2:]]


def text(x, y, words, anchor="middle", extra=""):
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}"{extra}>{escape(words)}</text>'


def line(x1, y1, x2, y2, css):
    return f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" class="{css}"/>'


def ticks(low, high):
    """Powers of ten in the range; with 2 and 5 between them where these are few."""
    steps = (1,) if high / low > 1e4 else (1, 2, 5)
    first, last = math.floor(math.log10(low)), math.ceil(math.log10(high))
    return [s * 10.0**e for e in range(first, last + 1) for s in steps if low * 0.999 <= s * 10.0**e <= high * 1.001]


class Scale:
    def __init__(self, values, begin, end, logarithmic):
        self.log, self.begin, self.end = logarithmic, begin, end
        if logarithmic:
            self.low, self.high = min(values) / 1.25, max(values) * 1.25
        else:
            self.low, self.high = min(0.0, *values), max(values) * 1.08

    def __call__(self, value):
        change = math.log if self.log else float
        share = (change(value) - change(self.low)) / (change(self.high) - change(self.low))
        return self.begin + share * (self.end - self.begin)

    def ticks(self):
        if self.log:
            return ticks(self.low, self.high)
        step = 10 ** math.floor(math.log10(self.high))
        step = next(step * part for part in (0.1, 0.2, 0.25, 0.5, 1) if self.high / (step * part) <= 8)
        return [k * step for k in range(int(self.high / step) + 1)]


def legend(names):
    parts, x = [], LEFT
    for name, colour in zip(names, COLOURS):
        parts.append(f'<rect x="{x}" y="10" width="12" height="12" fill="{colour}"/>' + text(x + 17, 20, name, "start"))
        x += 30 + 7 * len(name)
    return "".join(parts)


def frame(parts, names, what, height):
    return (f'<figure class="pd-chart"><svg viewBox="0 0 {WIDTH} {height:g}" role="img" aria-label="{escape(what)}: {escape(", ".join(names))}">'
            + legend(names) + "".join(parts) + "</svg></figure>")


def lines(head, rows, words):
    cells = [[number(cell) for cell in row] for row in rows]
    x = Scale([row[0] for row in cells], LEFT + 8, WIDTH - RIGHT, True)
    y = Scale([value for row in cells for value in row[1:] if value], HEIGHT - BOTTOM, TOP, True)
    parts = [line(LEFT, y(v), WIDTH - RIGHT, y(v), "grid") + text(LEFT - 6, y(v) + 4, f"{v:g}", "end") for v in y.ticks()]
    parts += [text(x(row[0]), HEIGHT - BOTTOM + 18, rows[k][0]) for k, row in enumerate(cells)]
    parts.append(text((LEFT + WIDTH) / 2, HEIGHT - 8, head[0]))
    for column in range(1, len(head)):
        points = [(x(row[0]), y(row[column])) for row in cells if row[column]]
        path = " ".join(f"{a:.1f},{b:.1f}" for a, b in points)
        colour = COLOURS[(column - 1) % len(COLOURS)]
        parts.append(f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="2"/>')
        parts += [f'<circle cx="{a:.1f}" cy="{b:.1f}" r="3.5" fill="{colour}"/>' for a, b in points]
    middle = (TOP + HEIGHT - BOTTOM) / 2
    parts.append(text(14, middle, words, extra=f' transform="rotate(-90 14 {middle})"'))
    return frame(parts, head[1:], f"lines of {words}", HEIGHT)


def bars(head, rows, words, line_at_one=False):
    """Bars lie, so that their names may be long."""
    cells = [[number(cell) for cell in row[1:]] for row in rows]
    columns = len(head) - 1
    left, tall = 12 + 7.1 * max(len(row[0]) for row in rows), 11
    step = tall * columns + 9
    bottom = TOP + step * len(rows)
    x = Scale([value for row in cells for value in row if value], left, WIDTH - 50, False)
    parts = [line(x(v), TOP, x(v), bottom, "grid") + text(x(v), bottom + 16, f"{v:g}") for v in x.ticks()]
    for k, row in enumerate(cells):
        y = TOP + step * k + 5
        parts.append(text(left - 8, y + tall * columns / 2 + 4, rows[k][0], "end"))
        for c, value in enumerate(row):
            if value is None:
                continue
            begin, end = sorted((x(0), x(value)))
            parts.append(f'<rect x="{begin:.1f}" y="{y + c * tall:.1f}" width="{max(end - begin, 1):.1f}" height="{tall - 1}" '
                         f'fill="{COLOURS[c % len(COLOURS)]}"/>' + text(end + 4, y + c * tall + 9.5, rows[k][c + 1], "start", ' font-size="10"'))
    if line_at_one:
        parts.append(line(x(1), TOP, x(1), bottom, "one"))
    parts.append(text((left + WIDTH) / 2, bottom + 34, words))
    return frame(parts, head[1:], f"bars of {words}", bottom + 42)


def with_charts(markdown):
    def drawn(match):
        table, kind, words = match.groups()
        head, rows = rows_of(table)
        return f"{table}\n{lines(head, rows, words) if kind == 'lines' else bars(head, rows, words, kind == 'ratios')}"

    return TABLE.sub(drawn, markdown)
