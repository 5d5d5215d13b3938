"""Whatever the bytes: a design, or a clean message. Never another exception, never a warning."""

import pytest
from hypothesis import given, settings, strategies as st

from sizes import examples
from stepwell.files import (
    DesignError,
    arena_text,
    arenas,
    dumps,
    load,
    loads,
    loads_arena,
    parameters,
    preset_text,
    presets,
)
from stepwell.files.arena import TABLES as ARENA_TABLES
from stepwell.files.schema import elements as schema
from stepwell.files.schema.chain import TABLES, LeverKeys
from stepwell.files.schema.elements import ElementKeys, LibraryKeys
from stepwell.files.schema.robot import TABLES as ROBOT_TABLES
from stepwell.mechanism import Chain
from stepwell.robot import Arena, Robot

KEYS = sorted({key for keys in TABLES.values() for key in keys.model_fields})
ROBOT_KEYS = sorted({key for keys in ROBOT_TABLES.values() for key in keys.names()})
ARENA_KEYS = sorted({key for keys in ARENA_TABLES.values() for key in keys.names()})
ROBOTS = [name for name in presets() if name.startswith("robot-")]
CHAINS = [name for name in presets() if name not in ROBOTS]
WORDS = [*KEYS, "x", "q_mmm", '"é"']
NUMBERS = ["0", "-0.0", "1", "-3", "10", "45", "90", "1e6", "1e-9", "28.5", "1e400", "nan", "-inf"]
OTHERS = ["true", '"rigid"', '"t"', "''", "1979-05-27", "07:32:00", "[]", "{}", "0xff", "9" * 30]
# What a file with good intentions holds: mostly the right kind of value behind each key.
NUMBER = st.sampled_from(NUMBERS) | st.floats(-50, 50).map(repr)
POINT = st.tuples(NUMBER, NUMBER).map(lambda xy: f"[{xy[0]}, {xy[1]}]")
TABLE = st.lists(POINT, max_size=3).map(lambda rows: f"[{', '.join(['[0, 0]', *rows])}]")
LISTS = st.sampled_from(["[1, 2, 3]", '["chain"]', '["leg.*.at_mm", "foot.x"]'])
ANYTHING = st.sampled_from([*NUMBERS, *OTHERS]) | POINT | TABLE


def pair(key: str) -> st.SearchStrategy[str]:
    kinds = {"p_mm": POINT, "q_mm": POINT, "title": st.just("'t'"), "name": st.just('"θ"')}
    table = key in ("table_mm_N", "shape_mm", "load_mm_N")
    likely = TABLE if table else kinds.get(key, NUMBER)
    likely = st.booleans().map(str).map(str.lower) if key == "two_sided" else likely
    return (likely | likely | likely | ANYTHING).map(lambda value: f"{key} = {value}")


def some(table: str, *, most: int) -> st.SearchStrategy[list[str]]:
    keys = sorted(
        key
        for key in TABLES[table].model_fields
        if f"{table}.{key}".lstrip(".") not in TABLES and key not in OF_CURVES | {"p_mm", "q_mm"}
    )
    likely = st.sampled_from(keys).flatmap(pair)
    odd = st.sampled_from(WORDS).flatmap(pair)
    return st.lists(likely | likely | likely | odd, max_size=most)


def inline(table: str) -> st.SearchStrategy[str]:
    return some(table, most=3).map(lambda lines: f"{{ {', '.join(lines)} }}")


COLUMNS = st.lists(NUMBER, min_size=1, max_size=6)
ASCENDING = st.lists(st.integers(-9, 99), min_size=2, max_size=6, unique=True)
OF_CURVES = ElementKeys.model_fields.keys() - LeverKeys.model_fields.keys()


@st.composite
def curves(draw) -> str:
    """The curve of an element, mostly one that it can have."""
    x = draw(ASCENDING.map(sorted) | COLUMNS)
    y = draw(st.lists(st.integers(-9, 9) | NUMBER, min_size=len(x), max_size=len(x)))
    keys = draw(st.sampled_from(list(schema.COLUMNS.values())))
    form = draw(st.sampled_from(["table", "points", "curve"]))
    columns = (f"{key} = [{', '.join(map(str, v))}]" for key, v in zip(keys, (x, y), strict=True))
    return f"{form} = {{ {', '.join(columns)} }}"


@st.composite
def elements(draw) -> str:
    """The keys of an element, mostly those that it can have."""
    name = draw(st.sampled_from([*LibraryKeys.model_fields]))
    of_library = some(f"chain.cell.{name}", most=3).map(lambda keys: f"{{ {', '.join(keys)} }}")
    form = draw(curves() | of_library.map(lambda keys: f"{name} = {keys}"))
    more = draw(st.sampled_from(["", "", "", "beside", "inside"]))
    if more == "inside":
        form = f"inside = [{{ {form} }}, {{ p_mm = [-10, 0], q_mm = [10, {draw(NUMBER)}] }}]"
    if more == "beside":
        form = f"beside = [{{ {form} }}, {{ {draw(curves())}, stops = true }}]"
    rest = [draw(st.sampled_from(["stops = true", "stops = [true, false]", "force_scale = 2"]))]
    others = st.lists(st.sampled_from(sorted(OF_CURVES)), max_size=1)
    rest += [draw(pair(key)) for key in draw(others)]
    return "\n".join([form, *rest])


@st.composite
def chains_of_elements(draw) -> str:
    cells = draw(st.lists(elements(), min_size=1, max_size=2))
    return "[chain]\n" + "\n".join(f"[[chain.cell]]\n{one}" for one in cells)


@st.composite
def documents(draw) -> str:
    lines = [*draw(some("", most=1)), "[chain]", *draw(some("chain", most=2))]
    lines += [f"band = {draw(inline('chain.band'))}"] * draw(st.booleans())
    for _ in range(draw(st.integers(1, 2))):
        lines += ["[[chain.cell]]", *draw(some("chain.cell", most=2))]
        lines += [f"band = {draw(inline('chain.cell.band'))}"] * draw(st.booleans())
        anchors = f"p_mm = [-10, 0], q_mm = {draw(POINT)}"
        if draw(st.booleans()):
            lines += anchors.replace("], ", "]\n").split("\n")
        else:
            lines += [f"bands = [{{ {anchors} }}, {{ {anchors} }}]"]
    return "\n".join(lines)


def check(text: str) -> None:
    try:
        chain = loads(text, "fuzz.toml").subject
    except DesignError as error:
        lines = str(error).split("\n")
        assert all(line.startswith("fuzz.toml: ") and line.isprintable() for line in lines)
        assert max(map(len, lines)) < 600
        return
    if isinstance(chain, Robot):
        assert loads(dumps(chain)).subject == chain
        assert parameters(chain)
    else:
        assert isinstance(chain, Chain)
        # What a file may say is physics: every force is a number, and it can be written again.
        assert all(0 <= cell.largest_force < float("inf") for cell in chain.cells)
        assert loads(dumps(chain)).subject == chain


@given(st.binary(max_size=400))
def test_any_bytes_in_a_file_end_in_a_clean_message(tmp_path_factory, content):
    file = tmp_path_factory.getbasetemp() / "fuzz.toml"
    file.write_bytes(content)
    with pytest.raises(DesignError) as caught:
        load(file)
    assert all(line.startswith(f"{file}: ") for line in str(caught.value).split("\n"))


@pytest.mark.slow
@given(st.text(max_size=200))
def test_any_text_ends_in_a_clean_message(text):
    with pytest.raises(DesignError):
        loads(text)


@pytest.mark.slow
@given(documents())
def test_any_toml_with_our_keys_ends_in_a_chain_or_a_clean_message(text):
    check(text)


@pytest.mark.slow
@given(chains_of_elements())
def test_any_toml_with_elements_ends_in_a_chain_or_a_clean_message(text):
    check(text)


@st.composite
def mutations(draw, texts: list[str], keys: list[str]) -> str:
    text = draw(st.sampled_from(texts))
    for _ in range(draw(st.integers(1, 4))):
        start = draw(st.integers(0, len(text)))
        stop = start + draw(st.integers(0, 12))
        piece = draw(
            st.sampled_from([*NUMBERS, *OTHERS, *keys, "\n", "=", "[", "]"]) | st.text(max_size=6)
        )
        text = text[:start] + piece + text[stop:]
    return text


@st.composite
def changed_values(draw, texts: list[str]) -> str:
    """A file with other numbers and words in it: still TOML most of the time."""
    lines = draw(st.sampled_from(texts)).splitlines()
    for _ in range(draw(st.integers(1, 4))):
        i = draw(st.integers(0, len(lines) - 1))
        if " = " in lines[i]:
            key = lines[i].split(" = ")[0]
            lines[i] = f"{key} = {draw(ANYTHING | LISTS)}"
        elif draw(st.booleans()):
            del lines[i]
    return "\n".join([*lines, ""])


CHAIN_TEXTS = [preset_text(name) for name in CHAINS]
ROBOT_TEXTS = [preset_text(name) for name in ROBOTS]
ARENA_TEXTS = [arena_text(name) for name in arenas()]
wrong_chains = mutations(CHAIN_TEXTS, KEYS)
wrong_robots = mutations(ROBOT_TEXTS, ROBOT_KEYS) | changed_values(ROBOT_TEXTS)
wrong_arenas = mutations(ARENA_TEXTS, ARENA_KEYS) | changed_values(ARENA_TEXTS)


@given(wrong_chains)
def test_any_small_change_to_a_preset_ends_in_a_chain_or_a_clean_message(text):
    check(text)


@given(wrong_robots)
def test_any_small_change_to_a_robot_ends_in_a_design_or_a_clean_message(text):
    check(text)


@given(wrong_arenas)
def test_any_small_change_to_an_arena_ends_in_an_arena_or_a_clean_message(text):
    check_arena(text)


@given(st.text("#oSG><^v. \nxc1", max_size=60).map(lambda rows: f"cell 80 mm\n{rows}"))
def test_any_map_ends_in_an_arena_or_a_clean_message(text):
    check_arena(text)


def check_arena(text: str) -> None:
    try:
        arena = loads_arena(text, "fuzz")
    except DesignError as error:
        lines = str(error).split("\n")
        assert all(line.startswith("fuzz: ") and line.isprintable() for line in lines)
        assert max(map(len, lines)) < 600
    else:
        assert isinstance(arena, Arena)
        assert loads_arena(dumps(arena)) == arena


@pytest.mark.slow
@settings(max_examples=examples(50, full=6000))
@given(wrong_robots)
def test_thousands_of_wrong_robots_end_in_a_design_or_a_clean_message(text):
    check(text)


@pytest.mark.slow
@settings(max_examples=examples(70, full=10_000))
@given(documents() | wrong_chains | chains_of_elements())
def test_thousands_of_wrong_files_end_in_a_chain_or_a_clean_message(text):
    check(text)
