"""A unit cell: two blocks on two parallel levers, held by one or more bands."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from stepwell.base import ByValue, Drawn, Floats, InputError, Measure, Vec2, check, require, to_unit
from stepwell.mechanism import cubics, geometry, sizes
from stepwell.mechanism.band import Band, Load
from stepwell.mechanism.phase import Phase, Stretch, a_mobility

# Angles at which a law without a closed form is looked at; a feature narrower than the limit
# divided by this number can be missed by `peak_angle` and `barrier`, never by the engine.
_LOOKS = 4097
# Smallest and largest θc, in degrees and in rad.
LIMITS_DEG = 0.01, 89.9
LIMITS = math.radians(LIMITS_DEG[0]), math.radians(LIMITS_DEG[1])

_WAY = "If it is meant so, pass unusual=True."


@dataclass(frozen=True, slots=True, eq=False)
class Cell(ByValue, Drawn):
    """Two blocks joined by two parallel levers, and what pulls on them.

    State 0 is θ = -limit, state 1 is θ = +limit; travel runs from 0 to `full_travel` between.

    Args:
        band: one band or several.
        lever: r [m], > 0.
        limit: θc [rad], from 0.01° to 89.9°, where the blocks touch.
        load: a force on the cell that depends on its travel; None for none.
        friction: Coulomb friction against travel [N], >= 0.
        name: name of the cell in messages and figures.
        unusual: True to accept sizes that look like unit errors compared with the lever (theory
            page, "Slips of unit"), here and in functions that take a cell and a number. Copies by
            `dataclasses.replace` are not checked again.
        mobility: speed per force relative to the other cells (inverse drag), > 0; it can affect
            the landing of a snap of three or more cells.


    Raises:
        ValueError: a value out of its range, a band whose two ends meet on the way, or a size
            that is probably in another unit.

    Source: Kamp et al. 2024, Fig. 1; the defaults are the paper's cell.
    """

    band: Band | Sequence[Band]
    lever: float = 0.014142135623730951  # 10√2 mm
    limit: float = math.pi / 4
    load: Load | None = None
    friction: float = 0.0
    name: str = ""
    unusual: bool = field(default=False, compare=False)
    mobility: float = field(default=1.0, kw_only=True)
    low: ClassVar[float] = 0.0
    """Travel at state 0 [m]."""
    stopped: ClassVar[tuple[bool, bool]] = (True, True)
    """Whether it is stopped at either end: its blocks touch there."""
    measure: ClassVar[Measure] = Measure.TRAVEL
    """What its travel and force are: a travel and a force."""
    # Whether the sizes were checked for slips; `replace` copies it.
    _asked: bool = field(default=False, repr=False, compare=False, kw_only=True)
    # S [m], which most computations read several times a cell.
    _full_travel: float = field(init=False, repr=False, compare=False)

    def __post_init__(self):
        if not isinstance(self.band, Band):
            bands = tuple(self.band)
            if not bands or any(type(band) is not Band for band in bands):
                raise InputError(f"band = {self.band!r}: must be a Band or a sequence of Bands.")
            require("bands", len(bands), "the cell has")
            object.__setattr__(self, "band", bands[0] if len(bands) == 1 else bands)
        check.fields(self, check.positive, lever="m", limit="rad")
        check.fields(self, check.not_negative, friction="N")
        object.__setattr__(self, "mobility", a_mobility(self.mobility))
        _refuse_limit(self.limit)
        full = geometry.travel_of(self.sin_limit, self.lever, self.sin_limit)
        object.__setattr__(self, "_full_travel", full)
        if not (self.unusual or self._asked):
            slips = sizes.slips(self)
            if slips:
                raise sizes.SlipError(slips, _WAY)
        object.__setattr__(self, "_asked", True)
        if self.load is not None:
            _refuse_steps(self.load, self.full_travel)
        for band in self.bands:
            _refuse_meeting_ends(band, self.lever, self.limit)

    @property
    def bands(self) -> tuple[Band, ...]:
        """All bands of the cell."""
        return (self.band,) if isinstance(self.band, Band) else tuple(self.band)

    @property
    def sin_limit(self) -> float:
        """sin θc [1]."""
        return math.sin(self.limit)

    @property
    def full_travel(self) -> float:
        """S = 2 r sin θc [m]."""
        return self._full_travel

    def with_anchors(self, p: Vec2 | None = None, q: Vec2 | None = None) -> "Cell":
        """The same cell with the anchors of its bands at p and q [m]; None leaves them.

        Anchors that look like unit errors raise ValueError, unless the cell is `unusual`.
        """
        if not self.unusual:
            # Relative to the present anchors: one that is far already may move further.
            own = max([self.lever, *(math.hypot(*a) for b in self.bands for a in (b.p, b.q))])
            given = ((name, at) for name, at in (("p", p), ("q", q)) if at is not None)
            groups = (sizes.far(name, check.vector(name, at), own) for name, at in given)
            far = tuple(slip for slips in groups for slip in slips)
            if far:
                raise sizes.SlipError(far, _WAY)
        bands = [
            replace(b, p=b.p if p is None else p, q=b.q if q is None else q) for b in self.bands
        ]
        return replace(self, band=bands)

    def travel(self, theta: ArrayLike) -> Floats:
        """Travel s = r (sin θ + sin θc) [m] at (...) angles θ [rad]; ValueError past a stop."""
        return geometry.travel_of(np.sin(self._within(theta)), self.lever, self.sin_limit)

    def angle(self, travel: ArrayLike) -> Floats:
        """Lever angle θ [rad] at travels s [m] of any shape; ValueError past a stop."""
        travel = np.asarray(travel, float)
        if not np.all(geometry.between_stops(travel, self.full_travel)):
            raise InputError(
                f"travel = {to_unit(_worst(travel), 'mm'):.6g} mm: must be between 0 and "
                f"{to_unit(self.full_travel, 'mm'):.6g} mm, the stops."
            )
        return geometry.angle_at(travel, self.lever, self.limit, self.sin_limit)

    def energy(self, theta: ArrayLike) -> Floats:
        """Potential energy [J] of bands and load at angles θ [rad] of any shape.

        The load counts from travel 0; an angle past a stop raises ValueError. Source: Kamp et al.
        2024, Eqs. 1 and 2.
        """
        theta = self._within(theta)
        energy = sum(band.energy(band.length(theta, self.lever)) for band in self.bands)
        if self.load is not None:
            energy = energy + cubics.integral(self.load.pieces(), self.travel(theta))
        return np.asarray(energy)

    def force(self, theta: ArrayLike) -> Floats:
        """Force F = dE/ds [N] without friction at (...) angles θ [rad]; ValueError past a stop."""
        theta = self._within(theta)
        force = sum(band.force(theta, self.lever) for band in self.bands)
        if self.load is not None:
            force = force + cubics.value(self.load.pieces(), self.travel(theta))
        return np.asarray(force)

    @property
    def force_0(self) -> float:
        """F0 [N], the force at state 0: above it, the cell leaves state 0."""
        return float(self.force(-self.limit))

    @property
    def force_1(self) -> float:
        """F1 [N], the force at state 1: below it, the cell leaves state 1."""
        return float(self.force(self.limit))

    def force_at(self, travel: ArrayLike, sheet: int = 0) -> Floats:
        """Force F [N] without friction at travels s [m] of any shape, or ValueError past a stop."""
        return self.force(self.angle(travel))

    def energy_at(self, travel: ArrayLike, sheet: int = 0) -> Floats:
        """Energy [J] of bands and load at travels s [m]; all else as for `force_at`."""
        return self.energy(self.angle(travel))

    @property
    def high(self) -> float:
        """Travel at state 1, S [m]."""
        return self.full_travel

    @property
    def stretches(self) -> tuple[Stretch, ...]:
        """Sheet and travels [m] of its two states, which are the stops."""
        full = self.full_travel
        return (0, 0.0, 0.0), (0, full, full)

    @property
    def switching_range(self) -> tuple[float, float]:
        """Least and largest switching force of its states [N]."""
        return min(self.force_0, self.force_1), max(self.force_0, self.force_1)

    @property
    def phases(self) -> tuple[Phase, ...]:
        """Its two states, at the stops."""
        full = self.full_travel
        force_0, force_1 = self.force((-self.limit, self.limit)).tolist()
        return (Phase(0, 0.0, 0.0, -math.inf, force_0), Phase(0, full, full, force_1, math.inf))

    @property
    def largest_force(self) -> float:
        """Largest force in size on its way [N], as far as a table of it shows."""
        return float(np.max(np.abs(self.force(np.linspace(-self.limit, self.limit, _LOOKS)))))

    @property
    def peak_angle(self) -> float:
        """θmax [rad] where the energy peaks: atan2(d_y, d_x) for one band without load.

        For one band it may lie past a stop, and then the cell is monostable (Kamp et al. 2024,
        Eq. 3). With several bands or a load it is the highest point between the stops.
        """
        if len(self.bands) == 1 and self.load is None:
            dx, dy = self.bands[0].d
            return math.atan2(dy, dx)
        theta = np.linspace(-self.limit, self.limit, _LOOKS)
        return float(theta[np.argmax(self.energy(theta))])

    @property
    def largest_stretch(self) -> float:
        """Largest length of any band between the stops over its rest length [1]."""
        return max(band.largest_stretch(self.lever, self.limit) for band in self.bands)

    @property
    def barrier(self) -> float:
        """Energy [J] from state 0 up to the highest point between the stops."""
        theta = np.linspace(-self.limit, self.limit, _LOOKS)
        peak = min(max(self.peak_angle, -self.limit), self.limit)
        highest = max(float(np.max(self.energy(theta))), float(self.energy(peak)))
        return highest - float(self.energy(-self.limit))

    @property
    def is_bistable(self) -> bool:
        """Whether an energy barrier between the stops stands above both of them."""
        ends = self.energy(np.array([-self.limit, self.limit]))
        over = self.barrier - max(0.0, float(ends[1] - ends[0]))
        return over > 1e-12 * max(float(np.max(np.abs(ends))), self.barrier)

    def __repr__(self):
        inside = ", ".join(
            f"d=({to_unit(band.d[0], 'mm'):.4g}, {to_unit(band.d[1], 'mm'):.4g}) mm "
            f"k={band.stiffness:.4g} N/m ℓ0={to_unit(band.rest_length, 'mm'):.4g} mm"
            for band in self.bands
        )
        extra = f", friction={self.friction:.3g} N" if self.friction else ""
        extra += ", load" if self.load is not None else ""
        name = f"{self.name!r}, " if self.name else ""
        return (
            f"Cell({name}{inside}, r={to_unit(self.lever, 'mm'):.4g} mm, "
            f"θc={math.degrees(self.limit):.4g}°{extra})"
        )

    def _within(self, theta: ArrayLike) -> Floats:
        theta = np.asarray(theta, float)
        if np.any(~(np.abs(theta) <= self.limit * (1 + 1e-12))):
            raise InputError(
                f"theta = {math.degrees(_worst(theta)):.6g}°: must be between the stops, "
                f"±{math.degrees(self.limit):.6g}° (angles are in rad)."
            )
        return np.clip(theta, -self.limit, self.limit)


def _refuse_limit(limit: float) -> None:
    (least, most), (low, high) = LIMITS, LIMITS_DEG
    if least * (1 - 1e-12) <= limit <= most * (1 + 1e-12):
        return
    meant = math.radians(limit)
    likely = sizes.LEAST_LIMIT <= meant <= most
    probably = f" Did you mean {meant:.6g} rad ({limit:.6g}°)?" if likely else ""
    raise InputError(
        f"limit = {limit} rad: must be from {least:.6g} to {most:.6g} ({low}° to {high}°; angles "
        f"are in rad). Smaller limits leave almost no travel; at larger ones the force at the "
        f"stops is unbounded.{probably}"
    )


def _worst(values: Floats) -> float:
    flat = np.ravel(values)
    return float(flat[np.argmax(np.where(np.isnan(flat), np.inf, np.abs(flat)))])


def _refuse_steps(load: Load, full: float) -> None:
    # Within rounding of the travel a force has no value.
    for before, after in pairwise(load.travel):
        if after - before < 1e-9 * full:
            raise InputError(
                f"load: its points at {before!r} and {after!r} m are {after - before:.3g} m "
                f"apart, must be {1e-9 * full:.3g} m or more: within a billionth of the travel the "
                f"force is undefined."
            )


def _refuse_meeting_ends(band: Band, lever: float, limit: float) -> None:
    # At ℓ = 0 the force of a band has no direction. A band with ℓ0 = 0 has no force there: its
    # force is (T/ℓ) g, and T/ℓ has a limit.
    if band.rest_length == 0.0:
        return
    shortest, _ = band.lengths(lever, limit)
    taut = band.two_sided or shortest >= band.rest_length
    if taut and shortest < 1e-6 * lever:
        theta = float(geometry.farthest_angle(-band.d[0], -band.d[1], limit))
        slackens = band.two_sided and shortest < band.rest_length
        way = "let it go slack (two_sided=False)" if slackens else "set rest_length = 0"
        raise InputError(
            f"the ends of the band with q - p = ({to_unit(band.d[0], 'mm'):.6g}, "
            f"{to_unit(band.d[1], 'mm'):.6g}) mm meet at θ = {math.degrees(theta):.4g}°, where the "
            f"force of a band with a rest length of {to_unit(band.rest_length, 'mm'):.6g} mm has "
            f"no direction: move an anchor, or {way}."
        )
