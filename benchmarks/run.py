"""All benchmarks in one run, as one table."""

import os

# Machine code is what is timed; what an install without any takes is timed by itself.
os.environ.setdefault("STEPWELL_KERNELS", "compiled")

from rich.console import Console
from rich.table import Table

import batches
import commands
import cycles
import graphs
import inverse
import maps
import peers
import programs
import proofs
import recordings
import robot
import studies
import studio
import worlds
import yields


def main() -> None:
    """Print what was timed, what came out and what is wanted."""
    table = Table("what", "measured", "wanted", title="stepwell benchmarks")
    whole = (
        maps,
        cycles,
        batches,
        graphs,
        programs,
        proofs,
        yields,
        inverse,
        peers,
        commands,
        robot,
        worlds,
    )
    for module in (*whole, studies, studio, recordings):
        for row in module.rows():
            table.add_row(*row)
    Console(width=120).print(table)


if __name__ == "__main__":
    main()
