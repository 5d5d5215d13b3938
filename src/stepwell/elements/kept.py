"""Elements of the library kept by the arguments that they were made of."""

from collections.abc import Callable
from functools import lru_cache, wraps
from typing import ParamSpec

from stepwell.mechanism import Element

P = ParamSpec("P")

# A curve is a few kilobytes; of more elements the one that was asked for longest ago is made again.
_MOST = 256


def kept(make: Callable[P, Element]) -> Callable[P, Element]:
    """The same function, which makes an element of the same arguments once.

    An element cannot be changed, so all who ask for it may share it. A law that is fitted with
    cubics takes up to a tenth of a second, and a page asks for all elements of its design again
    after every change of one number.
    """
    # 1, 1.0 and True are the same key but not the same argument.
    known = lru_cache(_MOST, typed=True)(make)

    @wraps(make)
    def element(*args: P.args, **kwargs: P.kwargs) -> Element:
        try:
            return known(*args, **kwargs)
        except TypeError:  # a list has no hash, and a wrong argument is told by the function itself
            return make(*args, **kwargs)

    return element
