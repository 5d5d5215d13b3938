"""Full cycle of a design with its margin, landings and yield."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

from stepwell.base import ByValue
from stepwell.design.margins.margin import LONGEST_FOLLOWED, Margin, margin
from stepwell.design.tolerances.yields import Yield, yields
from stepwell.mechanism import Chain
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
    def built(self) -> Yield | None:
        """Yield of a few samples that reproduce the sequence; None for more than 12 cells."""
        if len(self.chain) > LONGEST_FOLLOWED:
            return None
        target = str(self.cycle.sequence)
        few = yields(self.chain, samples=_FOLLOWED, target=target)
        return few if few.by_engine else yields(self.chain, samples=_IN_CLOSED_FORM, target=target)
