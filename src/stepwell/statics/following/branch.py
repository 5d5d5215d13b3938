"""One smooth branch of equilibria: its stability, its fold, its point at a given drive.

All moving cells share one force λ, so a branch is a sum of inverses of monotone pieces and the
fold is a scalar condition. The drive coordinate is U = α Σ s_i + β λ: (1, 0) for a prescribed
stroke, (1, 1/K) for an actuator of stiffness K, (0, 1) for a prescribed force.
"""

import numpy as np

from stepwell.base import Floats
from stepwell.kernels import leaf, overspent
from stepwell.mechanism import law, smallest
from stepwell.statics.following.pieces import invert, invert_near, piece_along
from stepwell.statics.following.state import DrivenChain, Movers


@leaf
def inverse_slope(problem: DrivenChain, cell: int, piece: int, travel: float) -> float:
    """1/κ with the sign of the piece, so that rounding at an extremum cannot turn it over."""
    pieces = problem.pieces
    slope = law(problem.laws, cell, pieces.picked[piece], travel)[1]
    return pieces.sign[piece] / max(abs(slope), 1e-300)


@leaf
def smallest_eigenvalue(slopes: Floats, weights: Floats, alpha: float, beta: float) -> float:
    """Least stiffness [N/m] of cells with slopes κ and weights 1 at fixed drive, or inf."""
    # With slopes m κ and weights m it is the least rate of decay. The eigenvalues solve β/α² + Σ
    # w_i/(κ_i - μ) = 0, a function that rises between two κ, so the least one is bracketed.
    moving = len(slopes)
    if moving == 0:
        return np.inf
    if alpha == 0.0:
        return smallest(slopes)
    if moving == 1:
        return np.inf if beta == 0.0 else float(slopes[0] + weights[0] * alpha * alpha / beta)
    low = high = np.inf
    for slope in slopes:
        if slope < low:
            low, high = slope, low
        elif slope < high:
            high = slope
    soft = beta / (alpha * alpha)
    for _ in range(200):
        middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        total = soft
        for i in range(moving):
            total += weights[i] / (slopes[i] - middle)
        if total > 0.0:
            high = middle
        else:
            low = middle
    return float(0.5 * (low + high))


@leaf
def compliance(problem: DrivenChain, movers: Movers, one: float, two: float) -> tuple[float, float]:
    """An upper bound of dU/dλ between forces `one` and `two`, and its value at `two`."""
    laws, pieces, alpha, beta = problem.laws, problem.pieces, problem.alpha, problem.beta
    bound = end = beta + alpha * movers.soft
    for m in range(len(movers.cell)):
        cell, piece, offset = movers.cell[m], movers.piece[m], movers.offset[m]
        at_one = invert(laws, pieces, cell, piece, one - offset)
        at_two = invert_near(laws, pieces, cell, piece, two - offset, at_one)
        soft = inverse_slope(problem, cell, piece, at_two)
        bound += alpha * max(inverse_slope(problem, cell, piece, at_one), soft)
        end += alpha * soft
    return (np.inf if np.isnan(bound) else bound), end


@leaf
def first_fold(problem: DrivenChain, movers: Movers, begin: float, end: float) -> float:
    """First force on the way at which dU/dλ = α Σ 1/κ_i + β reaches 0; NaN where there is none."""
    # κ is monotone on a piece, so its ends bound it: intervals are dismissed by proof, not step.
    tolerance = 1e-15 * problem.scale
    one, two = problem.spare.stack[0], problem.spare.stack[1]
    one[0], two[0] = begin, end
    waiting = 1
    while waiting > 0:
        waiting -= 1
        a, b = one[waiting], two[waiting]
        if overspent(problem.effort, 60 * len(movers.cell)):
            break
        bound, at_b = compliance(problem, movers, a, b)
        if bound < 0.0:
            continue
        middle = 0.5 * (a + b)
        if abs(b - a) <= tolerance or middle == a or middle == b:
            if at_b >= 0.0:
                return b
            continue
        one[waiting], two[waiting] = middle, b
        one[waiting + 1], two[waiting + 1] = a, middle
        waiting += 2
    return np.nan


@leaf
def point_at(
    problem: DrivenChain,
    movers: Movers,
    begin: float,
    end: float,
    drive: float,
    out: Floats,
    joints: bool,
) -> float:
    """The λ between `begin` and `end` at which a branch has U = `drive`; travels into `out`."""
    # With `joints` the movers pass to the next pieces of their branches.
    low, high, force = begin, end, end
    # The result does not depend on the previous contents.
    out[:] = np.nan
    u_low = drive_at(problem, movers, low, out, joints)
    u_high = drive_at(problem, movers, high, out, joints)
    rising = u_high > u_low
    for step in range(200):
        force = 0.5 * (low + high)
        if step % 3 != 2 and u_high != u_low:
            force = low + (drive - u_low) * (high - low) / (u_high - u_low)
        if not min(low, high) < force < max(low, high):
            force = 0.5 * (low + high)
            if force == low or force == high:
                break
        u = drive_at(problem, movers, force, out, joints)
        if u == drive:
            break
        if (u < drive) == rising:
            low, u_low = force, u
        else:
            high, u_high = force, u
    drive_at(problem, movers, force, out, joints)
    # Near an extremum λ is too blunt a coordinate: let the softest cell close the sum, unless
    # the actuator is softer still.
    softest, largest, total = 0, 0.0, movers.held
    for m in range(len(movers.cell)):
        inverse = inverse_slope(problem, movers.cell[m], movers.piece[m], out[m])
        if abs(inverse) > largest:
            softest, largest = m, abs(inverse)
    soft = problem.beta + problem.alpha * movers.soft
    if problem.alpha * largest <= soft:
        return force
    for m in range(len(movers.cell)):
        if m != softest:
            total += out[m]
    pieces, piece = problem.pieces, movers.piece[softest]
    travel = (drive - soft * force) / problem.alpha - total
    out[softest] = min(max(travel, pieces.left[piece]), pieces.right[piece])
    return force


@leaf
def drive_at(
    problem: DrivenChain, movers: Movers, force: float, out: Floats, joints: bool
) -> float:
    """U of a branch where its force is `force`; travels into `out`, from those there on."""
    laws, pieces, alpha, beta = problem.laws, problem.pieces, problem.alpha, problem.beta
    total = movers.held
    for m in range(len(movers.cell)):
        if joints:
            movers.piece[m] = piece_along(pieces, movers.cell[m], movers.piece[m], force)
        cell, piece = movers.cell[m], movers.piece[m]
        out[m] = invert_near(laws, pieces, cell, piece, force - movers.offset[m], out[m])
        total += out[m]
    return alpha * total + (beta + alpha * movers.soft) * force
