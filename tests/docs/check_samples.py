"""Holds documents to programs that are compiled: `check_samples.py FOLDERS_OF_PROGRAMS -- DOCUMENTS`.

Each block marked `cpp` or `c` in a document must stand in one of the programs, word for word but for its indentation.
"""
import pathlib
import re
import sys
import textwrap

BLOCK = re.compile(r"^```(?:cpp|c)\n(.*?)^```$", re.M | re.S)
MARKED = re.compile(r"^ *(?://|/\*) \[(\w+)\](?: \*/)?\n(.*?)^ *(?://|/\*) \[/\1\](?: \*/)?$", re.M | re.S)


def main(folders, documents):
    wholes, parts = [], set()
    for folder in folders:
        for program in sorted(path for path in pathlib.Path(folder).rglob("*.c*") if path.suffix in (".c", ".cpp")):
            text = program.read_text()
            wholes.append(text)
            parts.update(textwrap.dedent(found[2]).strip() for found in MARKED.finditer(text))
    wrong = shown = 0
    for document in documents:
        for block in BLOCK.findall(pathlib.Path(document).read_text()):
            shown += 1
            sample = block.strip()
            if sample not in parts and not any(sample in whole for whole in wholes):
                wrong += 1
                print(f"{document}: no compiled program holds this sample:\n{textwrap.indent(sample, '    ')}")
    print(f"{shown} samples of {len(documents)} documents, {wrong} of them in no program")
    return wrong == 0 and shown > 0


if __name__ == "__main__":
    split = sys.argv.index("--")
    sys.exit(0 if main(sys.argv[1:split], sys.argv[split + 1:]) else 1)
