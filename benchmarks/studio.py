"""Time from a move of the pointer to the painted answer, and frames a second of play."""

import shutil
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

MOVES = 200
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
addEventListener("pointermove", (event) => { window.moved = event.timeStamp; }, true);
const Plain = WebSocket;
window.WebSocket = class extends Plain {
  constructor(...given) {
    super(...given);
    this.began = new Map();
    this.addEventListener("message", ({ data }) => {
      const length = new DataView(data).getUint32(0, true);
      const { type, seq } = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, length)));
      const began = this.began.get(seq);
      if (type !== "evaluate" || !began) return;
      requestAnimationFrame(() => {
        const { port1, port2 } = new MessageChannel();
        port1.onmessage = () => window.taken.push(performance.now() - began);
        port2.postMessage(0);
      });
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
(k) => new Promise((done) => {
  const look = () => (window.taken.length > k ? done() : setTimeout(look, 3));
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


def rows() -> list[tuple[str, str, str]]:
    """What was timed, what came out, what is wanted."""
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    if chromium is None:
        return [("studio", "there is no chromium here", "")]
    pair, frames = measured(chromium, "paper-forward", "outer")
    five, _ = measured(chromium, "metachronal-wave", None)
    return [
        ("studio: pointer move to painted frame, a pair", told(pair), "p50 28 ms, p95 45 ms"),
        ("studio: the same, metachronal-wave", told(five), "p95 60 ms for five cells"),
        ("studio: frames a second of play", f"{frames:.0f}", "60"),
    ]


def told(taken: list[float]) -> str:
    """The median and the slowest of twenty [ms]."""
    twentieths = statistics.quantiles(taken, n=20)
    return f"p50 {statistics.median(taken):.0f} ms, p95 {twentieths[-1]:.0f} ms"


def measured(chromium: str, preset: str, cell: str | None) -> tuple[list[float], float]:
    """Times of moves one after another [ms], and frames a second of play."""
    from playwright.sync_api import sync_playwright

    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        script = Path(folder) / "serve.py"
        script.write_text(SERVE)
        command = [sys.executable, str(script), preset]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
            assert server.stdout is not None
            address = server.stdout.readline().strip()
            browser = playwright.chromium.launch(
                executable_path=chromium, args=["--no-sandbox", "--disable-gpu"]
            )
            page = browser.new_page(viewport={"width": 1280, "height": 800})
            page.add_init_script(WATCH)
            page.goto(address)
            page.get_by_role("status", name="sequence").wait_for()
            page.wait_for_timeout(1500)
            name = f"q of {cell}" if cell else "q of "
            dot = page.get_by_role("button", name=name).locator(".dot").last
            box = dot.bounding_box()
            assert box is not None
            x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
            page.mouse.move(x, y)
            page.mouse.down()
            for k in range(MOVES):
                page.mouse.move(x + (k % 40) * 1.3 - 26, y + (k % 23) - 11)
                page.evaluate(ANSWERED, k)
                page.wait_for_timeout(7 + k % 13)
            page.mouse.up()
            taken = page.evaluate("window.taken")
            page.get_by_role("button", name="Play").click()
            frames = page.evaluate(FRAMES)
            browser.close()
            server.terminate()
    return taken[20:], frames


if __name__ == "__main__":
    for what, found, wanted in rows():
        print(f"{what}: {found} (wanted: {wanted})")
