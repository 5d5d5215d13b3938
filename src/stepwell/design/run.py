"""Full cycle of a design with its margin, landings and yield."""

from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING

from stepwell.base import ByValue, StepwellError
from stepwell.design.margins.margin import LONGEST_FOLLOWED, Margin, margin
from stepwell.design.tolerances.yields import Yield, yields
from stepwell.mechanism import Chain, Element
from stepwell.sequences import Cycle, cycle

if TYPE_CHECKING:
    from stepwell.statics import Landing

# Simulated samples, and samples in closed form: both take about as long.
_FOLLOWED, _IN_CLOSED_FORM = 100, 20_000


@dataclass(frozen=True, eq=False)
class Run(ByValue):
    """A full cycle of a design with its robustness margin, each computed once.

    Attributes:
        cycle, margin: the full cycle, and the smallest changes that change its sequence.
        landings: robustness of each landing to other mobilities; None if unchecked.
    """

    cycle: Cycle
    margin: Margin
    landings: "tuple[Landing, ...] | None" = field(repr=False)

    @classmethod
    def of(cls, chain: Chain, mobility_ratio: float | None = None) -> "Run":
        """The run of a chain.

        Args:
            chain: the design.
            mobility_ratio: landings are checked up to it; by default up to 10, for up to 8 cells.

        Raises:
            ValueError: a ratio that is not allowed.
            StaticsError: the engine could not continue; the text states an action.
        """
        motion = cycle(chain)
        path = motion.path
        checked = path.checked_landings if mobility_ratio is None else path.landings(mobility_ratio)
        return cls(motion, margin(chain), checked)

    @property
    def chain(self) -> Chain:
        """The design."""
        return self.cycle.chain

    @cached_property
    def within_bands(self) -> tuple[Cycle, ...]:
        """Cycles with the curves of measured elements changed by their error bands.

        Of each such element alone, and of all, the drops are larger or smaller by the error band;
        empty without measured elements, and for more than 12 cells.
        """
        cells = self.chain.cells
        banded = [i for i, c in enumerate(cells) if isinstance(c, Element) and c.error_band]
        if not banded or len(cells) > LONGEST_FOLLOWED:
            return ()
        groups = [{i} for i in banded] + [{*banded}] * (len(banded) > 1)
        cycles: list[Cycle] = []
        for group, way in product(groups, (1.0, -1.0)):
            # A drop as small as the error band is reported as such.
            with suppress(StepwellError):
                changed = [
                    c.at_band(way) if i in group and isinstance(c, Element) else c
                    for i, c in enumerate(cells)
                ]
                cycles.append(cycle(replace(self.chain, cells=tuple(changed))))
        return tuple(cycles)

    @property
    def dissipated_range(self) -> tuple[float, float] | None:
        """Least and largest dissipated energy [J] within the error bands; None without bands."""
        energies = [one.dissipated for one in (self.cycle, *self.within_bands)]
        return (min(energies), max(energies)) if len(energies) > 1 else None

    @property
    def other_sequences(self) -> tuple[str, ...]:
        """Sequences other than that of the cycle within the error bands."""
        own = str(self.cycle.sequence)
        sequences = dict.fromkeys(str(one.sequence) for one in self.within_bands)
        return tuple(one for one in sequences if one != own)

    @cached_property
    def built(self) -> Yield | None:
        """Yield of a few samples that reproduce the sequence; None for more than 12 cells."""
        if len(self.chain) > LONGEST_FOLLOWED:
            return None
        target = str(self.cycle.sequence)
        few = yields(self.chain, samples=_FOLLOWED, target=target)
        return few if few.by_engine else yields(self.chain, samples=_IN_CLOSED_FORM, target=target)
