#!/usr/bin/python3
"""The report of a cloud in headless Chromium: no errors, a picture, and the numbers of certificate.json.

usage: report_page_test.py UMTET CLOUD     exit code 77: there is no Chromium (Debian's chromium)
"""
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from html.parser import HTMLParser

SKIPPED = 77
CHROMIUM = ["chromium", "--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
            "--window-size=1400,1000", "--enable-logging=stderr", "--v=0", "--timeout=60000"]


class Marked(HTMLParser):
    """Texts of the elements with data-certificate, and the attributes of body."""

    def __init__(self, page):
        super().__init__()
        self.texts, self.body, self.at = [], {}, None
        self.feed(page)

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        if tag == "body":
            self.body.update(attributes)
        self.at = attributes.get("data-certificate")
        if self.at is not None:
            self.texts.append([self.at, tag, ""])

    def handle_data(self, data):
        if self.at is not None:
            self.texts[-1][2] += data

    def handle_endtag(self, tag):
        self.at = None


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
        with ThreadPoolExecutor() as pool:  # a browser waits more than it works
            (page, said), (cut, cut_said), (bare, _) = pool.map(lambda view: opened(*view), (
                (url, f"{folder}/a"), (f"{url}#axis=0&edges=0", f"{folder}/b"), (url, f"{folder}/c", "--disable-3d-apis")))
        assert not said + cut_said, said + cut_said
        numbers_are_those_of(certificate, page)
        assert page.body["data-webgl"] == "drawn", page.body
        whole = int(page.body["data-pixels"])
        assert whole > 20_000, page.body
        assert .2 * whole < int(cut.body["data-pixels"]) < .95 * whole, (page.body, cut.body)
        print(f"opened in {page.body['data-ready']} ms, {len(html)} bytes for {certificate['n_tets']} tets")

        numbers_are_those_of(certificate, bare)
        assert bare.body["data-webgl"] == "missing", bare.body
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
