"""The results of `stepwell robot`, `walk` and `maze` as people read them."""

from __future__ import annotations

from itertools import groupby
from typing import Any

from stepwell.base import Column, Quantity, number, rows_of
from stepwell.cli.screen import show_facts, show_lines, show_records
from stepwell.results import (
    CHANGE,
    CONTACT,
    CYCLES,
    FLIP,
    PREDICTED,
    PUSH,
    RESOLUTION,
    TOUCHED,
)
from stepwell.robot import Motion

MOST_ROWS = 40
_LISTED = "`stepwell robot show` lists them all"
_LEG = Column("leg", lambda row: row["leg"])


def robot(record: dict[str, Any]) -> None:
    """Print what `results.robot_record` returns."""
    said = record["prediction"]
    legs, motion = said["legs"], Motion[said["motion"].upper()].value
    found = {
        "Weight": f"{number(record['mass_g'])} g, {number(record['weight_N'])} N",
        "Predicted": f"{motion}: d/u_max {said['advance_over_u_max']:.2f}, "
        f"{said['turn_deg']:z.1f}° to the left a cycle, u_max {number(record['u_max_mm'])} mm",
        "Drive": said["too_soft"].removeprefix("the drive is "),
        "Drive needs": _needs(said["drive_needs"]),
        "Assumed": _assumed(record["parameters"])
        and f"{_assumed(record['parameters'])}; see below",
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
            Column("value", _numbers, True),
            Quantity("unit", head="unit"),
            Quantity("source", head="source"),
        ],
        record["parameters"],
        most=None,
    )


def _needs(needs: dict[str, Any]) -> str:
    """What a motor must have for the gait."""
    stiffness = needs["stiffness_N_per_m"]
    enough = f"{number(stiffness, 3)} N/m or more" if stiffness else "any stiffness"
    return f"{number(needs['push_N'], 3)} N out, {number(needs['pull_N'], 3)} N back, {enough}"


def _of_legs(legs: list[dict[str, Any]], name: str) -> list[dict[str, Any]]:
    return [{"leg": leg["name"]} | one for leg in legs for one in leg[name]]


def _range(flip: Any) -> str:
    earliest = number(flip["earliest_mm"], 3)
    if flip["latest_mm"] is None:
        return f"{earliest} on, or never"
    return f"{earliest} to {number(flip['latest_mm'], 3)}"


def sweep(record: dict[str, Any]) -> None:
    """Print what `results.sweep_record` returns."""
    from stepwell.simulation import TRIAL

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


def convergence(record: dict[str, Any]) -> None:
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
        "Forces off: of samples, root mean square against the last row. Jumps: steps in which a "
        "force of the floor changes by more than a fifth.",
    )


def walk(record: dict[str, Any]) -> None:
    """Print what `results.walk_record` returns."""
    per_cycle = record["work_per_cycle_mJ"]
    found = {
        "Walked": f"{number(record['distance_mm'])} mm in {record['cycles']} cycles of "
        f"{number(record['period_s'])} s",
        "A cycle": _mean(record),
        "Work": per_cycle is not None and f"{number(per_cycle)} mJ a cycle",
        "Statics": record["comparison"],
        "Transport": record["cost_of_transport"] is not None
        and f"{number(record['cost_of_transport'], 3)} of work over weight and distance",
        "Stopped": record["stopped"].removeprefix("Stopped "),
        "Assumed": _assumed(record["parameters"])
        and f"{_assumed(record['parameters'])}; {_LISTED}",
    }
    show_facts(record, found, 12)
    _gaits(record["legs"])
    _feet(record)
    cycles = rows_of({q.key: record[q.key] for q in CYCLES})
    show_records(
        "Cycle by cycle",
        [Quantity("cycle", head="cycle"), *CYCLES],
        [{"cycle": k} | cycle for k, cycle in enumerate(cycles, 1)],
    )


def _mean(record: dict[str, Any]) -> str:
    """How far and round a robot goes in a cycle."""
    if record["mean_advance_over_u_max"] is None:
        return ""
    after = " after the first" if record["cycles"] > 1 else ""
    return (
        f"d/u_max {record['mean_advance_over_u_max'] + 0.0:.3f} and "
        f"{record['mean_turn_deg']:z.1f}° to the left{after}"
    )


def _gaits(legs: list[dict[str, Any]]) -> None:
    rows = [
        {"leg": "" if i else leg["name"], "cycles": when, "states": gait}
        | {"slip": "" if i else number(leg["slip_mm"], 3)}
        for leg in legs
        for i, (when, gait) in enumerate(_runs(leg["gaits"]))
    ]
    words = (Quantity(name, head=name) for name in ("leg", "cycles", "states"))
    slip = Quantity("slip", head="slip [mm a cycle]", left=False)
    show_records("Gaits", [*words, slip], rows)


def _feet(record: dict[str, Any]) -> None:
    known = [leg for leg in record["legs"] if leg["feet_mm"] is not None]
    if known:
        feet = next(q for q in PREDICTED if q.name == "feet")
        each = ", ".join(f"{leg['name']} {feet.cell(leg)} mm" for leg in known)
        show_lines(
            "",
            f"Feet stand {number(record['foot_mm'])} mm deep; by statics the predicted gait stays: "
            f"{each}.",
        )


def _runs(gaits: list[str]) -> list[tuple[str, str]]:
    """Equal gaits that follow each other told once: their cycles from 1, and the gait."""
    found: list[tuple[str, str]] = []
    first = 1
    for gait, same in groupby(gaits):
        last = first + len(list(same)) - 1
        found.append((f"{first}" if first == last else f"{first} to {last}", gait or "none"))
        first = last + 1
    return found


def maze(record: dict[str, Any]) -> None:
    """Print what `results.maze_record` returns."""
    from stepwell.simulation import Outcome

    touched = sum(one["time_s"] is not None for one in record["touched"])
    x, y = record["end_mm"] or (None, None)
    found = {
        "Outcome": f"{Outcome[record['outcome'].upper()]} after {number(record['duration_s'])} s",
        "Arena": record["arena"],
        "Touched": record["touched"] and f"{touched} of {len(record['touched'])} obstacles",
        "Antennas": _antennas(record["antennas"]),
        "Ended at": x is not None and f"({number(x)}, {number(y)}) mm",
        "Stopped": record["stopped"].removeprefix("Stopped "),
        "Assumed": _assumed(record["parameters"])
        and f"{_assumed(record['parameters'])}; {_LISTED}",
    }
    show_facts(record, found, 12)
    show_records("Obstacles", TOUCHED, record["touched"], most=None)
    legs = {one["name"]: one["leg"] for one in record["antennas"] if one["connected"]}
    leg = Column("reprograms", lambda contact: legs.get(contact["antenna"], "nothing"))
    show_records("Antenna contacts", [*CONTACT, leg], record["contacts"])
    time, *gaits = CHANGE
    show_records(
        "Changes of gait", [Column("from [s] on", time.cell, True), *gaits], record["changes"]
    )


def _antennas(antennas: list[dict[str, Any]]) -> str:
    if not antennas:
        return "none"
    off = [one["name"] for one in antennas if not one["connected"]]
    if not off:
        return str(len(antennas))
    return f"{len(antennas)}, the levers of {', '.join(off)} taken off"


def _assumed(parameters: list[dict[str, Any]]) -> str:
    """How many numbers nobody has measured."""
    assumed = sum(one["source"] == "assumed" for one in parameters)
    return f"{assumed} of its {len(parameters)} numbers" if assumed else ""


def _numbers(parameter: Any) -> str:
    # Its key names the unit.
    return ", ".join(f"{value:.6g}" for value in parameter["values"])
