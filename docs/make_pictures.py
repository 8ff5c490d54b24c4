"""The gallery's pictures, from the tool itself: python docs/make_pictures.py (needs Chromium and a Vulkan driver)."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[1]
PICTURES = ROOT / "docs" / "pictures"
WIDTH = 1280
CHROMIUM = ["chromium", "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--hide-scrollbars",
            "--disable-background-networking", "--disable-sync"]  # fmt: skip


def tentacle(*arguments: str, folder: Path) -> None:
    """Run a verb of this checkout."""
    program = "import sys, tentacle.cli; sys.exit(tentacle.cli.main())"
    path = {"PYTHONPATH": str(ROOT), "PATH": "/usr/local/bin:/usr/bin:/bin", "HOME": str(folder)}
    subprocess.run([sys.executable, "-c", program, *arguments], cwd=folder, env=path, check=True)


def photograph(page: Path, picture: Path, height: int) -> None:
    """A report as a browser shows it."""
    size = [f"--window-size=1000,{height}", f"--screenshot={picture}", f"--user-data-dir={page.parent / 'browser'}"]
    subprocess.run([*CHROMIUM, *size, page.as_uri()], check=True, capture_output=True)


def keep(picture: Path) -> None:
    """Into the gallery, no wider than WIDTH."""
    import cv2

    image = cv2.imread(str(picture))
    if image is None:
        raise SystemExit(f"{picture} was not drawn")
    scale = min(1.0, WIDTH / image.shape[1])
    small = cv2.resize(image, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    cv2.imwrite(str(PICTURES / picture.name), small, [cv2.IMWRITE_PNG_COMPRESSION, 9])


def main() -> None:
    """Film an arm in a current that is not declared, diagnose it, and photograph every step."""
    sys.path[:0] = [str(ROOT), str(ROOT / "benchmarks")]
    from first_hour import film

    PICTURES.mkdir(exist_ok=True)
    folder = Path(tempfile.mkdtemp(prefix="pictures-"))
    film(folder / "swim", 8.0)
    tentacle("view", "swim", "--screenshot", "recording.png", "--at", "3", folder=folder)
    tentacle("diagnose", "swim", "--out", "answer", folder=folder)
    tentacle("view", "answer/session.rrd", "--screenshot", "session.png", "--at", "6.6", folder=folder)
    tentacle("figure", "6", "swim", "--model", "answer/model.toml", "--out", "stills.png", folder=folder)
    tentacle("figure", "9", "--model", "answer/model.toml", "--out", "thrust_map.png", folder=folder)
    photograph(folder / "answer" / "report.html", folder / "report.png", 1250)
    for name in ("recording", "session", "report", "stills", "thrust_map"):
        keep(folder / f"{name}.png")


if __name__ == "__main__":
    main()
