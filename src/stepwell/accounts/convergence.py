"""How far a simulated walk depends on the time step."""

from __future__ import annotations

from typing import TYPE_CHECKING

from stepwell.accounts.account import Account, Level, Section, Table, Text
from stepwell.accounts.head import About
from stepwell.accounts.shape import Shape
from stepwell.base import Column, Quantity, Schema, number

if TYPE_CHECKING:
    from stepwell.simulation import Convergence


_STEP: Schema = (
    Quantity("time_step", "ms", "time step"),
    Quantity("advance", "over_u_max", "d/u_max", form="z.3f"),
    Quantity("turn", "deg", "turn", form="z.1f"),
    Quantity("forces_off", "percent", read="off", form=".2f"),
    Quantity("jumps", "percent", "jumps", form=".1f"),
)
_DEVIATION = Column("force deviation [% of weight]", _STEP[3].cell, True)


def convergence_schema(_shape: Shape | None = None) -> Schema:
    """What is reported of a walk at several time steps."""
    return (
        Quantity("title", read="robot.title"),
        Quantity("time_steps", read="rows", holds=[_STEP]),
    )


def convergence_account(found: Convergence, about: About | None = None) -> Account:
    """What is reported of a walk at several time steps."""
    rows = found.rows
    steps = ", ".join(number(row.time_step * 1e3) for row in rows)
    advance = [row.advance for row in rows]
    made = Account(
        found,
        kind="convergence/1",
        schema=convergence_schema(),
        title=f"{found.robot.title or 'A robot'}, by time step",
        answer=f"d/u_max {min(advance):.3f} to {max(advance):.3f} at time steps of {steps} ms; "
        f"ground reaction forces deviate by at most {max(row.off for row in rows) * 100:.2f} % of "
        "the weight",
        about=about or About(found.robot),
        packages=("mujoco",),
        sections=(
            Section(
                "Time steps",
                [
                    Table(
                        (*_STEP[:3], _DEVIATION, _STEP[4]),
                        lambda: made.record["time_steps"],
                        most=None,
                        more="time steps",
                        level=Level.CARD,
                    )
                ],
            ),
            Section(
                "Definitions",
                [
                    Text(
                        "Force deviation: root mean square over samples of the ground reaction "
                        "forces against those at the smallest time step. Jumps: fraction of the "
                        "steps in which a ground reaction force changes by more than a fifth."
                    )
                ],
            ),
        ),
    )
    return made
