"""A stroke program: its turning points, their tolerance intervals, and the events."""

from stepwell.accounts import events, words
from stepwell.accounts.chain import actuator_schema
from stepwell.accounts.head import About, Row, Shape, keys, of_class
from stepwell.accounts.parts import CARD, Account, Fact, Picture, RecordTable, Replay, Text
from stepwell.base import Quantity, Schema, amount, counted, record
from stepwell.sequences import Program, Unreachable, turn_schema


def program_schema(shape: Shape) -> Schema:
    """What is reported of a program; an unreachable state has null for most of it."""
    planned = (
        *keys(arrives=str, strokes=int),
        Quantity("turning_points", shape.drive, holds=[float]),
        *keys(sequence=(str, words.spelled_out)),
        *keys(events=([events.event_schema(shape)], "path.events")),
        *keys(landings=([events.landing_schema(shape)], _landings)),
        *keys(dissipated=("mJ", "path.dissipated"), turns=[turn_schema(shape.drive)]),
        *(events.extrapolated_schema(shape, "path") if shape.elements else ()),
        *keys(end_low=(shape.drive, "low"), end_high=(shape.drive, "high"), slack=shape.drive),
    )
    return (
        *keys(title=(str, "chain.title"), actuator=(actuator_schema(shape), "chain")),
        *keys(cells=([str], "chain.names")),
        Quantity("from", read="start"),
        *keys(target=str, meets_target=(bool, _meets_target)),
        *keys(proved=(bool, lambda one: one.shortest if isinstance(one, Program) else one.proved)),
        *keys(robust=float),
        *keys(reason=(str, lambda one: one.reason if isinstance(one, Program) else str(one))),
        *of_class(Program, planned),
    )


def _meets_target(value: Program | Unreachable) -> bool:
    return isinstance(value, Program) and value.meets_target


def _landings(program: Program) -> list[Row] | None:
    return events.landed(program.path.checked_landings, program.path.events)


def unreachable_account(value: Unreachable, about: About) -> Account:
    """What is reported if there is no program."""
    proved = "This is proved." if value.proved else "A search found no way; that is no proof."
    if value.chain is None:
        return Account(value, "Unreachable", answer=str(value), origin=proved)
    title = value.chain.title or "Unreachable"
    return Account(value, title, "program/2", str(value), origin=proved)


def program_account(program: Program, about: About) -> Account:
    """What is reported of a program."""
    chain, path = program.chain, program.path
    works, strokes = program.meets_target, counted(program.strokes, "stroke")
    ends = strokes if works else f"ends in {program.arrives} after {strokes}"
    slack = f"every turning point may deviate by {amount(program.slack, chain.drive_unit, 3)}"
    spelled = len(chain) <= words.LONGEST_IN_A_LINE
    facts = (
        Fact("Turning points", words.turning_points(program.turning_points, chain)),
        Fact("Slack", f"{slack} at once" if works and program.turns else ""),
        Fact("States", str(program.sequence) if spelled else ""),
        Fact("Dissipated", amount(path.dissipated, "J", 3)),
        Fact("Landings", events.landing_words(path.checked_landings)),
    )
    # Where a turn can go back to is computed for programs of a search alone.
    turns = turn_schema(Shape.of(chain).drive)
    columns = turns[: None if any(turn.branch for turn in program.turns) else -1]
    table = RecordTable(
        [Quantity("turn", head="turn"), *columns],
        lambda: [{"turn": k} | record(turns, one) for k, one in enumerate(program.turns, 1)],
        "Anywhere in its tolerance interval each turn gives the same motion.",
        more="turns",
        level=CARD,
    )
    sections = {
        "Path": Picture("program", "The program, and the motion of the cells"),
        "Motion": Replay(chain.title),
        "Tolerance intervals of the turning points": table,
        **events.event_sections(chain, path.events, path.checked_landings),
        "Method": Text(f"{program.reason}.", CARD),
        **words.assumed(chain),
    }
    title, way = chain.title or "A stroke program", f"{program.start} to {program.target}"
    past = events.extrapolated_warning(path)
    warnings = [words.degenerate(path.degenerate, chain), past, words.scattered(chain)]
    answer, origin = f"{way}: {ends}", f"A program from {way} for {words.cells_of(chain)}."
    return Account(program, title, "program/2", answer, facts, sections, warnings, origin)
