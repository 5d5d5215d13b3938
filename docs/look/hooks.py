"""What is done to pages while MkDocs builds them: formulas, the sources' address, search, files."""

import html
import json
import os
import re
import tomllib
from pathlib import Path
from typing import Any

from latex2mathml.converter import convert
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

from stepwell.accounts import schema_kinds, schema_of

ROOT = Path(__file__).resolve().parents[2]

# Signs that sources hold as they are, for they read better; the converter knows them by name.
SIGNS = {
    "≤": r"\le ",
    "≥": r"\ge ",
    "·": r"\cdot ",
    "∓": r"\mp ",
    "±": r"\pm ",
    "≺": r"\prec ",
    "∈": r"\in ",
    "µ": "μ",
}
# Names of functions, and what comes right before or after one without a sign between them.
_NAMED = "<mi>(?:sin|cos|tan|exp|max|min)</mi>"
_THIN = '<mspace width="0.167em" />'

# Who searches wants to do a thing first, then to know why it is so, then why it was built so.
BOOST = {
    "glossary": 4.0,
    "tutorial": 2.5,
    "how-to/": 2.0,
    "lessons": 2.0,
    "index": 2.0,
    "api": 0.3,
    "decisions/": 0.2,
}


# On these pages s_i is a symbol with an index; elsewhere what has a low line is a name in the code.
SYMBOLIC = ("theory.md", "robot-theory.md")
_WHOLE = re.compile(r"(<(pre|code|math|script)\b.*?</\2>|<[^>]+>)", re.S)
_INDEXED = re.compile(r"(?<![\w.])(\w)_(?:(\w)(?!\w)|\{([^}]+)\})")
# Code in a sentence, and a word in it that a line would be broken in.
_CODE = re.compile(r"<code>[^<]*</code>")
_BREAKABLE = re.compile(r"(?<![^\s>])(?:--?[\w-]{1,22}|'[^\s']{1,22}')(?![^\s<])")
_UNBROKEN = r'<span class="whole">\g<0></span>'
_SEARCH = 'data-md-component="search" role="dialog" aria-label="Search box"'


def formula(source: str, *_: Any, **__: Any) -> str:
    """A displayed formula as MathML, from LaTeX in a block marked math.

    It may break where the source has a quad; what is still too wide scrolls within itself.
    """
    parts = [_mathml(part) for part in re.split(r"\\q?quad\b", source)]
    group = '<div class="formula" role="group" aria-label="formula" tabindex="0">'
    return f"{group}{''.join(parts)}</div>"


def _mathml(source: str) -> str:
    text = source.strip()
    for sign, name in SIGNS.items():
        text = text.replace(sign, name)
    try:
        made = convert(text, display="block")
    except Exception as wrong:
        raise PluginError(f"This formula cannot be typeset: {wrong!r}\n{source}") from wrong
    if "<mi>&</mi>" in made or re.search(r"<m[io]>\\\w+</m[io]>", made):
        raise PluginError(f"This formula has something that cannot be typeset:\n{source}")
    # A name is no operator, and stands apart from the symbol it is applied to.
    made = re.sub("<mo>(max|min)</mo>", r"<mi>\1</mi>", made)
    made = re.sub(f"({_NAMED})(?=<m(?:i|sub|sup|n|row)>)", rf"\1{_THIN}", made)
    made = re.sub(f"(</m(?:i|n|sub|sup|frac|row)>)(?={_NAMED})", rf"\1{_THIN}", made)
    # A full stop ends the sentence and not a number.
    made = made.replace("<mo>.</mo></mrow></math>", "<mtext>.</mtext></mrow></math>")
    said = html.escape(re.sub(r"\s+", " ", source.strip()), quote=True)
    return made.replace("<math ", f'<math alttext="{said}" ', 1)


def address(variable: str, name: str) -> str:
    """The address in an environment variable, else the one under [project.urls], else ''."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    return (os.environ.get(variable) or project.get("urls", {}).get(name, "")).rstrip("/")


def repository() -> str:
    """The address of the sources."""
    return address("STEPWELL_REPOSITORY", "Repository")


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Blocks marked math are formulas; the addresses of sources and site are used if known.

    The page for a missing address, 404.html, begins its links at the path of the site's address,
    or at / without one.
    """
    config.mdx_configs.setdefault("pymdownx.superfences", {})["custom_fences"] = [
        {"name": "math", "class": "formula", "format": formula}
    ]
    if sources := repository():
        config.repo_url = sources
        config.repo_name = "/".join(sources.split("/")[-2:])
    if site := address("STEPWELL_SITE", "Documentation"):
        config.site_url = f"{site}/"
    return config


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """The JSON Schema of every result, as `stepwell schema` prints it: generated, not committed."""
    for kind in schema_kinds():
        text = json.dumps(schema_of(kind), indent=2) + "\n"
        files.append(File.generated(config, f"schema/{kind}.json", content=text))
    return files


def on_page_markdown(markdown: str, page: Page, **_: Any) -> str:
    """How early a page comes among what a search finds, unless the page itself says so."""
    for start, boost in BOOST.items():
        if page.file.src_uri.startswith(start):
            page.meta.setdefault("search", {}).setdefault("boost", boost)
    return markdown


def on_page_content(html: str, page: Page, **_: Any) -> str:
    """Options in code are not broken; symbols have their index below the line on some pages."""
    html = _CODE.sub(lambda code: _BREAKABLE.sub(_UNBROKEN, code[0]), html)
    if page.file.src_uri not in SYMBOLIC:
        return html
    made, last = [], 0
    for kept in _WHOLE.finditer(html):
        made += [_lowered(html[last : kept.start()]), kept[0]]
        last = kept.end()
    return "".join([*made, _lowered(html[last:])])


def on_post_page(output: str, **_: Any) -> str:
    """The box of the search has a name for those who hear the page."""
    return output.replace('data-md-component="search" role="dialog"', _SEARCH)


def on_post_template(output_content: str, template_name: str, **_: Any) -> str:
    """The same on the page for a missing address."""
    return on_post_page(output_content) if template_name == "404.html" else output_content


def _lowered(text: str) -> str:
    return _INDEXED.sub(lambda found: f"{found[1]}<sub>{found[2] or found[3]}</sub>", text)
