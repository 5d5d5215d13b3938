"""The results of commands about chains as people read them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

from stepwell.base import Column, Quantity, number, percent, signed, told_in
from stepwell.cli.screen import (
    show_facts,
    show_lines,
    show_records,
    show_text,
    wrapped,
)
from stepwell.design.margins import WAY
from stepwell.mechanism import Chain
from stepwell.results import (
    NOT_CHECKED,
    SENSITIVITY,
    built_schema,
    cell_schema,
    change_columns,
    cycle_schema,
    drive_schema,
    elsewhere_of,
    elsewhere_rows,
    event_columns,
    landings_told,
    nearest_changes,
    tolerance_words,
)
from stepwell.sequences import Pathway
from stepwell.sequences.programs import turn_schema

if TYPE_CHECKING:
    from stepwell.sequences import ImplicitGraph

# The states of a longer chain are too long to be read.
MOST_CELLS = 12


def run(record: dict[str, Any], chain: Chain) -> None:
    """Print what `results.run_record` returns of a chain."""
    names = list(chain.names)
    dissipated, peak, _, *driven = cycle_schema(chain)
    found = {
        "Sequence": record["sequence"] if len(names) <= MOST_CELLS else None,
        "Pathway": (record["pathway"] or "").replace("_", " "),
        "Loading": _order(record["loading_order"], names),
        "Unloading": _order(record["unloading_order"], names),
        f"Peak {chain.measure.force}": f"{peak.cell(record)} {peak.sign}",
        "Driven": "".join(f"{points.cell(record)} {points.sign}" for points in driven),
        "Dissipated": f"{dissipated.cell(record)} {dissipated.sign} in a cycle",
        "Margin": _nearest(record["margin"], chain),
        "Landings": _landings(record),
    }
    show_facts(record, found, 2 + max(map(len, found)))
    show_events(record, chain)
    show_records("Cells, innermost first", cell_schema(chain), record["cells"])
    changes = record["margin"]["changes"]
    show_records(
        "Margin: the smallest change of one thing that gives another sequence",
        change_columns(chain, changes),
        changes,
    )
    if record["ties"]:
        show_lines("", "Too close to call", *record["ties"])


def _order(cells: Sequence[int], names: Sequence[str], most: int = 12) -> str:
    shown = ", ".join(names[cell] for cell in cells[:most])
    return shown + f" and {len(cells) - most} more" * (len(cells) > most)


def _nearest(margin: dict[str, Any], chain: Chain) -> str:
    found = list(nearest_changes(chain, margin["changes"]).values())
    if found:
        listed = " or ".join([*([", ".join(found[:-1])] if found[1:] else []), found[-1]])
        return f"{listed} to another sequence ({margin['method']})"
    if len(chain.elements) == len(chain):
        return "no other sequence by any change of one thing"
    return f"no other sequence within {number(margin['reach_mm'])} mm of any anchor"


def _landings(record: dict[str, Any]) -> str:
    told = landings_told(record["landings"])
    return f"{told}; --mobility-ratio 10 does" if told == NOT_CHECKED else told


def show_events(record: dict[str, Any], chain: Chain) -> None:
    """Print a table of switches and snaps, and one of other places where these land."""
    show_records("Switches and snaps", event_columns(chain), record["events"])
    show_records(
        "Landings that other mobilities of the cells change",
        elsewhere_of(chain),
        elsewhere_rows(record["landings"], record["events"]),
    )


def map_(record: dict[str, Any]) -> None:
    """Print what `results.map_record` returns."""
    across, up = (
        f"{axis['parameter']} {number(axis['from'])} to {number(axis['to'])}"
        f"{_unit(axis['unit'])}, {axis['count']} values"
        for axis in (record["across"], record["up"])
    )
    show_lines(record["title"], "", f"Across  {across}", f"Up      {up}")
    labels = {pathway.value: pathway.label for pathway in Pathway}
    pathway = Column("pathway", lambda one: labels.get(one["sequence"], ""))
    show_records(
        "Sequences",
        [
            *([pathway] if "pathway_shares" in record else []),
            Quantity("sequence", head="sequence"),
            Column("share of the map", lambda one: f"{100 * one['share']:.1f} %", True),
        ],
        [{"sequence": name, "share": share} for name, share in record["shares"].items() if share],
        most=None,
    )
    show_lines(
        "",
        f"{record['moved_cell']} is monostable on {100 * record['monostable_fraction']:.1f} % of "
        f"the map. {record['closed_form_designs']} designs in closed form, "
        f"{record['engine_designs']} by the engine; {record['degenerate_designs']} sit on a "
        f"boundary.",
    )
    show_records("Boundaries", _BOUNDARY, record["boundaries"], most=None)


def _unit(unit: str) -> str:
    return "" if unit == "1" else f" {Quantity('', unit).sign}"


def _error(boundary: Any) -> str:
    exact = boundary["method"] == "exact"
    return "" if exact else f"{number(boundary['error_of_axes'], 2)} of the axes"


_BOUNDARY = (
    Quantity("changes", head="what changes"),
    Quantity("points", head="points", left=False),
    Quantity("method", head="how"),
    Column("within", _error),
)


_FEW = 4  # cells of a row
# What is said of a cell that has moved; where it has two phases, its name tells that it did.
_PLACE = {"01": "", "11": "", **{f"-{last}": " in transit" for last in "123456789"}}


def implicit_graph(record: dict[str, Any], graph: ImplicitGraph) -> None:
    """Print what `results.implicit_graph_record` returns of a graph."""
    show_facts(record, {}, 0)
    show_lines(*str(graph).splitlines())
    unit, _ = told_in(graph.unit)
    names, start, walk = graph.names, record["start"], record["walk"]
    readable = len(names) <= MOST_CELLS
    number = {node["label"]: k for k, node in enumerate(walk, 1)}

    def state(node: Mapping[str, Any]) -> str:
        if readable:
            return node["label"]
        last = zip(names, node["label"], start, graph.chain.last_state, strict=False)
        left = [
            name + _PLACE.get(at + most, f" at {at}") for name, at, was, most in last if at != was
        ]
        return _order(range(len(left)), left, _FEW) or "nothing"

    def leads(way: str, node: Mapping[str, Any]) -> str:
        if node[way] is None:
            return ""
        to = number.get(node[way]["to"])
        return _order(node[way]["cells"], names, _FEW) + (f" → {to}" if to else "")

    begin = start if readable else "all cells at 0" if start == graph.zero else "the start"
    count = "all" if record["walk_whole"] else "the first"
    show_records(
        f"A walk from {begin}: {count} {len(walk)} nodes, those near by first",
        (
            Column("node", lambda node: str(number[node["label"]]), True),
            Column("state" if readable else "unlike the start", state),
            Quantity("low", unit, "from"),
            Quantity("high", unit, "to"),
            Column("up", partial(leads, "up")),
            Column("down", partial(leads, "down")),
        ),
        walk,
    )
    if record["ties"]:
        show_lines("", "Too close to call", *record["ties"])


def program(record: dict[str, Any], chain: Chain) -> None:
    """Print what `results.program_record` or `results.unreachable_record` returns of a chain."""
    if record["arrives"] is None:
        show_facts(record, {}, 10)
        show_lines(*wrapped(record["reason"]))
        return
    unit, _ = told_in(chain.drive_unit)
    points, _, _, off = drive_schema(unit)
    slack = record[off.key]
    found = {
        "Program": f"{record['from']} to {record['to']}: {_verdict(record)}",
        "Turns at": _points(record[points.key], points.sign),
        "Slack": slack is not None
        and f"every turn may be off by {number(slack, 3)} {off.sign} at once",
        "States": len(record["cells"]) <= MOST_CELLS and record["sequence"],
        "Landings": landings_told(record["landings"]),
    }
    show_facts(record, found, 10)
    # Where a turn can go back to is known of programs that were searched for.
    columns = turn_schema(unit)[: None if any(turn["branch"] for turn in record["turns"]) else -1]
    show_records(
        "Turns: anywhere in its window each does the same",
        [Quantity("turn", head="turn"), *columns],
        [{"turn": k} | turn for k, turn in enumerate(record["turns"], 1)],
    )
    show_events(record, chain)
    show_text(f"{record['reason']}.")


def _verdict(record: dict[str, Any]) -> str:
    times = f"{record['strokes']} stroke{'s' * (record['strokes'] != 1)}"
    return times if record["does_it"] else f"ends in {record['arrives']} after {times}"


def _points(points: list[float], unit: str) -> str:
    more = f" and {len(points) - 12} more" if len(points) > 12 else ""
    return " → ".join(map(number, points[:12])) + f" {unit}{more}"


# Of the places on the way every so manieth is printed; --json and --out have all.
EVERY = 5


def reprogram(record: dict[str, Any]) -> None:
    """Print what `results.reprogram_record` returns."""
    if not record["possible"]:
        wanted = record["target"] or "another sequence"
        reach = record.get("reach_mm")
        tried = (
            f"value of {record['by']} that was looked at"
            if reach is None
            else f"displacement of {record['by']} up to {number(reach)} mm"
        )
        show_facts(record, {}, 0)
        show_lines(f"No {tried} makes it {wanted} ({record['method']}).")
    elif not _told(record, "distance")[0]:
        show_facts(record, {}, 0)
        show_lines(f"It does {record['before']} already.")
        return
    elif record["way"]:
        _displacement(record)
    else:
        to, unit = _told(record, "place")
        by, _ = _told(record, "displacement")
        found = {
            "Now": record["before"],
            "Then": record["after"],
            "Set": f"{record['by']} to {number(to)}{unit} ({signed(by)}; {record['method']})",
        }
        show_facts(record, found, 7)
    if record["resolution"]:
        show_text(f"Searched, not exact: {record['resolution']}")


def _told(record: dict[str, Any], name: str) -> tuple[Any, str]:
    """A number with the unit that stands in its key."""
    key = next(key for key in record if key == name or key.startswith(f"{name}_"))
    return record[key], _unit(key.removeprefix(name).removeprefix("_") or "1")


def _displacement(record: dict[str, Any]) -> None:
    x, y = record["displacement_mm"]
    at_x, at_y = record["place_mm"]
    found = {
        "Now": record["before"],
        "Then": record["after"],
        "Move": f"{record['by']} by ({signed(x)}, {signed(y)}) mm, {number(record['distance_mm'])} "
        f"mm, to ({number(at_x)}, {number(at_y)}) mm ({record['method']})",
        "Force": f"up to {number(record['largest_force_N'])} N against the displacement",
        "Work": f"{number(record['work_at_0_mJ'])} mJ at state 0 of the cell, "
        f"{number(record['work_at_1_mJ'])} mJ at state 1",
    }
    show_facts(record, found, 7)
    columns = [Quantity("moved", "mm", "moved"), *WAY[1:]]
    keys = [column.key for column in columns]
    rows = (
        (one["fraction"] * record["distance_mm"], *one["at_mm"], *list(one.values())[2:])
        for one in record["way"]
    )
    show_records(
        "On the way: force against the displacement",
        columns,
        [dict(zip(keys, row, strict=True)) for row in rows],
        most=None,
        every=EVERY,
    )


# A list of more states than these helps nobody.
MOST_STATES = 16


def design(record: dict[str, Any], chain: Chain | None) -> None:
    """Print what `results.design_record` or `results.impossible_record` returns of a chain."""
    if chain is None:
        show_lines(*wrapped(record["reason"]))
        return
    shares = _shares(record["yield"], chain) | {"Wanted": ""}
    found = _states(record) | shares | {"Worst": _robustness(record["robustness"], chain)}
    show_facts({"title": ""}, found, 10)
    schema = built_schema(chain)
    if not chain.elements:
        # What can be chosen stands before what is given.
        name, p, q, *others = schema
        schema = name, q, p, *others
    show_records("Cells, innermost first", schema, record["cells"])
    more = f"more states may be in reach: {record['states_how']}"
    show_text(record["reason"], *([] if record["states_whole"] else [more]), record["assumptions"])


def _states(record: dict[str, Any]) -> dict[str, str]:
    count, states = record["state_count"], record["states"]
    listed = f"{count} states" if record["states_whole"] else f"{count} states surely"
    if states is None:
        return {"In reach": listed}
    more = f" and {len(states) - MOST_STATES} more" if len(states) > MOST_STATES else ""
    listed += f": {', '.join(states[:MOST_STATES])}{more}"
    return {"Sequence": record["sequence"], "In reach": listed}


def _robustness(found: dict[str, Any] | None, chain: Chain) -> str:
    if found is None:
        return ""
    if "share" in found:
        text = f"all {chain.measure.force}s may be off by {number(found['share'] * 100)} % at once"
    else:
        text = f"all anchors may be off by {number(found['radius_mm'])} mm at once"
    if found["meet"] is not None:
        first, second = (chain.names[cell] for cell in found["meet"])
        text += f"; then {first} and {second} change places while {found['while']}"
    return text


MOST_ROWS = 12


def yields(record: dict[str, Any], chain: Chain) -> None:
    """Print what `results.yield_record` or `results.survival_record` returns of a chain."""
    show_facts(record, _shares(record, chain), 10)
    if "outcomes" not in record:
        calibrated(record)
        show_text(record["assumptions"])
        return
    if record["advice"]:
        show_text(record["advice"])
    show_records(
        "What the others do",
        [
            Column("outcome", lambda one: one["outcome"]),
            Column("share", lambda one: percent(one["count"] / record["samples"]), True),
        ],
        record["outcomes"],
        most=MOST_ROWS,
    )
    if record["sensitivities"] is not None:
        show_records(
            "Share of the variance of the smallest gap that a part makes, alone and with others",
            SENSITIVITY,
            sorted(record["sensitivities"], key=lambda one: -one["total"]),
            most=MOST_ROWS,
        )
        if record["gap_agreement"] is not None:
            agreed = percent(record["gap_agreement"])
            show_lines(f"The gap tells what the engine finds in {agreed}")
    calibrated(record)
    show_text(record["assumptions"])


def calibrated(record: dict[str, Any]) -> None:
    """Print what recordings have told, where some were folded in."""
    if about := record["calibrated"]:
        show_text(
            f"Bands, weight and friction as calibrated on {about['data']}:", *about["summary"]
        )


def _shares(record: dict[str, Any], chain: Chain) -> dict[str, str]:
    """Share, tolerances and critical pair of a yield."""
    tolerances = tolerance_words(record["tolerances"], chain)
    low, high = percent(record["share_low"]), percent(record["share_high"])
    return {
        "Yield": f"{percent(record['share'])}, with 95 % confidence {low} to {high}",
        "Wanted": record.get("wanted") or f"{record['from']} to {record['to']} by the program",
        "Made": f"{record['samples']} mechanisms with {tolerances}",
        "Critical": _critical(record.get("critical"), chain.names),
    }


def _critical(pair: dict[str, Any] | None, names: Sequence[str]) -> str:
    if pair is None:
        return ""
    first, second = pair.get("names") or (names[pair["first"]], names[pair["second"]])
    return (
        f"{first} before {second} while {pair['while']}: in the other order in "
        f"{percent(pair['share'])}"
    )
