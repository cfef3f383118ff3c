#!/usr/bin/python3
"""Writes docs/constants.md: the parameters whose alternatives are measured, with the measurement.

usage: tools/docs/constants.py            writes docs/constants.md
       tools/docs/constants.py --check    changes nothing; exit 1 when the page is stale or a number has no comment

Measurements come from data/constants/sensitivity.csv. Names, values and meanings come from the sources: the fields of
structs *Params and the constants k* of the folders below. Every other number of these folders states its reason in the
comment at its definition, so the check requires a comment.
"""
import argparse
import collections
import csv
import difflib
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
TABLE, MEASURED = ROOT / "docs/constants.md", ROOT / "data/constants/sensitivity.csv"
FILES = ["mesh/core/quality_target.h"]
FOLDERS = ["body", "mesh/classification", "mesh/fast", "mesh/implicit", "pipeline/domain", "pipeline/meshing", "pipeline/stages",
           "reconstruct/cloud", "reconstruct/triangles", "reconstruct/winding", "reconstruct/solve"]
# Numbers that decide nothing about results: markers, units, indices, sizes of blocks.
SELF_EXPLANATORY = {"kInfinity", "kNaN", "kNone", "kAny", "kNoSpacing", "kLeafSize", "kInPlane", "kUpward", "kTriangles", "kListed", "kRoundedUp",
                    "kQuadricCoefficients", "kCells", "kChunk", "kStride", "kNodes", "kEdge", "kReached", "kUsed", "kHalf", "kAround", "kPad", "kWords"}
COMMAND = "build/release/tools/sensitivity > data/constants/sensitivity.csv"
UNITS = {"failed": "bodies without a mesh, share", "left": "tets that smoothing leaves below the target, in 10^5 at the boundary",
         "below": "the same after repair", "least_q": "min Q", "quantile": "1 % quantile of Q",
         "misaligned": "boundary faces more than 60 degrees from psi = 0, in 10^5", "folded_over": "more than 90 degrees",
         "not_manifold": "boundary vertices where the boundary is no manifold, in 10^5",
         "chordal": "rms distance of face centroids from psi = 0, 10^-3 h",
         "farthest": "greatest distance from psi = 0 to the mesh, h",
         "solves_percent": "vertex solves of projection and smoothing", "patches": "patches tried by repair, for 10^5 tets at the boundary",
         "psi_percent": "evaluations of psi", "changed": "moving bodies: vertices that change sides a step, in 100 positive vertices"}
WORK = {"solves_percent", "patches", "psi_percent", "changed"}
Number = collections.namedtuple("Number", "file name value meaning")


def one_line(comment):
    return re.sub(r"\s+", " ", comment).strip().rstrip(".")


def first_sentence(text):
    end = re.search(r"(?<!eq)(?<!eqs)(?<!Alg)[.](?= [A-Z\[0-9])", text)
    return text[:end.start()] if end else text


def split(text):
    """At commas outside of brackets."""
    parts, depth = [""], 0
    for c in text:
        depth += (c in "({[") - (c in ")}]")
        if c == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += c
    return [p.strip() for p in parts]


def declarators(text):
    """[(name, value)] of "name = value, other{value}"."""
    found = []
    for part in split(text):
        if match := re.match(r"(?:.*?\b)?(\w+)\s*(?:=\s*(.*)|(\{.*\}))$", part, re.S):
            found.append((match[1], re.sub(r"\s+", " ", match[2] or match[3]).strip()))
    return found


def comment_above(lines, i, mark):
    """The block of comment lines right above line i; declarations of the same kind may stand between."""
    block = []
    for line in reversed(lines[:i]):
        text = line.strip()
        if text.startswith("//") and not text.startswith("///<"):
            block.insert(0, text.lstrip("/").strip())
        elif block or not re.match(mark, text):
            break
    return " ".join(block)


def constants(file):
    lines = (ROOT / file).read_text().split("\n")
    for i, line in enumerate(lines):
        if not re.match(r"\s*(?:inline |static )*constexpr [^()]*\bk[A-Z]\w*\s*[={]", line):
            continue
        statement, trailing = "", []
        for more in lines[i:]:
            code, _, comment = more.partition("//")
            statement += code.strip() + " "
            trailing += [comment.strip("/< ")] if comment else []
            if code.rstrip().endswith(";"):
                break
        statement = re.sub(r"^(?:inline |static )*constexpr ", "", statement.strip().rstrip(";"))
        meaning = " ".join(trailing) or comment_above(lines, i, r"(inline |static )*constexpr ")
        for name, value in declarators(statement):
            if re.match(r"k[A-Z]", name):
                yield Number(file, name, value, one_line(meaning))


def fields(file):
    """Those with a default, and what a function of the struct sets in another: RepairParams::patch_smoothing()."""
    lines = (ROOT / file).read_text().split("\n")
    struct = inner = None
    for i, line in enumerate(lines):
        if match := re.match(r"struct (\w+Params) {", line):
            struct = match[1]
        elif line == "};":
            struct = None
        elif match := re.match(r"  static \w+ (\w+)\(\) {", line):
            inner = match[1]
        elif line == "  }":
            inner = None
        elif struct and inner and (match := re.match(r"    params\.(\w+) = (.*);", line)):
            above = next(k for k in range(i, 0, -1) if f" {inner}()" in lines[k])
            yield Number(file, f"{struct}::{inner}.{match[1]}", match[2], one_line(comment_above(lines, above, "$^")))
        elif struct and not inner and re.match(r"  (?!//|return|using|static|struct)[\w:<>* ]+ \w+ =", line) and "(" not in line.split("//")[0]:
            code, _, trailing = line.partition("//")
            k = i + 1
            while not code.rstrip().endswith(";"):  # the formatter has broken the line
                more, _, comment = lines[k].partition("//")
                code, trailing, k = code + more, trailing + " " + comment, k + 1
            while k < len(lines) and lines[k].strip().startswith("///<"):
                trailing, k = trailing + " " + lines[k].strip().removeprefix("///<"), k + 1
            meaning = trailing.replace("/<", "").strip() or comment_above(lines, i, "$^")
            for name, value in declarators(code.strip().rstrip(";")):
                yield Number(file, f"{struct}::{name}", value, one_line(meaning))


def numbers():
    files = FILES + [p.relative_to(ROOT).as_posix() for folder in FOLDERS for p in sorted((ROOT / folder).rglob("*"))
                     if p.suffix in (".h", ".cpp") and "tables" not in p.parts]
    return [n for file in files for n in (*fields(file), *constants(file))]


def cell(text):
    return text.replace("|", "\\|").replace("<", "&lt;").replace(">", "&gt;")


def plain(number):
    text = f"{float(number):g}"
    return re.sub(r"^(-?)0\.", r"\1.", text)


def effect(row):
    percent = " %" if row["measure"].endswith("_percent") else ""
    name = row["measure"].removesuffix("_percent")
    mean, low, high = (plain(row[key]) for key in ("difference", "low", "high"))
    return f"{name} {'+' if float(mean) > 0 else ''}{mean}{percent} [{low}, {high}]"


def measured_rows():
    """By parameter and value."""
    table = collections.OrderedDict()
    with open(MEASURED, newline="") as f:
        for row in csv.DictReader(f):
            table.setdefault(row["parameter"], collections.OrderedDict()).setdefault(float(row["value"]), []).append(row)
    return table


def as_good(of_value, standard):
    """The tested values next to the default, and on from there, at which no measure of quality is worse."""
    bad = {v for v, rows in of_value.items() if any(r["verdict"] == "worse" and r["measure"] not in WORK for r in rows)}
    values = sorted({*of_value, standard})
    at = low = high = values.index(standard)
    while low > 0 and values[low - 1] not in bad:
        low -= 1
    while high + 1 < len(values) and values[high + 1] not in bad:
        high += 1
    return plain(values[at]) if low == high else f"{plain(values[low])} to {plain(values[high])}"


def what_others_do(of_value):
    parts = []
    for value in sorted(of_value):
        sure = [effect(r) for r in of_value[value] if r["verdict"] in ("better", "worse")]
        opened = [r["measure"].removesuffix("_percent") for r in of_value[value] if r["verdict"] == "open"]
        text = "; ".join(sure) or ("no difference" if not opened else "no sure difference")
        parts.append(f"**{plain(value)}**: {text}" + (f" (open: {', '.join(opened)})" if opened else ""))
    return "<br>".join(parts)


def uncommented(known):
    """Problems: numbers that neither a comment nor their name explains."""
    missing = [f"constants.py: there is no folder {folder}" for folder in FOLDERS if not (ROOT / folder).is_dir()]
    return missing + [f"{n.file}: {n.name} has no comment" for n in known
                      if not n.meaning and n.name not in SELF_EXPLANATORY and not re.fullmatch(r"\w+::[A-Z]\w*", n.value)]  # a choice, no number


def page(known):
    problems, measured = [], measured_rows()
    by_name = {n.name: n for n in known}
    lines = [
        "# Measured parameters", "",
        "This page shows the effect of other parameter values on quality and work. `tools/docs/constants.py` writes this page from the sources and "
        "`data/constants/sensitivity.csv`; a test fails when it is stale. All other constants are explained where they are defined.",
        "",
        f"`{COMMAND}` makes the numbers. It meshes 126 bodies ([bodies.h](../tools/sensitivity/bodies.h)) with 10,000 to 40,000 tets each: "
        "66 random shapes, and ten known domains in six poses each, rotated and shifted relative to the lattice. One parameter at a time gets another value.", "",
        "A *difference* is the difference of the means over the bodies, paired by body, with its 95 % confidence interval (bootstrap over the bodies). "
        "It is listed as sure when the interval excludes 0, a sign-flip test gives p < .01, and the mean exceeds a tolerance. A measure is *open* "
        "when these bodies cannot decide. *As good* gives the range of tested values for which no measure of quality is worse than with the default; "
        "measures of work do not count.".replace("<", "&lt;"), "",
        "| measure | meaning | with the defaults |", "|---|---|---|"]
    defaults = {}
    for of_value in measured.values():
        for rows in of_value.values():
            for r in rows:
                defaults.setdefault(r["measure"], r["with default"])
    for name, what in UNITS.items():
        if name in defaults:
            lines.append(f"| {name.removesuffix('_percent')} | {what}{' (work)' if name in WORK else ''} | {plain(defaults[name])} |")
    lines += ["", "| name | meaning | value | as good | other values |", "|---|---|---|---|---|"]
    for name, of_value in measured.items():
        if name not in by_name:
            problems.append(f"{MEASURED.name}: the sources have no {name}")
            continue
        n = by_name[name]
        standard = float(next(iter(of_value.values()))[0]["default"])
        if re.fullmatch(r"-?[\d.e-]+F?", n.value) and float(n.value.rstrip("F")) != standard:
            problems.append(f"{name} = {n.value}, measured with {standard:g}: run {COMMAND}")
        lines.append(f"| `{name}` | {cell(first_sentence(n.meaning))} | {cell(n.value)} | {as_good(of_value, standard)} | {what_others_do(of_value)} |")
    return "\n".join(lines) + "\n", problems


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    known = numbers()
    fresh, problems = page(known)
    if arguments.check:
        problems += uncommented(known)
        old = TABLE.read_text() if TABLE.exists() else ""
        if fresh != old:
            sys.stdout.writelines(difflib.unified_diff(old.splitlines(True), fresh.splitlines(True), "docs/constants.md", "fresh", n=0))
            problems.append("docs/constants.md is stale: run tools/docs/constants.py")
    else:
        TABLE.write_text(fresh)
    if problems:
        sys.exit("\n".join(problems))


if __name__ == "__main__":
    main()
