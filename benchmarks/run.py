"""All benchmarks in one run, as one table."""

from rich.console import Console
from rich.table import Table

import commands
import cycles
import maps
import robot


def main() -> None:
    """Print what was timed, what came out and what is wanted."""
    table = Table("what", "measured", "wanted", title="stepwell benchmarks")
    for module in (maps, cycles, commands, robot):
        for row in module.rows():
            table.add_row(*row)
    Console(width=120).print(table)


if __name__ == "__main__":
    main()
