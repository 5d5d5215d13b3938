"""Table and picture of the packages on the page "Architecture".

`python tests/docs/architecture.py` writes both.

They are made of the first line of every room's `__init__` and of the contract in pyproject.toml.
"""

import ast
import tomllib
from html import escape
from pathlib import Path

from stepwell.paper.claims import replaced

ROOT = Path(__file__).resolve().parents[2]
PAGE, PICTURE = ROOT / "docs" / "architecture.md", ROOT / "docs" / "img" / "architecture.svg"
BEGIN = "<!-- rooms: written by `python tests/docs/architecture.py`, not by hand -->"
END = "<!-- end of rooms -->"
# Tasks of users, and their packages, one colour each (Okabe and Ito 2008).
STOREYS = {
    "basis": ("#999999", ("crash", "base", "kernels")),
    "analysis": ("#0072b2", ("mechanism", "concave", "statics", "sequences", "proof")),
    "inverse design": ("#009e73", ("design",)),
    "measurements": ("#cc79a7", ("lab",)),
    "robots": ("#d55e00", ("robot", "simulation")),
    "input and output": (
        "#e69f00",
        ("files", "build", "studies", "accounts", "figures", "paper", "reports", "studio", "cli"),
    ),
}


def rooms() -> list[tuple[str, str, list[str]]]:
    """Every package from the lowest layer: its name, its purpose and its folders."""
    told = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    layers = told["tool"]["importlinter"]["contracts"][0]["layers"]
    found = []
    for layer in reversed(layers):
        home = ROOT / "src" / Path(*layer.split("."))
        text = ast.get_docstring(ast.parse((home / "__init__.py").read_text("utf-8"))) or ""
        folders = sorted(one.parent.name for one in home.glob("*/__init__.py"))
        found.append((home.name, text.partition("\n")[0], folders))
    return found


def table() -> str:
    """The packages as a table of the page."""
    rows = (
        f"| `{name}` | {what} | {', '.join(f'`{folder}`' for folder in folders)} |"
        for name, what, folders in rooms()
    )
    return "\n".join(["| package | contents | folders |", "|---|---|---|", *rows])


def picture() -> str:
    """The packages as layers, the lowest at the bottom, as SVG."""
    colour = {room: shade for shade, held in STOREYS.values() for room in held}
    asked = {held[-1]: (words, len(held)) for words, (_, held) in STOREYS.items()}
    storey, wide, left = 26, 830, 40
    packages = rooms()
    top = 10
    tall = top + storey * len(packages) + 30
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {wide} {tall}" '
        'font-family="sans-serif" font-size="13">',
        "<title>The packages of Stepwell, from the lowest layer</title>",
        f'<rect width="{wide}" height="{tall}" fill="white"/>',
    ]
    for number, (name, _, folders) in enumerate(reversed(packages)):
        y = top + storey * number
        lines += [
            f'<rect x="{left}" y="{y}" width="590" height="{storey}" fill="{colour[name]}" '
            f'fill-opacity="0.18" stroke="#333" stroke-width="0.7"/>',
            f'<rect x="{left}" y="{y}" width="7" height="{storey}" fill="{colour[name]}"/>',
            f'<text x="{left + 18}" y="{y + 17.5}" font-weight="bold" fill="#222">{name}</text>',
            f'<text x="{left + 122}" y="{y + 17.5}" font-size="11" fill="#444">'
            f"{escape(', '.join(folders))}</text>",
        ]
        if name in asked:
            words, height = asked[name]
            middle, end = y + storey * height / 2, y + storey * height - 3
            lines += [
                f'<path d="M{left + 598} {y + 3} h5 V{end} h-5" fill="none" '
                f'stroke="{colour[name]}" stroke-width="2"/>',
                f'<text x="{left + 610}" y="{middle + 4.5}" fill="#222">{escape(words)}</text>',
            ]
    ground = top + storey * len(packages)
    lines += [f'<path d="M10 {ground} H{wide - 10}" stroke="#333" stroke-width="2"/>', "</svg>"]
    return "\n".join(lines) + "\n"


def page(text: str) -> str:
    """The page with its table updated."""
    return replaced(text, table(), BEGIN, END, "rooms")


if __name__ == "__main__":
    PAGE.write_text(page(PAGE.read_text("utf-8")), "utf-8")
    PICTURE.write_text(picture(), "utf-8")
