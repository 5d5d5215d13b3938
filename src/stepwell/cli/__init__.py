"""The stepwell command: one thin module per subcommand."""

from stepwell.cli.app import app, main

__all__ = ["app", "main"]
