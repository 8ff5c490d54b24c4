"""The arm of the pages, for their pictures and their tests: it stands in the how-to alone."""

from __future__ import annotations

import re
from pathlib import Path

PAGE = Path(__file__).with_name("howto") / "identify.md"


def shown_arm() -> str:
    """The arm.toml that the how-to shows. Raises ValueError where it shows none."""
    found = re.search(r"^cat > arm\.toml <<END\n(.*?)^END$", PAGE.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)
    if found is None:
        raise ValueError(f"{PAGE} shows no arm.toml")
    return found[1]
