"""A stroke program: its turning points, how far each may be off, and what the cells do."""

from typing import Any

from stepwell.accounts import events, parts, words
from stepwell.accounts.chain import actuator_schema
from stepwell.accounts.head import About, Shape, of_class
from stepwell.base import Quantity, Schema, amount, counted, quantities, record
from stepwell.sequences import Program, Unreachable, turn_schema


def program_schema(shape: Shape) -> Schema:
    """What is reported of a program; where there is none, what is known of it has null."""
    found = (
        *quantities(arrives=str, strokes=int),
        Quantity("turning_points", shape.drive, holds=[float]),
        Quantity("sequence", read=_spelled),
        Quantity("events", read="path.events", holds=[events.event_schema(shape)]),
        Quantity(
            "landings",
            read=lambda one: events.landed(one.path.checked_landings, one.path.events),
            holds=[events.landing_schema(shape)],
        ),
        Quantity("dissipated", "mJ", read="path.dissipated"),
        Quantity("turns", holds=[turn_schema(shape.drive)]),
        Quantity("end_low", shape.drive, read="low"),
        Quantity("end_high", shape.drive, read="high"),
        Quantity("slack", shape.drive),
    )
    return (
        Quantity("title", read="chain.title"),
        Quantity("actuator", read="chain", holds=actuator_schema(shape)),
        Quantity("cells", read="chain.names", holds=[str]),
        Quantity("from", read="start"),
        Quantity("target"),
        Quantity("does_it", read=does_it, holds=bool),
        Quantity(
            "proved",
            read=lambda one: one.shortest if isinstance(one, Program) else one.proved,
            holds=bool,
        ),
        Quantity("robust", holds=float),
        Quantity("reason", read=lambda one: one.reason if isinstance(one, Program) else str(one)),
        *of_class(Program, found),
    )


def _spelled(program: Program) -> str | None:
    return str(program.sequence) if len(program.chain) <= words.LONGEST_SPELLED_OUT else None


def does_it(value: Program | Unreachable) -> bool:
    """Whether a program ends in the state that it is meant to end in."""
    if isinstance(value, Unreachable):
        return False
    return value.arrives == value.target and value.hangs is None


def unreachable_account(value: Unreachable, about: About) -> parts.Account:
    """What is reported where there is no program."""
    proved = "This is proved." if value.proved else "A search found no way; that is no proof."
    if value.chain is None:
        return parts.Account(value, "Unreachable", answer=str(value), origin=proved)
    return parts.Account(
        value,
        value.chain.title or "Unreachable",
        "program/2",
        program_schema(Shape.of(value.chain)),
        answer=str(value),
        origin=proved,
    )


def program_account(program: Program, about: About) -> parts.Account:
    """What is reported of a program."""
    chain, path = program.chain, program.path
    shape, works = Shape.of(chain), does_it(program)
    strokes = counted(program.strokes, "stroke")
    ends = strokes if works else f"ends in {program.arrives} after {strokes}"
    landings = path.checked_landings
    spelled = str(program.sequence) if len(chain) <= words.LONGEST_IN_A_LINE else ""
    return parts.Account(
        program,
        chain.title or "A stroke program",
        "program/2",
        program_schema(shape),
        origin=f"A program from {program.start} to {program.target} for {words.cells_of(chain)}.",
        answer=f"{program.start} to {program.target}: {ends}",
        facts=(
            parts.Fact("Turning points", words.turning_points(program.turning_points, chain)),
            parts.Fact("Slack", _slack(program) if works else ""),
            parts.Fact("States", spelled),
            parts.Fact("Dissipated", amount(path.dissipated, "J", 3)),
            parts.Fact("Landings", events.landing_words(landings)),
        ),
        warnings=[words.degenerate(path.degenerate, chain)],
        sections=(
            parts.Section(
                "Path", parts.Picture("program", "The program, and the motion of the cells")
            ),
            parts.Section("Motion", parts.Replay(chain.title)),
            _turns(program),
            events.event_section(chain, path.events, landings),
            events.elsewhere_section(chain, path.events, landings),
            parts.Section("Method", parts.Text(f"{program.reason}.", parts.Level.CARD)),
            words.assumed(chain),
        ),
    )


def _slack(program: Program) -> str:
    """How far every turn may be off; "" without turns."""
    if not program.turns:
        return ""
    slack = amount(program.slack, program.chain.drive_unit, 3)
    return f"every turn may be off by {slack} at once"


def _turns(program: Program) -> parts.Section:
    # Where a turn can go back to is known of programs that were searched for.
    known = any(turn.branch for turn in program.turns)
    columns = turn_schema(Shape.of(program.chain).drive)

    def rows() -> list[dict[str, Any]]:
        return [{"turn": k} | record(columns, one) for k, one in enumerate(program.turns, 1)]

    table = parts.RecordTable(
        [Quantity("turn", head="turn"), *columns[: None if known else -1]],
        rows,
        "Anywhere in its tolerance interval each turn gives the same motion.",
        more="turns",
        level=parts.Level.CARD,
    )
    return parts.Section("Turns: anywhere in its window each does the same", table)
