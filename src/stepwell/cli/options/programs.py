"""Where the commands that drive a chain get their stroke program from."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from stepwell.mechanism import Chain
    from stepwell.sequences import Program

From = Annotated[
    str | None,
    typer.Option(
        "--from",
        metavar="STATE",
        help="Where it begins, such as 10, inner cell first; all cells at 0 by default.",
    ),
]
To = Annotated[
    str | None,
    typer.Option("--to", metavar="STATE", help="The state to end in, such as 01."),
]


def planned(chain: Chain, start: str | None, to: str | None) -> Program:
    """The shortest program; raises `Unreachable` where there is none."""
    from stepwell.cli.screen import progress
    from stepwell.sequences import Unreachable

    if to is None:
        raise typer.BadParameter("needs --to STATE, the state to end in.", param_hint="--from")
    for option, state in (("--from", start), ("--to", to)):
        if state is not None and (len(state) != len(chain) or set(state) - {"0", "1"}):
            problem = f"{state!r}: must be {len(chain)} characters 0 or 1, inner cell first."
            raise typer.BadParameter(problem, param_hint=option)
    try:
        with progress("program") as tell:
            return chain.program(to, start=start, progress=tell)
    except Unreachable:
        raise
    except ValueError as error:
        raise typer.BadParameter(str(error), param_hint="--from") from None


def own(text: str, design: str) -> Program:
    """The program that stands in a design file, on its chain."""
    from stepwell import files

    chain, written = files.loads_chain(text, design), files.loads_program(text, design)
    if written is None:
        raise files.DesignError(design, ["has no table [program]: pass --to STATE to plan one."])
    try:
        return written.on(chain)
    except ValueError as error:
        raise files.DesignError(design, [f"program: {error}"]) from None
