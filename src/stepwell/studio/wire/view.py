"""What a panel answers: words and numbers for people, arrays for pictures."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np


@dataclass(frozen=True, slots=True)
class View:
    """An answer of a panel.

    Attributes:
        header: what JSON can hold, the unit in the name of every number that has one.
        blocks: arrays of floats or of whole numbers, by name.
    """

    header: Mapping[str, Any]
    blocks: Mapping[str, np.ndarray[Any, Any]] = field(default_factory=dict)
