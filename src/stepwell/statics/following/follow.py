"""Following the local minimum through a list of turning points, event by event.

Between events the set of moving cells is fixed and every event but the fold is a comparison of
two forces, so nothing here depends on a step size.
"""

import numpy as np

from stepwell.kernels import SPENT, STROKES, entry, kernel, overspent
from stepwell.mechanism import Floats, summed
from stepwell.statics.following.log import FOLD
from stepwell.statics.following.smooth import (
    FLAT,
    LOST,
    choose,
    drift,
    join_flat,
    move,
    set_off,
    share,
)
from stepwell.statics.following.snap import note_saddle, snap
from stepwell.statics.following.state import (
    DONE,
    DUE,
    GAVE_UP,
    GOES_ON,
    LETS_GO,
    LOG_FULL,
    RUNS_AWAY,
    SENSE,
    SLIDES,
    STALLED,
    TRIGGER,
    Problem,
    State,
    drive_of,
    drive_slack,
    hold,
    set_snap,
)


@kernel
def _stroke(problem: Problem, state: State, direction: int, target: float) -> int:
    """Drive the chain to `target` in one direction."""
    n = len(state.mode)
    goes = np.zeros(n, np.int64)
    set_snap(state, -1, direction, FOLD)
    state.next_snap[DUE] = 0
    state.tie[:] = -1
    slack = drive_slack(problem)
    for i in range(n):
        if state.mode[i] == SLIDES or state.mode[i] == LETS_GO:
            hold(problem, state, i)
    # With all the stroke used up every cell is at its stop: ask for that and not for a number,
    # which rounding could meet one cell early.
    to_the_end = problem.beta == 0.0 and (
        target >= summed(problem.laws.full) - slack if direction > 0 else target <= slack
    )
    if to_the_end:
        target = direction * np.inf
    furthest, idle = np.nan, 0
    while True:
        drive = drive_of(problem, state.travel, state.force[0])
        if direction * (target - drive) <= slack:
            return DONE
        idle = idle + 1 if abs(drive - furthest) <= slack else 0
        furthest = drive
        if idle > 40 * n + 400:
            return STALLED
        if overspent(problem.effort, 10 * n):
            return GAVE_UP
        choice, leader = choose(problem, state, direction, goes)
        if choice == FLAT and join_flat(problem, state, direction):
            choice, leader = choose(problem, state, direction, goes)
        if choice == LOST or state.next_snap[DUE]:
            if state.next_snap[TRIGGER] < 0:
                state.next_snap[TRIGGER], state.next_snap[SENSE] = leader, direction
                note_saddle(problem, state, leader)
            status = snap(problem, state, direction)
        elif choice == FLAT:
            share(problem, state, goes)
            status = drift(problem, state, set_off(problem, state, goes), direction, target)
        else:
            status = move(problem, state, set_off(problem, state, goes), direction, target)
        if status != GOES_ON:
            return DONE if to_the_end and status == RUNS_AWAY else status


@entry()
def follow(problem: Problem, turning: Floats, state: State) -> int:
    """Drive the chain through `turning`, writing every segment to the log; how it ended."""
    effort = problem.effort
    for turn in range(1, len(turning)):
        effort[STROKES] = turn - 1
        if turning[turn] != turning[turn - 1]:
            direction = 1 if turning[turn] > turning[turn - 1] else -1
            effort[SPENT] = 0
            status = _stroke(problem, state, direction, turning[turn])
            if status != DONE:
                # What ran out of looks may say that it did not settle.
                return GAVE_UP if status != LOG_FULL and overspent(effort, 0) else status
    return DONE
