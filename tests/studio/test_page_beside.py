"""Two designs side by side: what stands beside stays, at the same stroke."""

from stepwell import files
from studio.browser import compare, field, number, output, settled

from playwright.sync_api import Page, expect  # isort: skip


def cells_of(page: Page, row: str) -> list[str]:
    table = page.get_by_role("table", name="This design and the comparison")
    texts = table.get_by_role("row").filter(has_text=row).get_by_role("cell").all_inner_texts()
    return [text.replace("−", "-") for text in texts]


def typed(page: Page, value: object) -> None:
    field(page, "q", "outer", "x").fill(str(value))
    field(page, "q", "outer", "x").press("Enter")
    settled(page)


def test_a_design_stays_beside_the_one_that_comes_after_it(page: Page):
    page.get_by_role("button", name="Compare").click()
    before = number(page, "peak force")
    typed(page, 15)
    was, now, difference = map(float, cells_of(page, "Peak force"))
    assert was == before
    assert now == number(page, "peak force") != before
    cycles = [files.preset("paper-forward").cycle()]
    tables = files.tables_in(files.preset_text("paper-forward"))
    tables["chain"]["cell"][1]["q_mm"] = [15, 0]
    cycles.append(files.loads_tables(tables).chain.cycle())
    change = cycles[1].peak_force - cycles[0].peak_force
    assert difference == float(f"{change:.3g}")
    was, now, _ = cells_of(page, "Margin")
    assert float(now) == number(page, "margin") != float(was)
    assert page.get_by_text("dashed: the comparison").is_visible()


def test_both_are_drawn_at_the_same_stroke_and_on_the_same_way(page: Page):
    page.get_by_role("button", name="Compare").click()
    page.get_by_role("slider", name="Stroke").fill("60")
    drawings = [
        page.get_by_role("group", name=name)
        for name in ("The mechanism at the present stroke", "The comparison at the same stroke")
    ]
    blocks = [
        [rect.get_attribute("y") for rect in one.locator("rect.block").all()] for one in drawings
    ]
    assert blocks[0] == blocks[1]
    typed(page, 15)
    sides = [one.locator(".band").last.get_attribute("d") for one in drawings]
    assert sides[0] != sides[1]


def test_the_two_change_places_and_the_comparison_ends(page: Page):
    page.get_by_role("button", name="Compare").click()
    typed(page, 15)
    page.get_by_role("button", name="Swap").click()
    settled(page)
    assert field(page, "q", "outer", "x").input_value() == "20"
    compare(page)
    page.get_by_role("button", name="Undo").click()
    settled(page)
    assert field(page, "q", "outer", "x").input_value() == "15"
    page.get_by_role("button", name="End comparison").click()
    expect(page.get_by_role("table")).to_have_count(0)
    expect(output(page, "sequence")).to_be_visible()
