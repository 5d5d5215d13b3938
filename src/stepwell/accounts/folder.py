"""What a folder of results contains: its record is `stepwell.json` in the folder itself."""

from __future__ import annotations

from stepwell.accounts.head import HEAD
from stepwell.accounts.shape import Shape
from stepwell.base import Quantity, Schema

KIND = "folder/1"
# A folder has no packages of its own: its result has.
FIRST: Schema = tuple(one for one in HEAD if one.name != "versions")


def schema(_: Shape) -> Schema:
    """What is reported of a folder; `files.staged_folder` writes it."""
    return (
        Quantity("command"),
        Quantity("files", holds={str: str}, doc="the SHA-256 of each file by its name"),
    )
