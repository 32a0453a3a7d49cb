"""HTML of tables, texts and pictures: whole in itself, nothing is fetched from elsewhere."""

import base64
import re
from pathlib import Path

from markdown_it import MarkdownIt
from markdown_it.token import Token
from markupsafe import Markup

from granstudy.trust.flags import Status, Trust

WORDS = ("untrusted", "failed", "diverged", "stopped", "marginal", "trusted")
"""Words of labels and endings that colour a cell; the first of a line's colours the line."""

TYPES = {".svg": "image/svg+xml", ".png": "image/png", ".csv": "text/csv", ".yaml": "text/yaml"}
"""Media types of files by their ending."""

assert {*WORDS, "missing", "ok"} == {one.name.lower() for kind in (Trust, Status) for one in kind}


def data_uri(path: str | Path) -> str:
    """A file's content as an address, so that the page holds it."""
    content = base64.b64encode(Path(path).read_bytes()).decode("ascii")
    return f"data:{TYPES[Path(path).suffix]};base64,{content}"


def html_of(markdown: str) -> Markup:
    """HTML of a table's Markdown, without its title; cells and lines have their label as a class."""
    reader = MarkdownIt("commonmark", {"html": False, "xhtmlOut": True}).enable("table")
    tokens = reader.parse(markdown)
    titled = [i for i, token in enumerate(tokens) if token.type == "heading_close"][:1]
    tokens = tokens[titled[0] + 1 :] if titled else tokens
    _colour(tokens)
    html = reader.renderer.render(tokens, reader.options, {})
    # A wide table is moved sideways by itself; the keyboard reaches it.
    html = html.replace(
        "<table>", '<div class="wide" tabindex="0" role="group" aria-label="table"><table>'
    )
    return Markup(html.replace("</table>", "</table></div>"))


def label_in(text: str) -> str:
    """The label that a cell says, alone or behind a number: ``0.0415 (untrusted)``; "" for none."""
    found = re.search(rf"(?:^|\()({'|'.join(WORDS)})(?: \(wrong\))?\)?$", text)
    return found[1] if found else ""


def _colour(tokens: list[Token]) -> None:
    """Give cells and lines of tables the class of their label."""
    row: list[Token] = []
    for place, token in enumerate(tokens):
        if token.type == "tr_open":
            row = [token]
        elif token.type == "td_open":
            label = label_in(tokens[place + 1].content)
            if label:
                token.attrSet("class", f"label {label}")
                row.append(token)
        elif token.type == "tr_close" and len(row) > 1:
            labels = {str(cell.attrs["class"]).split()[1] for cell in row[1:]}
            row[0].attrSet("class", f"of-{next(word for word in WORDS if word in labels)}")
