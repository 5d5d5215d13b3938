"""Claims about unit cells (Figs. 1D and 1E), the paper's designs, and misprints."""

import math
from functools import cache, partial

import numpy as np

from stepwell.base import Floats, bisected, to_unit
from stepwell.concave import certify, simple
from stepwell.files import preset
from stepwell.mechanism import Cell, Chain
from stepwell.paper.claims import Claim, Finding, claim, finding_of
from stepwell.sequences import Cycle, Pathway

# Names of the presets, by their anchor q [mm].
CELLS = {
    "(10, 0)": "paper-cell-10-0",
    "(0, 0)": "paper-cell-0-0",
    "(20, 0)": "paper-cell-20-0",
    "(10, -15)": "paper-cell-10-m15",
    "(20, 15)": "paper-cell-20-15",
    "(0, -15)": "paper-cell-0-m15",
}
PAIRS = {
    Pathway.CLOCKWISE: "paper-forward",
    Pathway.COUNTERCLOCKWISE: "paper-counterclockwise",
    Pathway.VIA_01: "paper-via-01",
    Pathway.VIA_10: "paper-via-10",
}


@cache
def six_cells() -> dict[str, Cell]:
    """The unit cells of Figs. 1D and 1E, by their anchor q [mm]."""
    return {q: preset(name).cells[0] for q, name in CELLS.items()}


@cache
def pair_cycle(pathway: Pathway) -> Cycle:
    """The cycle of the pair of cells that shows a pathway in Fig. 2."""
    return preset(PAIRS[pathway]).cycle()


def outer_anchor(pathway: Pathway) -> tuple[float, float]:
    """Anchor q [m] of the outer cell of that pair; the inner one has (10, 0) mm in all."""
    return pair_cycle(pathway).chain.levers[1].bands[0].q


@cache
def monostable_pair() -> Cycle:
    """The cycle of the inner cell of all pairs with the monostable unit cell as outer cell."""
    inner = pair_cycle(Pathway.CLOCKWISE).chain.cells[0]
    return Chain((inner, six_cells()["(0, -15)"]), title="Outer cell monostable").cycle()


# F0/(k r) and F1/(k r) from the paper's equations and parameters, by q [mm].
FORCES = {
    "(10, 0)": (0.967, -0.967),
    "(20, 0)": (1.607, -1.607),
    "(0, 0)": (0.391, -0.391),
    "(10, -15)": (0.263, -1.661),
    "(20, 15)": (2.393, -0.836),
    "(0, -15)": (-0.243, -0.910),
}
FORCE_TOLERANCE = 0.001
MONOSTABLE = ("(0, -15)",)
PEAK_TOLERANCE = 0.001  # degrees
_CURVE_TOLERANCE = 1e-6  # of k r² and k r


def _scale(cell: Cell) -> float:
    return cell.bands[0].stiffness * cell.lever


def _ends(q: str) -> Finding:
    cell = six_cells()[q]
    ours = (cell.force_0 / _scale(cell), cell.force_1 / _scale(cell))
    off = max(abs(a - b) for a, b in zip(ours, FORCES[q], strict=True))
    return finding_of(off <= FORCE_TOLERANCE, _two(ours))


def _two(forces: tuple[float, float]) -> str:
    return ", ".join(f"{force:.3f}" for force in forces)


@claim("Eqs. 1 and 2, Figs. 1D and 1E", "the equations, for six designs", "1e-6 k r² and k r")
def curves() -> Finding:
    """E against θ follows from band length and stiffness, and F is its slope along travel."""
    off = max(_distance_from_equations(cell) for cell in six_cells().values())
    agrees = off <= _CURVE_TOLERANCE
    same, other = f"the same for all {len(six_cells())}", f"off by {off:.1g} k r² or k r"
    return finding_of(agrees, same if agrees else other)


def _distance_from_equations(cell: Cell) -> float:
    """Largest deviation of E and F from Eqs. 1 and 2, in units of k r² and k r."""
    band, r = cell.bands[0], cell.lever
    k, rest, (dx, dy) = band.stiffness, band.rest_length, band.d

    def energy(travel: Floats) -> Floats:
        theta = np.arcsin(travel / r - math.sin(cell.limit))
        length = np.hypot(r * np.cos(theta) + dx, r * np.sin(theta) + dy)
        return k / 2 * (length - rest) ** 2

    step = 1e-5 * cell.full_travel
    travel = np.linspace(step, cell.full_travel - step, 2001)
    theta = cell.angle(travel)
    slope = (energy(travel + step) - energy(travel - step)) / (2 * step)
    of_energy = np.max(np.abs(cell.energy(theta) - energy(travel))) / (k * r**2)
    of_force = np.max(np.abs(cell.force(theta) - slope)) / (k * r)
    return float(max(of_energy, of_force))


@claim("Fig. 1D", "6 of 6", "proof")
def force_falls() -> Finding:
    """F falls all the way from state 0 to state 1 in all six designs."""
    proved = [q for q, cell in six_cells().items() if falls(cell)]
    missing = [q for q in six_cells() if q not in proved]
    return finding_of(
        not missing,
        f"proved for {len(proved)} of {len(six_cells())}",
        note="Proved by bounds over whole stretches of θ, not sampled. It holds for these six, "
        "and not for every anchor: short or folded-back bands rise.",
        otherwise=f"No proof for q = {', '.join(missing)} mm.",
    )


def falls(cell: Cell) -> bool:
    """Whether the force of a cell is proved to fall."""
    plain = simple(cell)
    return plain is not None and bool(certify(plain, 0.0))


@claim("Eq. 3, Fig. 1E", "atan2(d_y, d_x)", f"{PEAK_TOLERANCE:g}°")
def theta_max() -> Finding:
    """The energy is highest at θmax = atan2(d_y, d_x), or at the stop nearer to it."""
    off = max(abs(_highest(cell) - _eq_3(cell)) for cell in six_cells().values())
    degrees = math.degrees(off)
    ok = degrees <= PEAK_TOLERANCE
    return finding_of(ok, f"{'below 0.001' if ok else f'{degrees:.2g}'}° off in all six")


def _eq_3(cell: Cell) -> float:
    """θmax by Eq. 3, limited to the stops."""
    dx, dy = cell.bands[0].d
    return min(max(math.atan2(dy, dx), -cell.limit), cell.limit)


def _highest(cell: Cell) -> float:
    """θ of the largest energy: the angle at which the force changes sign."""
    if cell.force_0 <= 0:
        return -cell.limit
    if cell.force_1 >= 0:
        return cell.limit
    return bisected(lambda at: bool(cell.force(at) > 0), -cell.limit, cell.limit, 60)[0]


@claim("Eq. 3, Fig. 1E", "all but (0, -15) mm", "exact")
def bistable() -> Finding:
    """A cell is bistable where θmax lies between its stops: five of the six designs."""
    cells = six_cells()
    by_force = [q for q, cell in cells.items() if not (cell.force_0 > 0 > cell.force_1)]
    by_rule = [q for q, c in cells.items() if not abs(math.atan2(*c.bands[0].d[::-1])) < c.limit]
    return finding_of(
        tuple(by_force) == tuple(by_rule) == MONOSTABLE,
        f"all but {', '.join(by_force)} mm",
        note="By the forces that hold each state, and by Eq. 3.",
        otherwise=f"The forces at the stops say {by_force}, Eq. 3 says {by_rule}.",
    )


def force_id(q: str) -> str:
    """Id of the claim about the critical forces of the unit cell with an anchor q [mm]."""
    return f"force-{q.strip('()').replace(', ', '-').replace('--', '-m')}"


CELL_CLAIMS = (
    *(
        Claim(
            force_id(q),
            f"F0/(kr) and F1/(kr) of the unit cell with q = {q} mm.",
            "Fig. 1D, from its equations and parameters",
            _two(forces),
            f"{FORCE_TOLERANCE:g}",
            partial(_ends, q),
        )
        for q, forces in FORCES.items()
    ),
    curves,
    force_falls,
    theta_max,
    bistable,
)


@claim("Eq. 5", "-2 sin θc", "exact")
def eq_5_sign() -> Finding:
    """The stroke of two cells is r (sin θ of one + sin θ of the other) and a constant."""
    cells = pair_cycle(Pathway.CLOCKWISE).chain.levers
    r, limit = cells[0].lever, cells[0].limit
    moved = r * 2 * math.sin(-limit)
    printed, ours = (moved + sign * 2 * r * math.sin(limit) for sign in (-1, 1))
    return finding_of(
        abs(printed) < 1e-12 * r,
        f"+2 sin θc: u = {to_unit(abs(ours), 'mm'):.0f} mm there",
        otherwise=f"The paper starts at θ = -θc with u = 0. There the printed sign gives "
        f"u = {to_unit(printed, 'mm'):.0f} mm, a plus gives {to_unit(abs(ours), 'mm'):.0f} mm.",
    )


@claim("anchors of the unit cells", "cm", "0.001 in F0/(kr)")
def anchor_unit() -> Finding:
    """The unit printed with p and with some q."""
    cell = six_cells()["(10, 0)"]
    band, scale = cell.bands[0], cell.bands[0].stiffness * cell.lever
    (px, py), (qx, qy) = band.p, band.q
    in_cm = cell.with_anchors(p=(10 * px, 10 * py), q=(10 * qx, 10 * qy))
    as_mm, as_cm = cell.force_0 / scale, in_cm.force_0 / scale
    return finding_of(
        abs(as_cm - FORCES["(10, 0)"][0]) <= FORCE_TOLERANCE,
        "mm",
        otherwise=f"Read as mm the numbers give F0/(kr) = {as_mm:.3f} for q = (10, 0), as in "
        f"Fig. 1D; read as cm they give {as_cm:.1f}.",
    )


MISPRINT_CLAIMS = (eq_5_sign, anchor_unit)
