"""Time from a move of the pointer to the painted answer, frames a second, first paint, memory."""

import argparse
import json
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from inspect import unwrap
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from playwright.sync_api import Page

MOVES = 200
# Of a drag after which memory is looked at; 100000 take half an hour: `--moves 100000`.
LONG_DRAG = 2000
SERVE = """
import sys
from stepwell.files import preset_text, tables_in
from stepwell.studio.server import serve

if __name__ == "__main__":
    name = sys.argv[1]
    serve(tables_in(preset_text(name), name), opened=lambda address: print(address, flush=True))
"""
# Painted: the frame after the answer has been drawn and handed on.
WATCH = """
window.moved = 0; window.taken = [];
window.released = 0; window.repainted = [];
addEventListener("pointermove", (event) => { window.moved = event.timeStamp; }, true);
addEventListener("pointerup", (event) => { window.released = event.timeStamp; }, true);
const painted = (then) => requestAnimationFrame(() => {
  const { port1, port2 } = new MessageChannel();
  port1.onmessage = then;
  port2.postMessage(0);
});
const Plain = WebSocket;
window.WebSocket = class extends Plain {
  constructor(...given) {
    super(...given);
    this.began = new Map();
    this.addEventListener("message", ({ data }) => {
      const length = new DataView(data).getUint32(0, true);
      const header = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, length)));
      const fine = header.blocks.some(({ name, shape }) => name === "image" && shape[0] === 200);
      if (header.type === "map" && fine && window.released) {
        const began = window.released;
        window.released = 0;
        painted(() => window.repainted.push(performance.now() - began));
      }
      const began = this.began.get(header.seq);
      if (header.type !== "evaluate" || !began) return;
      painted(() => window.taken.push(performance.now() - began));
    });
  }
  send(text) {
    const { type, seq } = JSON.parse(text);
    if (type === "evaluate" && window.moved) this.began.set(seq, window.moved);
    super.send(text);
  }
};
"""
# The page's own rules forbid what Playwright would wait with.
ANSWERED = """
([k, name]) => new Promise((done) => {
  const look = () => (window[name].length > k ? done() : setTimeout(look, 3));
  look();
})
"""
FRAMES = """
() => new Promise((done) => {
  const times = [];
  requestAnimationFrame(function tick(now) {
    times.push(now);
    if (now - times[0] < 4000) requestAnimationFrame(tick);
    else done(((times.length - 1) * 1000) / (times.at(-1) - times[0]));
  });
})
"""
# A move a frame, which is faster than answers come; the drag itself began with a real pointer.
DRAG = """
async ([x, y, moves]) => {
  const dot = document.elementFromPoint(x, y).closest("[role=button]");
  for (let k = 0; k < moves; k += 1) {
    const to = { clientX: x + (k % 40) * 1.3 - 26, clientY: y + (k % 23) - 11, bubbles: true };
    dot.dispatchEvent(new PointerEvent("pointermove", { ...to, pointerId: 1, buttons: 1 }));
    await new Promise(requestAnimationFrame);
  }
}
"""
PAINT = "performance.getEntriesByName('first-contentful-paint')[0]?.startTime ?? NaN"


def rows(moves: int = LONG_DRAG) -> list[tuple[str, str, str]]:
    """What was timed, what came out, what is wanted."""
    answers = [answer(name) for name in ("curved-beam", "kresling", "balloon")]
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    if chromium is None:
        return [*answers, ("studio", "there is no chromium here", "")]
    pair, frames = measured(chromium, "paper-forward", "outer")
    five, _ = measured(chromium, "finger-selector", "little")
    six, _ = measured(chromium, "metachronal-wave", None)
    maps, space = repainted(chromium), turned(chromium)
    paint, server, page = grown(chromium, moves)
    return [
        *answers,
        ("studio: pointer move to painted frame, a pair", told(pair), "p50 28 ms, p95 45 ms"),
        ("studio: the same, five cells", told(five), "p95 60 ms"),
        ("studio: the same, six cells", told(six), ""),
        ("studio: release to a map of 200 x 200 repainted", told(maps), "80 ms"),
        ("studio: frames a second of play", f"{frames:.0f}", "60"),
        ("studio: frames a second of a robot in space, drawn by the processor", space, ""),
        ("studio: first paint", f"{paint:.0f} ms", "1000 ms"),
        (
            f"studio: memory after {moves} moves",
            f"server {server:+.1f} MB, page {page:+.1f} MB",
            "20 MB each after 100000",
        ),
    ]


def answer(preset: str) -> tuple[str, str, str]:
    """A message about a design whose elements are all new, against one whose elements are kept."""
    from stepwell import mechanism
    from stepwell.files import preset_text, tables_in
    from stepwell.studio.aside import answered
    from stepwell.studio.message import message_of

    design = tables_in(preset_text(preset), preset)
    text = json.dumps({"v": 1, "type": "evaluate", "seq": 1, "design": design})
    message = message_of(text, ("evaluate",))
    kept = mechanism.LIBRARY
    made = {name: replace(entry, make=unwrap(entry.make)) for name, entry in kept.items()}
    taken: dict[bool, list[float]] = {True: [], False: []}
    for _ in range(9):
        for new in (True, False):
            mechanism.LIBRARY = made if new else kept
            start = time.process_time()
            answered(message)
            taken[new].append(time.process_time() - start)
    before, after = (statistics.median(taken[new]) * 1e3 for new in (True, False))
    return (
        f"studio: an answer on {preset}, elements made again against kept, of processor time",
        f"{before:.0f} against {after:.0f} ms: {before / after:.1f} times",
        "-",
    )


def told(taken: list[float]) -> str:
    """The median and the slowest of twenty [ms]."""
    twentieths = statistics.quantiles(taken, n=20)
    return f"p50 {statistics.median(taken):.0f} ms, p95 {twentieths[-1]:.0f} ms"


def measured(chromium: str, preset: str, cell: str | None) -> tuple[list[float], float]:
    """Times of moves one after another [ms], and frames a second of play."""
    with opened(chromium, preset, WATCH) as (page, _):
        page.wait_for_timeout(1500)
        x, y = held(page, f"q of {cell}" if cell else "q of ")
        for k in range(MOVES):
            page.mouse.move(x + (k % 40) * 1.3 - 26, y + (k % 23) - 11)
            page.evaluate(ANSWERED, [k, "taken"])
            page.wait_for_timeout(7 + k % 13)
        page.mouse.up()
        taken = page.evaluate("window.taken")
        page.get_by_role("button", name="Play").click()
        frames = page.evaluate(FRAMES)
    return taken[20:], frames


def repainted(chromium: str) -> list[float]:
    """Times from a release of the pointer to a fine map of other parameters painted [ms]."""
    with opened(chromium, "paper-forward", WATCH) as (page, _):
        page.set_viewport_size({"width": 1280, "height": 1700})  # anchor and map both in view
        page.get_by_role("tab", name="Map").click()
        page.wait_for_timeout(3000)
        for k in range(24):
            x, y = held(page, "q of inner")
            page.mouse.move(x + (3 if k % 2 else -3), y, steps=3)
            page.wait_for_timeout(60)
            page.mouse.up()
            page.evaluate(ANSWERED, [k, "repainted"])
            page.wait_for_timeout(50)
        return page.evaluate("window.repainted")[4:]


def turned(chromium: str) -> str:
    """Frames a second while a walk is played in the plane and in space."""
    with opened(chromium, "robot-forward") as (page, _):
        page.get_by_role("spinbutton", name="Cycles to walk").fill("3")
        page.get_by_role("spinbutton", name="Cycles to walk").press("Enter")
        page.get_by_role("button", name="Walk", exact=True).click()
        page.get_by_role("status", name="advance").wait_for(timeout=120_000)
        page.get_by_role("slider", name="Time in the run").fill("0")
        page.get_by_role("button", name="Play the run").click()
        seen = page.locator("canvas[data-ready]").count()
        return f"{page.evaluate(FRAMES):.0f}" if seen else "there is no WebGL here"


def grown(chromium: str, moves: int) -> tuple[float, float, float]:
    """First paint [ms], and by how much server and page grow over a long drag [MB]."""
    with opened(chromium, "paper-forward") as (page, server):
        paint = page.evaluate(PAINT)
        inside = page.context.new_cdp_session(page)

        def sizes() -> tuple[float, float]:
            inside.send("HeapProfiler.collectGarbage")
            return resident(server), inside.send("Runtime.getHeapUsage")["usedSize"] / 1e6

        x, y = held(page, "q of outer")
        page.evaluate(DRAG, [x, y, 500])  # whatever is made once is made now
        before = sizes()
        page.evaluate(DRAG, [x, y, moves])
        after = sizes()
        page.mouse.up()
    return paint, after[0] - before[0], after[1] - before[1]


def resident(process: int) -> float:
    """Memory that a process holds [MB]; NaN where the system does not tell."""
    status = Path(f"/proc/{process}/status")
    found = re.search(r"VmRSS:\s+(\d+) kB", status.read_text()) if status.exists() else None
    return int(found[1]) * 1024 / 1e6 if found else float("nan")


def held(page: "Page", name: str) -> tuple[float, float]:
    """Where an anchor is, the pointer having taken hold of it."""
    dot = page.get_by_role("button", name=name).locator(".dot").last
    dot.evaluate("(element) => element.scrollIntoView({ block: 'center' })")
    box = dot.bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    return x, y


@contextmanager
def opened(chromium: str, preset: str, script: str = "") -> Iterator[tuple["Page", int]]:
    """A page on a studio of its own, with a script that runs before it; the server's process."""
    from playwright.sync_api import sync_playwright

    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        serve = Path(folder) / "serve.py"
        serve.write_text(SERVE)
        command = [sys.executable, str(serve), preset]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
            try:
                assert server.stdout is not None
                address = server.stdout.readline().strip()
                browser = playwright.chromium.launch(
                    executable_path=chromium, args=["--no-sandbox", "--disable-gpu"]
                )
                page = browser.new_page(viewport={"width": 1280, "height": 800})
                if script:
                    page.add_init_script(script)
                page.goto(address)
                page.get_by_role("status", name="sequence").wait_for()
                yield page, server.pid
                browser.close()
            finally:
                server.terminate()


if __name__ == "__main__":
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("--moves", type=int, default=LONG_DRAG, help="of the long drag")
    for what, found, wanted in rows(asked.parse_args().moves):
        print(f"{what}: {found} (wanted: {wanted})")
