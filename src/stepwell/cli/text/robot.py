"""The results of `stepwell robot` as people read them."""

from __future__ import annotations

from typing import Any

from stepwell.cli.screen import number, show_lines, show_table
from stepwell.cli.text.sources import value_text

MOST_ROWS = 40
MOTIONS = {
    "forward": "walks forward",
    "backward": "walks backward",
    "left": "turns left",
    "right": "turns right",
    "none": "stays where it is",
}


def show(record: dict[str, Any]) -> None:
    """Print what `results.robot_record` returns."""
    said = record["prediction"]
    show_lines(
        *([record["title"], ""] if record["title"] else []),
        f"Weight      {number(record['mass_g'])} g, {number(record['weight_N'])} N",
        f"Predicted   {MOTIONS[said['motion']]}: d/u_max {said['advance_over_u_max']:.2f}, "
        f"{_turn(said['turn_deg'])}° to the left a cycle, u_max {number(record['u_max_mm'])} mm",
    )
    _legs(said["legs"])
    _pushes(said["legs"])
    _flips(said["legs"])
    near = [leg for leg in said["legs"] if leg["near_boundary"]]
    for leg in near:
        others = leg["alternatives"] or [leg["nearest"]]
        show_lines("", f"Too close to call: {leg['name']} may do {' or '.join(others)} as well.")
    show_table(
        "What it is made of",
        ["key", "value", "unit", "source"],
        [[one["key"], value_text(one), one["unit"], one["source"]] for one in record["parameters"]],
        left=(0, 2, 3),
    )


def _turn(value: float) -> str:
    return f"{0.0 if abs(value) < 0.05 else value:.1f}"


def _legs(legs: list[dict[str, Any]]) -> None:
    show_table(
        "Predicted gaits, without simulation",
        [
            *("leg", "states", "feet [mm]", "d/u_max", "margin [mN]", "unknown [mN]"),
            "past the margin",
        ],
        [
            [
                leg["name"],
                leg["gait"],
                feet_text(leg["feet_mm"]),
                f"{leg['advance_over_u_max']:.2f}",
                "over 2000" if leg["margin_mN"] is None else number(leg["margin_mN"], 3),
                number(leg["uncertainty_mN"], 3),
                leg["nearest"],
            ]
            for leg in legs
        ],
        left=(0, 1, 6),
    )


def feet_text(depths: list[float] | None) -> str:
    """Depths of the feet [mm] between which a gait surely stays what it is."""
    return "" if depths is None else f"{depths[0]:.2f} to {depths[1]:.2f}"


def _pushes(legs: list[dict[str, Any]]) -> None:
    rows = [
        [
            leg["name"],
            push["direction"],
            f"{push['gain_mm']:.1f} of {push['step_mm']:.1f}",
            number(push["drag_N"], 3),
            "any" if push["largest_drag_N"] is None else number(push["largest_drag_N"], 3),
            push["limit"],
        ]
        for leg in legs
        for push in leg["pushes"]
    ]
    if rows:
        show_table(
            "Pushes",
            ["leg", "while", "gains [mm]", "drag [N]", "goes on up to [N]", "then"],
            rows,
            left=(0, 1, 5),
        )


def _flips(legs: list[dict[str, Any]]) -> None:
    rows = [
        [
            flip["antenna"],
            leg["name"],
            number(flip["displacement_mm"], 3),
            _range(flip),
            number(flip["swing_deg"], 3),
            flip["gait"],
        ]
        for leg in legs
        for flip in leg["flips"]
    ]
    if rows:
        show_table(
            "What antennas change",
            ["antenna", "leg", "anchor moved [mm]", "in doubt [mm]", "swing [deg]", "then"],
            rows,
            left=(0, 1, 5),
        )


def _range(flip: dict[str, Any]) -> str:
    earliest = number(flip["earliest_mm"], 3)
    if flip["latest_mm"] is None:
        return f"{earliest} on, or never"
    return f"{earliest} to {number(flip['latest_mm'], 3)}"


def show_sweep(record: dict[str, Any]) -> None:
    """Print what `results.sweep_record` returns."""
    trials, keys = record["trials"], record["keys"]
    rows = [
        [
            *(number(value, 6) for value in trial["values"]),
            *_measures(trial),
            " | ".join(dict.fromkeys(gait or "none" for gait in trial["gaits"])),
        ]
        for trial in trials[:MOST_ROWS]
    ]
    show_table(
        f"{len(trials)} robots",
        [*keys, "d/u_max", "turn [deg]", "states of the last cycle"],
        rows,
        left=(len(keys) + 2,),
        hidden=len(trials) - MOST_ROWS,
    )
    failed = [trial for trial in trials if trial["stopped"]]
    if failed:
        first = failed[0]["stopped"]
        show_lines("", f"{len(failed)} did not walk to the end; the first of them: {first}")


def show_convergence(record: dict[str, Any]) -> None:
    """Print what `results.convergence_record` returns."""
    show_table(
        f"{record['title'] or 'robot'}, by time step",
        ["time step [ms]", "d/u_max", "turn [deg]", "floor forces off [% of weight]", "jumps [%]"],
        [
            [
                number(row["time_step_ms"]),
                f"{row['advance_over_u_max']:z.3f}",
                _turn(row["turn_deg"]),
                f"{row['forces_off_percent']:.2f}",
                f"{row['jumps_percent']:.1f}",
            ]
            for row in record["time_steps"]
        ],
        left=(),
    )
    show_lines(
        "",
        "Forces off: of samples, root mean square against the last row. Jumps: steps in which a",
        "force of the floor changes by more than a fifth.",
    )


def _measures(trial: dict[str, Any]) -> list[str]:
    advance, turn = trial["advance_over_u_max"], trial["turn_deg"]
    return ["" if advance is None else f"{advance:.3f}", "" if turn is None else _turn(turn)]
