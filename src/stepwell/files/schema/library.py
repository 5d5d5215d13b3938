"""The keys of the elements of the library: the arguments of their functions, in units of files."""

from __future__ import annotations

from decimal import Decimal
from typing import Annotated, Any

from pydantic import PlainValidator

from stepwell.files.schema.checks import Keys, above_zero, bounded, lengths, refuse


def _corner(value: Any) -> tuple[Decimal, ...]:
    return lengths(value, 2, "must be a travel in mm and a force in N, as in [4, 1].")


def _count(value: Any) -> int:
    if type(value) is not int or not 1 <= value <= 1000:
        refuse("must be a whole number from 1 to 1000.")
    return value


Corner = Annotated[tuple[Decimal, ...], PlainValidator(_corner)]
Count = Annotated[int, PlainValidator(_count)]
Size = Annotated[Decimal, above_zero("1e-3", "1e6")]
Height = Annotated[Decimal, bounded("0", "1e6", ">= 0 (up to 1e6)")]
Spring = Annotated[Decimal, above_zero("1e-6", "1e9")]
Modulus = Annotated[Decimal, above_zero("1e-6", "1e9")]
Share = Annotated[Decimal, bounded("0", "1e9", ">= 0 (up to 1e9)")]
Stretch = Annotated[Decimal, bounded("1", "100")]


class TrilinearKeys(Keys):
    """Two straight rising branches with a falling one between them."""

    peak_mm_N: Corner | None = None
    valley_mm_N: Corner | None = None
    first_N_per_m: Spring | None = None
    last_N_per_m: Spring | None = None


class TrussKeys(Keys):
    """Two inclined springs whose apex is pushed through."""

    half_width_mm: Size | None = None
    height_mm: Size | None = None
    stiffness_N_per_m: Spring | None = None


class BeamKeys(Keys):
    """Cosine-shaped beams that are joined in the middle."""

    span_mm: Size | None = None
    height_mm: Size | None = None
    thickness_mm: Size | None = None
    width_mm: Size | None = None
    modulus_GPa: Modulus | None = None
    beams: Count | None = None


class BalloonKeys(Keys):
    """A spherical rubber balloon."""

    radius_mm: Size | None = None
    thickness_mm: Size | None = None
    c1_kPa: Modulus | None = None
    c2_kPa: Share | None = None
    stretch: Stretch | None = None


class KreslingKeys(Keys):
    """One storey of a folded cylinder."""

    sides: Count | None = None
    radius_mm: Size | None = None
    folded_mm: Height | None = None
    deployed_mm: Size | None = None
    mountain_N_per_m: Spring | None = None
    valley_N_per_m: Spring | None = None


class DomeKeys(Keys):
    """Rubber domes of a keyboard, as measured."""

    count: Count | None = None


class LibraryKeys(Keys):
    """The elements of the library by the names of their functions."""

    trilinear: TrilinearKeys | None = None
    von_mises_truss: TrussKeys | None = None
    curved_beam: BeamKeys | None = None
    balloon: BalloonKeys | None = None
    kresling: KreslingKeys | None = None
    dome: DomeKeys | None = None
