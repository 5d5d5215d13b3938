"""Many robots: what each of them does in a cycle."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from stepwell.accounts.account import Account, Level, Picture, Section, Table, Warned
from stepwell.accounts.head import About
from stepwell.accounts.shape import Shape
from stepwell.base import Column, Quantity, Schema, counted, number, read_off
from stepwell.robot import TRIAL

if TYPE_CHECKING:
    from stepwell.simulation import Sweep, Trial


def sweep_schema(_shape: Shape | None = None) -> Schema:
    """What is reported of a sweep over robots."""
    trial = (Quantity("values", holds=[float], read="values"), *read_off(TRIAL, "trial"))
    return (
        Quantity("keys", read=lambda sweep: list(sweep.values), holds=[str]),
        Quantity("trials", holds=[trial], read=_trials),
    )


class _Trial(NamedTuple):
    values: tuple[float, ...]
    trial: Trial


def _trials(sweep: Sweep) -> list[_Trial]:
    count = len(sweep.trials)
    values = zip(*sweep.values.values(), strict=True) if sweep.values else ((),) * count
    return [_Trial(tuple(row), one) for row, one in zip(values, sweep.trials, strict=True)]


def sweep_account(sweep: Sweep, about: About | None = None) -> Account:
    """What is reported of a sweep over robots."""
    about = about or About()
    failed = [one for one in _trials(sweep) if one.trial.stopped]
    count = counted(len(sweep.trials), "robot")
    varied = [
        Column(key, lambda row, k=k: number(row["values"][k], 6), True)
        for k, key in enumerate(sweep.values)
    ]
    why = Column("why it stopped", lambda row: row["stopped"])
    first = f"{counted(len(failed), 'robot')} did not walk to the end. The first of these: "
    made = Account(
        sweep,
        kind="sweep/1",
        schema=sweep_schema(),
        title=count,
        origin=f"Varied: {', '.join(sweep.values) or 'nothing'}.",
        answer=f"{len(sweep.trials) - len(failed)} of {count} walked to the end",
        about=about,
        seed=about.seeds.get("values"),
        packages=("mujoco",),
        warnings=(
            Warned(
                "Stopped early",
                "The simulation of some robots ended before its time.",
                [f"{first}{failed[0].trial.stopped}"] if failed else [],
            ),
        ),
        sections=(
            Section("Results", [Picture("sweep", "What each robot does in a cycle")]),
            Section(
                "Robots",
                [
                    Table(
                        (*varied, *TRIAL),
                        lambda: made.record["trials"],
                        "One row for each robot.",
                        wide=[why] if failed else (),
                        more="robots",
                        level=Level.CARD,
                    )
                ],
            ),
        ),
    )
    return made
