"""What the Fortran formats in blocked .cdb files of Ansys Mechanical APDL find, a JSON document a file: the element type, the
coordinates of all nodes, the nodes and the volume of the elements, and the components of nodes and of elements. `names` tells the
parts whose components have other names. Troubles are told in `wrong`."""

import json
import re
import sys

# SOLID285: I J K L. SOLID187: I J K L, and the middles M N O P Q R.
MIDDLES = {"285": [], "187": [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]}
REAL = re.compile(r" *-?\d\.\d{13}E[+-]\d{3}")
NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,31}")


class Cdb:
    def __init__(self, path):
        self.lines = open(path, encoding="ascii").read().split("\n")
        self.at = 0
        self.wrong = []

    def check(self, holds, what):
        if not holds and len(self.wrong) < 10:
            self.wrong.append(f"line {self.at}: {what}")

    def line(self):
        self.at += 1
        return self.lines[self.at - 1]

    def widths(self, expected):
        """The format line that follows: the width of every field."""
        line = self.line()
        self.check(line == expected, f"format {line}")
        return [(kind, int(width)) for n, kind, width in re.findall(r"(\d+)([ie])(\d+)", line) for _ in range(int(n))]

    def fields(self, widths, count):
        """The first `count` fields of the next line, which must fill it."""
        line, at, values = self.line(), 0, []
        for kind, width in widths[:count]:
            text = line[at:at + width]
            at += width
            self.check(len(text) == width, "too short")
            self.check(kind == "i" or REAL.fullmatch(text), f"'{text}' is no E{width}.13E3")
            values.append(int(text) if kind == "i" else float(text))
        self.check(at == len(line), "too long")
        return values

    def read(self):
        kind, nodes, elements, volume, components, names = "", {}, [], 0, {"NODE": {}, "ELEM": {}}, {}
        self.check(self.lines[-1] == "" and self.lines[-2] == "FINISH" and "/PREP7" in self.lines, "no /PREP7 or FINISH")
        while self.at < len(self.lines):
            words = self.line().split(",")
            if words[0].startswith("! component "):
                component, part = words[0][12:].split(" = ")
                names[part] = component
            elif words[0] == "ET":
                self.check(words[1] == "1", "type")
                kind = words[2]
            elif words[0] == "NBLOCK":
                self.check(words[1:3] == ["6", "SOLID"] and words[3] == words[4], "NBLOCK")
                widths = self.widths("(3i9,6e21.13e3)")
                for n in range(1, int(words[4]) + 1):
                    id, solid, line, *x = self.fields(widths, 6)
                    self.check((id, solid, line) == (n, 0, 0), f"node {n}")
                    nodes[id] = x
                self.check(self.line() == "N,R5.3,LOC,       -1,", "end of NBLOCK")
            elif words[0] == "EBLOCK":
                self.check(words[1:3] == ["19", "SOLID"] and words[3] == words[4], "EBLOCK")
                widths = self.widths("(19i9)")
                for n in range(1, int(words[4]) + 1):
                    count = 4 + len(MIDDLES[kind])
                    material, type, real, section, *rest = values = self.fields(widths, 11 + min(count, 8))
                    self.check((material, type, real, section) == (1, 1, 1, 1), f"attributes of element {n}")
                    self.check(rest[:7] == [0, 0, 0, 0, count, 0, n], f"fields 5 to 11 of element {n}")
                    ids = values[11:] + (self.fields(widths, count - 8) if count > 8 else [])
                    volume += self.volume(n, ids, nodes, MIDDLES[kind])
                    elements.append(ids)
                self.check(self.line() == "       -1", "end of EBLOCK")
            elif words[0] == "CMBLOCK":
                name, entity, n = words[1], words[2], int(words[3])
                self.check(NAME.fullmatch(name) and name.upper() not in ("ALL", "STAT", "DEFA"), f"name {name}")
                self.check(name.upper() not in [c.upper() for of in components.values() for c in of], f"{name} twice")
                components[entity][name] = self.component(n)
            else:
                self.check(words[0] in ("/COM", "/PREP7", "FINISH", ""), f"command {words[0]}")
        return {"type": kind, "nodes": list(nodes.values()), "elements": elements, "volume": volume, "sets": components["NODE"],
                "element_sets": components["ELEM"], "names": names, "wrong": self.wrong}

    def component(self, n):
        """The next n items. An item below 0 is the end of a range."""
        widths, items, found = self.widths("(8i10)"), [], []
        while len(items) < n:
            items += self.fields(widths, min(8, n - len(items)))
        for item in items:
            self.check(item > 0 or (found and -item > found[-1]), "range")
            found += [item] if item > 0 else range(found[-1] + 1, -item + 1)
        self.check(all(a < b for a, b in zip(found, found[1:])), "not ascending")
        return found

    def volume(self, n, ids, x, middles):
        """The volume of the corners. Every middle is nearer to the middle of its own edge than to those of the others."""
        a, b, c, d = (x[i] for i in ids[:4])
        p, q, r = ([s - t for s, t in zip(v, a)] for v in (b, c, d))
        six = sum(p[k] * (q[k - 2] * r[k - 1] - q[k - 1] * r[k - 2]) for k in range(3))
        self.check(six > 0, f"element {n} is turned over")
        centres = [[(s + t) / 2 for s, t in zip(x[ids[i]], x[ids[j]])] for i, j in middles]
        for k, i in enumerate(ids[4:]):
            off = [sum((s - t) ** 2 for s, t in zip(x[i], centre)) for centre in centres]
            self.check(off[k] == min(off), f"middle {k} of element {n}")
        return six / 6


for path in sys.argv[1:]:
    print(json.dumps(Cdb(path).read()))
