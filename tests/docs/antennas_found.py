"""The tables and the picture of docs/antennas-found.md, from its studies' records.

The studies are those of the commands on the page; docs/antennas-found.json holds of each what it
found and what was handed on, and the ways of a few of the last. `python
tests/docs/antennas_found.py FOLDER` reads it from the folder in which the commands were run;
without a folder, what is on the page is made of the file that there is.
"""

from __future__ import annotations

import csv
import json
import re
import shlex
import sys
from collections import Counter
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
from scipy.stats import binomtest

import stepwell as sw
from stepwell import studies
from stepwell.accounts import account
from stepwell.base import number, percent
from stepwell.design import fraction_of
from stepwell.figures import svg
from stepwell.figures.common import legends
from stepwell.figures.common.marks import plain, scale_bar
from stepwell.figures.common.sheet import blank, place
from stepwell.figures.common.style import BLUE, INK, MM, ORANGE, PAGE as WIDE, styled
from stepwell.figures.robots.parts import draw_arena, frame, in_world
from stepwell.robot import Arena, other_layout, other_start

ROOT = Path(__file__).parents[2]
PAGE, FILE = ROOT / "docs" / "antennas-found.md", ROOT / "docs" / "antennas-found.json"
PICTURE = ROOT / "docs" / "img" / "antennas-found.svg"
PRESET = "robot-antennas"
ROUNDS, LAST = ("first", "second", "third"), ("found", "today")
COLOURS = {"found": BLUE, "today": ORANGE}


def records() -> dict[str, Any]:
    return json.loads(FILE.read_text("utf-8"))


def commands() -> list[list[str]]:
    """The words of the page's commands, without `stepwell` and `sweep`, in their order."""
    text = PAGE.read_text("utf-8").replace("\\\n", " ")
    return [shlex.split(line) for line in re.findall(r"^stepwell sweep (.*)$", text, re.M)]


def option(words: list[str], name: str, default: str = "") -> str:
    return words[words.index(name) + 1] if name in words else default


def arena_text() -> str:
    """The arena's file, as it stands on the page."""
    (text,) = re.findall(r'```toml title="two-walls.toml"\n(.*?)```', PAGE.read_text("utf-8"), re.S)
    return text


def asked(store: str) -> list[str]:
    """The command of a study."""
    (words,) = (w for w in commands() if w[0] == "maze" and option(w, "--out") == f"{store}.zarr")
    return words


def layouts(store: str) -> range:
    first = int(option(asked(store), "--first", "0"))
    return range(first, first + int(option(asked(store), "--layouts")))


def layout(number: int) -> Arena:
    """An arena of the studies by its number."""
    words, there = asked("found"), sw.files.loads_arena(arena_text(), "two-walls.toml")
    apart = {
        "place": float(option(words, "--place")) / 1e3,
        "angle": np.radians(float(option(words, "--angle"))),
    }
    return other_start(other_layout(there, number, **apart), number)


def rows(store: str) -> list[dict[str, str]]:
    """What a study found, design by design, as `sweep export` writes it."""
    return list(csv.DictReader(records()["studies"][store]["table"]))


def passed(store: str) -> list[bool]:
    """Whether the only design of a study gets through each arena."""
    (row,) = rows(store)
    return [outcome == "reached" for outcome in row["outcomes"].split(", ")]


def written(text: str) -> str:
    """The page with its tables as they should be."""
    for name, inside in {"rounds": _rounds(), "numbers": _numbers(), "judged": _judged()}.items():
        begin, end = f"<!-- {name}: written by tests/docs/antennas_found.py -->", "<!-- end -->"
        new = f"{begin}\n\n{inside}\n\n{end}"
        text = re.sub(f"{re.escape(begin)}.*?{end}", lambda _, new=new: new, text, flags=re.S)
    return text


def _rounds() -> str:
    lines = ["| round | designs | arenas | best | median | least |", "|---|---|---|---|---|---|"]
    for store in ROUNDS:
        shares, of = [float(row["reached"]) for row in rows(store)], layouts(store)
        told = " | ".join(percent(f(shares)) for f in (max, median, min))
        lines.append(f"| {store} | {len(shares)} | {of[0]} to {of[-1]} | {told} |")
    return "\n".join(lines)


def _numbers() -> str:
    robot = sw.preset(PRESET)
    today = {one.path: one.values[0] for one in sw.files.parameters(robot)}
    words, (found,) = asked("first"), csv.DictReader(records()["lists"]["found.csv"])
    lines = ["| number | today | found | searched |", "|---|---|---|---|"]
    for text in (words[k + 1] for k, word in enumerate(words) if word == "--vary"):
        name, _, between = text.partition("=")
        value = today[name.partition(",")[0].replace("*", "left")]
        key = name.replace("*", "\\*").replace(",", ", ")
        low, high = between.split(":")
        told = number(float(found[name]), 3)
        lines.append(f"| {key} | {number(value)} | {told} | {low} to {high} |")
    return "\n".join(lines)


def _judged() -> str:
    lines = ["| antennas | passed | share | 95 % interval | the others |", "|---|---|---|---|---|"]
    ways = {store: passed(store) for store in LAST}
    for store in LAST:
        share = fraction_of(sum(ways[store]), len(ways[store]))
        outcomes = Counter(rows(store)[0]["outcomes"].split(", "))
        rest = ", ".join(f"{n} {what}" for what, n in outcomes.most_common() if what != "reached")
        between = f"{percent(share.low)} to {percent(share.high)}"
        of = f"{share.times} of {share.of}"
        lines.append(f"| {store} | {of} | {percent(share.estimate)} | {between} | {rest} |")
    won, lost = (sum(a and not b for a, b in pairs) for pairs in _pairs(ways))
    chance = binomtest(won, won + lost).pvalue if won + lost else 1.0
    verdict = (
        "more than chance makes of equal antennas" if chance < 0.05 else "as chance can make it"
    )
    lines += [
        "",
        f"{won} arenas are passed by the antennas that were found and not by today's, {lost} the "
        f"other way round: {verdict} (p = {number(float(chance), 2)}, McNemar's test, exact).",
    ]
    return "\n".join(lines)


def _pairs(ways: dict[str, list[bool]]) -> list[list[tuple[bool, bool]]]:
    one, other = (ways[store] for store in LAST)
    return [list(zip(one, other, strict=True)), list(zip(other, one, strict=True))]


def shown() -> dict[str, list[int]]:
    """Arenas of the picture by who passes them: the first two of each kind."""
    found: dict[str, list[int]] = {}
    one, other = (passed(store) for store in LAST)
    for k, a, b in zip(layouts("found"), one, other, strict=True):
        who = ("both pass" if b else "found passes") if a else "today's passes"
        kind = who if a or b else "neither passes"
        found[kind] = [*found.get(kind, []), k][:2]
    return dict(sorted(found.items()))


@styled
def picture() -> Any:
    """The ways of both through a few of the arenas that judge: a column for every kind."""
    ways, robots, kinds = records()["ways"], {store: robot(store) for store in LAST}, shown()
    gap, title, foot = 3.0, 4.5, 8.0
    wide = (WIDE - (len(kinds) - 1) * gap) / len(kinds)
    high = wide * 0.9
    figure = blank(WIDE, 2 * (high + title) + foot)
    for i, (kind, arenas) in enumerate(kinds.items()):
        for j, k in enumerate(arenas):
            ax = place(figure, i * (wide + gap), foot + (1 - j) * (high + title), wide, high)
            plain(ax, (-180.0, 820.0, -450.0, 450.0))
            arena = layout(k)
            draw_arena(ax, arena, [True] * len(arena.walls))
            for store in LAST:
                lines = frame(robots[store], [0.0, 0.0])
                bodies = len(lines) - len(robots[store].antennas)
                for n, line in enumerate(lines):
                    shape = in_world(line, *arena.start, arena.heading) * MM
                    colour, thick = (INK, 0.6) if n < bodies else (COLOURS[store], 1.4)
                    ax.plot(*shape.T, color=colour, linewidth=thick, zorder=4)
                way = np.array(ways[str(k)][store])
                ax.plot(*way.T, color=COLOURS[store], linewidth=1.6, zorder=6)
            if i == j == 0:
                scale_bar(ax, 800.0, -420.0, 200.0)
            ax.set_title(f"{k}: {kind}", fontsize=7, color=INK, pad=2)
    told = [legends.line(f"antennas {store}", COLOURS[store], 1.6) for store in LAST]
    legends.below(figure, told, 2)
    return figure


def robot(store: str) -> sw.Robot:
    """The only robot of a study."""
    (row,) = csv.DictReader(records()["lists"][f"{store}.csv"])
    keys = {name: float(value) for name, value in row.items() if name != "design"}
    made = studies.changed(sw.preset(PRESET), list(keys), list(keys.values()))
    assert isinstance(made, sw.Robot)
    return made


def drawn() -> str:
    return svg(picture())


def collected(folder: Path) -> dict[str, Any]:
    """All that the page needs of a folder in which its commands were run, but for the ways."""
    found: dict[str, Any] = {"studies": {}, "lists": {}}
    for store in (*ROUNDS, *LAST):
        status = studies.status(folder / f"{store}.zarr")
        status.study.to_csv(folder / "table.csv")
        record = account(status).record
        kept = (
            "stepwell",
            "versions",
            "design_sha256",
            "identity",
            "count",
            "finished",
            "problems",
        )
        lines = (folder / "table.csv").read_text("utf-8").splitlines()
        found["studies"][store] = {name: record[name] for name in kept} | {"table": lines}
    for words in commands():
        if table := option(words, "--table"):
            found["lists"][table] = (folder / table).read_text("utf-8").splitlines()
    return found


def walked() -> dict[str, dict[str, list[list[float]]]]:
    """The ways of both through the arenas of the picture [mm], a point every 2 s, walked anew."""
    from stepwell.simulation import Outcome, maze

    limit = float(option(asked("found"), "--limit"))
    found: dict[str, dict[str, list[list[float]]]] = {}
    for k in (k for arenas in shown().values() for k in arenas):
        found[str(k)] = {}
        for store in LAST:
            way = maze(robot(store), layout(k), limit=limit)
            was = passed(store)[k - layouts(store)[0]]
            assert (way.outcome is Outcome.REACHED) == was, f"arena {k}: {store} now ends otherwise"
            times = np.arange(0.0, way.duration, 2.0)
            walk = way.walk
            xy = [np.interp(times, walk.time, one) * MM for one in (walk.x, walk.y)]
            found[str(k)][store] = np.column_stack(xy).round(0).tolist()
    return found


if __name__ == "__main__":
    if sys.argv[1:]:
        FILE.write_text(json.dumps(collected(Path(sys.argv[1]))) + "\n", "utf-8")
        FILE.write_text(json.dumps(records() | {"ways": walked()}, indent=1) + "\n", "utf-8")
    PICTURE.write_text(drawn(), "utf-8")
    PAGE.write_text(written(PAGE.read_text("utf-8")), "utf-8")
