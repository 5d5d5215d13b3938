"""The tables and the pictures of docs/what-decides.md, from its studies' records.

The studies are those of the commands on the page; docs/what-decides.json holds what `stepwell sweep
status STORE --json` prints of each. `python tests/docs/what_decides.py` makes both anew.
"""

from __future__ import annotations

import json
import re
import shlex
from functools import partial
from pathlib import Path
from typing import Any

from stepwell.base import percent
from stepwell.figures import compose, influences, svg
from stepwell.studies import DecidingNumbers, Influence

ROOT = Path(__file__).parents[2]
PAGE, FILE = ROOT / "docs" / "what-decides.md", ROOT / "docs" / "what-decides.json"
# One for each study; of a width [mm] at which a phone shows them readably.
PICTURES = {
    name: ROOT / "docs" / "img" / f"what-decides-{name.replace('_', '-')}.svg"
    for name in ("forward_10", "forward_30", "backward_30", "right_30")
}
WIDTH = 105.0
# What the keys of the commands are called on the page.
WORDS = {
    "blocks.carriage_g": "mass of the carriage",
    "blocks.damping_N_s_per_m": "damping of the blocks",
    "blocks.mass_g": "mass of a block",
    "body.mass_g": "mass of the body",
    "drive.period_s": "period of the drive",
    "drive.stiffness_N_per_m": "stiffness of the drive",
    "floor.drag_N": "drag of the T-foot",
    "floor.foot_friction": "friction of the feet",
    "foot.below_mm": "depth of the feet",
    "foot.mass_g": "mass of a foot",
    "foot.radius_mm": "radius of a foot",
    "leg.*.chain.cell.*.band.stiffness_N_per_m": "stiffness of the bands",
    "leg.*.chain.cell.*.friction_N": "friction of the joints",
    "gaits": "the gait stays",
}
# What each page is about: the noise of a robot that goes straight is left out.
COLUMNS = {
    "forward_10": ("advance", "work"),
    "forward_30": ("advance", "work", "gaits"),
    "backward_30": ("advance", "work", "gaits"),
    "right_30": ("turn", "work", "gaits"),
}


def records() -> dict[str, dict[str, Any]]:
    return json.loads(FILE.read_text("utf-8"))


def table(record: dict[str, Any], columns: tuple[str, ...]) -> str:
    lines = [
        "| what | decided by | share of its variance | more of it gives |",
        "|---|---|---|---|",
    ]
    rows = ((one, row) for one in record["decided"] for row in one["influences"][:5])
    for one, row in rows:
        what = one["column"]
        if what in columns and row["fraction"] >= max(0.01, one["floor"]):
            more = "more" if row["trend"] > 0 else "less"
            more = {"gaits": f"{more} often"}.get(what, more)
            told, key = WORDS.get(what, what), WORDS[row["parameter"]]
            lines.append(f"| {told} | {key} | {percent(row['fraction'])} | {more} |")
    return "\n".join(lines)


def kept(record: dict[str, Any]) -> str:
    first = record["outcomes"][0]
    ends = " to ".join(percent(first[end]) for end in ("fraction_low", "fraction_high"))
    gait = first["value"].replace(">", " → ").replace(" | ", ", right leg ")
    count, of = f"{first['designs']:,}", f"{record['count']:,}"
    return f"{count} of {of} robots, {percent(first['fraction'])} ({ends}), step left leg {gait}."


def written(text: str) -> str:
    """The page with its tables as they should be."""
    for name, record in records().items():
        begin, end = f"<!-- {name}: written by tests/docs/what_decides.py -->", "<!-- end -->"
        inside = f"{begin}\n\n{kept(record)}\n\n{table(record, COLUMNS[name])}\n\n{end}"
        text = re.sub(
            f"{re.escape(begin)}.*?{end}", lambda _, new=inside: new, text, flags=re.DOTALL
        )
    return text


def drawn(name: str) -> str:
    """What each number of a study decides by itself, as SVG."""
    found = [
        DecidingNumbers(
            one["column"],
            "",
            one["designs"],
            one["floor"],
            tuple(
                Influence(each["parameter"], each["fraction"], each["trend"])
                for each in one["influences"]
            ),
        )
        for one in records()[name]["decided"]
        if one["column"] in COLUMNS[name]
    ]
    return svg(compose([partial(influences, found, WORDS)], width=WIDTH))


def commands() -> list[list[str]]:
    """The words of the page's commands that begin studies."""
    text = PAGE.read_text("utf-8").replace("\\\n", " ")
    return [shlex.split(line) for line in re.findall(r"^stepwell (sweep walk .*)$", text, re.M)]


if __name__ == "__main__":
    for name, file in PICTURES.items():
        file.write_text(drawn(name), "utf-8")
    PAGE.write_text(written(PAGE.read_text("utf-8")), "utf-8")
