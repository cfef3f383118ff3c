"""What an XML parser finds in files of FEBio (febio_spec 4.0), a JSON document a file, by the rules of its manual: numbers of nodes
and tets and their type; coordinates of all nodes; the nodes of every set; of every surface its facets, its area vector, and whether
each facet is a face of a tet, seen from outside. Troubles are told in `wrong`."""

import json
import sys
import xml.etree.ElementTree as ET

# Of FEBio's shape functions (FECore/FESolidElementShape.cpp, FESurfaceElementShape.cpp): between which corners a middle lies.
MIDDLES = {"tet4": [], "tet10": [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)], "tri3": [], "tri6": [(0, 1), (1, 2), (2, 0)]}


def minus(a, b):
    return [p - q for p, q in zip(a, b)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a, b):
    return sum(p * q for p, q in zip(a, b))


def ids_of(element):
    return [int(word) for word in element.text.split(",")]


def read_feb(path):
    text = open(path, encoding="utf-8").read()
    root = ET.fromstring(text)
    wrong = [] if text.startswith("<?xml") else ["no <?xml at the beginning"]

    def check(holds, what):
        if not holds and len(wrong) < 10:
            wrong.append(what)

    check(root.tag == "febio_spec" and root.get("version") == "4.0", "version")
    check(root[0].tag == "Module", "the first section is not Module")
    mesh = root.find("Mesh")
    nodes, elements = mesh.findall("Nodes"), mesh.findall("Elements")
    check(len(nodes) == 1 and len(elements) == 1, "several Nodes or Elements")
    x = {}
    for n, node in enumerate(nodes[0], 1):
        check(node.tag == "node" and int(node.get("id")) == n, f"node {n}")
        x[n] = [float(word) for word in node.text.split(",")]
    kind = elements[0].get("type")

    def middles_fit(ids, kind):
        corners = len(ids) - len(MIDDLES[kind])
        return all(max(abs(p - (q + r) / 2) for p, q, r in zip(x[ids[corners + k]], x[ids[a]], x[ids[b]])) < 1e-9
                   for k, (a, b) in enumerate(MIDDLES[kind]))

    opposite, volume = {}, 0
    for n, element in enumerate(elements[0], 1):
        ids = ids_of(element)
        check(element.tag == "elem" and int(element.get("id")) == n, f"elem {n}")
        check(len(ids) == 4 + len(MIDDLES[kind]) and middles_fit(ids, kind), f"nodes of elem {n}")
        a, b, c, d = (x[i] for i in ids[:4])
        tet = dot(cross(minus(b, a), minus(c, a)), minus(d, a)) / 6
        check(tet > 0, f"elem {n} is turned over")
        volume += tet
        for k in range(4):
            opposite.setdefault(frozenset(ids[:k] + ids[k + 1:4]), []).append(ids[k])
    surfaces = {}
    for surface in mesh.findall("Surface"):
        area = [0, 0, 0]
        tri = "tri3" if kind == "tet4" else "tri6"
        for n, facet in enumerate(surface, 1):
            ids = ids_of(facet)
            check(facet.tag == tri and int(facet.get("id")) == n, f"{surface.get('name')} {n}")
            check(len(ids) == 3 + len(MIDDLES[tri]) and middles_fit(ids, tri), f"nodes of {surface.get('name')} {n}")
            behind = opposite.get(frozenset(ids[:3]), [])
            a, b, c = (x[i] for i in ids[:3])
            vector = cross(minus(b, a), minus(c, a))
            check(len(behind) == 1 and dot(vector, minus(x[behind[0]], a)) < 0, f"{surface.get('name')} {n} looks inwards")
            area = [p + q / 2 for p, q in zip(area, vector)]
        surfaces[surface.get("name")] = {"facets": len(surface), "area": area}
    sets = {s.get("name"): ids_of(s) for s in mesh.findall("NodeSet")}
    names = [child.get("name") for child in mesh]
    for tag in ("NodeSet", "Surface"):
        listed = [child.get("name") for child in mesh.findall(tag)]
        check(len(set(listed)) == len(listed), f"a {tag} twice")
    check(all(names), "something without a name")
    return {"nodes": list(x.values()), "tets": len(elements[0]), "type": kind, "part": elements[0].get("name"),
            "volume": volume, "sets": sets, "surfaces": surfaces, "wrong": wrong}


for path in sys.argv[1:]:
    print(json.dumps(read_feb(path)))
