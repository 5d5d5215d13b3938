"""A slow, independent follower of serial chains: dense drive steps, each relaxed by the flow.

It knows nothing of branches, folds or inverse curves. It holds a state, moves the drive a
little, and lets every cell slide at a speed proportional to the force that is out of
balance until nothing slides any more. It shares no code with the package it judges, and
must never import it.

The flow (mobilities m_i beside that of the fastest cell, so forces and speeds share one unit)

    ds_i/dt = m_i ((λ - F_i - f_i)^+ [if s_i < S_i]  -  (F_i - f_i - λ)^+ [if s_i > 0])

with F_i the cell's force, f_i its Coulomb friction and λ the actuator force:

    'stroke'   Σ s_i = u: λ is the multiplier that makes Σ ds_i/dt = du/dt
    K          λ = K (U - Σ s_i) at all times, U the far end of the actuator spring
    'force'    λ is the drive itself

A curve that folds back is given sheet by sheet. A cell that slides to the end of a sheet is at
once on the sheet that this end leads to, at the same travel.

What it resolves: a drive step (a 128th of one for the place of a snap, a 1000th for which
cell leaves a vertex first under stroke control). Exact ties, identical cells and several
slack cells at once are decided by rounding, not by mechanics.
"""

from __future__ import annotations

import gc
import getpass
import math
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

import numpy as np
from numba import njit

STROKE, COMPLIANT, FORCE = 0, 1, 2

BINS = 128  # per travel, for the local stiffness that limits the time step
SAMPLES_PER_BIN = 16
QUIET = 1e-3  # of the force scale: driven by less, cells only creep to where they will rest
RAMP_STEPS = 16  # time steps over which one drive increment is applied
REFINE = 7  # a drive step that jumps is halved up to this many times
GENTLE = 10  # and the step that leaves a vertex is begun with this many halvings
MAX_TIME_STEPS = 5_000_000  # per drive step; beyond it the flow is declared not to settle
MAX_SNAPS = 1000
MAX_VERTICES = 10_000


# What is known of a cell on one sheet of its curve.
LEVER, HALF, LOW, HIGH, SPAN, FRICTION, MOBILITY, DATUM = range(8)
FIRST_BAND, END_BAND, FIRST_KNOT, END_KNOT, BELOW, ABOVE, ROW, SHEET = range(8, 16)


@dataclass(frozen=True)
class OracleSheet:
    """One sheet of a curve that folds back: knots (s [m], F [N]), linear between them.

    energy: at its low end [J]. below, above: the sheets that its ends lead to, None for a stop.
    """

    load: Sequence[tuple[float, float]]
    energy: float = 0.0
    below: int | None = None
    above: int | None = None


@dataclass(frozen=True)
class OracleCell:
    """One cell: lever [m], limit [rad], bands, load and friction [N].

    bands: (dx, dy [m], k [N/m], l0 [m], a2 [1/m], a3 [1/m^2], two_sided) each; its tension is
        k (e + a2 e^2 + a3 e^3) with e = l - l0, and zero for e < 0 unless two_sided.
    load: knots (s [m], F [N]), s strictly increasing; linear between them, constant outside.
        One knot is a constant load. Positive resists travel.
    mobility: how fast it slides for a force, beside the other cells, > 0.
    sheets: a curve that folds back, within 0 and the full travel; load is not used then.
        The cell starts on the first one.
    """

    lever: float
    limit: float
    bands: Sequence[tuple[float, float, float, float, float, float, bool]] = ()
    load: Sequence[tuple[float, float]] = ()
    friction: float = 0.0
    mobility: float = 1.0
    sheets: Sequence[OracleSheet] = ()

    @property
    def span(self) -> float:
        """Full travel S = 2 r sin θc [m]."""
        return 2.0 * self.lever * math.sin(self.limit)

    def force(self, travel):
        """Force along travel [N], friction excluded, of an array of travels [m]."""
        return self._sample(_cell_force, travel)

    def energy(self, travel):
        """Energy [J] of bands (zero when slack) and load (zero at s = 0)."""
        return self._sample(_cell_energy, travel)

    def _sample(self, kernel, travel):
        packed = _pack([self])
        s = np.asarray(travel, dtype=float)
        out = np.array([kernel(0, float(x), *packed) for x in s.ravel()])
        return out.reshape(s.shape)[()]


@dataclass(frozen=True)
class OracleSnap:
    """A jump at (almost) fixed drive: travels [m], forces [N] before and after, release [J]."""

    row: int  # the first row after it
    drive: float
    force_before: float
    force_after: float
    released: float  # by the balance of energy, work of the drive and heat of friction
    viscous: float  # the same a second way: what the flow dissipated on its path, less exact
    before: np.ndarray
    after: np.ndarray


@dataclass(frozen=True)
class OracleRun:
    """What the chain did, one row per drive step (row 0 is the start, at rest).

    drive: (n,) prescribed u, U [m] or λ [N]. stroke: (n,) Σ s [m]. travel: (n, N) [m]. sheet:
    (n, N), 0 unless curves fold back.
    force: (n,) λ [N]. energy: (n,) of the cells [J]. total: (n,) with the actuator spring
    or the dead load [J]. snaps: in order. sequence: "00>10>11>01>00", every state passed with
    all cells at stops, repeats removed (also those passed between two rows).
    """

    drive: np.ndarray
    stroke: np.ndarray
    travel: np.ndarray
    sheet: np.ndarray
    force: np.ndarray
    energy: np.ndarray
    total: np.ndarray
    snaps: list[OracleSnap] = field(default_factory=list)
    sequence: str = ""


def follow(
    cells: Sequence[OracleCell],
    turning_points: Sequence[float],
    *,
    start: Sequence[float] | None = None,
    control: str | float = "stroke",
    steps: int = 2000,
    snap_travel: float | None = None,
) -> OracleRun:
    """Drive the chain through the turning points, `steps` drive steps per leg.

    start: travels [m]; by default all empty, or all full when the stroke starts at its end.
        It is relaxed at the first turning point before row 0.
    control: 'stroke', 'force', or the actuator's stiffness K [N/m].
    snap_travel: a jump is a motion [m] of one cell above this that no refinement of the
        drive step makes smaller; by default a hundredth of the longest span.
    """
    packed = _pack(cells)
    count = len(cells)
    spans = packed[0][:count, SPAN]
    points = np.asarray(turning_points, dtype=float)
    if points.ndim != 1 or len(points) < 2:
        raise ValueError(f"turning_points must be two or more numbers, got {turning_points!r}")
    if control == "stroke":
        mode, stiffness = STROKE, 0.0
        if points.min() < -1e-12 or points.max() > spans.sum() + 1e-12:
            raise ValueError(f"stroke must stay within 0..{spans.sum()!r}, got {points!r}")
        points = np.clip(points, 0.0, spans.sum())
    elif control == "force":
        mode, stiffness = FORCE, 0.0
    else:
        mode, stiffness = COMPLIANT, float(control)
        if not 0.0 < stiffness < math.inf:
            raise ValueError(f"the actuator stiffness must be finite and > 0, got {control!r}")

    if start is None:
        full = mode == STROKE and abs(points[0] - spans.sum()) <= 1e-12
        s = spans.copy() if full else np.zeros_like(spans)
    else:
        s = np.array(start, dtype=float)
    s[np.abs(s - spans) < 1e-12] = spans[np.abs(s - spans) < 1e-12]
    s[np.abs(s) < 1e-12] = 0.0
    if s.shape != spans.shape or (s < 0).any() or (s > spans).any():
        raise ValueError(f"start must be {len(spans)} travels within the stops, got {start!r}")
    if mode == STROKE and abs(s.sum() - points[0]) > 1e-9:
        raise ValueError(f"start sums to {s.sum()!r} but the stroke starts at {points[0]!r}")

    threshold = float(spans.max()) / 100 if snap_travel is None else float(snap_travel)
    with _compiled_once():
        rows, jumps, codes, failed = _follow(
            mode, stiffness, points, s, int(steps), threshold, *packed
        )
    if failed:
        raise RuntimeError("the flow did not settle within a drive step")
    if len(jumps) == MAX_SNAPS or len(codes) == MAX_VERTICES:
        raise RuntimeError("more snaps or vertices than the oracle keeps")

    n = count
    snaps = [
        OracleSnap(
            row=int(j[0]),
            drive=float(j[1]),
            force_before=float(j[2]),
            force_after=float(j[3]),
            released=float(j[4]),
            viscous=float(j[5]),
            before=j[6 : 6 + n].copy(),
            after=j[6 + n :].copy(),
        )
        for j in jumps
    ]
    travel = rows[:, 4 : 4 + n].copy()
    return OracleRun(
        drive=rows[:, 0].copy(),
        stroke=travel.sum(axis=1),
        travel=travel,
        sheet=rows[:, 4 + n :].astype(int),
        force=rows[:, 1].copy(),
        energy=rows[:, 2].copy(),
        total=rows[:, 3].copy(),
        snaps=snaps,
        sequence=">".join(
            "".join("1" if code >> i & 1 else "0" for i in range(n)) for code in codes
        ),
    )


@contextmanager
def _compiled_once() -> Iterator[None]:
    """Of several processes one compiles, for many seconds; the others take what it has kept."""
    if _follow.signatures:
        yield
        return
    from filelock import FileLock

    with FileLock(Path(tempfile.gettempdir()) / f"oracle-{getpass.getuser()}.lock"):
        # Looking for what can be freed is a tenth of the work.
        gc.disable()
        try:
            yield
        finally:
            gc.enable()


def _pack(cells: Sequence[OracleCell]):
    """Plain arrays for the kernels: a row of every cell and sheet, bands and knots of loads.

    The first rows are the cells on their first sheets, their others follow.
    """
    bands: list[tuple[float, ...]] = []
    loads: list[tuple[float, float]] = []
    rows: list[list[float]] = []
    others: list[list[float]] = []
    fastest = max(cell.mobility for cell in cells)
    for i, cell in enumerate(cells):
        half = cell.lever * math.sin(cell.limit)
        first_band = len(bands)
        bands += [tuple(float(x) for x in b) for b in cell.bands]
        if cell.friction < 0:
            raise ValueError(f"friction must be >= 0, got {cell.friction!r}")
        if not 0 < cell.mobility < math.inf:
            raise ValueError(f"mobility must be finite and > 0, got {cell.mobility!r}")
        own = [i, *(len(cells) + len(others) + k for k in range(len(cell.sheets) - 1))]
        for number, sheet in enumerate(cell.sheets or (OracleSheet(cell.load),)):
            knots = [(float(a), float(b)) for a, b in sheet.load]
            if any(b <= a for (a, _), (b, _) in pairwise(knots)):
                raise ValueError(f"load knots must increase in s, got {[a for a, _ in knots]!r}")
            low, high, datum = 0.0, 2.0 * half, 0.0
            if cell.sheets:
                low, high = max(low, knots[0][0]), min(high, knots[-1][0])
                datum = sheet.energy - knots[0][1] * low
            leads = [-1 if k is None else own[k] for k in (sheet.below, sheet.above)]
            row = [cell.lever, half, low, high, 2.0 * half, cell.friction, cell.mobility / fastest]
            row += [datum, first_band, len(bands), len(loads), len(loads) + len(knots), *leads]
            loads += knots
            (others if number else rows).append([*row, own[number], number])
    band_array = np.array(bands, dtype=float).reshape(-1, 7)
    load_array = np.array(loads, dtype=float).reshape(-1, 2)
    return np.array(rows + others), band_array, load_array


@njit(cache=True)
def _copy(source, target):
    """The same rows: an assignment of slices compiles the words of its errors, for seconds."""
    for i in range(len(source)):
        target[i] = source[i]


@njit(cache=True)
def _copy_rows(source, target):
    for i in range(len(source)):
        for k in range(len(source[i])):
            target[i, k] = source[i, k]


# --- one cell -------------------------------------------------------------------------------
# In Cartesian coordinates of the outer block, no angles: along travel y = s - r sin θc, across
# it x = sqrt(r² - y²). Then dx/ds = -y/x and dy/ds = 1.


@njit(cache=True)
def _cell_force(i, s, geometry, bands, loads):
    r = geometry[i, LEVER]
    y = s - geometry[i, HALF]
    x = math.sqrt(r * r - y * y)
    total = 0.0
    for b in range(int(geometry[i, FIRST_BAND]), int(geometry[i, END_BAND])):
        across = x + bands[b, 0]
        along = y + bands[b, 1]
        length = math.sqrt(across * across + along * along)
        e = length - bands[b, 3]
        if e < 0.0 and bands[b, 6] == 0.0:
            continue
        if length == 0.0:
            continue
        tension = bands[b, 2] * e * (1.0 + e * (bands[b, 4] + e * bands[b, 5]))
        total += tension * (along - across * y / x) / length
    first, last = int(geometry[i, FIRST_KNOT]), int(geometry[i, END_KNOT]) - 1
    if last >= first:
        if s <= loads[first, 0]:
            total += loads[first, 1]
        elif s >= loads[last, 0]:
            total += loads[last, 1]
        else:
            k, end = first, last
            while end - k > 1:
                middle = (k + end) // 2
                if s > loads[middle, 0]:
                    k = middle
                else:
                    end = middle
            part = (s - loads[k, 0]) / (loads[k + 1, 0] - loads[k, 0])
            total += loads[k, 1] + part * (loads[k + 1, 1] - loads[k, 1])
    return total


@njit(cache=True)
def _cell_energy(i, s, geometry, bands, loads):
    r = geometry[i, LEVER]
    y = s - geometry[i, HALF]
    x = math.sqrt(r * r - y * y)
    total = geometry[i, DATUM]
    for b in range(int(geometry[i, FIRST_BAND]), int(geometry[i, END_BAND])):
        e = math.sqrt((x + bands[b, 0]) ** 2 + (y + bands[b, 1]) ** 2) - bands[b, 3]
        if e < 0.0 and bands[b, 6] == 0.0:
            continue
        total += bands[b, 2] * (e**2 / 2.0 + bands[b, 4] * e**3 / 3.0 + bands[b, 5] * e**4 / 4.0)
    # The load is integrated from 0 to s piece by piece, each piece by its two ends.
    first, last = int(geometry[i, FIRST_KNOT]), int(geometry[i, END_KNOT]) - 1
    if last >= first:
        a = 0.0
        k = first
        while a < s:
            while k <= last and loads[k, 0] <= a:
                k += 1
            b = s
            if k <= last and loads[k, 0] < s:
                b = loads[k, 0]
            if k == first:
                mean = loads[first, 1]
            elif k > last:
                mean = loads[last, 1]
            else:
                slope = (loads[k, 1] - loads[k - 1, 1]) / (loads[k, 0] - loads[k - 1, 0])
                mean = loads[k - 1, 1] + slope * (0.5 * (a + b) - loads[k - 1, 0])
            total += mean * (b - a)
            a = b
    return total


@njit(cache=True)
def _stiffness_table(geometry, bands, loads):
    """Largest |dF/ds| of each row within a bin or its neighbours, and the force scale."""
    n = geometry.shape[0]
    raw = np.zeros((n, BINS))
    scale = 0.0
    for i in range(n):
        h = geometry[i, SPAN] / (BINS * SAMPLES_PER_BIN)
        before = _cell_force(i, 0.0, geometry, bands, loads)
        scale = max(scale, abs(before))
        for b in range(BINS):
            for m in range(SAMPLES_PER_BIN):
                s = min((b * SAMPLES_PER_BIN + m + 1) * h, geometry[i, SPAN])
                now = _cell_force(i, s, geometry, bands, loads)
                raw[i, b] = max(raw[i, b], abs(now - before) / h)
                scale = max(scale, abs(now))
                before = now
    table = raw.copy()
    for i in range(n):
        for b in range(BINS):
            if b > 0:
                table[i, b] = max(table[i, b], raw[i, b - 1])
            if b < BINS - 1:
                table[i, b] = max(table[i, b], raw[i, b + 1])
    return table, scale


# --- the flow -------------------------------------------------------------------------------


@njit(cache=True)
def _speed(i, lam, s, force, mobility, geometry):
    """Speed of one cell under the actuator force λ; a cell at a stop moves only inward."""
    up = force[i] + geometry[i, FRICTION]
    down = force[i] - geometry[i, FRICTION]
    if lam > up and s[i] < geometry[i, HIGH]:
        return mobility[i] * (lam - up)
    if lam < down and s[i] > geometry[i, LOW]:
        return mobility[i] * (lam - down)
    return 0.0


@njit(cache=True)
def _multiplier(w, c, near, s, force, mobility, geometry):
    """The λ that solves Σ_i speed_i(λ) + c λ = w, exactly; nearest to `near` if many do.

    The left side is piecewise linear and never falls. Its kinks are F_i + f_i of the cells
    that can advance and F_i - f_i of those that can give back.
    """
    n = geometry.shape[0]
    lo, g_lo, lo_known = 0.0, 0.0, False  # nearest kink with too little, and its excess
    hi, g_hi, hi_known = 0.0, 0.0, False  # nearest kink with too much
    hit_lo, hit_hi, hits = 0.0, 0.0, False  # kinks that solve it exactly
    ups = 0.0
    downs = 0.0
    for j in range(2 * n):
        i = j // 2
        if j % 2 == 0:
            if s[i] >= geometry[i, HIGH]:
                continue
            kink = force[i] + geometry[i, FRICTION]
            ups += mobility[i]
        else:
            if s[i] <= geometry[i, LOW]:
                continue
            kink = force[i] - geometry[i, FRICTION]
            downs += mobility[i]
        g = c * kink - w
        for m in range(n):
            g += _speed(m, kink, s, force, mobility, geometry)
        if g < 0.0:
            if not lo_known or kink > lo:
                lo, g_lo, lo_known = kink, g, True
        elif g > 0.0:
            if not hi_known or kink < hi:
                hi, g_hi, hi_known = kink, g, True
        elif not hits:
            hit_lo, hit_hi, hits = kink, kink, True
        else:
            hit_lo, hit_hi = min(hit_lo, kink), max(hit_hi, kink)
    if hits:
        # With w = 0 nothing moves between the outer solving kinks. Beyond them either cells
        # move, or none can: all empty (λ may fall freely) or all full (λ may rise freely).
        if near < hit_lo and not (downs == 0.0 and w == 0.0 and c == 0.0):
            return hit_lo, True
        if near > hit_hi and not (ups == 0.0 and w == 0.0 and c == 0.0):
            return hit_hi, True
        return near, True
    if lo_known and hi_known:
        return lo + (hi - lo) * (-g_lo / (g_hi - g_lo)), True
    if lo_known and ups + c > 0.0:
        return lo - g_lo / (ups + c), True
    if hi_known and downs + c > 0.0:
        return hi - g_hi / (downs + c), True
    return near, False


@njit(cache=True)
def _reach(s, v, dt, geometry):
    """When the first cell meets a stop or the end of its sheet, and that cell; dt, -1 if none."""
    who = -1
    for i in range(geometry.shape[0]):
        t = dt
        if v[i] > 0.0:
            t = (geometry[i, HIGH] - s[i]) / v[i]
        elif v[i] < 0.0:
            t = (geometry[i, LOW] - s[i]) / v[i]
        if t < dt:
            dt, who = t, i
    return dt, who


@njit(cache=True)
def _note_vertex(s, codes, geometry):
    """Whether all cells are at stops; if so the state is appended to codes, as bits.

    codes[0] counts the vertices that follow it; repeats are not appended.
    """
    code = 0
    for i in range(geometry.shape[0]):
        near = 1e-6 * geometry[i, SPAN]
        if s[i] >= geometry[i, SPAN] - near:
            code |= 1 << i
        elif s[i] > near:
            return False
    count = codes[0]
    if (count == 0 or codes[count] != code) and count < MAX_VERTICES:
        codes[count + 1] = code
        codes[0] = count + 1
    return True


@njit(cache=True)
def _advance(mode, stiff, a, b, s, lam, table, scale, codes, geometry, sheets, bands, loads):
    """Move the drive from a to b as a slow ramp, then let the chain come to rest.

    Changes s and geometry (the rows of the sheets that the cells are on) in place and appends
    the vertices it passes to codes. Returns λ, the work done by the drive [J], the heat of
    friction [J], the heat of the flow [J] and whether it came to rest.
    """
    n = geometry.shape[0]
    force = np.empty(n)
    v = np.zeros(n)
    mean = np.empty(n)
    trial = np.empty(n)
    kappa = np.empty(n)
    mobility = geometry[:, MOBILITY].copy()
    moving = np.zeros(n, dtype=np.bool_)
    longest = 0.0
    for i in range(n):
        longest = max(longest, geometry[i, SPAN])
    soft = 0.05 * scale / longest  # a cell softer than this is as good as slack
    tol = 1e-7 * scale
    idle = 1e-6 * tol  # rounding keeps a settled cell creeping; that limits no time step
    # Explicit in the cells, so small against their stiffness. The actuator spring is taken
    # implicitly and only to first order, hence the smaller step there, and smaller still
    # while the chain is on its way to a new place.
    courant = 0.1 if mode == COMPLIANT else 0.25
    hardest = scale
    work = 0.0
    rubbed = 0.0
    viscous = 0.0
    drive = a
    rate = 0.0
    ramping = a != b
    settling = False
    for step in range(MAX_TIME_STEPS):
        # Too little left to be told from rounding.
        if ramping and abs(b - drive) <= 1e-12 * abs(b - a) + 1e-15 * max(abs(a), abs(b)):
            drive, ramping = b, False
        _note_vertex(s, codes, geometry)
        total = 0.0
        pushed = 0.0
        holding = 0.0
        # Where the cells are all but at rest no race is left to be run, and mobilities that are
        # all alike beside the stiffness bring every cell there in few steps.
        creeping = not ramping and hardest < QUIET * scale
        for i in range(n):
            force[i] = _cell_force(i, s[i], geometry, bands, loads)
            moving[i] = abs(v[i]) > idle * mobility[i]
            at = min(int(s[i] / geometry[i, SPAN] * BINS), BINS - 1)
            steepest = max(table[int(geometry[i, ROW]), at], soft)
            mobility[i] = soft / steepest if creeping else geometry[i, MOBILITY]
            kappa[i] = mobility[i] * steepest
            total += s[i]
            if moving[i]:
                pushed += mobility[i]
                holding += mobility[i] * (force[i] + math.copysign(geometry[i, FRICTION], v[i]))
        if mode == STROKE and settling and pushed > 0.0:
            # If nothing is to move now, a range of λ will do: the one that moved the cells
            # last, without what the ramp's own speed added to it.
            lam = holding / pushed
        settling = ramping

        # Only cells that move limit the time step, and which move is known after it is
        # chosen: repeat until no other cell joins.
        if mode == COMPLIANT:
            courant = 0.02 if hardest > 5e-3 * scale else 0.1
        last = False
        beyond = False
        while True:
            local = 0.0
            for i in range(n):
                if moving[i]:
                    local = max(local, kappa[i])
            if local == 0.0:
                local = soft
            dt = courant / local
            usual = dt
            if ramping and step == 0:
                rate = (b - a) / (RAMP_STEPS * dt)
            last = ramping and abs(b - drive) <= abs(rate) * dt
            if last:
                dt = (b - drive) / rate
            target = drive
            if ramping:
                target = b if last else drive + rate * dt
            if mode == STROKE:
                # Besides du/dt, the rounding lost so far is paid back at an ordinary pace.
                w = rate + (drive - total) / usual if ramping else 0.0
                lam, ok = _multiplier(w, 0.0, lam, s, force, mobility, geometry)
                beyond = not ok
            elif mode == COMPLIANT:
                c = 1.0 / (stiff * dt)
                w = (target - total) / dt
                lam, ok = _multiplier(w, c, lam, s, force, mobility, geometry)
            else:
                lam = target
            joined = False
            hardest = 0.0
            for i in range(n):
                v[i] = _speed(i, lam, s, force, mobility, geometry)
                driven = abs(v[i]) / mobility[i]
                hardest = max(hardest, driven)
                if driven > 1e3 * idle and not moving[i]:
                    joined = True
                    moving[i] = True
            if beyond or not joined:
                break
        if beyond:
            # Asked to go beyond the ends of the chain: only rounding may ask for that.
            if abs(b - drive) > 1e-9:
                return lam, work, rubbed, viscous, False
            drive, ramping = b, False
            for i in range(n):
                v[i] = 0.0
            continue
        behind = mode == COMPLIANT and abs(stiff * (b - total) - lam) > tol
        if not ramping and hardest < tol and not behind:
            break

        # No cell leaves the bins its stiffness was taken from.
        short = False
        for i in range(n):
            if abs(v[i]) * dt > 0.5 * geometry[i, SPAN] / BINS:
                dt = 0.5 * geometry[i, SPAN] / BINS / abs(v[i])
                short = True
        dt_stop, who = _reach(s, v, dt, geometry)
        short = short or who >= 0
        dt = dt_stop
        if who < 0 and mode != COMPLIANT:
            # Second order where the path is smooth (Heun); plain where a cell meets a stop.
            for i in range(n):
                trial[i] = s[i] + dt * v[i]
            for i in range(n):
                force[i] = _cell_force(i, trial[i], geometry, bands, loads)
            if mode == STROKE:
                w = 0.0
                for i in range(n):
                    w += v[i]
                lam2, ok = _multiplier(w, 0.0, lam, trial, force, mobility, geometry)
            else:
                lam2, ok = target, True
            if ok:
                joined = False
                for i in range(n):
                    second = _speed(i, lam2, trial, force, mobility, geometry)
                    enough = 1e3 * idle * mobility[i]
                    joined = joined or (not moving[i] and abs(second) > enough)
                    mean[i] = 0.5 * (v[i] + second)
                # Unless a cell only now sets off, or would be pressed into the stop it leaves.
                dt_stop, who = _reach(s, mean, dt, geometry)
                if not joined and dt_stop > 0.5 * dt:
                    short = short or who >= 0
                    dt = dt_stop
                    _copy(mean, v)
                else:
                    who = -1

        for i in range(n):
            ds = dt * v[i]
            end = HIGH if v[i] > 0.0 else LOW
            if i == who:
                ds = geometry[i, end] - s[i]
                s[i] = geometry[i, end]
            else:
                s[i] = min(max(s[i] + ds, geometry[i, LOW]), geometry[i, HIGH])
            viscous += v[i] * ds / mobility[i]
            rubbed += geometry[i, FRICTION] * abs(ds)
            leads = int(geometry[i, ABOVE if v[i] > 0.0 else BELOW])
            if v[i] != 0.0 and s[i] == geometry[i, end] and leads >= 0:
                for k in range(geometry.shape[1]):
                    geometry[i, k] = sheets[leads, k]
        if ramping:
            if short:
                target = drive + rate * dt
            elif last:
                ramping = False
                target = b
            moved = target - drive
            if mode == FORCE:
                after = 0.0
                for i in range(n):
                    after += s[i]
                work -= 0.5 * (total + after) * moved
            else:
                work += lam * moved
            drive = target
    else:
        return lam, work, rubbed, viscous, False
    if mode == COMPLIANT:
        total = 0.0
        for i in range(n):
            total += s[i]
        lam = stiff * (b - total)
    elif mode == FORCE:
        lam = b
    return lam, work, rubbed, viscous, True


@njit(cache=True)
def _energies(mode, stiff, drive, s, geometry, bands, loads):
    """Energy of the cells, and with the actuator spring or the dead load [J]."""
    cells = 0.0
    total = 0.0
    for i in range(geometry.shape[0]):
        cells += _cell_energy(i, s[i], geometry, bands, loads)
        total += s[i]
    if mode == COMPLIANT:
        return cells, cells + 0.5 * stiff * (drive - total) ** 2
    if mode == FORCE:
        return cells, cells - drive * total
    return cells, cells


@njit(cache=True)
def _follow(mode, stiff, points, s, steps, threshold, sheets, bands, loads):
    """All legs. Rows: drive, λ, energy, total, travels, sheets. Jumps: row, drive, λ before, λ
    after, released, viscous, travels before, travels after."""
    n = len(s)
    geometry = sheets[:n].copy()
    legs = len(points) - 1
    rows = np.empty((legs * steps + 1, 4 + 2 * n))
    jumps = np.empty((MAX_SNAPS, 6 + 2 * n))
    found = 0
    codes = np.zeros(MAX_VERTICES + 1, dtype=np.int64)
    # Strokes at which all cells can be at stops: never stepped over under stroke control.
    vertex = np.zeros(2**n if mode == STROKE else 0)
    for code in range(len(vertex)):
        for i in range(n):
            if code >> i & 1:
                vertex[code] += geometry[i, SPAN]
    table, scale = _stiffness_table(sheets, bands, loads)
    scale = max(scale, 1e-12)
    for i in range(n):
        scale = max(scale, geometry[i, FRICTION])
    # At a vertex λ has a range; begin at its end towards the first motion.
    lam = 1e30 if points[1] > points[0] else -1e30
    lam, _, _, _, ok = _advance(
        mode, stiff, points[0], points[0], s, lam, table, scale, codes,
        geometry, sheets, bands, loads,
    )  # fmt: skip
    if not ok:
        return rows, jumps[:0], codes[1:1], True
    cells, total = _energies(mode, stiff, points[0], s, geometry, bands, loads)
    rows[0, 0], rows[0, 1], rows[0, 2], rows[0, 3] = points[0], lam, cells, total
    for i in range(n):
        rows[0, 4 + i], rows[0, 4 + n + i] = s[i], geometry[i, SHEET]
    saved, stood = s.copy(), geometry.copy()
    row = 0
    for leg in range(legs):
        for k in range(steps):
            x = rows[row, 0]
            end = points[leg + 1]
            if k < steps - 1:
                end = points[leg] + (points[leg + 1] - points[leg]) * (k + 1) / steps
            whole = abs(end - x)
            part = whole
            while True:
                # The stroke leaves a vertex gently: there the ramp's haste could set off a
                # second cell whose force is nearly that of the first.
                if mode == STROKE and _note_vertex(s, codes, geometry):
                    part = min(part, whole * 0.5**GENTLE)
                y = end
                if part < abs(end - x) * (1.0 - 1e-9):
                    y = x + (part if end > x else -part)
                for stroke in vertex:
                    if min(x, y) + 1e-12 < stroke < max(x, y) - 1e-12:
                        y = stroke
                _copy(s, saved)
                _copy_rows(geometry, stood)
                noted = codes[0]
                lam_saved, total_saved = lam, total
                lam, work, rubbed, viscous, ok = _advance(
                    mode, stiff, x, y, s, lam, table, scale, codes,
                    geometry, sheets, bands, loads,
                )  # fmt: skip
                if not ok:
                    return rows, jumps[:0], codes[1:1], True
                jump = 0.0
                for i in range(n):
                    jump = max(jump, abs(s[i] - saved[i]))
                if jump > threshold and abs(y - x) > whole * 1.5 * 0.5**REFINE:
                    _copy(saved, s)
                    _copy_rows(stood, geometry)
                    lam = lam_saved
                    codes[0] = noted
                    part = 0.5 * abs(y - x)
                    continue
                cells, total = _energies(mode, stiff, y, s, geometry, bands, loads)
                if jump > threshold and found < MAX_SNAPS:
                    jumps[found, 0] = row + 1
                    jumps[found, 1] = y
                    jumps[found, 2] = lam_saved
                    jumps[found, 3] = lam
                    jumps[found, 4] = total_saved + work - rubbed - total
                    jumps[found, 5] = viscous
                    for i in range(n):
                        jumps[found, 6 + i], jumps[found, 6 + n + i] = saved[i], s[i]
                    found += 1
                x = y
                if x == end:
                    break
                # Past a jump the rest of the step may be taken in growing parts again.
                part = min(2.0 * part, whole)
            row += 1
            rows[row, 0], rows[row, 1], rows[row, 2], rows[row, 3] = end, lam, cells, total
            for i in range(n):
                rows[row, 4 + i], rows[row, 4 + n + i] = s[i], geometry[i, SHEET]
    return rows, jumps[:found], codes[1 : 1 + codes[0]], False
