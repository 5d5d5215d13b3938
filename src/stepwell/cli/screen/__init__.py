"""What all commands do on the screen: tables, progress, errors."""

from stepwell.cli.screen.outcomes import (
    EXIT_CODES,
    FAILED,
    PIPE_CLOSED,
    Commands,
    answered,
    stopped,
    usable,
)
from stepwell.cli.screen.progress import WRITING, Interrupted, Progress, progress
from stepwell.cli.screen.show import (
    at_terminal,
    has_display,
    report,
    show_json,
    show_lines,
    show_table,
    show_text,
    show_title,
    show_verbatim,
    styled,
    warn,
    wrapped,
)
