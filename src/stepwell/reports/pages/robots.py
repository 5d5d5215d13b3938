"""Pages of robots: what they are, how they walked, and their way through an arena."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import groupby
from typing import TYPE_CHECKING, Any

from stepwell.base import Column, Quantity, counted, number, rows_of
from stepwell.reports.pages import parts
from stepwell.results import CHANGE, CONTACT, CYCLES, FLIP, PREDICTED, TOUCHED

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_LEGS = Column("leg", lambda row: row["leg"])
_STATES = Column("states", lambda row: row["states"].replace(">", " → "))


def robot_page(
    record: Mapping[str, Any],
    does: str,
    drawn: Mapping[str, Figure],
    narrow: Mapping[str, Figure],
) -> str:
    """The page of a robot and of the gait that statics predicts.

    Args:
        record: what `results.robot_record` returns.
        does: what it is predicted to do, in words.
        drawn, narrow: figures by caption, on a wide window and on a phone.

    Returns:
        HTML text.
    """
    said = record["prediction"]
    needs = said["drive_needs"]
    named = {q.name: q for q in PREDICTED}
    order = ("name", "gait", "feet", "advance", "margin", "uncertainty", "nearest")
    flips = [{"leg": leg["name"]} | one for leg in said["legs"] for one in leg["flips"]]
    antenna, moved, _, _, swing, then = FLIP
    doubts = [
        f"{leg['name']} may do {' or '.join(leg['alternatives'] or [leg['nearest']])} as well."
        for leg in said["legs"]
        if leg["near_boundary"]
    ]
    return parts.page(
        record["title"] or "A robot",
        "Predicted by statics, without simulation.",
        f"It {does}",
        [
            f"In a cycle it advances by {number(said['advance_over_u_max'], 2)} of its longest "
            f"step, {number(record['u_max_mm'])} mm, and turns by {said['turn_deg']:z.1f}° to the "
            f"left.",
            parts.sentence(said["too_soft"]),
        ],
        {
            "Mass": f"{number(record['mass_g'])} g",
            "Weight": f"{number(record['weight_N'], 3)} N",
            "Drive": f"{number(needs['push_N'], 3)} N out, {number(needs['pull_N'], 3)} N back, "
            f"{number(needs['stiffness_N_per_m'], 3)} N/m or more",
            **_assumed(record["parameters"]),
        },
        [
            parts.part("The robot", parts.pictures(drawn, narrow)),
            parts.part(
                "Predicted gaits",
                parts.table(
                    [named[name] for name in order],
                    said["legs"],
                    "Feet: how deep they may stand for the gait to stay. Margin: by which force "
                    "the floor could differ before the gait does.",
                ),
            ),
            parts.part(
                "What antennas change",
                parts.table(
                    [antenna, _LEGS, moved, swing, then],
                    flips,
                    "How far an antenna moves the anchor before the gait of its leg changes.",
                ),
            ),
            _made(record["parameters"]),
            parts.part("What the numbers assume", parts.listed(said["assumptions"])),
        ],
        parts.warned("Too close to call.", "Statics cannot tell what these legs do.", doubts),
    )


def walk_page(
    record: Mapping[str, Any],
    drawn: Mapping[str, Figure],
    narrow: Mapping[str, Figure],
    replay: str = "",
) -> str:
    """The page of a walk.

    Args:
        record: what `results.walk_record` returns.
        drawn, narrow: figures by caption, on a wide window and on a phone.
        replay: its motion, as of `studio.replay`; none by default.

    Returns:
        HTML text.
    """
    title = record["title"] or "A walk"
    cycles = rows_of({q.key: record[q.key] for q in CYCLES})
    return parts.page(
        title,
        f"Simulated: {counted(record['cycles'], 'cycle')} of "
        f"{number(record['period_s'])} s on the floor.",
        f"It went {number(record['distance_mm'], 3)} mm",
        [
            _cycle(record),
            _against_statics(record),
            parts.sentence(record["stopped"]),
        ],
        {
            "A cycle, of the longest step": _number(record["mean_advance_over_u_max"], 3),
            "Turn in a cycle": _degrees(record["mean_turn_deg"]),
            "Work in a cycle": _number(record["work_per_cycle_mJ"], 3, " mJ"),
            "Cost of transport": _number(record["cost_of_transport"], 3),
        },
        [
            parts.part("See it move", parts.motion(replay, title) if replay else ""),
            parts.part("Where it went", parts.pictures(drawn, narrow)),
            parts.part(
                "The gait of each leg",
                parts.table(
                    [_LEGS, Column("cycles", lambda row: row["cycles"]), _STATES, _SLIP],
                    _gaits(record["legs"]),
                    "The states that its cells go through in a cycle, and how far its foot slips.",
                ),
            ),
            parts.part(
                "Cycle by cycle",
                parts.table(
                    [Quantity("cycle", head="cycle", left=False), *CYCLES],
                    [{"cycle": k} | cycle for k, cycle in enumerate(cycles, 1)],
                    "d/u_max is the advance over the longest step.",
                ),
            ),
            _made(record["parameters"]),
        ],
    )


def maze_page(
    record: Mapping[str, Any],
    outcome: str,
    drawn: Mapping[str, Figure],
    narrow: Mapping[str, Figure],
    replay: str = "",
) -> str:
    """The page of a way through an arena.

    Args:
        record: what `results.maze_record` returns.
        outcome: how it ended, in words.
        drawn, narrow: figures by caption, on a wide window and on a phone.
        replay: its motion, as of `studio.replay`; none by default.

    Returns:
        HTML text.
    """
    touched = [one for one in record["touched"] if one["time_s"] is not None]
    title = record["title"] or "A robot in an arena"
    off = [one["name"] for one in record["antennas"] if not one["connected"]]
    legs = {one["name"]: one["leg"] for one in record["antennas"] if one["connected"]}
    leg = Column("reprograms", lambda row: legs.get(row["antenna"], "nothing"))
    touches = f"It touched {len(touched)} of {counted(len(record['touched']), 'obstacle')}"
    pressed = (
        f", its antennas were pressed {counted(len(record['contacts']), 'time')}, and "
        f"{counted(len(record['changes']), 'change')} of gait followed"
        if record["antennas"]
        else ""
    )
    return parts.page(
        title,
        f"Simulated in the arena: {record['arena'] or 'without a name'}.",
        f"It {outcome} after {number(record['duration_s'], 3)} s",
        [
            f"{touches}{pressed}.",
            f"The levers of {', '.join(off)} were taken off." if off else "",
            parts.sentence(record["stopped"]),
        ],
        {
            "Walked": f"{number(record['distance_mm'], 3)} mm",
            "In cycles": str(record["cycles"]),
            "Cost of transport": _number(record["cost_of_transport"], 3),
        },
        [
            parts.part("See it move", parts.motion(replay, title) if replay else ""),
            parts.part("Its way", parts.pictures(drawn, narrow)),
            parts.part(
                "Obstacles", parts.table(TOUCHED, record["touched"], "When each was touched.")
            ),
            parts.part(
                "Antennas pressed",
                parts.table(
                    [*CONTACT, leg], record["contacts"], "Each press, and which leg it changes."
                ),
            ),
            parts.part(
                "Changes of gait",
                parts.table(CHANGE, record["changes"], "From when on, and to what."),
            ),
            _made(record["parameters"]),
        ],
    )


def sweep_page(
    record: Mapping[str, Any],
    columns: Sequence[Any],
    drawn: Mapping[str, Figure],
    narrow: Mapping[str, Figure],
) -> str:
    """The page of many robots.

    Args:
        record: what `results.sweep_record` returns.
        columns: those of a robot among many.
        drawn, narrow: figures by caption, on a wide window and on a phone.

    Returns:
        HTML text.
    """
    trials, keys = record["trials"], record["keys"]
    failed = [trial for trial in trials if trial["stopped"]]
    why = [Column("why it stopped", lambda trial: trial["stopped"])] if failed else []
    varied = [
        Column(key, lambda trial, k=k: number(trial["values"][k], 6), True)
        for k, key in enumerate(keys)
    ]
    return parts.page(
        counted(len(trials), "robot"),
        f"Varied: {', '.join(keys) or 'nothing'}.",
        f"{len(trials) - len(failed)} of {counted(len(trials), 'robot')} walked to the end",
        [f"The first that did not: {failed[0]['stopped']}" if failed else ""],
        {},
        [
            parts.part("What they did", parts.pictures(drawn, narrow)),
            parts.part(
                "One by one", parts.table([*varied, *columns, *why], trials, "A row a robot.")
            ),
        ],
    )


def _against_statics(record: Mapping[str, Any]) -> str:
    compared = record["as_predicted"] is not None
    return parts.sentence(f"{'the last cycle is ' if compared else ''}{record['comparison']}")


def _cycle(record: Mapping[str, Any]) -> str:
    if record["mean_advance_over_u_max"] is None:
        return "It did not last a whole cycle."
    after = "After the first cycle it" if record["cycles"] > 1 else "It"
    advance, turn = record["mean_advance_over_u_max"], record["mean_turn_deg"]
    way = "forward" if advance >= 0 else "backward"
    side = "left" if turn >= 0 else "right"
    return (
        f"{after} goes {way} by {number(abs(advance), 2)} of its longest step, "
        f"{number(record['u_max_mm'])} mm, in every cycle, and turns by {abs(turn):.1f}° "
        f"to the {side}."
    )


_SLIP = Column("slip [mm a cycle]", lambda row: row["slip"], True)


def _gaits(legs: Sequence[Mapping[str, Any]]) -> list[dict[str, str]]:
    """Equal gaits that follow each other told once: their cycles from 1, and the gait."""
    found: list[dict[str, str]] = []
    for leg in legs:
        first = 1
        for gait, same in groupby(leg["gaits"]):
            last = first + len(list(same)) - 1
            cycles = f"{first}" if first == last else f"{first} to {last}"
            slip = _number(leg["slip_mm"], 3)
            found.append(
                {"leg": leg["name"], "cycles": cycles, "states": gait or "none", "slip": slip}
            )
            first = last + 1
    return found


def _number(value: float | None, digits: int, sign: str = "") -> str:
    return "" if value is None else number(value, digits) + sign


def _degrees(value: float | None) -> str:
    return "" if value is None else f"{value:z.1f}°"


def _assumed(parameters: Sequence[Mapping[str, Any]]) -> dict[str, str]:
    assumed = sum(one["source"] == "assumed" for one in parameters)
    return {"Numbers that nobody measured": f"{assumed} of {len(parameters)}"}


def _made(parameters: Sequence[Mapping[str, Any]]) -> str:
    """What a robot is made of, with the source of every number."""
    return parts.part(
        "What it is made of",
        parts.table(
            [
                Quantity("key", head="key"),
                Column("value", lambda row: ", ".join(f"{v:.6g}" for v in row["values"]), True),
                Quantity("unit", head="unit"),
                Quantity("source", head="source"),
            ],
            parameters,
            "Every number with its source; its key is that of the design file.",
        ),
    )
