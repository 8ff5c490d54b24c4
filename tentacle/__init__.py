"""Two models of a soft arm in a tank, and the loop between them and measured data: the shared words."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    from tentacle.recording import Recording


def read_recording(path: str | Path) -> Recording:
    """A recording from an import folder, or from an .rrd file; InputError names what is wrong with it."""
    from tentacle.io.reading import read_recording as read  # here, so that `import tentacle` loads no numpy

    return read(path)
