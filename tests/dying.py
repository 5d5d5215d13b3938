"""A call that marks a file and may die; its module is where every process of the tests finds it."""

import os
import signal
from pathlib import Path


def marked(name: str) -> None:
    """Touch the file of that name; one that ends in d kills its process, in i raises."""
    if name.endswith("d"):
        os.kill(os.getpid(), signal.SIGKILL)
    if name.endswith("i"):
        raise OSError("no room")
    Path(name).touch()
