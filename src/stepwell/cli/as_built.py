"""`stepwell lab as-built`: a first build, what it must be, and which anchors to move."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from stepwell.base import told_in
from stepwell.cli.options import Design, Force, Json, Out, free, read_chain, tolerances as given
from stepwell.cli.screen import progress, report, usable

if TYPE_CHECKING:
    from stepwell.lab import Pull
    from stepwell.mechanism import Chain

_Strokes = Annotated[
    str | None,
    typer.Option(
        metavar="LIST",
        help="Strokes where it snapped that way, with commas [mm, mL or deg]; none for no snap.",
    ),
]


def as_built(
    design: Design,
    seen: Annotated[
        str | None,
        typer.Option(metavar="STATES", help="The states it went through, as 00>10>11>01>00."),
    ] = None,
    snaps_out: _Strokes = None,
    snaps_back: _Strokes = None,
    pulls: Annotated[
        str | None,
        typer.Option(
            metavar="LIST",
            help="Forces read on the way out, STROKE:FORCE with commas [mm:N, mL:kPa, deg:N mm].",
        ),
    ] = None,
    data: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="A recording of stroke and force [mm, N].", exists=True),
    ] = None,
    ruler: Annotated[
        float,
        typer.Option(
            metavar="DOUBT", help="Standard deviation of a stroke [mm, mL or deg].", min=0.01
        ),
    ] = 1.0,
    scale: Annotated[
        float | None,
        typer.Option(
            metavar="DOUBT",
            help="Standard deviation of a force [N, kPa or N mm]; 5 % of the drawing's peak force.",
            min=1e-6,
        ),
    ] = None,
    want: Annotated[
        str | None,
        typer.Option(metavar="STATES", help="What it should do; by default what the drawing does."),
    ] = None,
    hole: Annotated[
        float, typer.Option("--hole-mm", metavar="MM", help="How far apart holes are.", min=0.1)
    ] = 5.0,
    wrong_hole: Annotated[
        float,
        typer.Option(
            metavar="PERCENT",
            help="How likely an anchor is in the hole beside its own.",
            min=0,
            max=40,
        ),
    ] = 5.0,
    anchor: given.Anchor = 1.0,
    stiffness_spread: given.StiffnessSpread = 10.0,
    rest_length_spread: given.RestLengthSpread = 0.0,
    friction: given.Friction = 0.0,
    travel_spread: given.TravelSpread = 5.0,
    samples: Annotated[
        int, typer.Option(metavar="N", help="How many builds are drawn.", min=100)
    ] = 200,
    seed: given.Seed = 0,
    out: Out = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Say what a first build must be like to do what it did, and which anchors to move.

    Give what you saw when it was pulled out and let back once: the order of its states, strokes of
    snaps read off a ruler, forces read off a scale, or a recording. Builds within tolerances, some
    with an anchor in a wrong hole, are drawn at random and weighed by how well they agree with it.
    With --out, the design as it was built and as it is with the best move go into a folder.
    """
    from stepwell import lab
    from stepwell.accounts import About, account
    from stepwell.design import Tolerances

    free(out, "lab as-built", force)
    text, chain = read_chain(design)
    (_, driven), (_, forced) = told_in(chain.drive_unit), told_in(chain.measure.force_unit)
    peak = abs(chain.cycle().peak_force)
    with usable("what was seen"):
        told = lab.Observed(
            seen,
            _strokes(snaps_out, "--snaps-out", driven),
            _strokes(snaps_back, "--snaps-back", driven),
            (*_read(pulls, chain), *(_recorded(data, chain) if data is not None else ())),
            ruler / driven,
            0.05 * peak if scale is None else scale / forced,
        )
    spread: Tolerances = given.tolerances(
        anchor, stiffness_spread, rest_length_spread, 0.0, friction, travel_spread, chain.measure
    )
    with usable("what was seen"), progress("builds") as tell:
        found = lab.as_built(
            chain,
            told,
            spread,
            wanted=want,
            hole=hole * 1e-3,
            wrong_hole=wrong_hole / 100,
            n=samples,
            seed=seed,
            progress=tell,
        )
    report(account(found, About(text, design)), as_json, out, force)


def _strokes(text: str | None, option: str, factor: float) -> tuple[float, ...] | None:
    if text is None:
        return None
    if text.strip() in ("", "none"):
        return ()
    try:
        return tuple(float(one) / factor for one in text.split(","))
    except ValueError:
        message = f"{text!r}: must be numbers with commas, as 36.5,38, or none."
        raise typer.BadParameter(message, param_hint=option) from None


def _read(text: str | None, chain: Chain) -> tuple[Pull, ...]:
    from stepwell.lab import Pull

    if text is None:
        return ()
    stroke, force = told_in(chain.measure.travel_unit)[1], told_in(chain.measure.force_unit)[1]
    try:
        pairs = [tuple(map(float, one.split(":"))) for one in text.split(",")]
        return tuple(Pull(1, u / stroke, f / force) for u, f in pairs)
    except ValueError:
        message = f"{text!r}: must be STROKE:FORCE with commas, as 10:0.35,20:0.1."
        raise typer.BadParameter(message, param_hint="--pulls") from None


def _recorded(file: Path, chain: Chain) -> tuple[Pull, ...]:
    from stepwell.lab import pulls_of, read

    return pulls_of(read(file), chain.full_stroke)
