"""Places to write into, looked at before the work begins."""

from __future__ import annotations

from pathlib import Path

import typer


def free(out: Path | None, command: str, force: bool, **texts: str) -> None:
    """Refuse a folder where results would replace others' work, or cannot be written.

    Args:
        out: what --out says.
        command: whose results they are.
        force: what --force says.
        texts: of files whose content is known, by their names without .toml.
    """
    from stepwell import files

    if out is not None:
        known = {f"{name}.toml": text for name, text in texts.items()}
        files.check_folder(out, command, force=force, texts=known)


def free_file(file: Path | None, force: bool) -> None:
    """Refuse a file that exists, unless it may be replaced."""
    if file is not None and file.exists() and not force:
        message = "exists: choose another name, or pass --force to replace it."
        raise typer.BadParameter(message, param_hint=str(file))
