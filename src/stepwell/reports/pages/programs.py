"""The page of a stroke program: where it leads, and how far each turn may be off."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from stepwell.base import Quantity, counted, number, told_in
from stepwell.reports.pages import parts
from stepwell.results import assumptions, drive_schema, event_columns, landings_told, program_record
from stepwell.sequences.programs import turn_schema

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from stepwell.sequences import Program

# More turning points than these are not read in a line.
_MOST_TURNS = 12


def program_page(
    program: Program,
    drawn: Mapping[str, Figure],
    narrow: Mapping[str, Figure],
    replay: str = "",
) -> str:
    """The page of a program.

    Args:
        program: played or found.
        drawn, narrow: figures by caption, on a wide window and on a phone.
        replay: its motion, as of `studio.replay`; none by default.

    Returns:
        HTML text.
    """
    chain, record = program.chain, program_record(program)
    unit, _ = told_in(chain.drive_unit)
    points, _, _, off = drive_schema(unit)
    times = counted(record["strokes"], "stroke")
    does = record["does_it"]
    verdict = f"{times} bring it there" if does else f"it ends in {record['arrives']} instead"
    turns = record[points.key]
    more = " and so on" * (len(turns) > _MOST_TURNS)
    where = ", ".join(map(number, turns[:_MOST_TURNS])) + more
    slack = record[off.key]
    said = (
        f"Driven to {where} {points.sign} in turn, it goes from {record['from']} to "
        f"{record['arrives']}."
    )
    safe = (
        f"Every turn may be off by {number(slack, 3)} {off.sign} at once, and it still does."
        if slack is not None and does
        else ""
    )
    # Where a turn can go back to is known of programs that were searched for.
    known = any(turn["branch"] for turn in record["turns"])
    columns = [Quantity("turn", head="turn"), *turn_schema(unit)[: None if known else -1]]
    rows = [{"turn": k} | turn for k, turn in enumerate(record["turns"], 1)]
    landings = landings_told(record["landings"])
    title = chain.title or "A stroke program"
    return parts.page(
        title,
        f"A program from {record['from']} to {record['to'] or record['arrives']} for "
        f"{counted(len(chain), 'cell')}, innermost first.",
        f"{record['from']} to {record['to'] or record['arrives']}: {verdict}",
        [said, safe, parts.sentence(record["reason"])],
        {
            "Strokes": str(record["strokes"]),
            "Each turn may be off by": "" if slack is None else f"{number(slack, 3)} {off.sign}",
            "Lost on the way": f"{number(record['dissipated_mJ'], 3)} mJ",
        },
        [
            parts.part(
                "The way",
                parts.pictures(drawn, narrow),
                parts.paragraph(
                    f"It passes {record['sequence']}".replace(">", " → ") + "."
                    if record["sequence"]
                    else ""
                ),
            ),
            parts.part("See it move", parts.motion(replay, title) if replay else ""),
            parts.part(
                "Turns", parts.table(columns, rows, "Anywhere in its window each does the same.")
            ),
            parts.part(
                "Switches and snaps",
                parts.table(
                    event_columns(chain, page=True),
                    record["events"],
                    "A switch is a cell arriving in a state; a snap is a jump.",
                ),
                parts.paragraph(f"Landings: {landings}." if landings else ""),
            ),
            parts.part("What the numbers assume", parts.listed(assumptions(chain))),
        ],
    )
