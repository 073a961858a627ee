"""Progress of long work, in terminals and notebooks."""

from __future__ import annotations

import sys
import time
from typing import Callable, TextIO


def progress_bar(stream: TextIO | None = None, every_s: float = 0.5) -> Callable[[int, int], None]:
    """A function for the argument `progress`: shows the progress of the work.

    A terminal and a notebook get one line that overwrites itself, a file one line now and then.
    """
    out = sys.stderr if stream is None else stream
    over = out.isatty() or "ipykernel" in sys.modules
    begun = time.monotonic()
    shown = begun - every_s
    pause_s = every_s if over else max(every_s, 10.0)

    def show(done: int, total: int) -> None:
        nonlocal shown
        now = time.monotonic()
        if done < total and now - shown < pause_s:
            return
        shown = now
        line = f"{done} of {total} ({100 * done / total:.1f} %), {done / max(now - begun, 1e-9):.0f} a second"
        if over:
            end = "\n" if done >= total else ""
            out.write(f"\r{line:<78}{end}")
        else:
            out.write(line + "\n")
        out.flush()

    return show
