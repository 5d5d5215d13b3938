"""Many designs: a study, the outcomes of its designs and what decides them."""

from collections.abc import Sequence
from typing import Any

from stepwell.accounts import parts
from stepwell.accounts.head import About, keys, recorded
from stepwell.accounts.parts import PAGE, TERMINAL, Account, Fact, Notes, Picture, RecordTable
from stepwell.base import Columns, Quantity, Schema, counted, percent, read_off
from stepwell.design import Share
from stepwell.studies import Extent, Status, Varied, gaps_text

# Of what decides a column so many are shown.
_FOREMOST = 5
_GAP = keys(first=int, last=int, damaged=bool)
_SHARE = keys(times=int, of=int, low=float, high=float, share=float)
_SCREEN: Schema = (
    Quantity("engine", read=lambda status: status.study.given["engine"]),
    Quantity("wanted", read=lambda status: status.study.given["wanted"], holds=str | int),
    *read_off(keys(designs=int, kept=int, computed=int), "screened"),
    *(
        Quantity(name, read=f"screened.{name}", holds=_SHARE, missing=True)
        for name in ("alike", "held", "missed")
    ),
)
_OUTCOME: Schema = (
    Quantity("column", head="column"),
    Quantity("value", head="value"),
    Quantity("designs", head="designs", read="share.times", holds=int, left=False),
    Quantity("share", head="fraction", read="share.share", holds=float, form=percent, left=False),
    Quantity("share_low", read=lambda one: one.share.low if one.sampled else None, holds=float),
    Quantity("share_high", read=lambda one: one.share.high if one.sampled else None, holds=float),
)
_INFLUENCE = keys(parameter=(str, "name"), share=float, trend=float)
_DECIDED: Schema = (
    Quantity("column"),
    Quantity("value", read=lambda one: one.value or None, missing=True),
    *keys(designs=int, floor=float, influences=[_INFLUENCE]),
)
# A row for each number that decides a column.
_DECIDING: Columns = (
    Quantity("column", head="column"),
    Quantity("parameter", head="parameter"),
    Quantity("share", head="fraction of its variance", form=percent, left=False),
    Quantity("trend", head="rank correlation", form="+.2f", left=False),
)
# Of what a screen kept and what was computed: which designs have the fraction.
_AMONG = {"alike": "drawn at random", "held": "kept", "missed": "drawn at random and not kept"}


def _unit(unit: str) -> str:
    return "" if unit == "1" else unit


def _unit_of(one: Varied | Extent) -> str:
    return one.unit or "1"


def _end(name: str, read: str = "") -> Quantity:
    """A number in the unit that its row has."""
    return Quantity(name, head=name, read=read, holds=float, left=False)


# What varies, of atlases too.
VARIED: Schema = (
    Quantity("parameter", head="parameter"),
    Quantity("unit", head="unit", read=_unit_of, form=_unit),
    _end("from", "low"),
    _end("to", "high"),
)
_NUMBER: Schema = (
    Quantity("column", head="column"),
    Quantity("unit", head="unit", read=_unit_of, form=_unit),
    _end("least"),
    _end("median"),
    _end("most"),
    Quantity("designs", head="designs", holds=int, left=False),
)


# What is reported of a study.
STUDY: Schema = (
    *keys(title=(str, "study.subject.title"), store=(str, lambda status: str(status.study.folder))),
    *read_off(keys(what=str, identity=str, how=(str, lambda of: str(of.designs.how))), "study"),
    *keys(count=(int, "study.count"), varied=[VARIED]),
    *read_off(keys(chunk=int, chunks=int), "study"),
    *keys(done=int, finished=bool, missing=([_GAP], "gaps"), problems={str: int}),
    Quantity("screen", read=lambda one: one if one.screened else None, holds=_SCREEN, missing=True),
    *keys(outcomes=[_OUTCOME], numbers=[_NUMBER], decided=[_DECIDED]),
)


def status_account(status: Status, about: About) -> Account:
    """What is reported of a study."""
    study, deciding = status.study, _deciding(status)
    missing = [gaps_text(status.gaps, study.count)] if status.gaps else []
    problems = [f"{counted(n, 'design')}: {kind}" for kind, n in status.problems.items()]
    answer = ""
    if status.outcomes:
        first = status.outcomes[0]
        share = _share(first.share, first.sampled, " of the designs")
        answer = f"{share} have {first.column} {first.value}"
    elif deciding:
        foremost = deciding[0]
        share = f"{percent(foremost['share'])} of the variance of {foremost['column']}"
        answer = f"{foremost['parameter']} explains {share}"
    designs = f"{study.what} of {counted(study.count, 'design')}, {study.designs.how}"
    done = f"{status.done} of {study.chunks} chunks are done"
    facts = (
        Fact("Study", designs),
        Fact("Done", "all of it" if status.finished else done),
        Fact("Store", str(study.folder), TERMINAL),
        *_screened(status),
    )
    influence = (
        "The fraction of a column's variance that a number explains by itself, and "
        "its rank correlation. Fractions that chance could produce are left out."
    )

    def table(columns: Schema, rows: Sequence[Any], about: str, more: str) -> RecordTable:
        return RecordTable(columns, recorded(columns, rows), about, most=None, more=more)

    sections = {
        "Outcomes": (
            Picture("outcomes", "Outcomes over the parameters that decide them"),
            table(_OUTCOME, status.outcomes, "The most frequent first.", "outcomes"),
        ),
        "Influence of each number": (
            Picture("influences", "Fraction of the variance that each number explains"),
            RecordTable(_DECIDING, lambda: deciding, influence, most=None),
        ),
        "Range of each result": table(_NUMBER, status.numbers, "", "results"),
        "Varied parameters": table(VARIED, status.varied, "", "parameters"),
        "Assumptions": Notes(_assumed(status), PAGE),
    }
    title = study.subject.title or "A study"
    warned = (
        parts.Warned("Missing designs", "", missing),
        parts.Warned("Designs that could not be computed", "", problems),
    )
    hints = [] if status.finished else [f"Continue with: stepwell sweep resume {study.folder}"]
    of = {"seed": study.designs.seed, "packages": ["zarr"], "hints": hints}
    return Account(status, title, "study/1", answer, facts, sections, warned, **of)


def _deciding(status: Status) -> list[dict[str, Any]]:
    """The numbers that surely decide something, the foremost of each column."""
    return [
        {
            "column": one.column + (f" = {one.value}" if one.value else ""),
            "parameter": each.name,
            "share": each.share,
            "trend": each.trend,
        }
        for one in status.decided
        for each in one.sure[:_FOREMOST]
    ]


def _share(share: Share, sampled: bool = True, of: str = "") -> str:
    """A fraction, of what, with its interval where the designs are a sample."""
    ends = f" (95 % confidence {percent(share.low)} to {percent(share.high)})"
    return f"{percent(share.share)}{of}{ends * sampled}"


def _screened(status: Status) -> list[Fact]:
    """How a screen and what was computed agree."""
    of = status.screened
    if of is None:
        return []
    engine = status.study.given["engine"]
    kept = f"{engine} keeps {of.kept} of {of.designs}; {of.computed} were computed"
    return [
        Fact("Screen", kept),
        *(
            Fact(name.capitalize(), f"{share.times} of {share.of} {among}: {_share(share)}")
            for name, among in _AMONG.items()
            if (share := getattr(of, name))
        ),
    ]


def _assumed(status: Status) -> list[str]:
    assumed = ["Each parameter varies independently and evenly between its bounds."]
    if status.study.designs.how == "listed":
        assumed = [
            "The designs were listed: each of the parameters that vary together has the fraction "
            "of all of them."
        ]
    elif status.study.designs.how == "as built":
        assumed = ["The designs vary as mechanisms are built within their tolerances."]
    if status.decided:
        assumed.append(
            "What several parameters decide only together is in the fraction of none. A fraction "
            "below the floor, which chance alone exceeds in one study of twenty, is not shown."
        )
    if any(one.sampled for one in status.outcomes):
        assumed.append(
            "Intervals are those of designs drawn independently, 95 % (Clopper and Pearson); with "
            "a Sobol' sequence or a Latin hypercube the error is mostly smaller."
        )
    if status.screened:
        assumed.append(
            "A prefilter in single precision chose the designs that were computed, and some were "
            "drawn at random: fractions are those of the designs drawn, all other numbers those "
            "of all designs that were computed."
        )
    return assumed
