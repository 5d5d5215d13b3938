"""A run: a full cycle and its margin; a stroke program: turning points and their tolerances."""

from collections import Counter
from collections.abc import Callable

from stepwell.accounts import changes, events, words
from stepwell.accounts.chain import actuator_schema, cell_schema, cell_section, named, texts
from stepwell.accounts.head import About, DesignShape, Row, keys, of_class
from stepwell.accounts.parts import (
    CARD,
    PAGE,
    Account,
    Fact,
    Picture,
    RecordTable,
    Replay,
    Text,
    Warned,
)
from stepwell.accounts.yields import PICTURES, sample_words, yield_words
from stepwell.base import (
    Quantity,
    Schema,
    amount,
    counted,
    in_measure,
    join_first,
    number,
    read_off,
    record,
)
from stepwell.design import Run
from stepwell.mechanism import Chain
from stepwell.sequences import Cycle, Pathway, Program, Unreachable, turn_schema
from stepwell.statics import EventKind, Path

# A longer sequence is not read in a line.
_MOST_LETTERS = 100
_NOT_PLAYED = "Not shown here: the command stepwell replay writes the motion as a page of its own."
_CHECK = "--mobility-ratio 10 checks the landings for other mobilities."


def run_schema(shape: DesignShape) -> Schema:
    """What is reported of a run."""
    cycle = (
        Quantity("sequence", read=words.spelled_out, missing=True),
        Quantity("pathway", holds=Pathway, missing=True),
        *keys(loading_order=[int], unloading_order=[int], events=[events.event_schema(shape)]),
    )
    return (
        *keys(title=(str, "chain.title"), actuator=(actuator_schema(shape), "chain")),
        *keys(cells=([cell_schema(shape)], lambda run: named(run.chain))),
        *read_off(cycle, "cycle"),
        Quantity(
            "landings",
            read=lambda run: events.landed(run.landings, run.cycle.events),
            holds=[events.landing_schema(shape)],
            missing=True,
        ),
        *read_off(cycle_schema(shape), "cycle"),
        *read_off(events.RATE, "cycle.path"),
        *keys(margin=changes.margin_schema(shape)),
        *(_measured_schema(shape) if shape.elements else ()),
        *(events.extrapolated_schema(shape, "cycle.path") if shape.elements else ()),
        *keys(ties=([str], lambda run: words.tie_notes(run.cycle.degenerate, run.chain))),
    )


def _measured_schema(shape: DesignShape) -> Schema:
    """What error bands and scatter of measured curves mean for a run."""

    def end(k: int) -> Callable[[Run], float | None]:
        return lambda run: run.dissipated_range and run.dissipated_range[k]

    ends = keys(dissipated_low=("mJ", end(0)), dissipated_high=("mJ", end(1)))
    notes = keys(curve_notes=([str], lambda run: words.curve_notes(run.chain)))
    return (*in_measure(ends, shape.measure), *keys(other_sequences=[str]), *notes)


def cycle_schema(shape: DesignShape) -> Schema:
    """The numbers of a cycle."""
    full = keys(dissipated="mJ", peak_force="N", full_stroke=("mm", "chain.full_stroke"))
    turns = Quantity(
        "turning_points",
        shape.drive,
        read="path.turning_points",
        form=lambda points: " → ".join(map(number, points)),
        holds=[float],
    )
    # The ends of the curves say little about how far a chain of elements is driven.
    return in_measure((*full, *([turns] if shape.elements else [])), shape.measure)


def cycle_account(cycle: Cycle, about: About) -> Account:
    """What a notebook shows of a cycle."""
    return _motion(cycle, cycle.path, "Cycle", cycle_words(cycle), cycle_facts(cycle))


def run_account(run: Run, about: About) -> Account:
    """What is reported of a run."""
    cycle, margin, chain = run.cycle, run.margin, run.chain
    made = f"Design file {about.source}" if about.source else "A design made in Python"
    origin = f"{made}. {words.cells_of(chain)}."
    nearest, landings = changes.margin_words(margin), events.landing_words(run.landings)
    tied, measure = bool(cycle.degenerate), chain.measure
    facts = (
        *cycle_facts(cycle),
        *_banded(run),
        Fact("Margin", nearest),
        Fact("Landings", landings),
        events.rate_fact(cycle.path),
    )
    nearby = (
        Picture("margins", "Distance of each parameter to another sequence"),
        Picture("around", "Sequences around the most sensitive anchor"),
    )
    captions = {
        "mechanism": "The mechanism in the states of its cycle",
        "landscape": "The energy landscape and the path through it",
        "force-stroke": f"Actuator {measure.force} against {measure.stroke}",
        "travel-stroke": f"{measure.travel.capitalize()} of each cell against {measure.stroke}",
        "element-curves": f"{measure.force.capitalize()} of each element and its phases",
    }
    sections = {
        **events.event_sections(chain, cycle.events, run.landings),
        **cell_section(chain),
        **changes.margin_section(margin, *nearby),
        "Yield within the usual tolerances": (
            Text(lambda: _samples(run, tied), PAGE),
            PICTURES[0],
            Text(lambda: run.built.assumptions if run.built else "", PAGE),
        ),
        "Motion": Replay(chain.title, _NOT_PLAYED),
        "Figures": [Picture(*one) for one in captions.items()],
        **words.assumed(chain),
    }
    title, answer = chain.title or about.source or "Untitled chain", cycle_words(cycle)
    curves = words.scattered(chain, run.other_sequences)
    past, same = events.extrapolated_warning(cycle.path), _namesakes(chain)
    warned = [words.degenerate(cycle.degenerate, chain), past, curves, same]
    hints = [_CHECK] if landings == events.NOT_CHECKED else []
    return Account(run, title, "run/2", answer, facts, sections, warned, origin, hints=hints)


def _namesakes(chain: Chain) -> Warned:
    """The warning of cells with the same name."""
    shared = [name for name, count in Counter(chain.names).items() if count > 1]
    numbers = {name: [k for k, one in enumerate(chain.names, 1) if one == name] for name in shared}
    lines = [
        f"Cells {join_first(list(map(str, cells)), 4)} are all named {name}: give each cell its "
        f"own name. Options take the number of such a cell, such as {cells[0]}."
        for name, cells in numbers.items()
    ]
    return Warned("Equal names", "Results show equal names for different cells.", lines)


def _banded(run: Run) -> list[Fact]:
    """The dissipated energy within the error bands of measured curves."""
    if run.dissipated_range is None:
        return []
    low, high = (amount(one, "J", 3) for one in run.dissipated_range)
    return [Fact("Dissipated within error bands", f"{low} to {high}")]


def cycle_words(cycle: Cycle) -> str:
    """The sequence of a cycle, its pathway and the number of its snaps."""
    sequence, pathway = cycle.sequence, cycle.pathway
    states = f"{len(sequence)} states of {len(cycle.chain)} cells"
    if len(sequence) * len(cycle.chain) <= _MOST_LETTERS:
        states = str(sequence)
    snaps = sum(event.kind is EventKind.SNAP for event in cycle.events)
    shape = [] if pathway is None else [pathway.label]
    return ", ".join([states, *shape, counted(snaps, "snap")])


def cycle_facts(cycle: Cycle) -> list[Fact]:
    """What a chain does in a full cycle."""
    chain, names = cycle.chain, cycle.chain.names
    lost, peak, full, *driven = texts(cycle_schema(DesignShape.of(chain)), cycle)
    return [
        Fact("Loading", words.listed([names[cell] for cell in cycle.loading_order])),
        Fact("Unloading", words.listed([names[cell] for cell in cycle.unloading_order])),
        Fact(f"Peak {chain.measure.force}", peak),
        Fact("Turning points", "".join(driven)),
        Fact(f"Full {chain.measure.stroke}", "" if driven else full),
        Fact("Dissipated", f"{lost} in a cycle"),
    ]


def _samples(run: Run, tied: bool) -> str:
    from stepwell.design import verdict_of

    built = run.built
    if built is None:
        return "Not computed here: the command stepwell yield counts samples."
    verdict = verdict_of(meets_target=True, tied=tied, interval=built.interval)
    return f"{verdict}: {yield_words(built)}, of {sample_words(built)}"


def path_account(path: Path, about: About) -> Account:
    """What a notebook shows of a path."""
    chain = path.chain
    lost, peak = texts(cycle_schema(DesignShape.of(chain))[:2], path)
    facts = [Fact("Dissipated", lost), Fact(f"Peak {chain.measure.force}", peak)]
    return _motion(path, path, "Path", words.turning_points(path.turning_points, chain), facts)


def _motion(value: Cycle | Path, path: Path, what: str, answer: str, facts: list[Fact]) -> Account:
    chain = path.chain
    title = f"{what} of {chain.title}" if chain.title else what
    sections = events.event_sections(chain, path.events, None)
    past = events.extrapolated_warning(path)
    warnings = [words.degenerate(path.degenerate, chain), past, words.scattered(chain)]
    return Account(value, title, answer=answer, facts=facts, sections=sections, warnings=warnings)


def program_schema(shape: DesignShape) -> Schema:
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
    turns = turn_schema(DesignShape.of(chain).drive)
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
