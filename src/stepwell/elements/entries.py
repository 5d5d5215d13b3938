"""What the library holds, as a table: presets, drafts and galleries are made from it."""

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from stepwell.base import ByValue, ReadOnly
from stepwell.elements.balloon import balloon
from stepwell.elements.curved_beam import curved_beam
from stepwell.elements.dome import dome
from stepwell.elements.kresling import kresling
from stepwell.elements.trilinear import trilinear
from stepwell.elements.von_mises_truss import von_mises_truss
from stepwell.mechanism import Element


@dataclass(frozen=True, slots=True, eq=False)
class LibraryEntry(ByValue):
    """One element of the library.

    Args:
        make: the function; called without arguments, it gives something to build.
        what: what it is, in one line.
        assumes: what its law takes for granted, in one line.
        source: author and year.
    """

    make: Callable[..., Element]
    what: str
    assumes: str
    source: str

    @property
    def defaults(self) -> Mapping[str, Any]:
        """The arguments of `make` in SI, but for its name: what they are where none is given."""
        parameters = inspect.signature(self.make).parameters.values()
        return {one.name: one.default for one in parameters if one.name != "name"}


LIBRARY: Mapping[str, LibraryEntry] = ReadOnly(
    {
        "trilinear": LibraryEntry(
            trilinear,
            "two rising branches with a falling one between them",
            "all three straight",
            "Puglisi & Truskinovsky 2000",
        ),
        "von-mises-truss": LibraryEntry(
            von_mises_truss,
            "two inclined springs whose apex is pushed through",
            "springs that stay straight, an apex on the axis of symmetry",
            "von Mises 1923",
        ),
        "curved-beam": LibraryEntry(
            curved_beam,
            "cosine-shaped beams, clamped at both ends and joined in the middle",
            "small slopes, a linear material, rigid clamps, no turning of the middle",
            "Qiu, Lang & Slocum 2004",
        ),
        "balloon": LibraryEntry(
            balloon,
            "a spherical rubber balloon, pressure against volume",
            "a thin Mooney-Rivlin membrane that stays a sphere, without loss",
            "Rivlin & Saunders 1951",
        ),
        "kresling": LibraryEntry(
            kresling,
            "a paper cylinder that twists as it shortens, one end free to turn",
            "creases that are springs along themselves and turn for nothing, rigid ends",
            "Yasuda & Yang 2015",
        ),
        "dome": LibraryEntry(
            dome,
            "a rubber dome of a keyboard switch, from a measured table",
            "one specimen, the half while pressed, friction of its stem within the force",
            "ThereminGoat 2025",
        ),
    }
)
