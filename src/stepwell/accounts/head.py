"""Provenance of a result, and the properties of a chain that decide the names in its record."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import product
from typing import TYPE_CHECKING, Any, NamedTuple

from stepwell import base
from stepwell.base import Measure, Quantity, Schema, keys

if TYPE_CHECKING:
    from stepwell.mechanism import Chain
    from stepwell.robot import Arena, Robot

Row = Mapping[str, Any]
# The first names of every JSON Schema, and those of computed results, see `head`.
BARE: Schema = keys(stepwell=str)
HEAD: Schema = (*BARE, *keys(versions={str: str}, design_sha256=str | None, seed=int | None))


def recorded(schema: Schema, values: Iterable[Any]) -> Callable[[], list[Row]]:
    """A function that returns the rows of a table: the records of some values."""
    return lambda: [base.record(schema, value) for value in values]


@dataclass(frozen=True)
class Calibrated:
    """The recordings on which a design was calibrated.

    Args:
        data: the name of their folder.
        data_sha256: of each file.
        law: of the bands, as fitted.
        summary: the fitted numbers, a sentence each.
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
    """The input from which a result was computed.

    Args:
        design: text of the design file, or the value for which such a file is written.
        source: the name of that file, or of the folder of recordings.
        calibrated: the recordings on which the design was calibrated; None without any.
        seeds: of earlier random draws, by name; None for a part without draws.
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
    """The first names of a record without a computation: `schema` and `stepwell`."""
    return {"schema": f"stepwell.{kind}", "stepwell": base.__version__}


def digest_of(design: str | Chain | Robot | Arena | None) -> str | None:
    """The SHA-256 of a design file, or of the one for a value; None if no file can hold it."""
    from stepwell.files import digest, dumps

    with suppress(ValueError):
        if design is not None:
            return digest(design if isinstance(design, str) else dumps(design))
    return None


def head(
    kind: str, design: str | Chain | Robot | None, seed: int | None = None, *packages: str
) -> dict[str, Any]:
    """The first names of a record, by which a result can be matched with its design.

    Args:
        kind: of the record, with its version, such as "check/1".
        design: text of the design file, or the value for which such a file is written.
        seed: of the draws; None without draws.
        packages: used packages besides NumPy, SciPy and Numba.

    Returns:
        `schema`, `stepwell`, `versions`, `design_sha256` (None if no file can hold the design) and
        `seed`.
    """
    versions = base.versions(*packages)
    return bare(kind) | {"versions": versions, "design_sha256": digest_of(design), "seed": seed}


class DesignShape(NamedTuple):
    """The kind of a chain: records of all chains of a shape have the same names."""

    measure: Measure = Measure.TRAVEL
    force_driven: bool = False  # Whether the actuator prescribes the force.
    levers: bool = True
    elements: bool = False
    folds: bool = False  # Whether the curve of an element folds back.

    @property
    def drive(self) -> str:
        """The unit of the drive in records."""
        measure = self.measure
        si = measure.force_unit if self.force_driven else measure.travel_unit
        return base.display_unit(si)[0]

    @classmethod
    def of(cls, chain: Chain) -> DesignShape:
        """The shape of a chain."""
        elements, force_driven = chain.elements, chain.actuator_stiffness == 0
        folds = any(len(element.laws) > 1 for element in elements)
        return cls(chain.measure, force_driven, len(elements) < len(chain), bool(elements), folds)


def shapes() -> Iterable[DesignShape]:
    """All possible shapes; cells with levers have travel and force as their measure."""
    kinds = [(False, True, False), (False, True, True)]
    levers = [(True, False, False), (True, True, False), (True, True, True)]
    for measure, force_driven in product(Measure, (False, True)):
        for kind in kinds + levers * (measure is Measure.TRAVEL):
            yield DesignShape(measure, force_driven, *kind)


def of_class(kind: type, schema: Iterable[Quantity]) -> Schema:
    """The same quantities, None for a value of another class."""

    def read(value: Any, quantity: Quantity) -> Any:
        return quantity.of(value) if isinstance(value, kind) else None

    return tuple(replace(q, read=partial(read, quantity=q), missing=True) for q in schema)
