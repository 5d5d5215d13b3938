"""Band length against lever angle or travel, with its slopes.

Written for floats and arrays alike, so that NumPy evaluates it here and Numba compiles the
same lines for the engine: one formula, one place.
"""

from typing import Any

import numpy as np


def band_length(sin: Any, cos: Any, dx: float, dy: float, lever: float) -> Any:
    """ℓ(θ) = |(r cos θ + d_x, r sin θ + d_y)| (Kamp et al. 2024, Eq. 2)."""
    x = lever * cos + dx
    y = lever * sin + dy
    return np.sqrt(x * x + y * y)


def length_slopes(
    sin: Any, cos: Any, length: Any, dx: float, dy: float, lever: float
) -> tuple[Any, Any, Any]:
    """First three derivatives of ℓ by travel s = r (sin θ + sin θc).

    From ℓ² = r² + d² + 2 r (d_x cos θ + d_y sin θ) and ds = r cos θ dθ:
    ℓ ℓ' = g with g = d_y - d_x tan θ, then ℓ'' = (g' - ℓ'²)/ℓ and ℓ''' = (g'' - 3 ℓ' ℓ'')/ℓ.
    """
    rc3 = lever * cos * cos * cos
    g = dy - dx * sin / cos
    g1 = -dx / rc3
    g2 = -3.0 * dx * sin / (lever * cos * cos * rc3)
    first = g / length
    second = (g1 - first * first) / length
    third = (g2 - 3.0 * first * second) / length
    return first, second, third
