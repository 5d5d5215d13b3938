"""What is proved of a path: a bound of the error of each number, and gaps with place and cause."""

from dataclasses import replace

from stepwell.accounts import run
from stepwell.accounts.events import way
from stepwell.accounts.head import About, DesignShape, keys, recorded
from stepwell.accounts.parts import CARD, Account, Fact, RecordTable, Text
from stepwell.base import Column, Quantity, Schema, counted, in_measure
from stepwell.mechanism import Chain
from stepwell.proof import PathProof, ProvedRun, Theorem

_ABOUT = (
    "Proved is a statement about the model with the numbers of the design as the engine has them, "
    "as doubles; not about rubber, friction at rest or masses. The errors are proved bounds."
)


def proved_event_schema(shape: DesignShape) -> Schema:
    """What is reported of a proved event."""
    schema = (
        *keys(event=(int, "number")),
        Quantity("direction", head="while", read=lambda one: way(one.event)),
        Quantity("drive", shape.drive, "drive", "event.drive"),
        Quantity("theorem", missing=True),
        Quantity("drive_error", shape.drive, "error of drive", form=2),
        Quantity("stroke_error", "mm", form=2),
        Quantity("after_error", "mm", "of travels", "travel_error", form=2),
        Quantity("force_error", "N", "of forces", form=2),
        Quantity("released_error", "mJ", "of released", form=2),
    )
    return in_measure(schema, shape.measure)


def gap_schema(shape: DesignShape) -> Schema:
    """What is reported of a gap."""
    schema = (
        *keys(event=(int | None, "number")),
        Quantity("direction", head="while", read=way),
        Quantity("drive", shape.drive, "drive"),
        Quantity("cause", head="not proved", left=True),
        Quantity("size", "N", "size", form=2),
        *keys(contradicted=bool),
    )
    return in_measure(schema, shape.measure)


def path_proof_schema(shape: DesignShape) -> Schema:
    """What is reported of the proof of a path."""
    return (
        *keys(proved=bool, outcome=str, stretches=int, mobility_ratio=float),
        *in_measure(keys(worst_error="mm"), shape.measure),
        *keys(events=[proved_event_schema(shape)], gaps=[gap_schema(shape)]),
    )


def proved_run_schema(shape: DesignShape) -> Schema:
    """What is reported of a run with a proof."""
    return (*run.run_schema(shape), *keys(proof=path_proof_schema(shape)))


def proof_words(proof: PathProof) -> str:
    """The outcome in a line, with the number of events and the largest error."""
    done, total = len(proof.events), len(proof.path.events)
    return f"{proof.outcome}; {done} of {counted(total, 'event')} enclosed"


def _facts(proof: PathProof, chain: Chain) -> list[Fact]:
    shape = DesignShape.of(chain)
    (worst,) = in_measure(keys(worst_error="mm"), shape.measure)
    error = f"at most {worst.of(proof) * worst.factor:.1e} {worst.sign}"
    return [
        Fact("Proof", proof_words(proof)),
        Fact("Error of travels", error if proof.events else ""),
    ]


def _sections(proof: PathProof, chain: Chain):
    shape = DesignShape.of(chain)
    event, gap = proved_event_schema(shape), gap_schema(shape)
    landing = Column("landing", lambda row: _landing_words(row["theorem"]))
    events = RecordTable(
        (event[1], event[2], landing, *event[4:5], *event[6:]),
        recorded(event, proof.events),
        "The model has exactly one such event within these errors of the reported numbers.",
        more="proved events",
    )
    gaps = RecordTable(
        gap[1:5],
        recorded(gap, proof.gaps),
        "Gaps: what is not proved, with place, cause and size.",
        more="gaps",
        level=CARD,
    )
    return {"Proof": (events, gaps, Text(_ABOUT))}


def _landing_words(theorem: str | None) -> str:
    return Theorem[theorem.upper()].value if theorem else ""


def path_proof_account(proof: PathProof, about: About) -> Account:
    """What a notebook shows of the proof of a path."""
    chain = proof.path.chain
    title = f"Proof of {chain.title or 'a path'}"
    facts, sections = _facts(proof, chain), _sections(proof, chain)
    return Account(proof, title, answer=proof_words(proof), facts=facts[1:], sections=sections)


def proved_run_account(value: ProvedRun, about: About) -> Account:
    """What is reported of a run with a proof."""
    account = run.run_account(value, about)
    chain = value.chain
    sections = {**_sections(value.proof, chain), **account.sections}
    facts = [*account.facts, *_facts(value.proof, chain)]
    return replace(
        account, kind="proved_run/1", facts=facts, sections=sections, packages=["python-flint"]
    )
