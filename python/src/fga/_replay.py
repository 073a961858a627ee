"""The replay page inside of a notebook."""

from __future__ import annotations

import html

from ._fga import Run


class replay:
    """The replay page of a run: the last expression of a notebook's cell shows it.

    `replay(run)` is a frame without network access; `.html` is the page itself.
    """

    def __init__(self, run: Run, height_px: int = 720) -> None:
        self.html = run.replay_html()
        self.height_px = int(height_px)

    def _repr_html_(self) -> str:
        page = html.escape(self.html, quote=True)
        return (
            f'<iframe srcdoc="{page}" width="100%" height="{self.height_px}" '
            'style="border:0" sandbox="allow-scripts"></iframe>'
        )

    def __repr__(self) -> str:
        return f"replay({len(self.html)} characters of HTML)"
