"""A page in a browser: what its tests share."""

import base64
import json
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from chromium import Opened as Opened, needed
from stepwell import files
from stepwell.mechanism import Chain

SERVE = """
import sys
from pathlib import Path
from stepwell.files import preset_text, tables_in
from stepwell.studio.server import serve

if __name__ == "__main__":
    name, port = sys.argv[1], int(sys.argv[2])
    design = tables_in(preset_text(name), name) if name else None
    studies = Path(__file__).with_name("studies")
    serve(
        design, port=port, studies=studies, opened=lambda address: print(address, flush=True)
    )
"""

# What rests before it is asked or kept rests for a moment: no number depends on how long.
HASTY = """
const later = window.setTimeout;
window.setTimeout = (call, ms, ...more) => later(call, ms > 100 && ms < 500 ? 40 : ms, ...more);
"""
# What processes of their own compute unasked, of an atlas that which comes with Stepwell.
LONG = "yield", "predict", "thumbnails", "atlas"
# The view in space takes a core where there is no graphics processor.
FLAT = """
const { getContext } = HTMLCanvasElement.prototype;
HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
  return kind === "webgl2" ? null : getContext.call(this, kind, ...more);
};
"""
# Of what a page asks, how much has no answer yet.
COUNTED = """
const said = WebSocket.prototype.send, asked = new Map(), heard = new WeakSet();
window.unanswered = () => asked.size;
WebSocket.prototype.send = function (message) {
  if (!heard.has(this)) {
    heard.add(this);
    this.addEventListener("message", ({ data }) => {
      const length = new DataView(data).getUint32(0, true);
      const head = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, length)));
      const last = !head.progress && !head.part;
      if (last && asked.get(head.type) === head.seq) asked.delete(head.type);
    });
  }
  const { type, seq } = JSON.parse(message);
  if (type !== "cancel") asked.set(type, seq);
  said.call(this, message);
};
"""
ANSWERED = """async (most) => {
  const end = performance.now() + most;
  do await new Promise((done) => setTimeout(done, 50));
  while (unanswered() && performance.now() < end);
}"""
# What stands in the fields of these names, and in the places where something is told.
VALUES = """(names) =>
  names.map((name) => document.querySelector(`input[aria-label=${JSON.stringify(name)}]`).value)
"""
SHOWN = """(names) => {
  const output = (name) =>
    document.querySelector(`:is(output, input[type="text"])[aria-label=${JSON.stringify(name)}]`);
  return names.map((name) => output(name).value || output(name).innerText);
}"""
# A drag is read once a frame.
SETTLED = """async () => {
  const frame = () => new Promise((done) => setTimeout(done, 16));
  const end = performance.now() + 30_000;
  for (let k = 0; k < 3; k += 1) await frame();
  while (document.querySelector("main")?.getAttribute("aria-busy") !== "false") {
    if (performance.now() > end) throw new Error("what was changed is not answered or not kept");
    await frame();
  }
}"""

needed("starlette", "uvicorn", "websockets")

from playwright.sync_api import Frame, Locator, Page, expect  # noqa: E402, where it is missing the tests are skipped above

# A busy machine is no failure.
expect.set_options(timeout=30_000)


@contextmanager
def served(folder: Path, preset: str, port: int = 0) -> Iterator[str]:
    """The address of a studio that begins with a preset, or with the gallery.

    It keeps studies in the folder `studies` of this one.
    """
    script = folder / "serve.py"
    script.write_text(SERVE)
    command = [sys.executable, str(script), preset, str(port)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
        assert server.stdout is not None
        try:
            yield server.stdout.readline().strip()
        finally:
            # How it ends by itself is tested where servers are; here it would first have to begin.
            server.kill()


def without(*kinds: str) -> str:
    """A script that has a page never ask for what takes long: of LONG these, by default all."""
    return f"""
const send = WebSocket.prototype.send;
WebSocket.prototype.send = function (message) {{
  const {{ type, ask }} = JSON.parse(message);
  if (!{json.dumps(kinds or LONG)}.includes(type) || ask.name) send.call(this, message);
}};
"""


def leave(page: Page) -> None:
    """Leave the studio from within: the browser keeps the process and what it compiled there."""
    with page.expect_navigation(url="about:blank"):
        page.evaluate("() => void setTimeout(() => location.replace('about:blank'))")


def link(address: str, design: str | dict[str, Any]) -> str:
    """The address of a page of the studio with a preset or tables, which it holds itself."""
    named = isinstance(design, str)
    text = json.dumps(files.tables_in(files.preset_text(design), design) if named else design)
    return f"{address}#design={base64.urlsafe_b64encode(text.encode()).decode().rstrip('=')}"


def begun(page: Page, address: str, design: str | dict[str, Any]) -> Page:
    """A page that shows something else, now with a preset or tables, answered and kept."""
    page.goto(link(address, design))
    output(page, "sequence").wait_for()
    settled(page)
    return page


def opens(offline: Opened, folder: Path, text: str) -> Page:
    """The page of a text that is opened from a file."""
    file = folder / "page.html"
    file.write_text(text, "utf-8")
    offline.page.goto(file.as_uri())
    return offline.page


def output(page: Page | Frame, name: str):
    return page.get_by_role("status", name=name, exact=True)


def number(page: Page, name: str) -> float:
    return float(output(page, name).inner_text().replace("−", "-"))


def numbers(page: Page, *names: str) -> list[float]:
    """Several at once: each word to a browser takes as long as all of them."""
    return [float(text.replace("−", "-")) for text in page.evaluate(SHOWN, names)]


def shown_as(value: float) -> float:
    return float(f"{value:.4g}")


def field(page: Page, anchor: str, cell: str, axis: str):
    return page.get_by_role("spinbutton", name=f"{anchor} of {cell}, {axis} in mm")


def handle(page: Page, anchor: str, cell: str):
    return page.get_by_role("button", name=f"{anchor} of {cell}", exact=True)


def anchors(page: Page, cell: str) -> list[list[float]]:
    """p and q."""
    names = [f"{anchor} of {cell}, {axis} in mm" for anchor in "pq" for axis in "xy"]
    field(page, "p", cell, "x").wait_for()
    px, py, qx, qy = map(float, page.evaluate(VALUES, names))
    return [[px, py], [qx, qy]]


def chain_shown(page: Page) -> Chain:
    """The chain that Python makes of the anchors that the page shows."""
    design = files.tables_in(files.preset_text("paper-forward"), "paper-forward")
    for cell in design["chain"]["cell"]:
        cell["p_mm"], cell["q_mm"] = anchors(page, cell["name"])
    text = f"[chain]\nlever_mm = {design['chain']['lever_mm']}\nlimit_deg = 45\n"
    text += "band = { stiffness_N_per_m = 28.5, rest_length_mm = 10 }\n"
    for cell in design["chain"]["cell"]:
        text += f"[[chain.cell]]\nname = {json.dumps(cell['name'])}\n"
        text += f"p_mm = {cell['p_mm']}\nq_mm = {cell['q_mm']}\n"
    return files.loads(text).chain


def compare(page: Page) -> None:
    """Every number on the page with the one that Python gives."""
    from stepwell.studio.motion import drawn

    chain = chain_shown(page)
    cycle, margin = chain.cycle(), chain.margin()
    expect(output(page, "sequence")).to_have_attribute("data-value", str(cycle.sequence))
    assert number(page, "peak force") == shown_as(cycle.peak_force)
    assert number(page, "dissipated") == shown_as(cycle.dissipated * 1e3)
    assert number(page, "margin") == shown_as(min(margin.anchors) * 1e3)
    path = drawn(cycle.path)
    slider = page.get_by_role("slider", name="Stroke")
    for k in (0, 40, len(path.drive) - 20):
        slider.fill(str(k))
        shown = numbers(page, "stroke", "force", *(f"travel of {name}" for name in chain.names))
        assert shown == [
            shown_as(path.stroke[k] * 1e3),
            shown_as(path.force[k]),
            *(shown_as(travel * 1e3) for travel in path.travel[k]),
        ]


def settled(page: Page) -> None:
    """All that was changed is answered and kept."""
    page.evaluate(SETTLED)


def middle(locator: Locator) -> tuple[float, float]:
    """Where the middle of something is, in view and not behind the bar at the bottom."""
    locator.evaluate("(element) => element.scrollIntoView({ block: 'center' })")
    box = locator.bounding_box()
    assert box is not None
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def drag(page: Page, anchor: str, cell: str, dx: int, dy: int) -> None:
    # Before its first answer is drawn the page may move what is aimed at.
    settled(page)
    dot = handle(page, anchor, cell).locator(".dot")
    x, y = middle(dot)
    while (again := middle(dot)) != (x, y):
        x, y = again
    page.mouse.move(x, y)
    page.mouse.down()
    for k in range(1, 11):
        page.mouse.move(x + dx * k / 10, y + dy * k / 10)
    page.mouse.up()
    settled(page)
