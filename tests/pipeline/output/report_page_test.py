#!/usr/bin/python3
"""Reports in headless Chromium: no errors, a picture, the numbers of certificate.json, and the patches of the mesh.

usage: report_page_test.py UMTET CLOUD     exit code 77: there is no Chromium (Debian's chromium)
"""
import json
import math
import pathlib
import random
import re
import shutil
import struct
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from html.parser import HTMLParser

SKIPPED = 77
CHROMIUM = ["chromium", "--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
            "--window-size=1400,1000", "--enable-logging=stderr", "--v=0", "--timeout=60000"]


class Marked(HTMLParser):
    """Texts of the elements with data-certificate, the attributes of body, and the rows of the legend of patches."""

    def __init__(self, page):
        super().__init__()
        self.texts, self.body, self.at, self.patches, self.row, self.page = [], {}, None, {}, None, page
        self.feed(page)

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        if tag == "body":
            self.body.update(attributes)
        if attributes.get("class") == "patch":
            self.row = self.patches[int(attributes["data-number"])] = []
        elif self.row is not None and tag == "i":
            self.row.append(attributes["style"])
        self.at = attributes.get("data-certificate")
        if self.at is not None:
            self.texts.append([self.at, tag, ""])

    def handle_data(self, data):
        if self.at is not None:
            self.texts[-1][2] += data
        if self.row is not None:
            self.row.append(data)

    def handle_endtag(self, tag):
        self.at = None
        if tag == "div":
            self.row = None


def opened(page, profile, *flags):
    """The page as Chromium leaves it; fails where its console has something to say."""
    answer = subprocess.run([*CHROMIUM, f"--user-data-dir={profile}", *flags, "--dump-dom", page], capture_output=True,
                            text=True, timeout=100)
    said = [line for line in answer.stderr.splitlines() if "CONSOLE" in line]
    return Marked(answer.stdout), said


def leaves(value, pointer=""):
    if isinstance(value, dict) and value:
        for key, child in value.items():
            yield from leaves(child, f"{pointer}/{key}")
    else:
        yield pointer, value


def same(text, value):
    """A number is shown with so many digits, and rounded to these."""
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        digits = len(re.sub(r"e.*|[-.,]", "", text).lstrip("0")) or 1
        return float(text.replace(",", "")) == (value if isinstance(value, int) else float(f"{value:.{digits}g}"))
    return text == "–" if value is None else text == (value if isinstance(value, str) else json.dumps(value))


def numbers_are_those_of(certificate, page):
    values = dict(leaves(certificate))
    table = {pointer: text for pointer, tag, text in page.texts if tag == "code"}
    assert table.keys() == values.keys(), table.keys() ^ values.keys()
    for pointer, text in table.items():
        assert json.loads(text) == values[pointer], (pointer, text)
    cards = [(pointer, text) for pointer, tag, text in page.texts if tag != "code"]
    assert len(cards) >= 12, cards
    for pointer, text in cards:
        assert same(text, values[pointer]), (pointer, text, values[pointer])


def stl_area(path):
    data, area = path.read_bytes(), 0
    for at in range(84, len(data), 50):
        a, b, c = (struct.unpack_from("<3f", data, at + 12 * k) for k in (1, 2, 3))
        u, v = [y - x for x, y in zip(a, b)], [y - x for x, y in zip(a, c)]
        area += math.hypot(*(u[i - 2] * v[i - 1] - u[i - 1] * v[i - 2] for i in range(3))) / 2
    return area, (len(data) - 84) // 50


def patches_are_those_of_the_files(umtet, folder):
    """A ball with three labels, one of them without a name."""
    with open(folder / "ball.xyz", "w") as cloud:
        for k in range(3000):
            z, a = 1 - (2 * k + 1) / 3000, 2.399963 * k
            x, y = math.sqrt(1 - z * z) * math.cos(a), math.sqrt(1 - z * z) * math.sin(a)
            cloud.write(f"{x} {y} {z} {x} {y} {z} {7 if z > .5 else 4 if x > 0 else 2}\n")
    subprocess.run([umtet, "run", folder / "ball.xyz", "-o", folder / "ball", "--tets", "5000", "--label-names",
                    "4=Feet,7=top", "--export", "stl", "-q", "--progress", "none"], check=True, stdout=subprocess.DEVNULL)
    report = folder / "ball/report.html"
    files = {number: stl_area(folder / f"ball/4-export/mesh.{name}.stl")
             for number, name in ((4, "Feet"), (7, "top"), (2, "patch_2"))}
    whole = sum(area for area, _ in files.values())
    scene = json.loads(re.search(r'id="scene">(.*?)</script>', report.read_text()).group(1))
    for patch in scene["patches"]:
        area, n_faces = files[patch["number"]]
        assert patch["n_faces"] == n_faces and abs(patch["area"] - area) < 1e-5 * area, (patch, area, n_faces)
    page, said = opened(f"file://{report}#colour=patch", folder / "d")
    assert not said, said
    assert page.patches.keys() == files.keys(), page.patches
    for number, (colour, name, share) in page.patches.items():
        assert name == {4: "Feet", 7: "top", 2: "patch_2"}[number], page.patches
        assert share == f"{100 * files[number][0] / whole:.1f} %", (page.patches, files)
    assert len({colour for colour, _, _ in page.patches.values()}) == 3, page.patches


def holes_are_shown(umtet, folder):
    """A ball without samples around +x: its report lists the hole, and opens there."""
    with open(folder / "open.xyz", "w") as cloud:
        for k in range(4000):
            z, a = 1 - (2 * k + 1) / 4000, 2.399963 * k
            x, y = math.sqrt(1 - z * z) * math.cos(a), math.sqrt(1 - z * z) * math.sin(a)
            if x < .8:
                cloud.write(f"{x} {y} {z} {x} {y} {z}\n")
    subprocess.run([umtet, "run", folder / "open.xyz", "-o", folder / "open", "--tets", "10000", "-q", "--progress", "none"],
                   check=True, stdout=subprocess.DEVNULL)
    report = folder / "open/report.html"
    assert len(re.findall(r'<button type="button" data-hole="\d+">', report.read_text())) == 1
    page, said = opened(f"file://{report}#hole=1&colour=patch", folder / "e")
    assert not said, said
    assert [row[1] for row in page.patches.values()] == ["boundary_1", "closed_holes"], page.patches
    assert int(page.body["data-pixels"]) > 20_000, page.body
    page, said = opened(f"file://{report}#hole=1", folder / "f")
    assert not said and not page.patches, (said, page.patches)


def what_samples_carry_is_a_colour(umtet, folder):
    """Half a ball with temperatures and colours, the other half without samples."""
    with open(folder / "warm.xyz", "w") as cloud:
        cloud.write("# x y z nx ny nz r g b heat\n")
        for k in range(4000):
            z, a = 1 - (2 * k + 1) / 4000, 2.399963 * k
            x, y = math.sqrt(1 - z * z) * math.cos(a), math.sqrt(1 - z * z) * math.sin(a)
            if x < .3:
                cloud.write(f"{x} {y} {z} {x} {y} {z} {128 + int(100 * y)} 40 {128 + int(100 * z)} {20 + 10 * z}\n")
    subprocess.run([umtet, "run", folder / "warm.xyz", "-o", folder / "warm", "--tets", "10000", "-q", "--progress", "none"],
                   check=True, stdout=subprocess.DEVNULL)
    for k, legend in enumerate(("scan_heat; grey: no value", "scan_rgb; grey: no value")):
        page, said = opened(f"file://{folder}/warm/report.html#colour=field_{k}", folder / f"field_{k}")
        assert not said, said
        assert page.body["data-webgl"] == "drawn" and int(page.body["data-pixels"]) > 20_000, page.body
        assert legend in page.page


def places_are_shown(umtet, folder):
    """A lens too thin for h: its report lists where the mesh is wrong, and opens at such a place, nearer than the whole."""
    done = subprocess.run([umtet, "mesh", "--implicit", "x^2+y^2+(z/0.12)^2-1", "--box=-1.6,-1.6,-.9,1.6,1.6,.9", "--h", ".3",
                           "-o", folder / "lens", "-q", "--progress", "none"], stdout=subprocess.DEVNULL, check=False)
    assert done.returncode == 6, done
    report = folder / "lens/report.html"
    places = json.loads((folder / "lens/certificate.json").read_text())["places"]
    assert places["n"] > 0
    assert len(re.findall(r'<button type="button" data-place="\d+">', report.read_text())) == len(places["listed"])
    page, said = opened(f"file://{report}", folder / "g")
    near, said_near = opened(f"file://{report}#spot=1", folder / "h")
    assert not said + said_near, said + said_near
    assert near.body["data-pixels"] != page.body["data-pixels"], page.body
    assert int(near.body["data-marked-faces"]) > 0, near.body
    driven_page, said = driven(report, CONTROLS, folder / "lens_profile")
    assert not said, said
    marked = json.loads(driven_page.body["data-seen"])["marked_faces"]
    assert marked and all(text.startswith("defect ") and n > 0 for n, text, _ in marked), marked


def driven(report, script, profile):
    """The page after a script that ran in it, with a copy of the report beside the report."""
    copy = report.with_name(f"driven_{profile.name}.html")
    copy.write_text(report.read_text().replace("</body>", f"<script>{script}</script>\n</body>"))
    return opened(f"file://{copy}", profile)


def sphere(n):
    for k in range(n):
        z, a = 1 - (2 * k + 1) / n, 2.399963 * k
        yield math.sqrt(1 - z * z) * math.cos(a), math.sqrt(1 - z * z) * math.sin(a), z


CONTROLS = """
const data = document.body.dataset, $ = (id) => document.getElementById(id);
const key = (name) => window.dispatchEvent(new KeyboardEvent("keydown", {key: name}));
const act = (id, change) => { change($(id)); $(id).dispatchEvent(new Event("input")); };
const pixels = () => {
  const gl = $("canvas").getContext("webgl2") || $("canvas").getContext("webgl"), b = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
  gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, b);
  let n = 0;
  for (let i = 3; i < b.length; i += 4) n += b[i] > 0;
  return n;
};
const drawn = pixels;
window.requestAnimationFrame = (render) => render();  // pictures are drawn at once
{
  const seen = {};
  for (let k = 0; k < document.querySelectorAll("#strip button").length; ++k) {
    key("ArrowRight");
    seen[data.stage] = {pixels: drawn(), command: $("command") ? $("command").textContent : "", samples: Number(data.samples),
                        marked: Number(data.marked), faces: Number(data.faces), info: $("stage-info").textContent};
  }
  const last = data.stage;
  key("ArrowLeft");
  const before = data.stage;
  key("ArrowRight");
  seen.keys = [last, before, data.stage];
  $("stage-mesh").click();
  act("axis", (e) => e.value = "0");
  drawn();
  seen.cut = data.cut;
  act("place", (e) => e.value = "0.3");
  drawn();
  seen.cutAside = data.cut;
  act("axis", (e) => e.value = "");
  act("worst", (e) => e.checked = true);
  seen.worst = [drawn(), $("worst-count").value];
  act("worst", (e) => e.checked = false);
  for (const on of $("cloud") ? [true, false] : []) {
    act("cloud", (e) => e.checked = on);
    drawn();
    if (on) seen.shown = data.samples;
  }
  act("beside", (e) => e.value = $("cloud") ? "cloud" : "level-set");
  seen.beside = [drawn(), $("names").textContent];
  act("beside", (e) => e.value = "");
  drawn();
  const box = $("canvas").getBoundingClientRect();
  seen.picked = [];
  for (const [x, y] of [[.5, .5], [.45, .4], [.55, .6], [.4, .6], [.6, .4], [.02, .02]]) {
    const at = {clientX: box.left + x * box.width, clientY: box.top + y * box.height, button: 0, pointerId: 1, bubbles: true};
    $("canvas").setPointerCapture = () => {};
    $("canvas").dispatchEvent(new PointerEvent("pointerdown", at));
    $("canvas").dispatchEvent(new PointerEvent("pointerup", at));
    seen.picked.push($("picked").hidden ? "" : $("picked").innerText);
  }
  HTMLAnchorElement.prototype.click = function () { seen.saved = [this.download, this.href.length, this.href.slice(0, 22)]; };
  $("save").click();
  seen.marked_faces = [];
  for (const button of document.querySelectorAll("button[data-place], button[data-missed], button[data-hole]")) {
    button.click();
    seen.marked_faces.push([Number(data.markedFaces), $("picked").textContent, drawn()]);
    if (seen.marked_faces.length >= 4) break;
  }
  data.seen = JSON.stringify(seen);
}
"""


def every_control_works(umtet, folder):
    """A noisy ball with outliers and turned normals, and a lens: every stage has a picture, its numbers and a command."""
    with open(folder / "strip.xyz", "w") as cloud:
        for k, (x, y, z) in enumerate(sphere(4000)):
            s = -1 if k % 10 == 0 else 1
            cloud.write(f"{x} {y} {z} {s * x} {s * y} {s * z}\n")
        for k in range(40):
            cloud.write(f"{2 * math.sin(k)} {2 * math.cos(7 * k)} {1.7 * math.sin(3 * k)} 0 0 1\n")
    case = folder / "strip"
    subprocess.run([umtet, "run", folder / "strip.xyz", "-o", case, "--tets", "9000", "-q", "--progress", "none"], check=True,
                   stdout=subprocess.DEVNULL)
    page, said = driven(case / "report.html", CONTROLS, folder / "strip_profile")
    assert not said, said
    seen = json.loads(page.body["data-seen"])
    stages = ["input", "cloud", "level-set", "chosen", "projected", "mesh"]
    records = {name: json.loads((case / folder_of / "record.json").read_text())
               for name, folder_of in (("cloud", "1-cloud"), ("mesh", "3-mesh"))}
    numbers = records["cloud"]["numbers"]
    for name in stages:
        assert seen[name]["pixels"] > 20_000, (name, seen[name])
        assert seen[name]["command"], name
    assert seen["keys"] == ["mesh", "projected", "mesh"], seen["keys"]
    assert seen["shown"] == str(numbers["n_points"]), seen["shown"]
    n_dropped = numbers["dropped"]["outliers"] + numbers["dropped"]["small_components"]
    assert n_dropped > 20 and numbers["normals"]["turned"] >= 400, numbers
    assert seen["input"]["marked"] == n_dropped, (seen["input"], n_dropped)
    assert seen["cloud"]["marked"] == n_dropped + numbers["normals"]["turned"], seen["cloud"]
    assert "turned" in seen["cloud"]["info"], seen["cloud"]
    certificate = json.loads((case / "certificate.json").read_text())
    assert seen["mesh"]["faces"] == certificate["boundary"]["n_faces"] == seen["projected"]["faces"], seen
    assert seen["cut"] == seen["cutAside"] == "tets", seen
    assert 20_000 < seen["worst"][0] and int(seen["worst"][1]) == 50, seen["worst"]
    assert "cloud" in seen["beside"][1] and seen["beside"][0] > 10_000, seen["beside"]
    found = [text for text in seen["picked"] if text]
    assert len(found) >= 3 and not seen["picked"][-1], seen["picked"]
    assert any(re.search(r"boundary face of tet \d+", text) and "mean ratio Q" in text for text in found), found
    assert seen["saved"][0] == "strip-mesh.png" and seen["saved"][1] > 5000 and seen["saved"][2] == "data:image/png;base64,", seen
    # Every command runs alone, in a copy of the case.
    for name in stages:
        command = seen[name]["command"].replace("umtet ", f"{umtet} ").replace("--progress", "")
        command = command + (" --no-report" if name not in ("input", "cloud", "level-set") else "")
        done = subprocess.run(["/bin/sh", "-c", f"rm -rf {case}-2 && {command} -q"], capture_output=True, text=True, check=False)
        assert done.returncode in (0, 6), (name, command, done)
    # The last of these copies has another h: its difference from the case is a picture, too.
    subprocess.run([umtet, "diff", case, f"{case}-2"], check=True, stdout=subprocess.DEVNULL)
    page, said = opened(f"file://{case}-2/diff.html#beside=b", folder / "diff_profile")
    assert not said and int(page.body["data-pixels"]) > 20_000 and page.body["data-stage"] == "a", (said, page.body)
    assert "distance to the other boundary" in page.page


def a_failed_run_has_a_report(umtet, folder):
    """Normals that contradict each other: no level set. The page shows the cloud, and says that its normals are to blame."""
    with open(folder / "wild.xyz", "w") as cloud:
        numbers = random.Random(1)
        for x, y, z in sphere(4000):
            n = [numbers.gauss(0, 1) for _ in range(3)]
            cloud.write(f"{x} {y} {z} {' '.join(str(c / math.hypot(*n)) for c in n)}\n")
    done = subprocess.run([umtet, "run", folder / "wild.xyz", "-o", folder / "wild", "--normals", "given", "--tets", "5000",
                           "--progress", "none"], capture_output=True, text=True, check=False)
    assert done.returncode == 4 and "report.html shows the stages" in done.stderr, done
    report = folder / "wild/report.html"
    for again in (False, True):
        if again:
            report.unlink()
            subprocess.run([umtet, "report", folder / "wild", "-q"], check=True, stdout=subprocess.DEVNULL)
        page, said = opened(f"file://{report}", folder / f"wild_{again}")
        assert not said, said
        assert page.body["data-stage"] == "cloud" and int(page.body["data-pixels"]) > 10_000, page.body
        assert "exit code 4" in page.page and "of the normals agree with their neighbours" in page.page
    # A case that is only begun has a report, too; one that ends well has no trace of the failure.
    subprocess.run([umtet, "run", folder / "wild.xyz", "-o", folder / "begun", "--until", "cloud", "-q"], check=True,
                   stdout=subprocess.DEVNULL)
    subprocess.run([umtet, "report", folder / "begun", "-q"], check=True, stdout=subprocess.DEVNULL)
    page, said = opened(f"file://{folder}/begun/report.html", folder / "begun_profile")
    assert not said and "There is no mesh yet" in page.page and int(page.body["data-pixels"]) > 10_000, (said, page.body)
    subprocess.run([umtet, "run", folder / "wild", "--normals", "estimate", "--progress", "none", "-q"], check=True,
                   stdout=subprocess.DEVNULL)
    assert not (folder / "wild/failure.json").exists()
    assert "exit code 4" not in report.read_text()


def a_large_mesh_can_be_cut_anywhere(umtet, folder):
    """More tets than a page holds: cells with the least Q at the cut, tets at the middle planes."""
    subprocess.run([umtet, "mesh", "--implicit", "x^2+y^2+z^2-1", "--box=-1.2,-1.2,-1.2,1.2,1.2,1.2", "--tets", "250000", "-o",
                    folder / "large", "-q", "--progress", "none"], check=True, stdout=subprocess.DEVNULL)
    report = folder / "large/report.html"
    assert len(report.read_text()) < 8e6
    for place, by in (("0.5", "tets"), ("0.3", "cells"), ("0.77", "cells")):
        page, said = opened(f"file://{report}#axis=1&place={place}", folder / f"large_{place}")
        assert not said and page.body["data-cut"] == by, (said, page.body)
        assert int(page.body["data-pixels"]) > 20_000, page.body


def main(umtet, cloud):
    if not shutil.which("chromium"):
        print("skipped: Debian's chromium is not installed")
        return SKIPPED
    with tempfile.TemporaryDirectory() as folder:
        case = pathlib.Path(folder) / "case"
        subprocess.run([umtet, "run", cloud, "-o", case, "-q", "--progress", "none"], check=True, stdout=subprocess.DEVNULL)
        certificate = json.loads((case / "certificate.json").read_text())
        html = (case / "report.html").read_text()
        assert len(html) < 5e6, len(html)
        assert not re.search(r"(src|href)\s*=\s*[\"']?(https?:)?//|@import|url\(", html.split("<!-- three.js")[0])

        url = f"file://{case}/report.html"
        page, said = opened(url, f"{folder}/a")
        with ThreadPoolExecutor() as pool:  # a browser waits more than it works
            (cut, cut_said), (bare, _), *_ = pool.map(lambda f: f(), (
                lambda: opened(f"{url}#axis=0&edges=0", f"{folder}/b"),
                lambda: opened(url, f"{folder}/c", "--disable-3d-apis"),
                lambda: patches_are_those_of_the_files(umtet, pathlib.Path(folder)),
                lambda: holes_are_shown(umtet, pathlib.Path(folder)),
                lambda: what_samples_carry_is_a_colour(umtet, pathlib.Path(folder)),
                lambda: places_are_shown(umtet, pathlib.Path(folder)),
                lambda: every_control_works(umtet, pathlib.Path(folder)),
                lambda: a_failed_run_has_a_report(umtet, pathlib.Path(folder)),
                lambda: a_large_mesh_can_be_cut_anywhere(umtet, pathlib.Path(folder))))
        assert not said + cut_said, said + cut_said
        numbers_are_those_of(certificate, page)
        assert page.body["data-webgl"] == "drawn", page.body
        whole = int(page.body["data-pixels"])
        assert whole > 20_000, page.body
        assert .2 * whole < int(cut.body["data-pixels"]) < .95 * whole, (page.body, cut.body)
        # Told, not judged: two seconds are promised, on a machine that has nothing else to do.
        print(f"first frame after {page.body['data-ready']} ms: {page.body['data-marks']}; "
              f"{len(html)} bytes for {certificate['n_tets']} tets")

        numbers_are_those_of(certificate, bare)
        assert bare.body["data-webgl"] == "missing", bare.body
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
