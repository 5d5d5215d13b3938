"""The library as a table."""

import inspect
import re

import pytest

from stepwell import elements as library, files
from stepwell.mechanism import LIBRARY, Chain, Element


def test_every_element_of_the_library_is_in_its_table():
    offered = {one for one in library.__all__ if inspect.isfunction(getattr(library, one))}
    assert {entry.make.__name__ for entry in LIBRARY.values()} == offered
    assert list(LIBRARY) == [entry.make.__name__.replace("_", "-") for entry in LIBRARY.values()]


@pytest.mark.slow
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


@pytest.mark.slow
@pytest.mark.parametrize("name", LIBRARY)
def test_an_element_is_made_once_for_the_same_arguments(name):
    make = LIBRARY[name].make
    assert make() is make()
    assert make(name="a") is make(name="a") and make(name="a") != make(name="b")


@pytest.mark.slow
def test_an_element_of_other_arguments_is_another_one():
    assert library.curved_beam(height=0.005) is not library.curved_beam(height=0.006)
    assert library.trilinear([0.004, 1.0]) == library.trilinear((0.004, 1.0))  # pyright: ignore[reportArgumentType]
    with pytest.raises(ValueError, match=r"beams = 1\.5"):
        library.curved_beam(beams=1.5)  # pyright: ignore[reportArgumentType]
    with pytest.raises(TypeError, match="hight"):
        library.curved_beam(hight=0.005)  # pyright: ignore[reportCallIssue]


def test_a_shared_element_cannot_be_changed():
    (sheet,) = library.curved_beam().sheets
    with pytest.raises(ValueError, match="read-only"):
        sheet.rows[0, 0] = 1.0


@pytest.mark.slow
def test_a_change_of_one_element_in_the_studio_makes_no_other_again(monkeypatch):
    design = files.preset_text("curved-beam")
    files.loads(design)
    made: list[float] = []
    from_law = Element.from_law
    monkeypatch.setattr(
        Element, "from_law", lambda law, low, high, *rest, **more: made.append(high) or from_law(
            law, low, high, *rest, **more
        ),
    )  # fmt: skip
    changed = re.sub(r"thickness_mm = [\d.]+", "thickness_mm = 0.777", design, count=1)
    assert changed != design
    assert len(files.loads(changed).chain.cells) == 3 and len(made) == 1
