"""A run: what a design does in a full cycle, and how far it is from doing something else."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from stepwell.accounts import changes, events, words
from stepwell.accounts.chain import actuator_schema, cell_schema, cell_section, named, with_sign
from stepwell.accounts.head import About, Shape
from stepwell.accounts.parts import Account, Fact, Level, Part, Picture, Replay, Section, Text
from stepwell.accounts.yields import OUTCOMES, sample_words, yield_words
from stepwell.base import Quantity, Schema, in_measure, number, quantities, read_off, record
from stepwell.mechanism import Chain
from stepwell.sequences import Pathway
from stepwell.statics import EventKind

if TYPE_CHECKING:
    from stepwell.design import Run
    from stepwell.sequences import Cycle
    from stepwell.statics import Path

# A longer sequence is not read in a line.
_MOST_LETTERS = 100


def run_schema(shape: Shape) -> Schema:
    """What is reported of a run."""
    return (
        Quantity("title", read="chain.title"),
        Quantity("actuator", read="chain", holds=actuator_schema(shape)),
        Quantity("cells", read=lambda run: named(run.chain), holds=[cell_schema(shape)]),
        Quantity("sequence", read=lambda run: _spelled(run.cycle), missing=True),
        Quantity("pathway", read="cycle.pathway", holds=Pathway, missing=True),
        Quantity("loading_order", read="cycle.loading_order", holds=[int]),
        Quantity("unloading_order", read="cycle.unloading_order", holds=[int]),
        Quantity("events", read="cycle.events", holds=[events.event_schema(shape)]),
        Quantity(
            "landings",
            read=lambda run: events.landed(run.landings, run.cycle.events),
            holds=[events.landing_schema(shape)],
            missing=True,
        ),
        *read_off(cycle_schema(shape), "cycle"),
        Quantity("margin", holds=changes.margin_schema(shape)),
        Quantity(
            "ties", read=lambda run: words.tie_notes(run.cycle.degenerate, run.chain), holds=[str]
        ),
    )


def _spelled(cycle: Cycle) -> str | None:
    return str(cycle.sequence) if len(cycle.chain) <= words.LONGEST_SPELLED_OUT else None


def cycle_schema(shape: Shape) -> Schema:
    """The numbers of a cycle."""
    schema = (
        *quantities(dissipated="mJ", peak_force="N"),
        Quantity("full_stroke", "mm", read="chain.full_stroke"),
        # Ends of curves say little of how far a chain of elements is driven.
        *([_points(shape)] if shape.elements else ()),
    )
    return in_measure(schema, shape.measure)


def _points(shape: Shape) -> Quantity:
    return Quantity(
        "turning_points",
        shape.drive,
        read="path.turning_points",
        form=lambda points: " → ".join(map(number, points)),
        holds=[float],
    )


def cycle_account(cycle: Cycle, about: About) -> Account:
    """What a notebook shows of a cycle."""
    chain = cycle.chain
    return Account(
        cycle,
        f"Cycle of {chain.title}" if chain.title else "Cycle",
        answer=_answer(cycle),
        facts=cycle_facts(cycle),
        warnings=[words.degenerate(cycle.degenerate, chain)],
        sections=[events.event_section(chain, cycle.events, None)],
    )


def run_account(run: Run, about: About) -> Account:
    """What is reported of a run."""
    cycle, margin, chain = run.cycle, run.margin, run.chain
    origin = f"Design file {about.source}" if about.source else "A design made in Python"
    landings = events.landing_words(run.landings)
    tied = bool(cycle.degenerate)
    return Account(
        run,
        chain.title or about.source or "Untitled chain",
        "run/2",
        run_schema(Shape.of(chain)),
        origin=f"{origin}. {words.cells_of(chain)}.",
        answer=_answer(cycle),
        facts=(
            *cycle_facts(cycle),
            Fact("Margin", changes.margin_words(margin)),
            Fact("Landings", landings),
        ),
        warnings=[words.degenerate(cycle.degenerate, chain)],
        sections=(
            events.event_section(chain, cycle.events, run.landings),
            events.elsewhere_section(chain, cycle.events, run.landings),
            cell_section(chain),
            changes.margin_section(
                margin,
                Text(changes.otherwise_words(margin, tied=tied), Level.PAGE),
                Picture("margins", "Distance of each parameter to another sequence"),
                Picture("around", "Sequences around the most sensitive anchor"),
            ),
            _samples(run, tied),
            Section("Motion", Replay(chain.title, _NOT_PLAYED)),
            Section("Figures", *_pictures(chain)),
            words.assumed(chain),
        ),
        hints=[_CHECK] if landings == events.NOT_CHECKED else [],
    )


_NOT_PLAYED = "Not shown here: the command stepwell replay writes the motion as a page of its own."
_CHECK = "--mobility-ratio 10 checks the landings for other mobilities."


def _answer(cycle: Cycle) -> str:
    sequence = cycle.sequence
    if len(sequence) * len(cycle.chain) <= _MOST_LETTERS:
        return str(sequence)
    return f"{len(sequence)} states of {len(cycle.chain)} cells"


def cycle_facts(cycle: Cycle) -> list[Fact]:
    """What a chain does in a full cycle."""
    chain = cycle.chain
    schema = cycle_schema(Shape.of(chain))
    found = record(schema, cycle)
    lost, peak, full, *driven = (with_sign(q, found[q.key]) for q in schema)
    snaps = sum(event.kind is EventKind.SNAP for event in cycle.events)
    return [
        Fact("Pathway", cycle.pathway.label if cycle.pathway is not None else ""),
        Fact("Loading", _order(chain, cycle.loading_order)),
        Fact("Unloading", _order(chain, cycle.unloading_order)),
        Fact("Snaps", str(snaps)),
        Fact(f"Peak {chain.measure.force}", peak),
        Fact("Driven", "".join(driven)),
        Fact(f"Full {chain.measure.stroke}", "" if driven else full, Level.CARD),
        Fact("Dissipated", f"{lost} in a cycle"),
    ]


def _order(chain: Chain, cells: Sequence[int]) -> str:
    return words.listed([chain.names[cell] for cell in cells])


def _samples(run: Run, tied: bool) -> Section:
    """How many samples reproduce the sequence: pages alone have it, for it takes a while."""

    def parts() -> list[Part]:
        from stepwell.design import judged

        found = run.built
        if found is None:
            return [
                Text("Not computed here: the command stepwell yield counts samples.", Level.PAGE)
            ]
        verdict = judged(does_it=True, tied=tied, interval=found.interval)
        return [
            Text(f"{verdict}: {yield_words(found)}, of {sample_words(found)}", Level.PAGE),
            Picture("yield", OUTCOMES),
            Text(found.assumptions, Level.PAGE),
        ]

    return Section("Yield within the usual tolerances", parts, level=Level.PAGE)


def _pictures(chain: Chain) -> list[Part]:
    measure = chain.measure
    captions = {
        "mechanism": "The mechanism in the states of its cycle",
        "landscape": "The energy landscape and the path through it",
        "force-stroke": f"Actuator {measure.force} against {measure.stroke}",
        "travel-stroke": f"{measure.travel.capitalize()} of each cell against {measure.stroke}",
        "element-curves": f"{measure.force.capitalize()} of each element and its phases",
    }
    return [Picture(name, caption) for name, caption in captions.items()]


def path_account(path: Path, about: About) -> Account:
    """What a notebook shows of a path."""
    chain = path.chain
    points = _points(Shape.of(chain))
    turns = [number(point * points.factor) for point in path.turning_points]
    lost, peak, *_ = cycle_schema(Shape.of(chain))
    found = record((lost, peak), path)
    return Account(
        path,
        f"Path of {chain.title}" if chain.title else "Path",
        answer=f"{' → '.join(turns[: words.LONGEST_IN_A_LINE])}"
        f"{' → …' * (len(turns) > words.LONGEST_IN_A_LINE)} {points.sign}",
        facts=[
            Fact("Dissipated", with_sign(lost, found[lost.key])),
            Fact(f"Peak {chain.measure.force}", with_sign(peak, found[peak.key])),
        ],
        warnings=[words.degenerate(path.degenerate, chain)],
        sections=[events.event_section(chain, path.events, None)],
    )
