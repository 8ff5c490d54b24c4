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

ARM = """\
order = 2
[specimen]
section = "cone"
base_radius_m = 0.0125
tip_radius_m = 0.0015
length_m = 0.14
density_kg_m3 = 1070.0
[fluid]
density_kg_m3 = 998.0
[effects.elasticity]
E = {value = 2.0e5, unit = "Pa"}
[effects.damping]
eta = {value = 300.0, unit = "Pa s"}
[effects.drag]
C_perp = {value = 1.1}
[effects.added_mass]
C_a = {value = 1.0}
"""


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


def compare_models(folder: Path) -> None:
    """The report on both models, the maps of two tapers and two slendernesses, and the arm as MuJoCo's camera sees
    it.
    """
    import cv2

    from tentacle.cli._validity import AMPLITUDES, LEVELS, ORDERS, RATIOS, validity_maps, variants
    from tentacle.model_file import read_model
    from tentacle.runner import Runner
    from viz.figures.flexibility import flexibility_figure
    from viz.figures.style import save
    from viz.figures.validity_map import validity_figure

    (folder / "arm.toml").write_text(ARM, encoding="utf-8")
    options = ("--tapers", "0.5", "--slenderness", "20")
    tentacle("compare", "arm.toml", "--out", "comparison", *options, folder=folder)
    photograph(folder / "comparison" / "report.html", folder / "compare.png", 1180)
    tentacle("view", "comparison/session.rrd", "--screenshot", "compare_session.png", "--at", "2", folder=folder)
    # The same call as the verb's: its results are found, not computed.
    maps = validity_maps(variants(read_model(folder / "arm.toml"), [0.5], [20.0]), Runner(folder / "comparison/cells"))
    errors = {f"shape, order {o}": maps[0].shape[i] for i, o in enumerate(ORDERS)}
    errors |= {f"mean thrust, order {o}": maps[0].thrust[i] for i, o in enumerate(ORDERS)}
    save(validity_figure(RATIOS, AMPLITUDES, errors, LEVELS), folder / "validity.png")
    over = {f"shape, order {o}": {m.label: m.shape[i] for m in maps} for i, o in enumerate(ORDERS)}
    save(flexibility_figure(RATIOS, {m.label: m.flexibility for m in maps}, over, LEVELS), folder / "flexibility.png")
    tentacle("reproduce", "fig9", "--out", "fig9", folder=folder)
    photograph(folder / "fig9" / "report.html", folder / "fig9.png", 1300)
    film = ("--sine", "0.5", "1.5", "--duration", "1", "--fps", "30", "--video", "mujoco", "--size", "640", "480")
    tentacle("simulate", "arm.toml", "--out", "film", *film, folder=folder)
    video = cv2.VideoCapture(str(folder / "film" / "video.mp4"))
    frames = [video.read()[1] for _ in range(24)][::5]
    cv2.imwrite(str(folder / "mujoco_camera.png"), cv2.hconcat([frame[:, 80:560] for frame in frames[1:]]))
    for name in ("compare", "compare_session", "validity", "flexibility", "fig9", "mujoco_camera"):
        keep(folder / f"{name}.png")


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
    compare_models(folder)


if __name__ == "__main__":
    main()
