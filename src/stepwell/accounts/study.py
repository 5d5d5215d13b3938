"""Many designs: studies, sweeps over robots, one walk at several time steps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from stepwell import base, robot
from stepwell.accounts import parts
from stepwell.accounts.head import About
from stepwell.base import Quantity, Schema

if TYPE_CHECKING:
    from stepwell.design import Share
    from stepwell.simulation import Convergence, Sweep
    from stepwell.studies import Extent, Status, Varied


# Of what decides a column so many are shown.
_FOREMOST = 5


def _screen(found: Status) -> Status | None:
    return found if found.screened else None


def _unit(unit: str) -> str:
    return "" if unit == "1" else unit


def _told(one: Varied | Extent) -> str:
    return one.unit or "1"


def _end(name: str, read: str = "") -> Quantity:
    """A number in the unit that its row has."""
    return Quantity(name, head=name, read=read, holds=float, left=False)


# What varies, of atlases too.
VARIED: Schema = (
    Quantity("parameter", head="parameter"),
    Quantity("unit", head="unit", read=_told, form=_unit),
    _end("from", "low"),
    _end("to", "high"),
)
_GAP: Schema = base.quantities(first=int, last=int, damaged=bool)
_SHARE: Schema = base.quantities(times=int, of=int, low=float, high=float, share=float)
_SCREEN: Schema = (
    Quantity("engine", read=lambda found: found.study.given["engine"]),
    Quantity("wanted", read=lambda found: found.study.given["wanted"], holds=str | int),
    *(Quantity(name, read=f"screened.{name}", holds=int) for name in ("designs", "kept")),
    Quantity("computed", read="screened.computed", holds=int),
    *(
        Quantity(name, read=f"screened.{name}", holds=_SHARE, missing=True)
        for name in ("alike", "held", "missed")
    ),
)
_OUTCOME: Schema = (
    Quantity("column", head="column"),
    Quantity("value", head="value"),
    Quantity("designs", head="designs", read="share.times", holds=int, left=False),
    Quantity(
        "share", head="fraction", read="share.share", holds=float, form=base.percent, left=False
    ),
    Quantity("share_low", read=lambda one: one.share.low if one.sampled else None, holds=float),
    Quantity("share_high", read=lambda one: one.share.high if one.sampled else None, holds=float),
)
_NUMBER: Schema = (
    Quantity("column", head="column"),
    Quantity("unit", head="unit", read=_told, form=_unit),
    _end("least"),
    _end("median"),
    _end("most"),
    Quantity("designs", head="designs", holds=int, left=False),
)
_DECIDED: Schema = (
    Quantity("column"),
    Quantity("value", read=lambda one: one.value or None, missing=True),
    *base.quantities(
        designs=int,
        floor=float,
        influences=[
            (Quantity("parameter", read="name"), *base.quantities(share=float, trend=float))
        ],
    ),
)
# A row for each number that decides a column.
_DECIDING: base.Columns = (
    Quantity("column", head="column"),
    Quantity("parameter", head="parameter"),
    Quantity("share", head="fraction of its variance", form=base.percent, left=False),
    Quantity("trend", head="rank correlation", form="+.2f", left=False),
)


# Of what a screen kept and what was computed: which designs have the fraction.
_AMONG = {"alike": "drawn at random", "held": "kept", "missed": "drawn at random and not kept"}


# What is reported of a study.
STUDY: Schema = (
    Quantity("title", read="study.subject.title"),
    Quantity("store", read=lambda found: str(found.study.folder)),
    Quantity("what", read="study.what"),
    Quantity("identity", read="study.identity"),
    Quantity("how", read=lambda found: str(found.study.designs.how)),
    Quantity("count", read="study.count", holds=int),
    Quantity("varied", holds=[VARIED]),
    Quantity("chunk", read="study.chunk", holds=int),
    Quantity("chunks", read="study.chunks", holds=int),
    *base.quantities(done=int, finished=bool),
    Quantity("missing", read="gaps", holds=[_GAP]),
    Quantity("problems", holds={str: int}),
    Quantity("screen", read=_screen, holds=_SCREEN, missing=True),
    *base.quantities(outcomes=[_OUTCOME], numbers=[_NUMBER], decided=[_DECIDED]),
)


def study_account(found: Status, about: About) -> parts.Account:
    """What is reported of a study."""
    from stepwell.studies import gaps_text

    study, deciding = found.study, _deciding(found)
    missing = [gaps_text(found.gaps, study.count)] if found.gaps else []
    designs = f"{study.what} of {base.counted(study.count, 'design')}, {study.designs.how}"
    return parts.Account(
        found,
        study.subject.title or "A study",
        "study/1",
        STUDY,
        answer=_answer(found, deciding),
        seed=study.designs.seed,
        packages=("zarr",),
        facts=(
            parts.Fact("Study", designs),
            parts.Fact("Done", _done(found)),
            parts.Fact("Store", str(study.folder), parts.Level.TERMINAL),
            *_screened(found),
        ),
        warnings=(
            parts.Warned("Missing designs", "", missing),
            parts.Warned(
                "Designs that could not be computed",
                "",
                [f"{base.counted(n, 'design')}: {kind}" for kind, n in found.problems.items()],
            ),
        ),
        sections=(
            parts.Section(
                "Outcomes",
                parts.Picture("outcomes", "Outcomes over the parameters that decide them"),
                _table(_OUTCOME, found, "outcomes", "The most frequent first.", "outcomes"),
            ),
            parts.Section(
                "Influence of each number",
                parts.Picture("influences", "Fraction of the variance that each number explains"),
                parts.RecordTable(
                    _DECIDING,
                    lambda: deciding,
                    "The fraction of a column's variance that a number explains by itself, and "
                    "its rank correlation. Fractions that chance could produce are left out.",
                    most=None,
                    more="numbers",
                ),
            ),
            parts.Section("Range of each result", _table(_NUMBER, found, "numbers", "", "results")),
            parts.Section("Varied parameters", _table(VARIED, found, "varied", "", "parameters")),
            parts.Section("Assumptions", parts.Notes(_assumed(found), parts.Level.PAGE)),
        ),
        hints=[] if found.finished else [f"Continue with: stepwell sweep resume {study.folder}"],
    )


def _table(columns: Schema, found: Status, name: str, about: str, more: str) -> parts.RecordTable:
    rows = getattr(found, name)
    return parts.RecordTable(
        columns, lambda: [base.record(columns, one) for one in rows], about, most=None, more=more
    )


def _done(found: Status) -> str:
    chunks = found.study.chunks
    return "all of it" if found.finished else f"{found.done} of {chunks} chunks are done"


def _deciding(found: Status) -> list[dict[str, Any]]:
    """The numbers that surely decide something, the foremost of each column."""
    return [
        {
            "column": one.column + (f" = {one.value}" if one.value else ""),
            "parameter": each.name,
            "share": each.share,
            "trend": each.trend,
        }
        for one in found.decided
        for each in one.sure[:_FOREMOST]
    ]


def _answer(found: Status, deciding: Sequence[Mapping[str, Any]]) -> str:
    """What most of the designs do, or else what decides most."""
    if found.outcomes:
        first = found.outcomes[0]
        share = _share(first.share, first.sampled, " of the designs")
        return f"{share} have {first.column} {first.value}"
    if deciding:
        first = deciding[0]
        of = f"the variance of {first['column']}"
        return f"{first['parameter']} explains {base.percent(first['share'])} of {of}"
    return ""


def _share(share: Share, sampled: bool = True, of: str = "") -> str:
    """A fraction, of what, with its interval where the designs are a sample."""
    ends = (
        f" (95 % confidence {base.percent(share.low)} to {base.percent(share.high)})"
        if sampled
        else ""
    )
    return f"{base.percent(share.share)}{of}{ends}"


def _screened(found: Status) -> list[parts.Fact]:
    """How a screen and what was computed agree."""
    of = found.screened
    if of is None:
        return []
    engine = found.study.given["engine"]
    kept = f"{engine} keeps {of.kept} of {of.designs}; {of.computed} were computed"
    return [
        parts.Fact("Screen", kept),
        *(
            parts.Fact(name.capitalize(), f"{share.times} of {share.of} {among}: {_share(share)}")
            for name, among in _AMONG.items()
            if (share := getattr(of, name))
        ),
    ]


def _assumed(found: Status) -> list[str]:
    assumed = ["Each parameter varies independently and evenly between its bounds."]
    if found.study.designs.how == "listed":
        assumed = [
            "The designs were listed: each of the parameters that vary together has the fraction "
            "of all of them."
        ]
    elif found.study.designs.how == "as built":
        assumed = ["The designs vary as mechanisms are built within their tolerances."]
    if found.decided:
        assumed.append(
            "What several parameters decide only together is in the fraction of none. A fraction "
            "below the floor, which chance alone exceeds in one study of twenty, is not shown."
        )
    if any(one.sampled for one in found.outcomes):
        assumed.append(
            "Intervals are those of designs drawn independently, 95 % (Clopper and Pearson); with "
            "a Sobol' sequence or a Latin hypercube the error is mostly smaller."
        )
    if found.screened:
        assumed.append(
            "A prefilter in single precision chose the designs that were computed, and some were "
            "drawn at random: fractions are those of the designs drawn, all other numbers those "
            "of all designs that were computed."
        )
    return assumed


def _trials(sweep: Sweep) -> Sequence[parts.Row]:
    values = zip(*sweep.values.values(), strict=True) if sweep.values else [()] * len(sweep.trials)
    return base.rows_of({"values": values, "trial": sweep.trials})


_TRIAL: Schema = (Quantity("values", holds=[float]), *base.read_off(robot.TRIAL, "trial"))
# What is reported of a sweep over robots.
SWEEP: Schema = (
    Quantity("keys", read=lambda sweep: list(sweep.values), holds=[str]),
    Quantity("trials", holds=[_TRIAL], read=_trials),
)


def sweep_account(sweep: Sweep, about: About) -> parts.Account:
    """What is reported of a sweep over robots."""
    failed = [one for one in sweep.trials if one.stopped]
    count = base.counted(len(sweep.trials), "robot")
    varied = [
        base.Column(key, lambda row, k=k: base.number(row["values"][k], 6), True)
        for k, key in enumerate(sweep.values)
    ]
    why = base.Column("why it stopped", lambda row: row["stopped"])
    first = f"{base.counted(len(failed), 'robot')} did not walk to the end. The first of these: "
    return parts.Account(
        sweep,
        kind="sweep/1",
        schema=SWEEP,
        title=count,
        origin=f"Varied: {', '.join(sweep.values) or 'nothing'}.",
        answer=f"{len(sweep.trials) - len(failed)} of {count} walked to the end",
        seed=about.seeds.get("values"),
        packages=("mujoco",),
        warnings=(
            parts.Warned(
                "Stopped early",
                "The simulation of some robots ended before its time.",
                [f"{first}{failed[0].stopped}"] if failed else [],
            ),
        ),
        sections=(
            parts.Section("Results", parts.Picture("sweep", "What each robot does in a cycle")),
            parts.Section(
                "Robots",
                parts.RecordTable(
                    (*varied, *robot.TRIAL),
                    "trials",
                    "One row for each robot.",
                    wide=[why] if failed else (),
                    more="robots",
                    level=parts.Level.CARD,
                ),
            ),
        ),
    )


_TIME_STEP: Schema = (
    Quantity("time_step", "ms", "time step"),
    Quantity("advance", "over_u_max", "d/u_max", form="z.3f"),
    Quantity("turn", "deg", "turn", form="z.1f"),
    Quantity("forces_off", "percent", read="off", form=".2f"),
    Quantity("jumps", "percent", "jumps", form=".1f"),
)
_DEVIATION = base.Column("force deviation [% of weight]", _TIME_STEP[3].cell, True)


# What is reported of a walk at several time steps.
CONVERGENCE: Schema = (
    Quantity("title", read="robot.title"),
    Quantity("time_steps", read="rows", holds=[_TIME_STEP]),
)


def convergence_account(found: Convergence, about: About) -> parts.Account:
    """What is reported of a walk at several time steps."""
    rows = found.rows
    steps = ", ".join(base.number(base.to_unit(row.time_step, "ms")) for row in rows)
    advance = [row.advance for row in rows]
    return parts.Account(
        found,
        kind="convergence/1",
        schema=CONVERGENCE,
        title=f"{found.robot.title or 'A robot'}, by time step",
        answer=f"d/u_max {min(advance):.3f} to {max(advance):.3f} at time steps of {steps} ms; "
        f"ground reaction forces deviate by at most {max(row.off for row in rows) * 100:.2f} % of "
        "the weight",
        packages=("mujoco",),
        sections=(
            parts.Section(
                "Time steps",
                parts.RecordTable(
                    (*_TIME_STEP[:3], _DEVIATION, _TIME_STEP[4]),
                    "time_steps",
                    most=None,
                    more="time steps",
                    level=parts.Level.CARD,
                ),
            ),
            parts.Section(
                "Definitions",
                parts.Text(
                    "Force deviation: root mean square over samples of the ground reaction "
                    "forces against those at the smallest time step. Jumps: fraction of the "
                    "steps in which a ground reaction force changes by more than a fifth."
                ),
            ),
        ),
    )
