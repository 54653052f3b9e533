"""The JSON Schema that `pdepth query --schema` prints, against the program itself.

    schema.py PDEPTH PROJECT

Every line of the corpus and its answer is valid. A line without a field that pdepth misses, or with one that pdepth does not know, is
not. Every query, every word of a refusal and every kind of line of a record is there.
"""

import json
import re
import subprocess
import sys
from pathlib import Path

try:
    import jsonschema
except ImportError:
    print("python3-jsonschema is not installed")
    sys.exit(0)

PROGRAM, PROJECT = sys.argv[1], Path(sys.argv[2])
faults = []


def expect(holds, words):
    if not holds:
        faults.append(words)


def run(*arguments, text=""):
    return subprocess.run([PROGRAM, *arguments], input=text, capture_output=True, text=True, check=True).stdout


SCHEMA = json.loads(run("query", "--schema"))


def validator(name):
    return jsonschema.Draft202012Validator({"$ref": "#/$defs/" + name, "$defs": SCHEMA["$defs"]})


def errors(name, value):
    return "; ".join(error.message[:200] for error in validator(name).iter_errors(value))


def answers(lines):
    return [json.loads(text) for text in run("query", text="".join(json.dumps(line) + "\n" for line in lines)).splitlines()]


def check_lines(lines):
    for line, answer in zip(lines, answers(lines)):
        name = line["query"]
        for kind, value in ((f"line.{name}", line), ("line", line)):
            expect(not errors(kind, value), f"{kind}: {errors(kind, value)}: {line}")
        kind = "error" if "error" in answer else f"answer.{name}"
        expect(not errors(kind, answer), f"{kind}: {errors(kind, answer)}: {answer}")


def check_spoilt(lines):
    spoilt = [({key: value for key, value in line.items() if key != name}, name) for line in lines for name in line if name != "query"]
    for (line, name), answer in zip(spoilt, answers([line for line, _ in spoilt])):
        missed = answer.get("error", {}).get("code") == "missing_field"
        valid = not errors("line." + line["query"], line)
        expect(valid != missed, f"without {name}: {'missed' if missed else 'answered'}, valid: {valid}: {line}")
    unknown = [{**line, "surprise": 1} for line in lines]
    for line, answer in zip(unknown, answers(unknown)):
        expect(answer["error"]["code"] == "bad_value", f"answered: {line}")
        expect(errors("line", line), f"valid with an unknown field: {line}")


def check_names():
    listed = {words.split()[0] for words in run("query", "--list").splitlines()}
    for kind in ("line.", "answer."):
        expect(listed == {name[len(kind):] for name in SCHEMA["$defs"] if name.startswith(kind)}, f"the queries of {kind}: {listed}")
    codes = {entry["const"] for entry in SCHEMA["$defs"]["error_code"]["oneOf"]}
    sources = [PROJECT / "pd_core/include/pd/numeric/expected.hpp", *(PROJECT / "demos/protocol").glob("*.cpp")]
    enum = re.search(r"enum class ErrorCode \{(.*?)\}", sources[0].read_text(), re.S)[1]
    said = set(re.findall(r"(\w+),", enum))
    for source in sources[1:]:
        said |= set(re.findall(r'refuse\("(\w+)"', source.read_text()))
    expect(said <= codes, f"error codes without a meaning: {said - codes}")
    page = (PROJECT / "pd_core/docs/pages/protocol.md").read_text()
    expect(all(code in page for code in codes), f"not in protocol.md: {[code for code in codes if code not in page]}")


def check_records():
    for line in (PROJECT / "tests/corpus/accuracy_cases.jsonl").read_text().splitlines():
        expect(not errors("record", json.loads(line)), f"record: {errors('record', json.loads(line))}: {line[:300]}")
    expect(errors("record", {"contact": 1, "a": "s1", "b": "s2"}), "a contact without a report is valid")


corpus = [json.loads(line) for line in (PROJECT / "tests/corpus/protocol_lines.jsonl").read_text().splitlines()]
regressions = [json.loads(line)["line"] for line in (PROJECT / "tests/corpus/queries.jsonl").read_text().splitlines() if line]
check_lines(corpus + regressions)
check_spoilt(corpus)
check_names()
check_records()
print("\n".join(faults) or f"{len(corpus) + len(regressions)} lines agree with the schema")
sys.exit(1 if faults else 0)
