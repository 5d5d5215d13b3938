"""Random chains with masses, their safe rates, and the least rates that change their orders."""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

import stepwell as sw
from chains import concave_chain
from stepwell.statics import SafeRate

# Rates that are tried above the safe one, as its multiples.
STEPS = 1.5 ** np.arange(1, 11)


class Rated(NamedTuple):
    """A random chain with masses, half of them with dampers."""

    path: sw.Path
    safe: SafeRate

    def keeps(self, share: float) -> bool | None:
        """Whether inertial motion at a share of the safe rate keeps the order; None: not known."""
        assert self.safe.rate is not None
        given = self.safe.masses, self.safe.damping
        try:
            return self.path.at_rate(share * self.safe.rate, *given).keeps_order
        except sw.StepwellError:
            return None

    def critical(self) -> float:
        """The first rate tried that changes the order, over the safe one; inf above 58 times."""
        return next((float(one) for one in STEPS if self.keeps(float(one)) is False), math.inf)


def rated(rng: np.random.Generator, cells: tuple[int, ...]) -> Iterator[Rated]:
    """Chains of 2 to 50 g a block, without dampers and with 0.01 to 3 N s/m, in turn."""
    dry = True
    while True:
        n, dry = int(rng.choice(cells)), not dry
        chain = concave_chain(rng, n)
        masses = np.exp(rng.uniform(math.log(0.002), math.log(0.050), n)).tolist()
        damping = np.exp(rng.uniform(math.log(0.01), math.log(3.0), n)) * (not dry)
        path = chain.cycle().path
        if not path.degenerate:
            yield Rated(path, path.safe_rate(masses, damping.tolist()))


def safe_ones(rng: np.random.Generator, cells: tuple[int, ...], count: int) -> list[Rated]:
    """The first chains for which a rate is safe."""
    every = (one for one in rated(rng, cells) if one.safe.rate is not None)
    return [next(every) for _ in range(count)]


if __name__ == "__main__":
    import sys

    count, measured = (map(int, sys.argv[1:3])) if len(sys.argv) > 2 else (100, 30)
    chains = safe_ones(np.random.default_rng(39), (2, 3, 4), count)
    print(f"{count} chains, {sum(one.safe.proved for one in chains)} of them proved by energy")
    below = [one.keeps(share) for one in chains for share in (1.0, 0.5)]
    print(f"{below.count(False)} of {len(below)} motions up to the safe rate change the order")
    print(f"{below.count(None)} of them could not be followed to their end", flush=True)
    times = np.sort([one.critical() for one in chains[:measured]])
    print(f"critical rate / safe rate of {measured}: least {times[0]:.3g}, ", end="")
    print(f"median {np.median(times):.3g}; above {STEPS[-1]:.3g} times {np.sum(np.isinf(times))}")
