"""Reading a parameter of a chain and the values it is to take."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

import typer

from stepwell.cli.options.grid import counted

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from stepwell.mechanism import Chain

EXAMPLE = "outer.q.x=0:20:41"


@dataclass(frozen=True)
class ParameterRange:
    """Values of a parameter from `start` to `stop`, both included, as the user writes them."""

    name: str
    start: float
    stop: float
    count: int
    log: bool

    def read(self, chain: Chain) -> float:
        """The parameter of a chain as it is, in SI; a number, as all that have values here."""
        from stepwell.design import parameter

        value = parameter(chain, self.name).value(chain)
        assert not isinstance(value, tuple)
        return value

    def values(self, chain: Chain) -> tuple[str, NDArray[np.float64]]:
        """The parameter and its values in SI, for a chain that has it."""
        import numpy as np

        from stepwell.base import told_in
        from stepwell.design import parameter

        one = parameter(chain, self.name)
        factor = told_in(one.unit)[1]
        space = np.geomspace if self.log else np.linspace
        values = space(self.start / factor, self.stop / factor, self.count)
        return self.name, one.values(values, 2)


def parameter_range(text: str) -> ParameterRange:
    """NAME=FROM:TO:COUNT, with :log at the end for equal ratios instead of equal steps."""
    parsed = re.fullmatch(r"(.+?)=([^:=]+):([^:=]+):(\d{1,15})(:log)?", text)
    try:
        if parsed is None:
            raise ValueError
        found = ParameterRange(
            parsed[1], float(parsed[2]), float(parsed[3]), int(parsed[4]), parsed[5] is not None
        )
    except ValueError:
        problem = (
            f"{text!r}: must be NAME=FROM:TO:COUNT or NAME=FROM:TO:COUNT:log, as in {EXAMPLE}."
        )
        raise typer.BadParameter(problem) from None
    if not -1e9 <= found.start < found.stop <= 1e9:
        raise typer.BadParameter(f"{text!r}: must rise, as {EXAMPLE} does, within -1e9 to 1e9.")
    if found.log and found.start <= 0:
        raise typer.BadParameter(f"{text!r}: must start above 0 for equal ratios.")
    counted(text, found.count)
    return found
