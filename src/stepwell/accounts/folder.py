"""What a folder of results contains: its record is `stepwell.json` in the folder itself."""

from __future__ import annotations

from stepwell.accounts.shape import Shape
from stepwell.base import Quantity, Schema


def folder_schema(_: Shape) -> Schema:
    """What is reported of a folder; `files.staged_folder` writes it."""
    return (
        Quantity("command"),
        Quantity("files", holds={str: str}, doc="the SHA-256 of each file by its name"),
    )
