"""What every result says of itself: its schema, and what it was computed from and with."""

from __future__ import annotations

from typing import Any

from stepwell.base import __version__, versions
from stepwell.files import digest, dumps
from stepwell.mechanism import Chain
from stepwell.robot import Robot


def head(
    schema: str, design: str | Chain | Robot | None, seed: int | None = None, *packages: str
) -> dict[str, Any]:
    """The first names of every record, so that a result can be matched with its design.

    Args:
        schema: of the record.
        design: text of the design file, or what such a file is written for.
        seed: of the draws; None where nothing is drawn.
        packages: that took part, besides NumPy, SciPy and Numba.

    Returns:
        `schema`, `stepwell`, `versions`, `design_sha256` (None of a design that no file can
        hold) and `seed`.
    """
    if isinstance(design, Chain | Robot):
        try:
            design = dumps(design)
        except ValueError:
            design = None
    return {
        "schema": schema,
        "stepwell": __version__,
        "versions": versions(*packages),
        "design_sha256": None if design is None else digest(design),
        "seed": seed,
    }
