"""What is proved of a margin, of all machines within tolerances, and of a design."""

from dataclasses import replace
from typing import Any

from stepwell import base
from stepwell.accounts import changes, design, proof
from stepwell.accounts.chain import cell_columns, cell_schema, named
from stepwell.accounts.head import About, DesignShape, keys, of_class, recorded
from stepwell.accounts.parts import CARD, Account, Fact, Part, RecordTable, Text
from stepwell.base import Column, Quantity, Schema
from stepwell.proof import (
    BoxOutcome,
    MarginProof,
    ProvedChange,
    ProvedDesign,
    ProvedImpossible,
    ToleranceProof,
)

_ABOUT = (
    "Machines within the tolerances: anchors anywhere in their discs, levers and friction within "
    "their bounds, other numbers within four standard deviations, all at once and independent."
)


def proved_change_schema(shape: DesignShape) -> Schema:
    """What is proved of a change: of an anchor in mm, of a number in percent."""
    return (
        *keys(cell=(int, "change.cell"), parameter=(str, "change.parameter"), outcome=str),
        *(Quantity(name, unit, read=_of(name, unit), missing=True)
          for name in ("up_to", "refuted_from")
          for unit in (("mm", "percent") if shape.levers else ("percent",))),
        *keys(cause=str),
    )  # fmt: skip


def _of(name: str, unit: str) -> Any:
    def read(one: ProvedChange) -> float | None:
        return getattr(one, name) if (one.change.parameter == "anchor") is (unit == "mm") else None

    return read


def tolerance_proof_schema(shape: DesignShape) -> Schema:
    """What is proved of all machines within tolerances."""
    return (
        *keys(sequence=str, outcome=str, cause=str, becomes=str, parameters=int, boxes=int),
        *keys(undecided=float | None),
        Quantity(
            "counterexample",
            read=lambda one: one.counterexample and named(one.counterexample),
            holds=[_machine_schema(shape)],
            missing=True,
        ),
    )


def _machine_schema(shape: DesignShape) -> Schema:
    """Anchors and bands, or scales, of the cells of a machine; of both kinds, their forces."""
    mixed = shape.elements and shape.levers
    return cell_schema(shape) if mixed else design.built_schema(shape)


def margin_proof_schema(shape: DesignShape) -> Schema:
    """What is proved of a margin."""
    return (
        *keys(proved=bool, changes=[proved_change_schema(shape)]),
        Quantity("within_tolerances", read="within", holds=tolerance_proof_schema(shape),
                 missing=True),
    )  # fmt: skip


def proved_margin_schema(shape: DesignShape) -> Schema:
    """What is reported of a margin with its proof."""
    own = base.read_off(changes.margin_schema(shape), "margin")
    return (*own, *keys(proof=(margin_proof_schema(shape), lambda one: one)))


def proved_design_schema(shape: DesignShape) -> Schema:
    """What is reported of a design with its proof."""
    path = Quantity("path", read="path_proof", holds=proof.path_proof_schema(shape))
    margin = Quantity("margin", read="margin_proof", holds=margin_proof_schema(shape))
    inner = (
        *of_class(ProvedDesign, (path, margin)),
        *of_class(ProvedImpossible, keys(outcome=str, covers=str, theorem=str, cause=str)),
    )
    return (*design.design_schema(shape), *keys(proof=(inner, lambda one: one)))


def change_words(one: ProvedChange) -> str:
    """What is proved of a change, in words."""
    anchor = one.change.parameter == "anchor"

    def size(value: float) -> str:
        return base.amount(value, "m") if anchor else f"{base.number(value * 100)} %"

    if one.proved:
        return f"proved up to {size(one.up_to)}"
    if one.outcome is BoxOutcome.REFUTED:
        return f"another sequence from {size(one.refuted_from)} on; proved up to {size(one.up_to)}"
    done = f"proved up to {size(one.up_to)}; " if one.up_to else ""
    return f"{done}beyond not decided: {one.cause}"


def _parts(value: MarginProof) -> tuple[Part, ...]:
    chain = value.margin.chain
    shape = DesignShape.of(chain)
    schema = proved_change_schema(shape)
    columns = (
        Quantity("cell", head="cell", form=lambda cell: chain.names[cell]),
        Column("parameter", lambda row: changes.part_words(row["parameter"], chain.measure)),
        Column("every smaller change keeps the sequence", lambda row: change_words(row["one"])),
    )
    table = RecordTable(
        columns,
        lambda: [base.record(schema, one) | {"one": one} for one in value.changes],
        "At the margin two cells tie, so proofs end at 99.999 % of it.",
        more="changes",
        level=CARD,
    )
    within = value.within
    return (table, *(_tolerance_parts(within) if within is not None else ()))


def _tolerance_parts(value: ToleranceProof) -> tuple[Part, ...]:
    text = Text(f"{value.tolerances}: {value}. {_ABOUT}", CARD)
    if value.counterexample is None:
        return (text,)
    chain = value.counterexample
    schema = _machine_schema(DesignShape.of(chain))
    columns, rows = cell_columns(schema, chain), recorded(schema, named(chain))
    return text, RecordTable(columns, rows, "The machine that refutes it.", more="cells")


def _facts(value: MarginProof) -> list[Fact]:
    within = "" if value.within is None else str(value.within)
    return [Fact("Proof", str(value)), Fact("Within tolerances", within)]


def margin_proof_account(value: MarginProof, about: About) -> Account:
    """What is reported of a margin with its proof."""
    account = changes.margin_account(value.margin, about)
    sections = {**account.sections, "Proof": _parts(value)}
    return Account(
        value,
        account.title,
        "proved_margin/1",
        account.answer,
        _facts(value),
        sections,
        origin=account.origin,
        packages=["python-flint"],
    )


def tolerance_proof_account(value: ToleranceProof, about: About) -> Account:
    """What a notebook shows of a proof within tolerances."""
    title = f"Proof within tolerances of {value.chain.title or 'a chain'}"
    return Account(value, title, answer=str(value), sections={"Proof": _tolerance_parts(value)})


def proved_design_account(value: ProvedDesign, about: About) -> Account:
    """What is reported of a design with its proof."""
    account = design.design_account(value, about)
    cycle = Fact("Proof of the cycle", proof.proof_words(value.path_proof))
    sections = {**account.sections, "Proof": _parts(value.margin_proof)}
    return replace(
        account,
        kind="proved_design/1",
        facts=[*account.facts, cycle, *_facts(value.margin_proof)],
        sections=sections,
        packages=["python-flint"],
    )


def proved_impossible_account(value: ProvedImpossible, about: About) -> Account:
    """What is reported of a refusal with its proof."""
    account = design.impossible_account(value, about)
    schema = proved_design_schema(DesignShape(value.measure))
    facts = [Fact("Proof", value.proof)]
    return replace(
        account, kind="proved_design/1", facts=facts, schema=schema, packages=["python-flint"]
    )
