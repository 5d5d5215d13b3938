"""Time from a move of the pointer to the painted answer, frames a second, first paint, memory."""

import argparse
import base64
import json
import os
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator
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
# Of a drag with each panel open.
FEW_MOVES = 150
# Between two moves, of which each is to be painted before the next one [s].
PAUSE = 0.07
SIZES = 2, 8, 32
TABS = "Graph", "Program", "Map", "Target", "Parts", "Measured", "Study", "Atlas"
SERVE = """
import sys
from stepwell.files import preset_text, tables_in
from stepwell.studio.server import serve

if __name__ == "__main__":
    name = sys.argv[1]
    design = tables_in(preset_text(name), name) if name else None
    serve(design, port=0, opened=lambda address: print(address, flush=True))
"""
# Painted: the frame after the answer has been drawn and handed on.
WATCH = """
window.moved = 0; window.taken = []; window.bounded = [];
window.released = 0; window.repainted = [];
for (const kind of ["pointermove", "pointerrawupdate"])
  addEventListener(kind, (event) => { window.moved = event.timeStamp; }, true);
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
      if (!began) return;
      const times = header.type === "evaluate" ? window.taken : window.bounded;
      painted(() => times.push(performance.now() - began));
    });
  }
  send(text) {
    const { type, seq, ask } = JSON.parse(text);
    const moves = (type === "evaluate" && ask.moves) || type === "limits";
    if (moves && window.moved) this.began.set(seq, window.moved);
    super.send(text);
  }
};
"""
# The page's own rules forbid what Playwright would wait with.
REPAINTED = """
(k) => new Promise((done) => {
  const look = () => (window.repainted.length > k ? done() : setTimeout(look, 3));
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
# When the first number is on the page, counted from when the page was asked for.
FIRST = """
window.first = 0;
const look = () => {
  if (document.querySelector("output[aria-label=sequence]")) window.first = performance.now();
  else requestAnimationFrame(look);
};
look();
"""
# From a key to all answered and kept.
KEYS = """
async (times) => {
  const dot = document.querySelector(".handle");
  const taken = [];
  for (let k = 0; k < times; k += 1) {
    const began = performance.now();
    const key = k % 2 ? "ArrowLeft" : "ArrowRight";
    dot.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
    do await new Promise((done) => setTimeout(done, 5));
    while (document.querySelector("main").getAttribute("aria-busy") !== "false");
    taken.push(performance.now() - began);
    await new Promise((done) => setTimeout(done, 300));
  }
  return taken;
}
"""
# The name of an anchor that is in view: of a long chain a part is drawn.
IN_VIEW = """
() => [...document.querySelectorAll(".drawing .handle")].find((one) => {
  const dot = one.querySelector(".dot").getBoundingClientRect();
  const [x, y] = [dot.x + dot.width / 2, dot.y + dot.height / 2];
  return document.elementFromPoint(x, y)?.closest(".handle") === one;
}).getAttribute("aria-label")
"""
PAINT = "performance.getEntriesByName('first-contentful-paint')[0]?.startTime ?? NaN"


def rows(moves: int = LONG_DRAG) -> list[tuple[str, str, str]]:
    """What was timed, what came out, what is wanted."""
    answers = [answer(name) for name in ("curved-beam", "kresling", "balloon")]
    chromium = browser()
    if not chromium:
        return [*answers, ("studio", "there is no chromium here", "")]
    pair, frames = measured(chromium, "paper-forward", "outer")
    five, _ = measured(chromium, "finger-selector", "little")
    six, _ = measured(chromium, "metachronal-wave", None)
    maps, space = repainted(chromium), turned(chromium)
    paint, server, page = grown(chromium, moves)
    return [
        *answers,
        *firsts(chromium),
        *sized(chromium),
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
        taken = moved(page, f"q of {cell}" if cell else "q of ", MOVES)
        page.get_by_role("button", name="Play").click()
        frames = page.evaluate(FRAMES)
    return taken[20:], frames


def chain_of(cells: int) -> dict[str, object]:
    """The tables of a chain of lever cells that switch one after another."""
    band = {"stiffness_N_per_m": 28.5, "rest_length_mm": 10}
    listed = [{"p_mm": [-10, 0], "q_mm": [10 + 10 * k / cells, 0]} for k in range(cells)]
    return {"chain": {"lever_mm": 16, "limit_deg": 45, "band": band, "cell": listed}}


def firsts(chromium: str) -> Iterator[tuple[str, str, str]]:
    """Time to the first number, with compiled kernels on disk and without any."""
    for kind, wanted in (("warm cache", "1500 ms"), ("fresh install", "4000 ms")):
        taken: list[float] = []
        for _ in range(3):
            with tempfile.TemporaryDirectory() as empty:
                fresh = {"NUMBA_CACHE_DIR": empty} if kind == "fresh install" else {}
                with opened(chromium, "paper-forward", FIRST, environment=fresh) as (page, _):
                    taken.append(page.evaluate("window.first"))
        text = f"median {statistics.median(taken):.0f} ms, longest {max(taken):.0f} ms, {load()}"
        yield f"studio: first number, {kind}", text, wanted


def sized(chromium: str, sizes: Iterable[int] = SIZES) -> Iterator[tuple[str, str, str]]:
    """Moves with each panel open, keys with two of them, and frames of play, by cells."""
    for cells in sizes:
        with opened(chromium, "", WATCH, design=chain_of(cells)) as (page, _):
            page.wait_for_timeout(4000)
            page.locator(".drawing").first.evaluate("(one) => one.scrollIntoView()")
            for tab in TABS:
                page.get_by_role("tab", name=tab).click()
                page.wait_for_timeout(1500)
                taken = moved(page, page.evaluate(IN_VIEW), FEW_MOVES)
                limits = page.evaluate("window.bounded")
                text = f"{told(taken[5:])}, with margins {told(limits[5:])}, {load()}"
                what = f"studio: pointer move to painted frame, {cells} cells, panel {tab}"
                yield what, text, "p95 40 ms"
            for tab in ("Graph", "Measured"):
                page.get_by_role("tab", name=tab).click()
                page.wait_for_timeout(1500)
                text = told(page.evaluate(KEYS, 12)[2:])
                yield f"studio: key to all kept, {cells} cells, panel {tab}", text, "-"
            # An edit has a yield counted in the background for some seconds.
            counting = page.get_by_text("counting")
            for beside, wanted in (", while a yield is counted", "-"), ("", "60"):
                if not beside:
                    counting.wait_for(state="hidden", timeout=120_000)
                page.get_by_role("button", name="Play", exact=True).click()
                text = f"{page.evaluate(FRAMES):.0f}, {load()}"
                page.get_by_role("button", name="Pause", exact=True).click()
                yield f"studio: frames a second of play, {cells} cells{beside}", text, wanted


def browser() -> str:
    """The system's own Chromium, with windows or without; nothing where there is none."""
    names = "chromium", "chromium-browser", "chromium-headless-shell"
    return next(filter(None, map(shutil.which, names)), "")


def additions() -> float:
    """The time of 10^7 additions [s], to compare machines."""
    began, total = time.process_time(), 0
    for k in range(10_000_000):
        total += k
    return time.process_time() - began


def load() -> str:
    """How many processes want a core, for those who compare times."""
    return f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores"


def moved(page: "Page", name: str, moves: int) -> list[float]:
    """Times of moves of an anchor one after another [ms]."""
    page.evaluate("window.taken = []; window.bounded = []")
    x, y = held(page, name)
    for k in range(moves):
        page.mouse.move(x + (k % 40) * 1.3 - 26, y + (k % 23) - 11)
        # Whatever asks the page whether it is done takes its time from what is measured.
        time.sleep(PAUSE + 1e-3 * (k % 13))
    page.wait_for_timeout(500)
    page.mouse.up()
    return page.evaluate("window.taken")


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
            page.evaluate(REPAINTED, k)
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
    # "p of cell 1" is also the beginning of "p of cell 10", which may be out of view.
    exact = page.get_by_role("button", name=name, exact=True)
    found = exact if exact.count() else page.get_by_role("button", name=name)
    dot = found.locator(".dot").last
    dot.evaluate("(element) => element.scrollIntoView({ block: 'center' })")
    box = dot.bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    return x, y


@contextmanager
def opened(
    chromium: str,
    preset: str,
    script: str = "",
    *,
    design: dict[str, object] | None = None,
    environment: dict[str, str] | None = None,
) -> Iterator[tuple["Page", int]]:
    """A page on a studio of its own, with a script that runs before it; the server's process."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        command = [sys.executable, "-c", SERVE, preset]
        around = os.environ | (environment or {})
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=around) as server:
            try:
                assert server.stdout is not None
                address = server.stdout.readline().strip()
                if design is not None:
                    text = base64.urlsafe_b64encode(json.dumps(design).encode()).decode()
                    address += f"#design={text.rstrip('=')}"
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


def main() -> None:
    """Print all rows, or those of some sizes."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--moves", type=int, default=LONG_DRAG, help="of the long drag")
    parser.add_argument("--first", action="store_true", help="only the time to the first number")
    parser.add_argument("--cells", type=int, nargs="*", help="only each panel at these sizes")
    given = parser.parse_args()
    chromium = browser()
    if not chromium:
        sys.exit("there is no chromium here")
    shown: Iterable[tuple[str, str, str]] = sized(chromium, given.cells) if given.cells else ()
    if given.first:
        shown = firsts(chromium)
    print(f"machine: 10^7 additions of Python in {additions():.2f} s, {load()}", flush=True)
    for what, found, wanted in shown or rows(given.moves):
        print(f"{what}: {found} (wanted: {wanted})", flush=True)


if __name__ == "__main__":
    main()
