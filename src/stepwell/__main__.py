"""What `stepwell` and `python -m stepwell` start."""

import os
import signal


def _leave(*_: object) -> None:
    os.write(2, b"Interrupted before anything was done.\n")
    os._exit(130)


def main() -> None:
    """Open the command line; until it is open, Ctrl-C ends the program at once."""
    signal.signal(signal.SIGINT, _leave)
    from stepwell.cli import main

    main()


if __name__ == "__main__":
    main()
