"""The design of a request: its tables, and the chain that they describe."""

from __future__ import annotations

from functools import cached_property
from typing import Any

from stepwell.base import InputError
from stepwell.files import DesignError, WrittenProgram, loads_tables
from stepwell.mechanism import Chain
from stepwell.robot import Robot

# More cannot be seen at once, nor followed while an anchor is dragged.
MOST_CELLS = 64


class Design:
    """What the page shows; nothing is checked before it is asked for.

    Args:
        tables: of a design file, as JSON has them; None where the request has no design.
    """

    def __init__(self, tables: dict[str, Any] | None):
        self.tables = tables

    @cached_property
    def read(self) -> tuple[Chain | Robot, WrittenProgram | None]:
        """What the tables describe, and the program of a chain.

        Raises:
            ValueError: there is no design, or one that cannot be; the text as for a file.
        """
        if self.tables is None:
            raise InputError("design: is missing; send the tables of a design file.")
        return loads_tables(self.tables)

    @property
    def whole(self) -> Chain:
        """The chain, however long.

        Raises:
            ValueError: as `read`, or it is a robot.
        """
        found, _ = self.read
        if not isinstance(found, Chain):
            raise DesignError("design", ["is a robot, and this needs a chain."])
        return found

    @property
    def chain(self) -> Chain:
        """The chain.

        Raises:
            ValueError: as `whole`, or it is longer than the studio can show.
        """
        found = self.whole
        if len(found) > MOST_CELLS:
            raise InputError(
                f"chain.cell: {len(found)} cells: the studio follows at most {MOST_CELLS} while "
                f"they are dragged; `stepwell run` takes more."
            )
        return found

    @property
    def program(self) -> WrittenProgram | None:
        """The program of the chain, where the design has one."""
        return self.read[1]
