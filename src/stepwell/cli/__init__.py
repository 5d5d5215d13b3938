"""The stepwell command: one thin function per subcommand."""

from stepwell.cli.app import app, main

__all__ = ["app", "main"]
