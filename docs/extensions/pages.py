"""Pages that GitHub shows as they are, and the site a little otherwise.

Links to the README's methods lead to the site's own page. Committed tables are pages outside the contents.
Docstrings are written for `help()`: what reStructuredText would take for markup is changed.
"""

import re
from typing import Any

from sphinx.application import Sphinx

README_METHODS = "](../README.md#methods)"


def read(app: Sphinx, page: str, source: list[str]) -> None:
    """Change a page's text before it is read."""
    source[0] = source[0].replace(README_METHODS, "](methods.md)")
    if page.startswith("results/"):
        source[0] = f"---\norphan: true\n---\n\n{source[0]}"


def docstring(app: Sphinx, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """Take the markup from bars, stars and underscores at the end of words: |v|, v*, component_."""
    for number, line in enumerate(lines):
        if line.lstrip().startswith("*"):  # *args, **words
            continue
        parts = re.split(r"(``.*?``)", line)
        for place in range(0, len(parts), 2):
            text = parts[place].replace("|", "∣").replace("*", "∗")  # as wide: tables stay whole
            parts[place] = re.sub(r"(?<=\w)_(?=$|[^\w`])", r"\\_", text)
        lines[number] = "".join(parts)


def setup(app: Sphinx) -> dict[str, bool]:
    """Listen to what Sphinx reads."""
    app.connect("source-read", read)
    app.connect("autodoc-process-docstring", docstring, priority=400)  # before napoleon
    return {"parallel_read_safe": True, "parallel_write_safe": True}
