"""Pictures of the studio for the pages: `python tests/docs/screenshots.py` takes them anew.

With a folder as argument it writes pictures of all sizes and schemes there, to be looked at.
Each carries in itself what could be read on the page when it was taken, so that a test can tell
whether it is still what a visitor sees.
"""

import io
import json
import sys
import tempfile
from pathlib import Path

from PIL import Image, PngImagePlugin
from playwright.sync_api import Browser, expect, sync_playwright

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "docs" / "img" / "studio"
SCHEMES = ("light", "dark")
SIZE = (1280, 800)
SIZES = (SIZE, (1920, 1080), (390, 844))
# What a visitor can press or read as a heading, in the order of the page.
LABELS = """
() => [...document.querySelectorAll("h1, h2, h3, button, [role=tab], [role=status][aria-label]")]
  .filter((one) => one.checkVisibility())
  .map((one) => (one.getAttribute("aria-label") ?? one.textContent).trim().replace(/\\s+/g, " "))
"""


def taken(browser: Browser, address: str, scheme: str, size: tuple[int, int] = SIZE) -> bytes:
    """The studio with the paper's forward leg, as a PNG that carries its labels."""
    wide, high = size
    page = browser.new_page(
        viewport={"width": wide, "height": high},
        color_scheme="dark" if scheme == "dark" else "light",
        reduced_motion="reduce",
    )
    page.goto(address)
    expect(page.get_by_role("status", name="sequence", exact=True)).to_be_visible()
    expect(page.locator("main")).to_have_attribute("aria-busy", "false", timeout=60_000)
    # What follows the design is asked after a rest.
    page.get_by_role("status", name="yield", exact=True).wait_for(timeout=120_000)
    expect(page.get_by_text("counting")).to_have_count(0, timeout=120_000)
    page.get_by_role("slider", name="Stroke").fill("70")
    page.evaluate("document.activeElement.blur()")
    page.wait_for_timeout(300)
    shown = page.evaluate(LABELS)
    shot = Image.open(io.BytesIO(page.screenshot()))
    page.close()
    told = PngImagePlugin.PngInfo()
    told.add_text("labels", json.dumps(shown))
    written = io.BytesIO()
    shot.convert("RGB").quantize(128).save(written, "PNG", optimize=True, pnginfo=told)
    return written.getvalue()


def labels(picture: bytes) -> list[str]:
    """What could be read on the page when a picture was taken."""
    with Image.open(io.BytesIO(picture)) as found:
        return json.loads(found.info["labels"])


if __name__ == "__main__":
    sys.path.insert(0, str(ROOT / "tests"))
    from chromium import CHROMIUM, QUIET
    from studio.browser import served

    into, sizes = (Path(sys.argv[1]), SIZES) if sys.argv[1:] else (FOLDER, (SIZE,))
    into.mkdir(parents=True, exist_ok=True)
    with (
        tempfile.TemporaryDirectory() as folder,
        served(Path(folder), "paper-forward") as studio,
        sync_playwright() as playwright,
    ):
        chromium = playwright.chromium.launch(executable_path=CHROMIUM, args=list(QUIET))
        for size in sizes:
            for one in SCHEMES:
                name = f"{one}-{size[0]}.png" if sys.argv[1:] else f"{one}.png"
                (into / name).write_bytes(taken(chromium, studio, one, size))
        chromium.close()
