"""What all commands do on the screen: tables, progress, errors."""

from stepwell.cli.screen.outcomes import EXIT_CODES, Commands, answered, stopped, usable
from stepwell.cli.screen.progress import progress
from stepwell.cli.screen.show import (
    number,
    show_json,
    show_lines,
    show_table,
    show_text,
    show_written,
    signed,
    styled,
    warn,
    wrapped,
)

__all__ = [
    "EXIT_CODES",
    "Commands",
    "answered",
    "number",
    "progress",
    "show_json",
    "show_lines",
    "show_table",
    "show_text",
    "show_written",
    "signed",
    "stopped",
    "styled",
    "usable",
    "warn",
    "wrapped",
]
