#!/usr/bin/python3
"""Draws docs/thin_bodies.svg from data/thin_bodies.csv: the share of thin bodies that pass, against thickness / h."""
import csv
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
COLOURS = {"plate": "#1f77b4", "blade": "#d62728", "rod": "#2ca02c", "cone": "#9467bd", "balls": "#ff7f0e",
           "slabs": "#7f7f7f"}
LEFT, TOP, WIDTH, HEIGHT, MOST = 50, 15, 460, 220, 3.0


def x_of(thickness):
    return LEFT + WIDTH * thickness / MOST


def y_of(share):
    return TOP + HEIGHT * (1 - share)


def main():
    with open(ROOT / "data/thin_bodies.csv", encoding="utf8") as f:
        rows = list(csv.DictReader(f))
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{LEFT + WIDTH + 90}" height="{TOP + HEIGHT + 45}" '
           'font-family="sans-serif" font-size="12">', '<rect width="100%" height="100%" fill="white"/>']
    for k in range(7):
        x = x_of(k / 2)
        out.append(f'<path d="M{x:.0f} {TOP}V{TOP + HEIGHT}" stroke="#ddd"/>'
                   f'<text x="{x:.0f}" y="{TOP + HEIGHT + 16}" text-anchor="middle">{k / 2:g}</text>')
    for k in range(5):
        y = y_of(k / 4)
        out.append(f'<path d="M{LEFT} {y:.0f}H{LEFT + WIDTH}" stroke="#ddd"/>'
                   f'<text x="{LEFT - 6}" y="{y + 4:.0f}" text-anchor="end">{25 * k} %</text>')
    for n, (family, colour) in enumerate(COLOURS.items()):
        points = " ".join(f"{x_of((float(r['from']) + float(r['to'])) / 2):.1f},"
                          f"{y_of(int(r['exit_0']) / max(1, int(r['bodies']))):.1f}"
                          for r in rows if r["family"] == family)
        y = TOP + 14 + 18 * n
        out.append(f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="2"/>'
                   f'<path d="M{LEFT + WIDTH + 12} {y - 4}h18" stroke="{colour}" stroke-width="2"/>'
                   f'<text x="{LEFT + WIDTH + 36}" y="{y}">{family}</text>')
    out.append(f'<text x="{LEFT + WIDTH / 2:.0f}" y="{TOP + HEIGHT + 36}" text-anchor="middle">'
               'thickness of body or gap, h</text></svg>')
    (ROOT / "docs/thin_bodies.svg").write_text("\n".join(out) + "\n", encoding="utf8")


if __name__ == "__main__":
    main()
