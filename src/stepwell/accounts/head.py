"""Where a result comes from, and on what the names in its record depend."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import product
from typing import TYPE_CHECKING, Any, NamedTuple

from stepwell.base import (
    Measure,
    Quantity,
    Schema,
    __version__,
    display_unit,
    keys,
    record,
    versions,
)

if TYPE_CHECKING:
    from stepwell.mechanism import Chain
    from stepwell.robot import Robot

Row = Mapping[str, Any]
# The first name of every JSON Schema, and those of what was computed, see `head`.
BARE: Schema = (Quantity("stepwell"),)


def recorded(schema: Schema, values: Iterable[Any]) -> Callable[[], list[Row]]:
    """What makes the rows of a table: the records of some values."""
    return lambda: [record(schema, value) for value in values]


HEAD: Schema = (*BARE, *keys(versions={str: str}, design_sha256=str | None, seed=int | None))


@dataclass(frozen=True)
class Calibrated:
    """The recordings that a design was calibrated on.

    Args:
        data: the name of their folder.
        data_sha256: of each file.
        law: of the bands, as fitted.
        summary: what was fitted, a sentence each.
        scatter: standard deviation of the bands' stiffness over its mean [1].
    """

    data: str
    data_sha256: Mapping[str, str]
    law: str
    summary: Sequence[str]
    scatter: float


CALIBRATED = Quantity(
    "calibrated",
    holds=keys(data=str, data_sha256={str: str}, law=str, summary=[str], scatter="percent"),
    missing=True,
)


@dataclass(frozen=True)
class About:
    """From what a result was computed.

    Args:
        design: text of the design file, or the value for which such a file is written.
        source: the name of that file, or of the folder of recordings.
        calibrated: of the recordings that the design was calibrated on; None for none.
        seeds: of what was drawn before the result was computed, by name; None of what was not.
        data_sha256: of the file of each recording by its name.
        designs_sha256: of each design file by its name, where recordings are compared with several.
    """

    design: str | Chain | Robot | None = None
    source: str | None = None
    calibrated: Calibrated | None = None
    seeds: Mapping[str, int | None] = field(default_factory=dict)
    data_sha256: Mapping[str, str] = field(default_factory=dict)
    designs_sha256: Mapping[str, str] = field(default_factory=dict)


def bare(kind: str) -> dict[str, Any]:
    """The first names of a record of which nothing was computed: `schema` and `stepwell`."""
    return {"schema": f"stepwell.{kind}", "stepwell": __version__}


def head(
    kind: str, design: str | Chain | Robot | None, seed: int | None = None, *packages: str
) -> dict[str, Any]:
    """The first names of a record, so that a result can be matched with its design.

    Args:
        kind: of the record, with its version, such as "check/1".
        design: text of the design file, or the value for which such a file is written.
        seed: of the draws; None where nothing is drawn.
        packages: that took part, besides NumPy, SciPy and Numba.

    Returns:
        `schema`, `stepwell`, `versions`, `design_sha256` (None if no file can hold the design) and
        `seed`.
    """
    from stepwell.files import digest, dumps

    if design is not None and not isinstance(design, str):
        try:
            design = dumps(design)
        except ValueError:
            design = None
    return {
        **bare(kind),
        "versions": versions(*packages),
        "design_sha256": None if design is None else digest(design),
        "seed": seed,
    }


class Shape(NamedTuple):
    """A kind of chain: in all chains of a shape the same names are in a record."""

    measure: Measure = Measure.TRAVEL
    force_driven: bool = False  # Whether the actuator prescribes the force.
    levers: bool = True
    elements: bool = False
    folds: bool = False  # Whether the curve of an element folds back.

    @property
    def drive(self) -> str:
        """The unit of the drive in records."""
        measure = self.measure
        return display_unit(measure.force_unit if self.force_driven else measure.travel_unit)[0]

    @classmethod
    def of(cls, chain: Chain) -> Shape:
        """The shape of a chain."""
        found, force_driven = chain.elements, chain.actuator_stiffness == 0
        folds = any(len(element.laws) > 1 for element in found)
        return cls(chain.measure, force_driven, len(found) < len(chain), bool(found), folds)


def shapes() -> Iterable[Shape]:
    """All shapes that there are; levers give travel and force alone."""
    for measure, force_driven in product(Measure, (False, True)):
        kinds = [(False, True, False), (False, True, True)]
        if measure is Measure.TRAVEL:
            kinds += [(True, False, False), (True, True, False), (True, True, True)]
        yield from (Shape(measure, force_driven, *kind) for kind in kinds)


def of_class(kind: type, schema: Iterable[Quantity]) -> Schema:
    """The same quantities, None of a value of another class."""

    def read(value: Any, quantity: Quantity) -> Any:
        return quantity.of(value) if isinstance(value, kind) else None

    return tuple(replace(q, read=partial(read, quantity=q), missing=True) for q in schema)
