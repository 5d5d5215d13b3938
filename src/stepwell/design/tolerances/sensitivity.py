"""Sobol' indices of the smallest gap, with the parameters in groups."""

import inspect
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from stepwell.base import ByValue, Floats, Ints
from stepwell.design.switches import switching_forces
from stepwell.design.tolerances.draws import Draws
from stepwell.design.tolerances.tally import gaps_between

# 2^12 points in each of the two base samples, and 2^10 if each has to be built.
_POWER, _POWER_BUILT = 12, 10
_SHOWN = 6
_CONSTANT = 1e-12  # of its size: a gap that varies less does not vary


@dataclass(frozen=True, eq=False)
class Sensitivities(ByValue):
    """Fractions of the variance of the smallest gap for each part.

    A part is "<cell>.d" (all anchors of its bands), "<cell>.stiffness", "<cell>.rest_length",
    "<cell>.lever" or "<cell>.friction", of an element "<cell>.force_scale", "<cell>.travel_scale"
    or "<cell>.friction", with <cell> its name, or its number from 1 where names repeat; only parts
    with a tolerance are listed. The gap is that of F0 + f or of F1 - f, f being friction; for
    elements, of all their switching forces. It decides the order of cells whose force falls over
    the whole travel; for others `agreed` is the agreement with the simulation. F0 and F1 of a cell
    with one linear band without a load are those of a taut band, also if it is slack in a sample.

    Attributes:
        parameters: (m,) the parts.
        first_order: (m,) fraction of the variance removed if this part alone is exact.
        total: (m,) fraction that remains if all others are exact; more than `first_order` if the
            part interacts with others.
        deviation: standard deviation of the smallest gap [N]; 0, as all fractions, if constant.
        points: points in each of the two base samples; the error of a fraction is about 0.01 with
            4096, and 0.03 with 1024.
        agreed: fraction of the simulated samples whose gap is positive exactly if they reach the
            target; None in closed form.
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
            lines.append(
                f"the gap agrees with the simulation in {100 * self.agreed:.1f} % of the samples"
            )
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

    `gap` [N] is a function of (m, columns) draws; fewer points are used if each has to be `built`.

    Source: Sobol' 2001; estimators of Saltelli et al. 2010, Table 2 (b) and (f), as in
    scipy.stats.sobol_indices. There one number is exchanged at a time; here all numbers of a part,
    since the position of an anchor in its disc takes two.
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
