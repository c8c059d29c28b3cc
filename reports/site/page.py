"""The page as one HTML text: template, style, script and data in one file, nothing fetched."""

from __future__ import annotations

import json
from base64 import b64encode
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
TEMPLATES = HERE / "templates"
CHARTS = HERE / "vendor" / "chart.umd.min.js"
"""Chart.js 4.6.1 (MIT, chartjs.org), as npm's chart.js package has it."""


@dataclass(frozen=True)
class Page:
    """A further page, from Markdown: a diagnosis, the challenge."""

    title: str
    markdown: str


def render(data: Mapping[str, Any], pages: Sequence[Page] = (), made: str = "") -> str:
    """Return the whole page. `data` as `payload` makes it; `made`: how and when it was made.

    Only our own scripts run: their hashes stand in the page's content security policy, and the
    data is text in a script block that holds no code.
    """
    from jinja2 import Environment, FileSystemLoader, StrictUndefined
    from markupsafe import Markup

    scripts = [CHARTS.read_text(encoding="utf-8"), _own("app.js")]
    environment = Environment(
        loader=FileSystemLoader(TEMPLATES), autoescape=True, undefined=StrictUndefined
    )
    return environment.get_template("page.html.j2").render(
        data=Markup(embedded(data)),  # noqa: S704 - escaped by `embedded`
        scripts=[Markup(script) for script in scripts],  # noqa: S704 - our own files
        style=Markup(_own("style.css")),  # noqa: S704 - our own file
        policy=" ".join(f"'sha256-{_hash(script)}'" for script in scripts),
        pages=[(_shown(page.title), Markup(_html(page.markdown))) for page in pages],  # noqa: S704
        made=_shown(made),
    )


def embedded(data: Mapping[str, Any]) -> str:
    """Return JSON that cannot end the script block it stands in."""
    text = json.dumps(data, allow_nan=False, separators=(",", ":"))
    for character in "<>&\u2028\u2029":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return text


def _own(name: str) -> str:
    return (TEMPLATES / name).read_text(encoding="utf-8")


def _hash(script: str) -> str:
    return b64encode(sha256(script.encode()).digest()).decode()


def _shown(words: str) -> str:
    """Return words without control characters; line ends stay."""
    return "".join(c if c.isprintable() or c == "\n" else " " for c in words)


def _html(markdown: str) -> str:
    """Return Markdown as HTML; markup in it stays text, pictures and links are left out."""
    from markdown_it import MarkdownIt

    parser = MarkdownIt("commonmark", {"html": False}).enable("table").disable(["image", "link"])
    return str(parser.render(_shown(markdown)))
