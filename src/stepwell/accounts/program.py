"""A stroke program: its turning points, how far each may be off, and what the cells do."""

from stepwell.accounts import events, parts, words
from stepwell.accounts.chain import actuator_schema
from stepwell.accounts.head import About, Row, Shape, keys, of_class
from stepwell.accounts.parts import CARD, Account, Fact, Picture, RecordTable, Text
from stepwell.base import Quantity, Schema, amount, counted, record
from stepwell.sequences import Program, Unreachable, turn_schema


def program_schema(shape: Shape) -> Schema:
    """What is reported of a program; where there is none, what is known of it has null."""
    drive = shape.drive
    found = (
        *keys(arrives=str, strokes=int),
        Quantity("turning_points", drive, holds=[float]),
        *keys(
            sequence=(str, words.spelled_out), events=([events.event_schema(shape)], "path.events")
        ),
        Quantity(
            "landings",
            read=lambda one: events.landed(one.path.checked_landings, one.path.events),
            holds=[events.landing_schema(shape)],
        ),
        *keys(dissipated=("mJ", "path.dissipated"), turns=[turn_schema(drive)]),
        *keys(end_low=(drive, "low"), end_high=(drive, "high"), slack=drive),
    )
    return (
        *keys(title=(str, "chain.title"), actuator=(actuator_schema(shape), "chain")),
        *keys(cells=([str], "chain.names")),
        Quantity("from", read="start"),
        *keys(target=str, meets_target=(bool, meets_target), proved=(bool, _proved), robust=float),
        Quantity("reason", read=lambda one: one.reason if isinstance(one, Program) else str(one)),
        *of_class(Program, found),
    )


def _proved(value: Program | Unreachable) -> bool:
    return value.shortest if isinstance(value, Program) else value.proved


def meets_target(value: Program | Unreachable) -> bool:
    """Whether a program ends in the state that it is meant to end in."""
    return isinstance(value, Program) and value.arrives == value.target and value.hangs is None


def unreachable_account(value: Unreachable, about: About) -> Account:
    """What is reported where there is no program."""
    proved = "This is proved." if value.proved else "A search found no way; that is no proof."
    if value.chain is None:
        return Account(value, "Unreachable", answer=str(value), origin=proved)
    title = value.chain.title or "Unreachable"
    return Account(value, title, "program/2", str(value), origin=proved)


def program_account(program: Program, about: About) -> Account:
    """What is reported of a program."""
    chain, path = program.chain, program.path
    works, landings = meets_target(program), path.checked_landings
    strokes = counted(program.strokes, "stroke")
    ends = strokes if works else f"ends in {program.arrives} after {strokes}"
    spelled = str(program.sequence) if len(chain) <= words.LONGEST_IN_A_LINE else ""
    slack = amount(program.slack, chain.drive_unit, 3)
    known = works and program.turns
    facts = (
        Fact("Turning points", words.turning_points(program.turning_points, chain)),
        Fact("Slack", f"every turn may be off by {slack} at once" if known else ""),
        Fact("States", spelled),
        Fact("Dissipated", amount(path.dissipated, "J", 3)),
        Fact("Landings", events.landing_words(landings)),
    )
    title, answer = (
        chain.title or "A stroke program",
        f"{program.start} to {program.target}: {ends}",
    )
    sections = {
        "Path": Picture("program", "The program, and the motion of the cells"),
        "Motion": parts.Replay(chain.title),
        **_turns(program),
        **events.event_sections(chain, path.events, landings),
        "Method": Text(f"{program.reason}.", CARD),
        **words.assumed(chain),
    }
    warnings = [words.degenerate(path.degenerate, chain)]
    origin = f"A program from {program.start} to {program.target} for {words.cells_of(chain)}."
    return Account(program, title, "program/2", answer, facts, sections, warnings, origin)


def _turns(program: Program) -> parts.Sections:
    # Where a turn can go back to is known of programs that were searched for.
    known = any(turn.branch for turn in program.turns)
    columns = turn_schema(Shape.of(program.chain).drive)

    def rows() -> list[Row]:
        return [{"turn": k} | record(columns, one) for k, one in enumerate(program.turns, 1)]

    shown = [Quantity("turn", head="turn"), *columns[: None if known else -1]]
    about = "Anywhere in its tolerance interval each turn gives the same motion."
    table = RecordTable(shown, rows, about, more="turns", level=CARD)
    return {"Turns: anywhere in its window each does the same": table}
