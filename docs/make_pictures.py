"""The documentation's pictures, from the tool itself: python docs/make_pictures.py [GROUP...]

Groups: moving, examples, views, reports, figures, maps, laws (default: all). Views need a Vulkan driver, reports and
the moving group Chromium, the rig's view g++. The arm swims in a current that its declaration leaves out; the
rest is what a user would type.
"""

from __future__ import annotations

import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

ROOT = Path(__file__).parents[1]
PICTURES = ROOT / "docs" / "pictures"
EXAMPLES = PICTURES / "examples"
WIDTH = 1280
MENU = 37  # rows of the viewer's menu, with its notes on this machine
QUALITY = 88  # of WebP: text stays sharp, at a fifth of a PNG's size
CHROMIUM = ["chromium", "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--hide-scrollbars",
            "--disable-background-networking", "--disable-sync"]  # fmt: skip
ENVIRONMENT = {"PYTHONPATH": str(ROOT), "PATH": "/usr/local/bin:/usr/bin:/bin"}
SPEEDS = """\
arm,motion,speed_m_s
14 cm,low sine,0.0006
14 cm,high sine,0.0012
14 cm,optimised,0.0066
21 cm,low sine,0.0052
21 cm,high sine,0.0104
21 cm,optimised,0.0227
25 cm,low sine,0.0049
25 cm,high sine,0.0067
25 cm,optimised,0.0214
"""  # the paper's Table II, means
WAVE = '[waveform]\nkind = "sine"\namplitude_rad = 0.4\nfrequency_hz = 0.8\n'


def tentacle(command: str, folder: Path) -> None:
    """Run a verb of this checkout, as a user types it."""
    program = "import sys, tentacle.cli; sys.exit(tentacle.cli.main())"
    environment = {**ENVIRONMENT, "HOME": str(folder)}
    subprocess.run([sys.executable, "-c", program, *command.split()[1:]], cwd=folder, env=environment, check=True)


def photograph(page: Path, height: int) -> Path:
    """The upper part of a report, as a browser shows it."""
    picture = page.with_suffix(".png")
    size = [f"--window-size=1000,{height}", f"--screenshot={picture}", f"--user-data-dir={page.parent / 'browser'}"]
    subprocess.run([*CHROMIUM, *size, page.as_uri()], check=True, capture_output=True)
    return picture


def keep(picture: Path, name: str, above: int = 0) -> None:
    """Into the documentation under that name, as WebP no wider than WIDTH, without so many rows at the top."""
    import cv2

    image = cv2.imread(str(picture))
    if image is None:
        raise SystemExit(f"{picture} was not drawn")
    image = image[above:]
    scale = min(1.0, WIDTH / image.shape[1])
    small = cv2.resize(image, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    target = PICTURES / f"{name}.webp"
    target.parent.mkdir(parents=True, exist_ok=True)
    cv2.imwrite(str(target), small, [cv2.IMWRITE_WEBP_QUALITY, QUALITY])


def examples(folder: Path) -> None:
    """Run every example; its picture and what it printed go into the gallery."""
    EXAMPLES.mkdir(parents=True, exist_ok=True)
    for script in sorted((ROOT / "examples").glob("*.py")):
        environment = {**ENVIRONMENT, "HOME": str(folder)}
        done = subprocess.run([sys.executable, str(script)], cwd=folder, env=environment, text=True,
                              stdout=subprocess.PIPE, check=True)  # fmt: skip
        (EXAMPLES / f"{script.stem}.txt").write_text(done.stdout, encoding="utf-8")
        keep(folder / f"{script.stem}.png", f"examples/{script.stem}")


def material(folder: Path) -> None:
    """What views, reports and figures show: recordings, and every verb's answer."""
    from first_hour import film

    from docs.arm import shown_arm

    film(folder / "swim", 8.0)
    (folder / "arm.toml").write_text(shown_arm())
    (folder / "speeds.csv").write_text(SPEEDS)
    for command in (
        "tentacle track swim --out tracked.rrd",
        "tentacle diagnose swim --out answer",
        "tentacle simulate arm.toml --out sine.rrd --sine 0.5 0.8 --duration 6 --fps 30",
        "tentacle identify sine.rrd --out identified",
        "tentacle compare arm.toml --no-map --out comparison",
        "tentacle optimise arm.toml --evaluations 1000 --out gait",
    ):
        tentacle(command, folder)


def views(folder: Path) -> None:
    """The viewer on every verb's session."""
    for name, file, at in (
        ("recording", "swim", 3.0),
        ("track", "tracked.rrd", 6.6),
        ("session", "answer/session.rrd", 6.45),
        ("identify", "identified/session.rrd", 4.3),
        ("compare", "comparison/session.rrd", 2.2),
        ("optimise", "gait/session.rrd", 8.0),
    ):
        tentacle(f"tentacle view {file} --screenshot view.png --at {at}", folder)
        keep(folder / "view.png", name, above=MENU)
    live(folder)


def live(folder: Path) -> None:
    """A run on the emulated rig, photographed while it lasts."""
    from rig import live_feed
    from rig.connection import connected, opened_camera
    from rig.motion import rig_motion
    from rig.record import Attendance, record_run
    from rig.setup_file import read_setup
    from tentacle.cli._rig_terminal import live_paths
    from tentacle.io.waveform_file import read_waveform
    from viz.blueprints.rig import send_live_layout
    from viz.viewer import headless_viewer

    (folder / "wave.toml").write_text(WAVE)
    program = "import sys, tentacle.cli; sys.exit(tentacle.cli.main())"
    emulated = subprocess.Popen(
        [sys.executable, "-c", program, "rig", "emulate", "emulated"],
        cwd=folder, env={**ENVIRONMENT, "HOME": str(folder)},
    )  # fmt: skip
    try:
        while not (folder / "emulated" / "rig.toml").exists():
            time.sleep(0.2)
        setup = read_setup(folder / "emulated" / "rig.toml")
        motion = rig_motion(read_waveform(folder / "wave.toml"), 8.0, setup.limits, {})
        with headless_viewer() as viewer, connected(setup) as board, opened_camera(setup, board.time) as camera:
            send_live_layout(viewer.url, live_feed.RIG_APPLICATION, live_paths(camera=True))
            out, address = folder / "run.rrd", viewer.url
            shown = Attendance(name="run", viewer=address)
            run = threading.Thread(target=record_run, args=(setup, board, camera, motion, out, shown))
            run.start()
            time.sleep(13.0)  # it settles, and synchronises the camera, before it moves
            (folder / "view.png").write_bytes(viewer.take_screenshot())
            run.join()
    finally:
        emulated.send_signal(signal.SIGINT)
        emulated.wait()
    keep(folder / "view.png", "rig", above=MENU)
    tentacle("tentacle view run.rrd --screenshot view.png --at 4", folder)
    keep(folder / "view.png", "rig_run", above=MENU)


def reports(folder: Path) -> None:
    """Every verb's report in a browser."""
    for name, file in (
        ("report_identify", "identified"),
        ("report_compare", "comparison"),
        ("report_optimise", "gait"),
    ):
        keep(photograph(folder / file / "report.html", 1250), name)


def figures(folder: Path) -> None:
    """The paper's figures of these recordings."""
    for number, rest in (
        (3, "swim"),
        (4, "sine.rrd"),
        (5, "sine.rrd --model identified/model.toml"),
        (6, "swim --model answer/model.toml"),
        (8, "sine.rrd tracked.rrd --model identified/model.toml"),
        (9, "--model identified/model.toml"),
        (10, "speeds.csv"),
    ):
        tentacle(f"tentacle figure {number} {rest} --out figure_{number}.png", folder)
        keep(folder / f"figure_{number}.png", f"figure_{number}")


def maps(folder: Path) -> None:
    """The reduced model beside the reference: where it serves, Figure 9 on both, and the arm in MuJoCo's camera."""
    import cv2

    from docs.arm import shown_arm
    from tentacle.io.model_file import read_model
    from tentacle.runner import Runner
    from validation.validity_map import AMPLITUDES, LEVELS, MAP_ORDERS, RATIOS, validity_maps, variants
    from viz.figures.flexibility import flexibility_figure
    from viz.figures.style import save
    from viz.figures.validity_map import validity_figure

    (folder / "thick.toml").write_text(shown_arm() + "added_mass.C_a = {value = 1.0}\n")
    tentacle("tentacle compare thick.toml --tapers 0.5 --slenderness 20 --out mapped", folder)
    keep(photograph(folder / "mapped" / "report.html", 1180), "report_validity")
    # The same call as the verb's: its results are found, not computed.
    found = validity_maps(variants(read_model(folder / "thick.toml"), [0.5], [20.0]), Runner(folder / "mapped/cells"))
    errors = {f"shape, order {o}": found[0].shape[i] for i, o in enumerate(MAP_ORDERS)}
    errors |= {f"mean thrust, order {o}": found[0].thrust[i] for i, o in enumerate(MAP_ORDERS)}
    save(validity_figure(RATIOS, AMPLITUDES, errors, LEVELS), folder / "validity.png")
    over = {f"shape, order {o}": {m.label: m.shape[i] for m in found} for i, o in enumerate(MAP_ORDERS)}
    save(flexibility_figure(RATIOS, {m.label: m.flexibility for m in found}, over, LEVELS), folder / "flexibility.png")
    tentacle("tentacle reproduce fig9 --out fig9", folder)
    photograph(folder / "fig9" / "report.html", 1300).rename(folder / "fig9.png")
    film = "--sine 0.5 1.5 --duration 1 --fps 30 --video mujoco --size 640 480"
    tentacle(f"tentacle simulate thick.toml --out film {film}", folder)
    video = cv2.VideoCapture(str(folder / "film" / "video.mp4"))
    frames = [video.read()[1] for _ in range(24)][::5]
    cv2.imwrite(str(folder / "mujoco_camera.png"), cv2.hconcat([frame[:, 80:560] for frame in frames[1:]]))
    for name in ("validity", "flexibility", "fig9", "mujoco_camera"):
        keep(folder / f"{name}.png", name)


def moving(folder: Path) -> None:
    """What the README shows of `tentacle demo`, moving and as a report; the page of `tentacle app` in a browser."""
    from discovery.diagnose import diagnose
    from docs.moving_picture import moving_picture
    from vision.tracked_recording import read_tracked
    from viz.scene import scene_of

    def stage(words: str, done: float = 0.0) -> None:
        """Nobody watches."""

    tentacle("tentacle demo --out demo", folder)
    recording = read_tracked(folder / "demo" / "tank" / "recording", stage)
    moving_picture(scene_of(diagnose([recording]).runs[0]), recording, PICTURES / "moving.webp")
    keep(photograph(folder / "demo" / "tank" / "report.html", 1450), "report")
    from docs.app_pictures import photograph_app

    for name, picture in photograph_app(folder, folder / "demo" / "tank" / "recording").items():
        keep(picture, name)


def laws(folder: Path) -> None:
    """The missing force of a hidden magnet, a thread and a one-way drag, on white, for dark pages too."""
    from discovery.diagnose import diagnose
    from validation.plants import Filming, make
    from validation.trials.law_trial import law_recording
    from viz.figures.force_over import force_over_figure
    from viz.figures.missing_force import missing_force_figure

    for name, effect, seed in (("missing_magnet", "magnet", 5), ("missing_tether", "thread", 6)):
        recording, _ = make("stranger", seed, effects=(effect,), filming=Filming(seconds=24.0), size=(10.0, 10.0))
        missing = diagnose([recording]).missing
        print(name, *missing.words, sep="\n")
        figure = missing_force_figure(missing.maps[0], missing.kinds)
        figure.savefig(folder / f"{name}.png", dpi=150, facecolor="white")
        keep(folder / f"{name}.png", name)
    missing = diagnose([law_recording(741, "one_way_drag")[0]]).missing
    print("missing_over", *missing.words, sep="\n")
    force_over_figure(missing.over).savefig(folder / "missing_over.png", dpi=110, facecolor="white")
    keep(folder / "missing_over.png", "missing_over")


GROUPS = {"moving": moving, "examples": examples, "views": views, "reports": reports, "figures": figures, "maps": maps,
          "laws": laws}  # fmt: skip


def main() -> None:
    """Make the groups that were named."""
    sys.path[:0] = [str(ROOT), str(ROOT / "benchmarks")]
    chosen = sys.argv[1:] or list(GROUPS)
    if set(chosen) - set(GROUPS):
        raise SystemExit(f"groups: {', '.join(GROUPS)}")
    PICTURES.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="pictures-") as place:
        folder = Path(place)
        if set(chosen) - {"examples", "laws", "moving"}:
            material(folder)
        for name in chosen:
            GROUPS[name](folder)


if __name__ == "__main__":
    main()
