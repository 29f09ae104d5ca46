# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""page: HTML pages in one file: text, pictures that flip and zoom, interactive charts. Nothing is loaded
from elsewhere."""

from __future__ import annotations

import base64
import html
import json
from typing import Any

from sunfleck.error import Error
from sunfleck.io.files import FilePath, replacing
from sunfleck.plot.figure import Panel, plotly_figure

__all__ = ["PAGE_TYPES", "Page", "plotly"]

PAGE_TYPES = (".html",)

_STYLE = """
body { font: 15px/1.5 sans-serif; max-width: 72rem; margin: 2rem auto; padding: 0 1rem; color: #222; }
figure { display: inline-block; margin: .5rem 1rem .5rem 0; vertical-align: top; max-width: 100%; }
figure img { max-width: 100%; cursor: zoom-in; }
figcaption { color: #555; max-width: 40rem; min-width: 12rem; contain: inline-size; }
button { font: inherit; margin: .2rem 0; }
#zoom { position: fixed; inset: 0; background: #000d; display: none; cursor: zoom-out; }
#zoom img { width: 100%; height: 100%; object-fit: contain; image-rendering: pixelated; }
footer { color: #777; font-size: 80%; margin-top: 2rem; }
"""

_SCRIPT = """
const zoom = document.getElementById("zoom");
zoom.onclick = () => { zoom.style.display = "none"; };
for (const figure of document.querySelectorAll("figure")) {
  const pictures = [...figure.querySelectorAll("img")];
  for (const picture of pictures)
    picture.onclick = () => { zoom.firstChild.src = picture.src; zoom.style.display = "block"; };
  const button = figure.querySelector("button"), caption = figure.querySelector("figcaption");
  if (!button) continue;
  let shown = 0;
  button.onclick = () => {
    pictures[shown].hidden = true;
    shown = (shown + 1) % pictures.length;
    pictures[shown].hidden = false;
    caption.textContent = pictures[shown].alt;
  };
}
for (const place of document.querySelectorAll(".chart")) {
  const made = JSON.parse(place.querySelector("script").textContent);
  Plotly.newPlot(place, made.data, made.layout, { responsive: true, displaylogo: false });
}
"""


def plotly() -> str:
    """The library that draws the interactive charts.

    Raises
    ------
    sunfleck.Error
        plotly is not installed.
    """
    try:
        from plotly.offline import get_plotlyjs
    except ImportError:
        raise Error("interactive charts need plotly; pip install 'sunfleck[chart]' brings it") from None
    script: str = get_plotlyjs()
    return script


class Page:
    """A page that is filled from the top.

    Parameters
    ----------
    title : str
    about : str
        The last line: where the numbers come from.

    Examples
    --------
    >>> from sunfleck.plot.page import Page
    >>> page = Page("Points", "made here")
    >>> page.text("Two < three.")
    >>> "Two &lt; three." in page.html()
    True
    """

    def __init__(self, title: str, about: str) -> None:
        self._title, self._about = title, about
        self._parts: list[str] = []
        self._charts = False
        self._names: dict[str, int] = {}

    def heading(self, text: str) -> None:
        """A heading; its anchor is the text in lower case with hyphens."""
        anchor = "-".join("".join(c if c.isalnum() else " " for c in text.lower()).split())
        self._parts.append(f'<h2 id="{html.escape(anchor)}">{html.escape(text)}</h2>')

    def text(self, text: str) -> None:
        """A paragraph."""
        self._parts.append(f"<p>{html.escape(text)}</p>")

    def lines(self, text: str) -> None:
        """Lines as they are, in a fixed pitch."""
        self._parts.append(f"<pre>{html.escape(text)}</pre>")

    def pictures(self, pictures: dict[str, bytes]) -> None:
        """PNGs by their captions in one place: a button flips through them, a click zooms."""
        images = "".join(
            f'<img alt="{html.escape(caption)}" src="data:image/png;base64,{base64.b64encode(data).decode()}"'
            f"{' hidden' if number else ''}>"
            for number, (caption, data) in enumerate(pictures.items())
        )
        flip = "<button>next</button> " if len(pictures) > 1 else ""
        caption = html.escape(next(iter(pictures)))
        self._parts.append(f"<figure>{images}<br>{flip}<figcaption>{caption}</figcaption></figure>")

    def chart(self, panel: Panel) -> None:
        """An interactive chart."""
        self._charts = True
        made = json.dumps(plotly_figure(panel, self._names)).replace("</", "<\\/")
        self._parts.append(f'<div class="chart"><script type="application/json">{made}</script></div>')

    def html(self) -> str:
        """The page.

        Raises
        ------
        sunfleck.Error
            It has charts, and plotly is not installed.
        """
        title = html.escape(self._title)
        library = f"<script>{plotly()}</script>" if self._charts else ""
        return (
            f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>{title}</title>'
            f'<link rel="icon" href="data:,"><style>{_STYLE}</style>{library}</head><body><h1>{title}</h1>'
            f"{''.join(self._parts)}<footer>{html.escape(self._about)}</footer>"
            f'<div id="zoom"><img alt=""></div><script>{_SCRIPT}</script></body></html>'
        )

    def save(self, path: FilePath) -> None:
        """Writes the page beside `path`, then renames it."""
        made: Any = self.html()
        with replacing(path, "pages", PAGE_TYPES) as target:
            target.write_text(made, encoding="utf-8")
