"""A worktree whose core holds all mutants in one build."""

import os
import pathlib
import re
import shutil
import subprocess
import sys

from .places import CORE

# PD_MUTANT: the mutant that is on, 0 for none; -1 turns none on and notes those that would have changed a value, whose numbers
# are added to the file PD_MUTANT_REACHED when the program ends.
HEADER = """#pragma once
#include <cstdio>
#include <cstdlib>
#include <type_traits>
#include <utility>
namespace pd::mutant {{
inline const int active = [] {{ const char* s = std::getenv("PD_MUTANT"); return s ? std::atoi(s) : 0; }}();
struct Reached {{
  volatile bool by[{count} + 1] = {{}};
  ~Reached() {{
    const char* name = active < 0 ? std::getenv("PD_MUTANT_REACHED") : nullptr;
    std::FILE* file = name ? std::fopen(name, "a") : nullptr;
    if (!file) return;
    for (int id = 1; id <= {count}; ++id) if (by[id]) std::fprintf(file, "%d\\n", id);
    std::fclose(file);
  }}
}};
inline Reached reached;
template <int Id> constexpr bool on() {{ return !std::is_constant_evaluated() && active == Id; }}
template <class Site, class A> struct Half {{ A&& a; }};
template <int Id, class Was, class To> void note(const Was& was, const To& to) {{
  // Of bits that are not NaN: a NaN counts as changed.
  if constexpr (std::is_arithmetic_v<Was> && std::is_arithmetic_v<To>) {{
    if (was != to) reached.by[Id] = true;
  }} else {{
    reached.by[Id] = true;
  }}
}}
template <int Id> constexpr double scaled(double x, double factor) {{
  if (!std::is_constant_evaluated() && active < 0) reached.by[Id] = true;
  return on<Id>() ? factor * x : x;
}}
}}  // namespace pd::mutant
"""
# The operator is written twice round an object of a type of its own: its left half holds the left operand, so that what binds
# how stays as it was. `a < b` becomes `a < Site1{} > b`.
SITE = """namespace pd::mutant {{
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wsign-compare"
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wbool-compare"
struct Site{id} {{}};
template <class A> constexpr Half<Site{id}, A> operator{left}(A&& a, Site{id}) {{ return {{std::forward<A>(a)}}; }}
template <class A, class B> constexpr auto operator{right}(Half<Site{id}, A> h, B&& b) {{
  if (!std::is_constant_evaluated() && active < 0) {noted}
  return on<{id}>() ? h.a {to} b : h.a {was} b;
}}
#pragma GCC diagnostic pop
}}  // namespace pd::mutant
"""
MIRROR = {"<": ">", ">": "<", "<=": ">=", ">=": "<="}


def rewritten(mutant):
    if mutant.is_constant():
        return f"::pd::mutant::scaled<{mutant.id}>({mutant.was}, {mutant.to})"
    return f"{mutant.was} ::pd::mutant::Site{mutant.id}{{}} {MIRROR.get(mutant.was, mutant.was)}"


def declaration(mutant):
    if mutant.is_constant():
        return ""
    # A quotient in place of a product may be one of integers by 0.
    compared = mutant.was not in "*/"
    noted = (f"note<{mutant.id}>(h.a {mutant.was} b, h.a {mutant.to} b);" if compared else f"reached.by[{mutant.id}] = true;")
    return SITE.format(id=mutant.id, left=mutant.was, right=MIRROR.get(mutant.was, mutant.was), to=mutant.to, was=mutant.was,
                       noted=noted)


def git(folder, *arguments):
    return subprocess.run(["git", *map(str, arguments)], cwd=folder, check=True, capture_output=True, text=True).stdout


def replace(path, text):
    """Leaves the time of a file alone whose text stays."""
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")


def texts_of_commit(root, commit, folder, suffixes=(".cpp", ".hpp")):
    names = [name for name in git(root, "ls-tree", "-r", "--name-only", commit, "--", folder).splitlines()
             if name.endswith(suffixes)]
    return {pathlib.Path(name): git(root, "show", f"{commit}:{name}") for name in names}


class Tree:
    """A worktree at the commit that `root` has checked out. Its core stays rewritten, so that a later call compiles little."""

    def __init__(self, root, folder):
        self.root = folder
        self.commit = git(root, "rev-parse", "--short", "HEAD").strip()
        if not folder.exists():
            git(root, "worktree", "add", "--detach", folder, self.commit)
        else:
            git(folder, "checkout", "--no-overlay", self.commit, "--", ".", f":!{CORE}")
        self.objects = folder / "build" / "release"
        self.originals = texts_of_commit(root, self.commit, CORE)

    def write(self, mutants, count):
        for path in (self.root / CORE).rglob("*.[ch]pp"):
            if path.relative_to(self.root) not in self.originals and path.name != "mutant.hpp":
                path.unlink()
        replace(self.root / CORE / "mutant.hpp", HEADER.format(count=count))
        of = {}
        for mutant in mutants:
            of.setdefault(mutant.path, []).append(mutant)
        for path, original in self.originals.items():
            replace(self.root / path, self.text_with(original, of[path]) if path in of else original)

    @staticmethod
    def text_with(original, mutants):
        lines = original.splitlines()
        for mutant in sorted(mutants, key=lambda m: (m.line, -m.start)):
            before = lines[mutant.line]
            lines[mutant.line] = before[:mutant.start] + rewritten(mutant) + before[mutant.start + len(mutant.was):]
        guard = "#pragma once\n" if "#pragma once" in lines else ""
        declarations = "".join(declaration(m) for m in mutants)
        # `a == Site{} == b` is what the warning is about.
        quiet = '#pragma GCC diagnostic ignored "-Wparentheses"\n'
        return f'{guard}#include "mutant.hpp"\n{quiet}{declarations}#line 1\n' + "\n".join(lines) + "\n"

    def environment(self):
        """By these settings the compiler cache of another build folder serves what is not mutated (debian_packages.sh)."""
        return dict(os.environ, CCACHE_SLOPPINESS="pch_defines,time_macros", CCACHE_BASEDIR=str(self.root), CCACHE_NOHASHDIR="1")

    def configure(self):
        launcher = ["-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []
        # Warnings are those of the originals; with the flags of CI the compiler cache knows what is not mutated.
        subprocess.run(["cmake", "--preset", "release", "--log-level=ERROR", *launcher, "-DPD_WARNINGS_AS_ERRORS=ON"], cwd=self.root,
                       check=True, stdout=subprocess.DEVNULL, env=self.environment())

    def build(self, jobs, targets):
        """Returns what the compiler says, or None when all is built."""
        done = subprocess.run(["cmake", "--build", self.objects, "-j", str(jobs), "--target", *targets, "--", "-k", "0"], text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False, env=self.environment())
        return None if done.returncode == 0 else done.stdout

    def compiled(self, mutants, jobs, targets):
        """Builds the programs with as many of the mutants as compile, and returns those."""
        count = max(m.id for m in mutants)
        self.write(mutants, count)
        self.configure()
        while (output := self.build(jobs, targets)) is not None:
            blamed = to_blame(output, mutants)
            if not blamed:
                sys.exit(output[-4000:] + "\nthe build fails, and not for a mutant")
            mutants = [m for m in mutants if m not in blamed]
            print(f"{len(blamed)} places do not compile otherwise: {len(mutants)} left", flush=True)
            self.write(mutants, count)
        return mutants


def to_blame(output, mutants):
    """Mutants on lines that the compiler complains about; all of the files named when none is on such a line."""
    places = set(re.findall(r"(pd_core/src/[\w/.]+?):(\d+):", output))
    lines = {(file, int(line) - 1) for file, line in places}
    blamed = [m for m in mutants if (str(m.path), m.line) in lines]
    blamed = blamed or [m for m in mutants if (str(m.path), m.line - 1) in lines or (str(m.path), m.line + 1) in lines]
    return blamed or [m for m in mutants if str(m.path) in {file for file, _ in places}]
