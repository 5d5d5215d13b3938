"""Plain technical English: words that no text of the project uses, and the length of sentences.

The rules are those of CONTRIBUTING.md, "Style". Words that a program can find are listed here with
the term to use instead.
"""

import io
import re
import tokenize
from collections import Counter
from pathlib import Path

import pytest

from docs.pages import ROOT

# Each word that no page, help text, docstring or comment may have, and what to write instead.
WORDS = {
    r"nobody|somebody|whoever": "the condition, such as 'if a display is available'",
    r"anew": "again; 're-' as in 'recompute'",
    r"by lot": "at random",
    r"for want of": "without",
    r"told|tells?|telling": "report, print, contain, identify",
    r"killer": "critical change",
}
# Identifiers in src of both words together.
MOST_IDENTIFIERS = 300
# Sentences of more than 30 words in all pages for users, of how many there are.
LONGEST = 30
MOST_LONG = 65
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
# These quote or list what other files have, or are written by programs.
FREE = {"decisions", "look"}
# Names of columns in stores that exist.
STORED = {'"told"'}
SOURCES = sorted((ROOT / "src" / "stepwell").rglob("*.py"))
_CODE = re.compile(
    r"^---\n.*?^---$|^```.*?^```$|^ {4}.*?$|`[^`\n]*`|<!--.*?-->|<[^>]+>", re.M | re.S
)


def prose(page: Path) -> str:
    """The text of a page without code, tags and addresses."""
    text = _CODE.sub(" ", page.read_text("utf-8"))
    return re.sub(r"\]\([^)]*\)", "]", text)


def users() -> list[Path]:
    return [page for page in PAGES if not FREE & set(page.parts)]


def told_words(text: str) -> list[str]:
    return [match[0] for word in WORDS for match in re.finditer(rf"\b(?:{word})\b", text, re.I)]


@pytest.mark.parametrize("page", users(), ids=lambda page: page.relative_to(ROOT).as_posix())
def test_no_page_has_a_word_of_the_list(page):
    assert told_words(prose(page)) == []


def comments_and_texts(source: Path) -> str:
    """Comments and strings of a file, without names in code."""
    kinds = (tokenize.COMMENT, tokenize.STRING)
    tokens = tokenize.generate_tokens(io.StringIO(source.read_text("utf-8")).readline)
    texts = (one.string for one in tokens if one.type in kinds and one.string not in STORED)
    return "\n".join(re.sub(r"`[^`\n]*`", " ", text) for text in texts)


def test_no_comment_docstring_or_message_of_the_source_has_a_word_of_the_list():
    found = {
        source.relative_to(ROOT).as_posix(): words
        for source in SOURCES
        if (words := told_words(comments_and_texts(source)))
    }
    assert found == {}


def test_identifiers_are_nouns_and_verbs_of_the_field():
    names = Counter(
        token.string
        for source in SOURCES
        for token in tokenize.generate_tokens(io.StringIO(source.read_text("utf-8")).readline)
        if token.type == tokenize.NAME
    )
    assert names["told"] + names["found"] <= MOST_IDENTIFIERS
    assert [name for name in names if re.fullmatch(r"nobody|somebody|whoever|killer", name)] == []


def sentences(text: str) -> list[str]:
    """Sentences of paragraphs and list items; tables and headings have none."""
    kept: list[str] = []
    for paragraph in re.split(r"\n\s*\n|\n(?=\s*(?:[-*]|\d+\.) )", text):
        lines = [line for line in paragraph.splitlines() if not re.match(r"\s*[|#]", line)]
        kept += re.split(r"(?<=[.!?:;])\s+", " ".join(" ".join(lines).split()))
    return kept


def test_few_sentences_of_the_pages_for_users_are_long():
    long = [
        (page.name, sentence)
        for page in users()
        for sentence in sentences(prose(page))
        if len(re.findall(r"[\w'’-]*[A-Za-z][\w'’-]*", sentence)) > LONGEST
    ]
    assert len(long) <= MOST_LONG, Counter(name for name, _ in long)
