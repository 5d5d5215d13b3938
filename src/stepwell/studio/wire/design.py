"""The design of a request: its tables, and the chain that they describe."""

from __future__ import annotations

from functools import cached_property
from typing import Any

from stepwell.base import InputError
from stepwell.files import DesignError, DesignFile, WrittenProgram, loads_tables
from stepwell.mechanism import Chain
from stepwell.robot import Robot

# More cannot be seen at once, nor followed while an anchor is dragged.
MOST_CELLS = 64


class Design:
    """What the page shows; nothing is checked before it is asked for.

    Args:
        tables: of a design file, as JSON has them; None where the request has no design.
        leg: of a robot, whose chain is meant where a chain is asked for.
    """

    def __init__(self, tables: dict[str, Any] | None, leg: int = 0):
        self.tables, self.leg = tables, leg

    @cached_property
    def read(self) -> DesignFile:
        """What the tables describe, and the program of a chain.

        Raises:
            ValueError: there is no design, or one that cannot be; the text as for a file.
        """
        if self.tables is None:
            raise InputError("design: is missing; send the tables of a design file.")
        return loads_tables(self.tables)

    @property
    def chain(self) -> Chain:
        """The chain, or that of one leg of the robot.

        Raises:
            ValueError: as `read`, or there is no such leg, or it is longer than the studio can
                show.
        """
        chain = self.read.subject
        if isinstance(chain, Robot):
            if self.leg >= len(chain.legs):
                raise DesignError("design", [f"leg[{self.leg}]: there are {len(chain.legs)}."])
            chain = chain.legs[self.leg].chain
        if len(chain) > MOST_CELLS:
            raise InputError(
                f"chain.cell: {len(chain)} cells: the studio follows at most {MOST_CELLS} while "
                f"they are dragged; `stepwell run` takes more."
            )
        return chain

    @property
    def robot(self) -> Robot:
        """The robot.

        Raises:
            ValueError: as `read`, or it is a chain.
        """
        found = self.read.subject
        if not isinstance(found, Robot):
            raise DesignError("design", ["is a chain, and this needs a robot."])
        return found

    @property
    def program(self) -> WrittenProgram | None:
        """The program of the chain, where the design has one."""
        return self.read.program
