"""`stepwell sweep`: one thing computed of many designs, into a store that loses nothing."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from stepwell.cli.options import Design, Json, read_chain, read_range
from stepwell.cli.screen import EXIT_CODES, finish, progress, show_lines, styled, usable

if TYPE_CHECKING:
    from stepwell.mechanism import Chain
    from stepwell.studies import Axis, Status

commands = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode="rich" if styled() else None,
    help="Compute one thing of many designs, on all cores; what is killed goes on.",
    epilog=EXIT_CODES,
)

_Vary = Annotated[
    list[str],
    typer.Option(
        "--vary",
        metavar="NAME=FROM:TO:COUNT",
        help="What varies, such as outer.q.x=0:20:41 or 1.stiffness=20:40:9, in the units of "
        "`stepwell map`; :log for equal ratios; without COUNT with --random, --sobol or --latin. "
        "May be given again.",
    ),
]
_Store = Annotated[
    Path,
    typer.Option(
        "--out", "-o", metavar="STORE", help="The store, a folder that xarray opens as Zarr."
    ),
]
_Drawn = {
    "sobol": typer.Option(metavar="N", min=1, help="N designs of a Sobol' sequence, scrambled."),
    "latin": typer.Option(metavar="N", min=1, help="N designs of a Latin hypercube."),
    "random": typer.Option(metavar="N", min=1, help="N designs drawn independently."),
}
_Seed = Annotated[int, typer.Option(help="Of what is drawn.", min=0)]
_Chunk = Annotated[
    int | None,
    typer.Option(metavar="N", min=1, help="Designs that are computed and written together."),
]
_Workers = Annotated[
    int | None,
    typer.Option(metavar="N", min=1, help="Processes at once; one for every core by default."),
]
_There = Annotated[Path, typer.Argument(metavar="STORE", help="What --out said.")]


def _command(what: str, doc: str) -> None:
    """A command for something that is computed."""

    def run(
        design: Design,
        vary: _Vary,
        out: _Store,
        sobol: Annotated[int | None, _Drawn["sobol"]] = None,
        latin: Annotated[int | None, _Drawn["latin"]] = None,
        random: Annotated[int | None, _Drawn["random"]] = None,
        seed: _Seed = 0,
        chunk: _Chunk = None,
        workers: _Workers = None,
        as_json: Json = False,
    ) -> None:
        from stepwell.studies import How, Space, sweep

        given = {How.SOBOL: sobol, How.LATIN: latin, How.RANDOM: random}
        asked = [(how, count) for how, count in given.items() if count is not None]
        if len(asked) > 1:
            raise typer.BadParameter(
                f"cannot stand with --{asked[1][0]}.", param_hint=f"--{asked[0][0]}"
            )
        how, count = asked[0] if asked else (How.GRID, 0)
        _, chain = read_chain(design)
        with usable("--vary"):
            space = Space(_axes(vary, chain, drawn=bool(asked)), how, count, seed)
        with usable(design), _going_on(out) as tell:
            found = sweep(chain, what, space, out, chunk=chunk, workers=workers, progress=tell)
        _show(found, as_json)

    run.__doc__ = doc
    commands.command(what, epilog=EXIT_CODES)(run)


for _what, _doc in {
    "cycle": "Follow the full cycle of every design: sequence, snaps, peak force, energy lost.",
    "margin": "Say how far every design is from another sequence, by an anchor or a stiffness.",
    "yield": "Say how many of every design, built with the usual tolerances, do what it does.",
    "graph": "Count the states and transitions that every design has in reach.",
}.items():
    _command(
        _what,
        f"{_doc}\n\nThe designs are a grid, or drawn. What is found goes chunk by chunk into a "
        f"store; whatever was killed, the same command goes on, and the finished store is the "
        f"same. A design that cannot be computed has its problem told in its row.",
    )


@commands.command(epilog=EXIT_CODES)
def resume(store: _There, workers: _Workers = None, as_json: Json = False) -> None:
    """Compute what is missing in a store."""
    from stepwell.studies import begun, opened, resumed

    with _going_on(store) as tell:
        found = resumed(begun(opened(store)), workers, tell)
    _show(found, as_json)


@commands.command(epilog=EXIT_CODES)
def status(store: _There, as_json: Json = False) -> None:
    """Say how far a study is, and what it has found so far."""
    from stepwell import studies

    _show(studies.status(store), as_json)


@commands.command(epilog=EXIT_CODES)
def export(
    store: _There,
    out: Annotated[
        Path, typer.Option("--out", "-o", metavar="FILE", help="The table, CSV.", dir_okay=False)
    ],
) -> None:
    """Write the designs of a store that are done as a table, units in the headings."""
    from stepwell.studies import opened

    count = opened(store).to_csv(out)
    show_lines(f"Written into {out}: {count} designs.")


def _show(found: Status, as_json: bool) -> None:
    from stepwell import results
    from stepwell.cli.text import studies as texts

    finish(results.study_record(found), texts.study, as_json)


def _going_on(store: Path) -> Any:
    kept = f"what is done stays, and `stepwell sweep resume {store}` goes on"
    return progress("chunks", kept=kept)


def _axes(texts: Sequence[str], chain: Chain, *, drawn: bool) -> tuple[Axis, ...]:
    """What varies, in SI, for a chain that has it."""
    from stepwell.base import told_in
    from stepwell.design import parameter
    from stepwell.studies import Axis

    form = "NAME=FROM:TO" if drawn else "NAME=FROM:TO:COUNT"
    example = "outer.q.x=0:20" + ("" if drawn else ":41")
    found: list[Axis] = []
    for text in texts:
        one = read_range(text, form, example)
        if not one.start < one.stop:
            raise typer.BadParameter(f"{text!r}: must rise, as {example} does.")
        wanted = parameter(chain, one.name)
        wanted.values([1.0, 2.0], 2)  # a place is no number
        factor = told_in(wanted.unit)[1]
        found.append(Axis(one.name, one.start / factor, one.stop / factor, one.count or 2, one.log))
    return tuple(found)
