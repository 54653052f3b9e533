"""Places of the core that can be changed, and a sample of them."""

import dataclasses
import pathlib
import re

CORE = pathlib.Path("pd_core/src")
INCLUDE = re.compile(r'#include "([\w/]+\.hpp)"')

OPERATOR = re.compile(r"(?<=\S) (<=|>=|==|!=|<|>|\+|-|\*|/)(?= |$)")
CONSTANT = re.compile(r"(?<![\w:.])((?:detail::)?k[A-Z]\w*)\b(?!\s*[=({\[<:])")
# Factors that cover the rounding of a bound itself: 2^-50 of it, which no answer could show.
SLACK = re.compile(r"\(1 \+ \d+ \* (?:detail::)?kUnitRoundoff\)")
# What a line that declares, includes or asserts says is no decision of the running program.
NO_CODE = re.compile(r"^\s*(#|//|template|using|static_assert|enum|namespace|requires|\*|PD_ASSERT|constexpr|static constexpr|"
                     r"inline constexpr)|operator")
FLIPS = {"<": ["<=", ">="], "<=": ["<", ">"], ">": [">=", "<="], ">=": [">", "<"], "==": ["!="], "!=": ["=="],
         "+": ["-"], "-": ["+"], "*": ["/"], "/": ["*"]}
# Share of each kind among the mutants; where a room has too few of one, comparisons make up for it.
KINDS = {"error bound": 0.3, "share or limit": 0.1, "arithmetic": 0.2, "comparison": 0.4}


@dataclasses.dataclass
class Mutant:
    kind: str
    path: pathlib.Path
    line: int  # from 0
    start: int
    was: str
    to: str  # an operator, or the factor of a constant
    text: str
    id: int = 0

    def is_constant(self):
        return self.kind in ("error bound", "share or limit")

    def room(self):
        return self.path.parts[2]

    def place(self):
        return f"{self.path.relative_to(CORE)}:{self.line + 1}"

    def change(self):
        return f"{self.was} -> {self.to}{' x' if self.is_constant() else ''}"

    def key(self):
        return (str(self.path), str(self.line + 1), str(self.start), self.was, self.to)


def values_of_constants(texts):
    """Values of the constants declared as double, as far as plain arithmetic gives them; by name, the last of its name."""
    values = {}
    declared = {}
    for text in texts.values():
        declared.update(re.findall(r"constexpr double (k\w+) = ([^;{]+);", text))
    for _ in range(3):  # constants of constants
        for name, expression in declared.items():
            plain = re.sub(r"0x[0-9a-fA-F.]+p[+-]?\d+", lambda m: repr(float.fromhex(m.group(0))), expression)
            plain = re.sub(r"(?:detail::)?(k[A-Z]\w*)", lambda m: repr(values.get(m.group(1), m.group(1))), plain)
            if re.fullmatch(r"[\d.e+\-*/ ()]+", plain):
                values[name] = eval(plain)  # pylint: disable=eval-used
    return values


def mutants_of(texts, values):
    found = {kind: [] for kind in KINDS}
    for path, text in sorted(texts.items()):
        for number, line in enumerate(text.splitlines()):
            code = line.split("//")[0].rstrip()
            if NO_CODE.search(code) or '"' in code or "[[" in code:
                continue
            for m in OPERATOR.finditer(code):
                kind = "comparison" if m.group(1) in "<=>=!=" else "arithmetic"
                found[kind] += [Mutant(kind, path, number, m.start(1), m.group(1), to, line.strip()) for to in FLIPS[m.group(1)]]
            for m in CONSTANT.finditer(SLACK.sub(lambda m: " " * len(m.group(0)), code)):
                value = values.get(m.group(1).removeprefix("detail::"))
                if value is not None:
                    # Roundings of any length; what is smaller stands for underflow, what is larger for a choice.
                    kind = "error bound" if 1e-35 < abs(value) < 1e-10 else "share or limit"
                    found[kind] += [Mutant(kind, path, number, m.start(1), m.group(1), to, line.strip()) for to in ("0", "0.01")]
    return found


def draw_files(found, count, dice):
    """Draws `count` files, each by the number of its places, error bounds counting ten times."""
    weights = {}
    for kind, pool in found.items():
        for mutant in pool:
            weights[mutant.path] = weights.get(mutant.path, 0) + (10 if kind == "error bound" else 1)
    # The greatest u^(1/w) are a sample without replacement (Efraimidis and Spirakis, 2006).
    return set(sorted(weights, key=lambda path: dice.random() ** (1 / weights[path]))[-count:])


def draw(found, counts, share_of_files, dice):
    """Draws `counts[room]` mutants in each room, at most one a line and kind, in few files: each is compiled anew."""
    drawn = []
    for room, count in counts.items():
        here = {kind: [m for m in pool if m.room() == room] for kind, pool in found.items()}
        files = draw_files(here, max(1, round(count * share_of_files)), dice)
        taken = {}
        for kind, share in KINDS.items():
            pool = [m for m in here[kind] if m.path in files]
            dice.shuffle(pool)
            wanted = count if kind == "comparison" else len(taken) + round(share * count)
            for mutant in pool:
                if len(taken) < wanted:
                    taken.setdefault((mutant.path, mutant.line, kind), mutant)
        drawn += taken.values()
    for number, mutant in enumerate(drawn, 1):
        mutant.id = number
    return drawn


def sources_that_see(texts):
    """How many sources each file is compiled in, by the includes between the files of the core's src."""
    reached = {}
    for source in texts:
        if source.suffix == ".cpp":
            seen, queue = set(), [source]
            while queue:
                path = queue.pop()
                if path in seen or path not in texts:
                    continue
                seen.add(path)
                queue += [CORE / name for name in INCLUDE.findall(texts[path])]
            for path in seen:
                reached[path] = reached.get(path, 0) + 1
    return reached
