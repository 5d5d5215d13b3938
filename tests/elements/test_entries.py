"""The library as a table."""

import inspect

import pytest

from stepwell import elements as library
from stepwell.elements import LIBRARY
from stepwell.mechanism import Chain


def test_every_element_of_the_library_is_in_its_table():
    offered = {one for one in library.__all__ if inspect.isfunction(getattr(library, one))}
    assert {entry.make.__name__ for entry in LIBRARY.values()} == offered
    assert list(LIBRARY) == [entry.make.__name__.replace("_", "-") for entry in LIBRARY.values()]


@pytest.mark.parametrize("name", LIBRARY)
def test_an_element_without_arguments_snaps_and_fits_in_a_chain(name):
    entry = LIBRARY[name]
    element = entry.make()
    assert len(element.phases) == 2
    assert element == entry.make(**entry.defaults)
    assert entry.make(name="mine").name == "mine"
    assert Chain([element, element]).cells == (element, element)


@pytest.mark.parametrize("name", LIBRARY)
def test_an_entry_speaks_in_lines(name):
    entry = LIBRARY[name]
    for line in (entry.what, entry.assumes, entry.source):
        assert line and "\n" not in line and not line.endswith(".") and len(line) < 100
    assert entry.source.rsplit(" ", 1)[0] in " ".join((inspect.getdoc(entry.make) or "").split())
