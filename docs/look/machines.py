"""The gallery while MkDocs builds it: a card and a page of every machine, made and not written.

What each does was computed before, by tests/docs/machines.py, and stands in docs/gallery.
"""

import json
import re
from collections.abc import Iterator
from html import escape
from pathlib import Path
from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

from stepwell.files import preset_text
from stepwell.studio.standalone import motion_page

FOLDER = Path(__file__).resolve().parents[1] / "gallery"
HERE = "<!-- machines: one card of each, made by docs/look/machines.py -->"
# Which machines stand together, in this order; each in the first group that it fits.
GROUPS = {
    "Machines with a purpose": lambda one: one["program"],
    "Robots": lambda one: one["kind"] == "robot",
    "The paper's": lambda one: one["name"].startswith("paper-"),
    "Other things that snap": lambda one: one["element"],
    "Further than the paper": lambda one: True,
}
# What is at the end of its group.
LAST = ("robot-15",)
# When a picture stands still, as a share of its round.
STILL = 0.3

_ANIMATE = re.compile(r"<animate\w* [^>]*/>")
_NUMBER = re.compile(r"-?\d+(?:\.\d+)?")


def machines() -> list[dict[str, Any]]:
    """Every machine as docs/gallery has it."""
    found: list[dict[str, Any]] = json.loads((FOLDER / "machines.json").read_text("utf-8"))
    return found


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Beside each machine's picture: its page, its still, its design file, its replay."""
    for one in machines():
        name = one["name"]
        made = {
            f"{name}.md": page(one),
            f"{name}-still.svg": still((FOLDER / f"{name}.svg").read_text("utf-8")),
            f"{name}.toml": preset_text(name),
            f"{name}.html": replay(one),
        }
        for file, content in made.items():
            files.append(File.generated(config, f"gallery/{file}", content=content))
    return files


def on_page_markdown(markdown: str, page: Page, **_: Any) -> str:
    """The cards stand where the page of the gallery has its mark."""
    if page.file.src_uri == "gallery.md":
        if HERE not in markdown:
            raise PluginError(f"docs/gallery.md has lost its line {HERE}")
        return markdown.replace(HERE, "\n".join(cards(machines())))
    return markdown


def cards(listed: list[dict[str, Any]]) -> Iterator[str]:
    """All cards in their groups, as Markdown and HTML."""
    left = sorted(listed, key=lambda one: one["name"] in LAST)
    for title, fits in GROUPS.items():
        yield f'\n## {title}\n\n<div class="cards machines">'
        yield from (_card(one) for one in left if fits(one))
        yield "</div>"
        left = [one for one in left if not fits(one)]


def _card(one: dict[str, Any]) -> str:
    name, title = one["name"], escape(one["title"])
    return (
        f'<div class="card" id="{name}-card"><a href="{name}/">{_pictures(name, title, "")}</a>'
        f'<h3><a href="{name}/">{name}</a></h3><p>{title}</p>'
        f'<p class="ways"><a href="{name}.html">Replay</a> <a href="{name}/#studio">Studio</a> '
        f'<a href="{name}/#python">Python</a> <a href="{name}/#design-file">TOML</a></p></div>'
    )


def _pictures(name: str, title: str, folder: str) -> str:
    """What moves, and what is shown in its place to those who want no motion."""
    common = 'loading="lazy" width="480" height="300"'
    return (
        f'<img class="bare moves" src="{folder}{name}.svg" alt="{title}" {common}>'
        f'<img class="bare still" src="{folder}{name}-still.svg" alt="{title}" {common}>'
    )


def page(one: dict[str, Any]) -> str:
    """The page of a machine, as Markdown."""
    name, options, title = one["name"], one["options"], escape(one["title"])
    runs = "walk" if one["kind"] == "robot" else "run"
    programmed = f"$ stepwell program preset:{name}\n" if one["program"] else ""
    story = f"[What it is good for, and how surely it works](../gallery.md#{name})\n\n"
    return f"""---
title: {name}
description: {json.dumps(one["title"], ensure_ascii=False)}
hide:
  - navigation
search:
  boost: 0.1
---

# {name}

{title}

<iframe class="replay" name="plays" src="../{name}.html" title="{title}"
sandbox="allow-scripts"></iframe>

[Open it alone]({name}.html){{ .md-button .md-button--primary }}
[All machines](../gallery.md){{ .md-button }}

The replay is one file that needs no network: save it, mail it, open it anywhere.

{story if one["program"] else ""}## Studio

Drag its anchors, and everything follows:

```console
$ stepwell studio preset:{name}
```

Its numbers, and this replay, in the terminal:

```console
$ stepwell {runs} preset:{name}{options}
{programmed}$ stepwell replay preset:{name}{options} -o {name}.html
```

## Python

```python
{one["python"]}```

## Design file

Copy it, change it, and give its name wherever `preset:{name}` stands above.
[Save it as {name}.toml]({name}.toml)

```toml
{preset_text(name)}```
"""


def replay(one: dict[str, Any]) -> str:
    """The page that plays a machine, with the script and the styles of today."""
    data = (FOLDER / f"{one['name']}.motion").read_text("utf-8").strip()
    return motion_page(one["title"], one["version"], data)


def still(moving: str) -> str:
    """A moving picture at one instant."""
    parts: list[str] = []
    last = 0
    for found in re.finditer(r"(<(?:path|g) [^>]*>)((?:<animate\w* [^>]*/>)+)", moving):
        parts += [moving[last : found.start()], _held(found[1], found[2])]
        last = found.end()
    return _ANIMATE.sub("", "".join([*parts, moving[last:]]))


def _held(tag: str, animated: str) -> str:
    """The tag of a part as it is then."""
    for one in _ANIMATE.findall(animated):
        told = dict(re.findall(r'([\w-]+)="([^"]*)"', one))
        times = [float(time) for time in told["keyTimes"].split(";")]
        values = told["values"].split(";")
        k = max(i for i, time in enumerate(times) if time <= STILL)
        value = values[k]
        if told.get("calcMode") != "discrete" and k + 1 < len(values):
            share = (STILL - times[k]) / (times[k + 1] - times[k])
            ends = [float(number) for number in _NUMBER.findall(values[k + 1])]
            rest = iter(ends)

            def between(number: re.Match[str], rest: Any = rest, share: float = share) -> str:
                begin = float(number[0])
                return f"{begin + share * (next(rest) - begin):.1f}"

            value = _NUMBER.sub(between, value)
        name = told["attributeName"]
        if name == "transform":
            tag = tag.replace(">", f' transform="{told["type"]}({value})">')
        else:
            tag = re.sub(rf' {name}="[^"]*"', f' {name}="{value}"', tag)
    return tag
