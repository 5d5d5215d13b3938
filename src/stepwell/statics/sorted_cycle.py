"""The full cycle of many concave cells, by sorting: N log N, where the follower needs N².

Used only where every step of the proof (theory page, "Sorting") has been checked for the chain
at hand; anything else goes to the follower.
"""

import numpy as np

from stepwell import concave
from stepwell.base import Floats, Ints
from stepwell.concave import Simple
from stepwell.kernels import entry, leaf
from stepwell.mechanism import Laws
from stepwell.statics.following import log as logged
from stepwell.statics.following.log import add_mover, add_row

# With fewer cells the follower is as fast, and its log is the reference.
WORTH_SORTING = 16
# Largest number of cells whose curve crosses that of the leader; each is looked at in each snap.
_MOST_CLOSE = 64


@leaf
def _head_start(leader: Simple, runner: Simple, full: float, at: float, lead: float) -> float:
    """Travel that the leader gives back before the runner's and its force fall by `lead` [N]."""
    # λ is the mean of the two: its slope at the start, and a bound of the second derivative.
    fall = concave.force_at(leader, full)[1] - concave.force_at(runner, at)[1]
    bend = concave.most_bend(leader) + concave.most_bend(runner)
    return 4.0 * lead / (fall + np.sqrt(fall * fall + 4.0 * bend * lead))


@leaf
def _keeps_ahead(leader: Simple, other: Simple, full: float, head: float, reach: float) -> bool:
    """Proof that the leader, `head` ahead of the other's travel up to `reach`, has more force."""
    # On [a, b] its pull at a is above the other's at b, or their difference, whose second
    # derivative is bounded, cannot sag to zero.
    bend = concave.most_bend(leader) + concave.most_bend(other)
    a, width = 0.0, 0.25 * reach
    strong, weak = concave.force_at(leader, full - head)[0], concave.force_at(other, full)[0]
    for _ in range(20_000):
        b = min(a + width, reach)
        strong_b, weak_b = (
            concave.force_at(leader, full - head - b)[0],
            concave.force_at(other, full - b)[0],
        )
        sag = 0.125 * bend * (b - a) * (b - a)
        if strong > weak_b or min(strong - weak, strong_b - weak_b) > sag:
            if b >= reach:
                return True
            a, width = b, 2.0 * width
            strong, weak = strong_b, weak_b
        else:
            width *= 0.5
            if width < 1e-7 * full:
                return False
    return False


@entry(1e-4, "table")
def load_sorted(
    table: Floats, order: Ints, full: float, start_force: float, scale: float, log: logged.Log
) -> bool:
    """Log the loading of cells, one Simple a row, in ascending F0; False where it is not proved."""
    n = len(order)
    tie = concave.TIED * scale
    force, drive = start_force, 0.0
    top, top_force, second, second_force = -1, -np.inf, -1, -np.inf
    checked_top, checked = -1, 0
    close, closer = np.empty(_MOST_CLOSE, np.int64), 0
    last = -np.inf
    for done in range(n):
        j = order[done]
        cell = concave.of_row(table[j])
        f0, f1 = concave.end_forces(cell)
        if f0 - last <= tie or abs(f1 - top_force) <= tie:
            return False
        last = f0
        if f0 != force:
            add_row(log, logged.HOLD, 1, (drive, drive), (force, f0))
        if f1 > top_force:
            add_row(log, logged.MOVE, 1, (drive, drive + full), (f0, f1))
            add_mover(log, j, -1, 0.0, 0.0, full)
            second, second_force = top, top_force
            top, top_force = j, f1
            force, drive = f1, full * (done + 1)
            continue
        if f1 > second_force:
            second, second_force = j, f1
        # The force of j falls to the largest critical force of the full cells: a snap.
        leader = concave.of_row(table[top])
        at = concave.travel_at(cell, top_force, f0, f1)
        lack = full - at
        # Other full cells may give travel back too while j runs. The leader had a head start
        # and keeps it as long as no curve crosses its own, moved by the head start, within half
        # of the travel that j has left then.
        if lack > 0.5 * full:
            return False
        if checked_top != top:
            checked_top, checked, closer = top, 0, 0
        while checked < done:
            k = order[checked]
            other = concave.of_row(table[k])
            if k != top and not _keeps_ahead(leader, other, full, 0.0, 0.25 * full):
                # Its curve crosses that of the leader: farther than in this snap?
                if closer == _MOST_CLOSE:
                    return False
                close[closer] = k
                closer += 1
            checked += 1
        head = 0.0
        if closer > 0:
            head = min(_head_start(leader, cell, full, at, top_force - second_force), lack)
        for place in range(closer):
            other = concave.of_row(table[close[place]])
            if not _keeps_ahead(leader, other, full, head, 0.5 * (lack - head)):
                return False
        back = full - lack
        add_row(log, logged.MOVE, 1, (drive, drive + at), (f0, top_force))
        add_mover(log, j, -1, 0.0, 0.0, at)
        after = concave.force_at(leader, back)[0]
        add_row(log, logged.SNAP, 1, (drive + at, drive + at), (top_force, after))
        add_mover(log, top, -1, 0.0, full, back)
        add_mover(log, j, -1, 0.0, at, full)
        snap = log.segments[log.used[0] - 1]
        snap[logged.CAUSE], snap[logged.LEADER], snap[logged.HEADING] = logged.RELEASE, top, -1
        lost, gained = concave.energy_at(cell, full), concave.energy_at(leader, full)
        # The next snap: a held cell of falling force moves together with the leader.
        near, travel = np.inf, np.inf
        if done + 1 < n:
            f0_next, slope = concave.force_at(concave.of_row(table[order[done + 1]]), 0.0)[:2]
            near, travel = f0_next - after, (f0_next - after) / abs(slope)
        second_force, slope = concave.force_at(concave.of_row(table[second]), full)[:2]
        near = min(near, after - second_force)
        travel = min(travel, (after - second_force) / abs(slope))
        snap[logged.NEAR_FORCE], snap[logged.NEAR_TRAVEL] = max(near, 0.0), max(travel, 0.0)
        snap[logged.DECIDED] = logged.BY_LINE
        snap[logged.RELEASED] = (
            concave.energy_at(cell, at) - lost + gained - concave.energy_at(leader, back)
        )
        add_row(log, logged.MOVE, 1, (drive + at, full * (done + 1)), (after, top_force))
        add_mover(log, top, -1, 0.0, back, full)
        force, drive = top_force, full * (done + 1)
    return True


def sorted_cycle(laws: Laws) -> tuple[logged.Log, float] | None:
    """The log of a full cycle and its first force, or None where the proof does not hold."""
    table, full = concave.simple_rows(laws), laws.full
    if table is None or not concave.same_travel(np.max(full), np.min(full)):
        return None
    forces, proved = concave.proved_ends(table)
    if not np.all(proved):
        return None
    loading, unloading = concave.motion_orders(forces)
    mirrored = table * np.array([1.0, -1.0, 1.0, 1.0, 1.0, 1.0])
    n = len(table)
    scale = float(np.max(np.abs(forces)))
    log = logged.empty_log(8 * n, 8 * n)
    begin = min(0.0, float(np.min(forces[:, 0])))
    if not load_sorted(table, loading, full[0], begin, scale, log):
        return None
    segments, movers = int(log.used[0]), int(log.used[1])
    # Unloading is the mirror image of loading: s → S - s and F → -F change the sign of d_y.
    arrival = -float(log.segments[segments - 1, logged.FORCE_1])
    if not load_sorted(mirrored, unloading, full[0], arrival, scale, log):
        return None
    back = log.segments[segments : log.used[0]]
    back[:, logged.DIRECTION] = -1
    back[:, [logged.DRIVE_0, logged.DRIVE_1]] = (
        n * full[0] - back[:, [logged.DRIVE_0, logged.DRIVE_1]]
    )
    back[:, [logged.FORCE_0, logged.FORCE_1, logged.HEADING]] *= -1.0
    way = log.movers[movers : log.used[1]]
    way[:, [logged.TRAVEL_0, logged.TRAVEL_1]] = (
        full[0] - way[:, [logged.TRAVEL_0, logged.TRAVEL_1]]
    )
    return log, begin
