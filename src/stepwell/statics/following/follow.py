"""Following the local minimum through a list of turning points, event by event.

Between events the set of moving cells is fixed and every event but the fold is a comparison of
two forces, so nothing here depends on a step size.
"""

import numpy as np

from stepwell.base import Floats
from stepwell.kernels import SPENT, entry, leaf, overspent
from stepwell.mechanism import ends_of
from stepwell.statics.following import smooth, state as st
from stepwell.statics.following.log import FOLD
from stepwell.statics.following.pieces import resting_piece
from stepwell.statics.following.rising import Rising
from stepwell.statics.following.series import advance, is_regular
from stepwell.statics.following.snap import FINE, note_saddle, snap
from stepwell.statics.following.state import DrivenChain, State

_LONGEST_WAIT = 15


# One kernel for speed: its steps share what each would get again as arguments.
@entry()
@leaf
def follow(problem: DrivenChain, turning: Floats, state: State, rising: Rising) -> int:
    """Drive the chain through `turning`, and log every segment; returns the status."""
    # Where the log is full, a call with a longer one continues from there.
    # One function: the loop of a stroke keeps its counts as locals; steps are functions.
    effort, n, goes = problem.effort, len(state.mode), problem.spare.whole[st.GOES]
    slack = st.drive_slack(problem)
    lowest, highest = ends_of(problem.sheets)
    regular = is_regular(problem)
    for turn in range(1, len(turning)):
        target = turning[turn]
        if target == turning[turn - 1] or turn < state.stroke[0]:
            continue
        direction = 1 if target > turning[turn - 1] else -1
        if turn > state.stroke[0]:
            state.stroke[0], effort[SPENT] = turn, 0
            _come_to_rest(problem, state, direction)
        # At the end of the stroke every cell is at its stop: this is exact, while a number could be
        # reached one cell early by rounding.
        ends = target >= highest - slack if direction > 0 else target <= lowest + slack
        to_the_end = problem.beta == 0.0 and ends
        if to_the_end:
            target = direction * np.inf
        furthest, idle, status = np.nan, 0, st.GOES_ON
        # After queues without effect, some events pass before they are tried again.
        in_vain, waits = 0, 0
        while status == st.GOES_ON:
            waits -= 1
            if regular and waits < 0 and state.next_snap[st.DUE] == 0:
                rows = state.log.used[0]
                status = advance(problem, state, rising, direction, target, slack)
                if status == st.LOG_FULL:
                    return st.LOG_FULL
                if status != st.GOES_ON:
                    break
                in_vain = min(2 * in_vain + 1, _LONGEST_WAIT) if rows == state.log.used[0] else 0
                waits = in_vain
            drive = st.drive_of(problem, state.travel, state.force[0])
            if direction * (target - drive) <= slack:
                status = st.DONE
                break
            idle = idle + 1 if abs(drive - furthest) <= slack else 0
            furthest = drive
            if idle > 40 * n + 400:
                status = st.STALLED
                break
            if overspent(effort, 10 * n):
                status = st.GAVE_UP
                break
            (rows, movers), log = state.log.used, state.log
            if rows == len(log.segments) or movers + n > len(log.movers):
                return st.LOG_FULL
            choice, leader = smooth.choose(problem, state, direction, goes)
            if choice == smooth.FLAT and smooth.join_flat(problem, state, direction):
                choice, leader = smooth.choose(problem, state, direction, goes)
            if choice == smooth.LOST or state.next_snap[st.DUE]:
                if state.next_snap[st.TRIGGER] < 0:
                    state.next_snap[st.TRIGGER], state.next_snap[st.SENSE] = leader, direction
                    note_saddle(problem, state, leader)
                status = snap(problem, state, direction, FINE)
            elif choice == smooth.FLAT:
                smooth.share(problem, state, goes)
                status = smooth.drift(
                    problem, state, smooth.set_off(problem, state, goes), direction, target
                )
            else:
                status = smooth.move(
                    problem, state, smooth.set_off(problem, state, goes), direction, target
                )
        if status != st.DONE and not (to_the_end and status == st.RUNS_AWAY):
            # A run that reached the step limit may report that it did not settle.
            return st.GAVE_UP if overspent(effort, 0) else status
    return st.DONE


@leaf
def _come_to_rest(problem: DrivenChain, state: State, direction: int) -> None:
    """Turn the actuator: sliding cells rest, and the next event is reset."""
    st.set_snap(state.next_snap, -1, direction, FOLD)
    state.next_snap[st.DUE] = 0
    state.tie[:] = -1
    for i in range(len(state.mode)):
        if state.mode[i] == st.SLIDES or state.mode[i] == st.LETS_GO:
            st.hold(problem, state, i)
        elif state.mode[i] == st.FREE and problem.pieces.sign[state.piece[i]] < 0:
            state.piece[i] = resting_piece(problem.pieces, i, state.travel[i])
