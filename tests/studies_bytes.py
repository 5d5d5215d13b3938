"""What a store holds, to the byte."""

import hashlib
from pathlib import Path


def bytes_of(folder: Path) -> dict[str, str]:
    """The digest of every file of a store; drafts that somebody left are none of it."""
    return {
        file.relative_to(folder).as_posix(): hashlib.sha256(file.read_bytes()).hexdigest()
        for file in sorted(folder.rglob("*"))
        if file.is_file() and not file.name.endswith(".partial")
    }
