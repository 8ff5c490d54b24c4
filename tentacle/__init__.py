"""Two models of a soft arm in a tank, and the loop between them and measured data.

    import tentacle

    recording = tentacle.read("my_arm")
    shapes = tentacle.track(recording)
    model = tentacle.identify(recording)
    found = tentacle.diagnose([recording], baseline=[...])

Each function has the name of a verb of the command line and does the same. A notebook shows each result as a table.
`import tentacle` loads no other room: a function loads its room when it is called.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tentacle.api import compare as compare
    from tentacle.api import diagnose as diagnose
    from tentacle.api import identify as identify
    from tentacle.api import optimise as optimise
    from tentacle.api import read as read
    from tentacle.api import simulate as simulate
    from tentacle.api import track as track

    __version__: str

__all__ = ["__version__", "compare", "diagnose", "identify", "optimise", "read", "simulate", "track"]


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import PackageNotFoundError, version

        try:
            return version("tentacle-twin")
        except PackageNotFoundError:  # run from a checkout that is not installed
            return "(not installed)"
    if name in __all__:
        return getattr(import_module("tentacle.api"), name)  # here, so that the shared words import no room
    raise AttributeError(f"module 'tentacle' has no attribute {name!r}; it has {', '.join(__all__)}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
