"""Pages of designs that were found or judged: how they are built, and how many work."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from stepwell.base import Column, Quantity, counted, number, percent, signed, told_in
from stepwell.design import WAY
from stepwell.reports.pages import parts, words
from stepwell.results import (
    SENSITIVITY,
    assumptions,
    built_schema,
    design_record,
    reprogram_record,
    yield_record,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from stepwell.design import Design, Reprogramming, Survival, Yield

# A list of more states than these helps nobody.
_MOST_STATES = 16
_COUNT = Column("share", lambda row: percent(row["share"]), True)


def design_page(found: Design, drawn: Mapping[str, Figure]) -> str:
    """The page of a design that was found.

    Args:
        found: what `design.design` returns.
        drawn: figures by caption.

    Returns:
        HTML text.
    """
    chain, record = found.chain, design_record(found)
    spelled = len(chain) <= words.MOST_SPELLED
    cycle = chain.cycle()
    states = record["states"]
    reach = f"{record['state_count']} states" + " surely" * (not record["states_whole"])
    listed = ""
    if states is not None and len(states) <= _MOST_STATES:
        listed = f": {', '.join(states)}"
    return parts.page(
        chain.title or "A design",
        f"Found by search. {counted(len(chain), 'cell')}, innermost first.",
        record["sequence"] if spelled else f"{len(chain)} cells in the order wanted",
        [words.motion(cycle), words.built(found.yield_)],
        {
            "Of those built do it": percent(found.yield_.share),
            "Largest error of all anchors at once": _worst(record["robustness"]),
            "States in reach": reach,
        },
        [
            parts.part(
                "How to build it",
                parts.table(
                    built_schema(chain),
                    record["cells"],
                    "Cells, innermost first; p is the anchor on the inner, q on the outer block.",
                ),
            ),
            parts.part(
                "How surely it works",
                parts.pictures(drawn),
                _outcomes(found.yield_),
                _critical(found.yield_),
            ),
            parts.part(
                "How it was found",
                parts.paragraph(parts.sentence(record["reason"])),
                parts.paragraph(f"In reach are {reach}{listed}."),
            ),
            parts.part(
                "What the numbers assume",
                parts.listed([*assumptions(chain), parts.sentence(record["assumptions"])]),
            ),
        ],
    )


def _worst(found: dict[str, Any] | None) -> str:
    if found is None:
        return ""
    return (
        f"{number(found['share'] * 100, 3)} % of force"
        if "share" in found
        else f"{number(found['radius_mm'], 3)} mm"
    )


def yield_page(
    found: Yield,
    drawn: Mapping[str, Figure],
    narrow: Mapping[str, Figure],
    calibrated: Mapping[str, Any] | None = None,
) -> str:
    """The page of a yield.

    Args:
        found: what `design.yields` returns.
        drawn, narrow: figures by caption, on a wide window and on a phone.
        calibrated: what is told of the recordings that were folded in; None for none.

    Returns:
        HTML text.
    """
    chain, record = found.chain, yield_record(found)
    parts_of = sorted(record["sensitivities"] or (), key=lambda one: -one["total"])
    return parts.page(
        chain.title or "A yield",
        f"{counted(len(chain), 'cell')}, innermost first. Wanted: {found.wanted}".replace(
            ">", " → "
        ),
        f"{percent(found.share)} of those built do it",
        [words.built(found), parts.sentence(record["advice"] or "")],
        {
            "Do what is wanted": f"{found.successes} of {found.n}",
            "Surely between": " and ".join(map(percent, found.interval)),
        },
        [
            parts.part(
                "What those built do",
                parts.pictures(drawn, narrow),
                _critical(found),
                _outcomes(found),
            ),
            parts.part(
                "Whose tolerance counts",
                parts.table(
                    SENSITIVITY,
                    parts_of,
                    "Share of the variance of the smallest gap that a part makes, alone and with "
                    "others.",
                ),
            ),
            parts.calibration(calibrated),
            parts.part(
                "What the numbers assume",
                parts.listed([*assumptions(chain), parts.sentence(found.assumptions)]),
            ),
        ],
    )


def _outcomes(found: Yield) -> str:
    rows = [
        {"outcome": text.replace(">", " → "), "share": count / found.n}
        for text, count in found.outcomes.items()
    ]
    outcome = Column("what they do", lambda row: row["outcome"])
    return parts.table([outcome, _COUNT], rows, "What the others do, most frequent first.")


def _critical(found: Yield) -> str:
    pair = found.critical
    if pair is None:
        return ""
    before, after = pair.names
    return parts.paragraph(
        f"The order that goes wrong first: {before} before {after} while {pair.way}, the other way "
        f"round in {percent(pair.share)}."
    )


def survival_page(found: Survival, calibrated: Mapping[str, Any] | None = None) -> str:
    """The page of how many mechanisms a program works on.

    Args:
        found: what `design.survival` returns.
        calibrated: what is told of the recordings that were folded in; None for none.

    Returns:
        HTML text.
    """
    chain, unit = found.chain, told_in(found.chain.drive_unit)
    where = ", ".join(number(point * unit[1]) for point in found.turning_points)
    return parts.page(
        chain.title or "A program on mechanisms as they are built",
        f"{counted(len(chain), 'cell')}, innermost first. The program goes from "
        f"{found.start} to {found.ends}.",
        f"On {percent(found.share)} of those built the program works",
        [
            words.built(found, "end where they should"),
            f"The actuator turns at {where} {Quantity('', unit[0]).sign}.",
        ],
        {
            "Arrive where they should": f"{found.successes} of {found.n}",
            "Surely between": " and ".join(map(percent, found.interval)),
        },
        [
            parts.calibration(calibrated),
            parts.part(
                "What the numbers assume",
                parts.listed([*assumptions(chain), parts.sentence(found.assumptions)]),
            ),
        ],
    )


def reprogramming_page(found: Reprogramming) -> str:
    """The page of the smallest change that makes a chain do something else.

    Args:
        found: what `design.reprogram` returns.

    Returns:
        HTML text.
    """
    chain, record = found.chain, reprogram_record(found)
    wanted = (record["target"] or "another sequence").replace(">", " → ")
    unit, factor = told_in(found.unit)
    sign = Quantity("", unit).sign
    tell = "" if unit == "1" else f" {sign}"
    if not record["possible"]:
        answer, said = f"Nothing found that makes it {wanted}", [""]
    else:
        by = found.displacement
        moved = (
            f"({', '.join(signed(one * factor) for one in by)}){tell}"
            if isinstance(by, tuple)
            else f"{signed(by * factor)}{tell}"
        )
        answer = f"{record['by']} changed by {number(found.distance * factor, 3)}{tell}"
        said = [
            f"It goes {record['before']}. With {record['by']} changed by {moved} it would go "
            f"{record['after'] or wanted}.".replace(">", " → ")
        ]
    force = record.get("largest_force_N")
    numbers = {
        "Most force against it on the way": "" if force is None else f"{number(force, 3)} N",
        "How it was found": record["method"],
    }
    columns = [Quantity("moved", unit, "moved"), *WAY[1:]]
    rows = [
        dict(
            zip(
                (column.key for column in columns),
                (row["fraction"] * found.distance * factor, *row["at_mm"], *list(row.values())[2:]),
                strict=True,
            )
        )
        for row in record["way"]
    ]
    return parts.page(
        chain.title or "Something else",
        f"{counted(len(chain), 'cell')}, innermost first. Wanted: {wanted}.",
        answer,
        said,
        numbers if math.isfinite(found.distance) else {},
        [
            parts.part("On the way", parts.table(columns, rows, "Force against the displacement.")),
            parts.part(
                "What the numbers assume",
                parts.paragraph(parts.sentence(record["resolution"] or "")),
                parts.listed(assumptions(chain)),
            ),
        ],
    )
