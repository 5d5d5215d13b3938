"""The results of `stepwell robot` as people read them."""

from __future__ import annotations

from typing import Any

from stepwell.base import Column, Quantity, number
from stepwell.cli.screen import show_facts, show_lines, show_records
from stepwell.cli.text.sources import value_text
from stepwell.results import FLIP, PREDICTED, PUSH, RESOLUTION
from stepwell.simulation import TRIAL

MOST_ROWS = 40
MOTIONS = {
    "forward": "walks forward",
    "backward": "walks backward",
    "left": "turns left",
    "right": "turns right",
    "none": "stays where it is",
}
_LEG = Column("leg", lambda row: row["leg"])


def show(record: dict[str, Any]) -> None:
    """Print what `results.robot_record` returns."""
    said = record["prediction"]
    legs = said["legs"]
    found = {
        "Weight": f"{number(record['mass_g'])} g, {number(record['weight_N'])} N",
        "Predicted": f"{MOTIONS[said['motion']]}: d/u_max {said['advance_over_u_max']:.2f}, "
        f"{said['turn_deg']:z.1f}° to the left a cycle, u_max {number(record['u_max_mm'])} mm",
    }
    show_facts(record, found, 12)
    named = {q.name: q for q in PREDICTED}
    order = ("name", "gait", "feet", "advance", "margin", "uncertainty", "nearest")
    show_records("Predicted gaits, without simulation", [named[name] for name in order], legs)
    way, _, _, _, *rest = PUSH
    gains = Column("gains [mm]", lambda p: f"{p['gain_mm']:.1f} of {p['step_mm']:.1f}", True)
    show_records("Pushes", [_LEG, way, gains, *rest], _of_legs(legs, "pushes"), most=None)
    antenna, moved, _, _, swing, then = FLIP
    doubt = Column("in doubt [mm]", _range, True)
    flips = _of_legs(legs, "flips")
    columns = [antenna, _LEG, moved, doubt, swing, then]
    show_records("What antennas change", columns, flips, most=None)
    for leg in legs:
        if leg["near_boundary"]:
            may = " or ".join(leg["alternatives"] or [leg["nearest"]])
            show_lines("", f"Too close to call: {leg['name']} may do {may} as well.")
    show_records(
        "What it is made of",
        [
            Quantity("key", head="key"),
            Column("value", value_text, True),
            Quantity("unit", head="unit"),
            Quantity("source", head="source"),
        ],
        record["parameters"],
        most=None,
    )


def _of_legs(legs: list[dict[str, Any]], name: str) -> list[dict[str, Any]]:
    return [{"leg": leg["name"]} | one for leg in legs for one in leg[name]]


def _range(flip: Any) -> str:
    earliest = number(flip["earliest_mm"], 3)
    if flip["latest_mm"] is None:
        return f"{earliest} on, or never"
    return f"{earliest} to {number(flip['latest_mm'], 3)}"


def show_sweep(record: dict[str, Any]) -> None:
    """Print what `results.sweep_record` returns."""
    trials = record["trials"]
    varied = [
        Column(key, lambda trial, k=k: number(trial["values"][k], 6), True)
        for k, key in enumerate(record["keys"])
    ]
    show_records(f"{len(trials)} robots", [*varied, *TRIAL], trials, most=MOST_ROWS)
    failed = [trial for trial in trials if trial["stopped"]]
    if failed:
        first = failed[0]["stopped"]
        show_lines("", f"{len(failed)} did not walk to the end; the first of them: {first}")


def show_convergence(record: dict[str, Any]) -> None:
    """Print what `results.convergence_record` returns."""
    step, advance, turn, off, jumps = RESOLUTION
    forces = Column("floor forces off [% of weight]", off.cell, True)
    show_records(
        f"{record['title'] or 'robot'}, by time step",
        [step, advance, turn, forces, jumps],
        record["time_steps"],
    )
    show_lines(
        "",
        "Forces off: of samples, root mean square against the last row. Jumps: steps in which a",
        "force of the floor changes by more than a fifth.",
    )
