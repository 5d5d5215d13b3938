"""What a design does, and how far it is from doing something else: a cycle and what follows."""

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

# Samples that the engine follows, and samples in closed form: both take about as long.
_FOLLOWED, _IN_CLOSED_FORM = 100, 20_000


@dataclass(frozen=True, eq=False)
class Run(ByValue):
    """A full cycle of a design with its robustness margin, each computed once.

    Attributes:
        cycle, margin: what the design does, and how far it is from another sequence.
        landings: whether each snap lands where it does for other mobilities; None if unchecked.
    """

    cycle: Cycle
    margin: Margin
    landings: "tuple[Landing, ...] | None" = field(repr=False)

    @classmethod
    def of(cls, chain: Chain, mobility_ratio: float | None = None) -> "Run":
        """The run of a chain.

        Args:
            chain: the design.
            mobility_ratio: landings are checked up to it; up to 10, of up to 8 cells, by default.

        Raises:
            ValueError: a ratio that is not allowed.
            StaticsError: the engine could not go on; its text says what to do.
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
        """How many of a few samples reproduce the sequence; None of more than 12 cells."""
        if len(self.chain) > LONGEST_FOLLOWED:
            return None
        target = str(self.cycle.sequence)
        few = yields(self.chain, samples=_FOLLOWED, target=target)
        return few if few.by_engine else yields(self.chain, samples=_IN_CLOSED_FORM, target=target)
