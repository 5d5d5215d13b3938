"""Which tolerance makes the smallest gap vary: Sobol' indices, with parts in groups."""

import inspect
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from stepwell.base import ByValue, Floats, Ints
from stepwell.design.switches import switching_forces
from stepwell.design.tolerances.draws import Draws
from stepwell.design.tolerances.tally import gaps_between

# 2^12 points in each of the two base samples, and 2^10 where each has to be built.
_POWER, _POWER_BUILT = 12, 10
_SHOWN = 6
_CONSTANT = 1e-12  # of its size: a gap that varies less does not vary


@dataclass(frozen=True, eq=False)
class Sensitivities(ByValue):
    """Shares of the variance of the smallest gap, part by part.

    A part is "<cell>.d" (all anchors of its bands), "<cell>.stiffness", "<cell>.rest_length",
    "<cell>.lever" or "<cell>.friction", of an element "<cell>.force_scale", "<cell>.travel_scale"
    or "<cell>.friction", with <cell> its name, or its number from 1 where names repeat; only parts
    with a tolerance are listed. The gap is that of F0 + f or of F1 - f, f being friction; of
    elements, of all their switching forces. It tells the order of cells whose force falls all the
    way; of others it need not, and `agreed` says how well it did. F0 and F1 of a cell of one linear
    band without a load are those of a taut band also where a mechanism has it slack.

    Attributes:
        parameters: (m,) the parts.
        first_order: (m,) share of the variance that goes when this part alone is made exact.
        total: (m,) share that stays when all others are made exact; more than `first_order`
            where the part acts together with others.
        deviation: standard deviation of the smallest gap [N]; 0, as all shares, if it is constant.
        points: mechanisms in each of the two base samples; with 4096 a share is good to about
            0.01, with 1024 to about 0.03.
        agreed: of how many mechanisms followed by the engine the gap is above zero exactly where
            they do what is wanted; None where the closed form has judged them.
    """

    parameters: tuple[str, ...]
    first_order: Floats
    total: Floats
    deviation: float
    points: int
    agreed: float | None = None

    def __str__(self):
        if self.deviation == 0.0:
            return "the smallest gap does not vary"
        order = np.argsort(-self.total, kind="stable")
        lines = [
            f"{self.parameters[i]}: {self.first_order[i]:.2f} (total {self.total[i]:.2f})"
            for i in order[:_SHOWN]
        ]
        if len(order) > _SHOWN:
            lines.append(f"and {len(order) - _SHOWN} more, less sensitive")
        if self.agreed is not None:
            lines.append(f"the gap tells what the engine finds in {100 * self.agreed:.1f} %")
        return "\n".join(lines)

    def __repr__(self):
        if self.deviation == 0.0:
            return "Sensitivities(the smallest gap does not vary)"
        most = self.parameters[int(np.argmax(self.total))]
        return f"Sensitivities({len(self.parameters)} parts, first {most}: {self.total.max():.2f})"


def gaps_of_built(draws: Draws, orders: Ints, rows: Floats) -> Floats:
    """(m,) smallest gap [N] between neighbours of two orders (2, T) of (m, columns) draws."""
    forces = np.array([switching_forces(draws.built(row)) for row in rows])
    return np.min(gaps_between(forces, orders), axis=(1, 2), initial=np.inf)


def sensitivities(
    draws: Draws, gap: Callable[[Floats], Floats], *, built: bool = False
) -> Sensitivities:
    """The indices of the smallest gap, from a base sample for each part and two for all.

    `gap` [N] is of (m, columns) draws; where each has to be `built`, fewer have to do.

    Source: Sobol' 2001; estimators of Saltelli et al. 2010, Table 2 (b) and (f), as in
    scipy.stats.sobol_indices. There one number is exchanged at a time; here all that belong to a
    part, since an anchor's place in its disc takes two and says nothing by one of them.
    """
    groups = {name: part.columns for name, part in draws.parts.items()}
    if not groups or len(switching_forces(draws.chain)) < 2:
        return Sensitivities((), np.empty(0), np.empty(0), 0.0, 0)
    active = np.concatenate(list(groups.values()))
    from scipy.stats import qmc, sobol_indices

    # SciPy 1.15 renamed the argument.
    name = "rng" if "rng" in inspect.signature(qmc.Sobol).parameters else "seed"
    seed: dict[str, Any] = {name: np.random.default_rng(draws.seed)}
    points = qmc.Sobol(2 * len(active), **seed).random_base2(_POWER_BUILT if built else _POWER)
    base = [np.full((len(points), draws.columns), 0.5) for _ in range(2)]
    base[0][:, active], base[1][:, active] = np.hsplit(points, 2)
    first, second = (gap(draws.shaped(sample.copy())) for sample in base)
    spread = float(np.std([first, second]))
    names = tuple(groups)
    if spread <= _CONSTANT * float(np.max(np.abs(first))):
        return Sensitivities(names, np.zeros(len(names)), np.zeros(len(names)), 0.0, len(points))
    exchanged = []
    for columns in groups.values():
        mixed = base[0].copy()
        mixed[:, columns] = base[1][:, columns]
        exchanged.append(gap(draws.shaped(mixed))[None])
    indices = sobol_indices(
        func={"f_A": first[None], "f_B": second[None], "f_AB": np.array(exchanged)}, n=len(points)
    )
    return Sensitivities(names, indices.first_order, indices.total_order, spread, len(points))
