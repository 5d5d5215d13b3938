"""Parts lists of a build as CSV: cut parts and fasteners, and the rubber bands."""

from collections.abc import Iterator, Sequence

from stepwell.base import GRAVITY, csv_text, grouped
from stepwell.build.builds import BandUse, Build
from stepwell.build.contour import GRAMS, MM
from stepwell.build.exports.sheets import CutSheet
from stepwell.build.robots.robot_builds import RobotBuild
from stepwell.design import BandType

PARTS_HEAD = ("what", "name", "mark", "quantity", "size", "material", "mass_g", "sheet")
BANDS_HEAD = (
    "cell",
    "band",
    "from_hole",
    "to_hole",
    "free_length_mm",
    "stiffness_N_per_m",
    "length_state_0_mm",
    "force_state_0_N",
    "pull_state_0_g",
    "length_state_1_mm",
    "force_state_1_N",
    "pull_state_1_g",
    "longest_mm",
    "stretch",
    "largest_stretch",
    "of_the_pack_mm",
    "available",
)
# Available bands count if their forces deviate by at most this many standard deviations.
_WITHIN = 2.0


def parts_csv(build: Build | RobotBuild, sheets: Sequence[CutSheet] = ()) -> str:
    """Cut parts, one a row with its sheet; fasteners of one size a row; quantities to buy."""
    return csv_text(PARTS_HEAD, [*_part_rows(build, sheets), *_fastener_rows(build)])


def _part_rows(build: Build | RobotBuild, sheets: Sequence[CutSheet]) -> Iterator[tuple[str, ...]]:
    density = build.build_file.sheet.density
    on = {part.name: sheet.name for sheet in sheets for part in sheet.parts}
    for part in build.parts:
        x0, y0, x1, y1 = (MM * one for one in part.outline.bounds)
        yield (
            "cut part",
            part.name,
            part.mark,
            "1",
            f"{x1 - x0:.2f} x {y1 - y0:.2f} x {MM * part.thickness:g} mm",
            part.material,
            f"{GRAMS * part.mass(density):.2f}",
            on.get(part.name, ""),
        )


def _fastener_rows(build: Build | RobotBuild) -> Iterator[tuple[str, ...]]:
    """Fasteners by use and size; heads belong to their screws."""
    bought = [one for one in build.layout.fasteners if one.use != "head"]
    for (use, size), same in grouped(((one.use, one.size), one) for one in bought).items():
        yield use, size, "", str(len(same)), size, "", "", ""
    for box in build.layout.boxes if isinstance(build, RobotBuild) else ():
        if box.size:
            yield "bought", box.name, "", "1", box.size, "", f"{GRAMS * box.mass:.2f}", ""


def bands_csv(build: Build | RobotBuild, available: Sequence[BandType] = ()) -> str:
    """Rubber bands: lengths, and forces as on a kitchen scale, in both states of their cells.

    The last column has the names of the available bands whose forces in both states are those of
    the design within two standard deviations of the stiffness, with the larger deviation.
    """
    return csv_text(BANDS_HEAD, [_band_row(build, one, available) for one in build.bands])


def _band_row(
    build: Build | RobotBuild, one: BandUse, available: Sequence[BandType]
) -> tuple[str, ...]:
    band = build.band_cell(one).bands[one.number]
    cell, inner, outer = build.band_words(one)
    states = (
        value
        for length, force in zip(one.lengths, one.tensions, strict=True)
        for value in (f"{MM * length:.2f}", f"{force:.3f}", f"{GRAMS * force / GRAVITY:.1f}")
    )
    return (
        cell,
        str(one.number + 1),
        inner,
        outer,
        f"{MM * one.rest_length:.2f}",
        f"{band.stiffness:.4g}",
        *states,
        f"{MM * one.longest:.2f}",
        f"{one.stretch:.3f}",
        f"{build.build_file.band.largest_stretch:.3f}",
        " or ".join(f"{MM * length:g}" for length in one.fits),
        " or ".join(_suitable(build, one, available)),
    )


def _suitable(
    build: Build | RobotBuild, one: BandUse, available: Sequence[BandType]
) -> Iterator[str]:
    """Names of the available bands that pull as the design's, each with its deviation."""
    most = _WITHIN * build.build_file.tolerance.stiffness
    for kind in available:
        band = kind.between((0.0, 0.0), (0.0, 0.0))
        # Slack bands have no force to compare.
        off = [
            float(band.tension(length)) / force - 1.0
            for length, force in zip(one.lengths, one.tensions, strict=True)
            if force > 0.0
        ]
        worst = max(off, key=abs, default=0.0)
        if abs(worst) <= most:
            yield f"{kind.name or f'{kind.stiffness:g} N/m'} ({100.0 * worst:+.1f} %)"
