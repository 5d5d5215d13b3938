"""Chains as state machines: the turning points of every input, and the table of all replies."""

from typing import Any

from stepwell.accounts import words
from stepwell.accounts.chain import actuator_schema
from stepwell.accounts.head import About, DesignShape, keys
from stepwell.accounts.parts import CARD, Account, Fact, RecordTable, Text
from stepwell.base import Column, Quantity, Schema, amount, counted
from stepwell.sequences import Realisation, Span

_METHOD = (
    "Read off the transition graph, which is exact: one drive between every two neighbouring ends "
    "of branches stands for all. All tolerance intervals hold at once."
)


def machine_schema(shape: DesignShape) -> Schema:
    """What is reported of a chain that realises a machine."""
    unit = shape.drive
    span = keys(drive=unit, low=unit, high=unit, slack=unit)
    given = (
        Quantity("input", read=lambda one: one[0]),
        Quantity("turns", read=lambda one: one[1], holds=[span]),
    )
    reply = keys(chain=(str, "label"), state=str, output=str, after=[int])
    return (
        *keys(title=(str, "chain.title"), actuator=(actuator_schema(shape), "chain")),
        *keys(machine=(str, "machine.title"), start=str, by_hand=bool),
        Quantity("reset", shape.drive, holds=[float]),
        *keys(base=span, inputs=([given], _inputs), replies=[reply], slack=shape.drive),
    )


def _inputs(way: Realisation) -> list[tuple[str, tuple[Span, ...]]]:
    return [*zip(way.machine.inputs, way.inputs, strict=True)]


def realisation_account(way: Realisation, about: About) -> Account:
    """What is reported of a chain that realises a machine."""
    chain, unit = way.chain, way.chain.drive_unit

    def shown(span: Span) -> str:
        return f"{amount(span.drive, unit, 4)} (±{amount(span.slack, unit, 3)})"

    reset = words.turning_points(way.reset, chain)
    facts = (
        Fact("Base", shown(way.base)),
        *(Fact(f"Input {name}", " → ".join(map(shown, spans))) for name, spans in _inputs(way)),
        Fact("Start", f"{way.start}, {'set by hand, then' if way.by_hand else 'by'} {reset}"),
        Fact("Slack", f"{amount(way.slack, unit, 3)} for base and all turning points at once"),
    )
    columns = (
        _column("chain", lambda one: one.label),
        _column("state", lambda one: one.state),
        _column("output", lambda one: one.output),
        *(
            _column(f"after {name}", lambda one, k=k: way.replies[one.after[k]].label)
            for k, name in enumerate(way.machine.inputs)
        ),
    )
    about_rows = "The states of the chain at the base, and the state after each input."
    table = RecordTable(
        columns,
        lambda: [{"reply": one} for one in way.replies],
        about_rows,
        more="states",
        level=CARD,
    )
    sections = {"Replies": table, "Method": Text(_METHOD, CARD), **words.assumed(chain)}
    title = chain.title or "A state machine"
    named = way.machine.title or "the machine"
    answer = f"{named}: {counted(len(way.replies), 'state')} of the chain"
    origin = f"Inputs found by search for {words.cells_of(chain)}."
    return Account(way, title, "machine/1", answer, facts, sections, origin=origin)


def _column(head: str, read: Any) -> Column:
    return Column(head, lambda row: read(row["reply"]))
