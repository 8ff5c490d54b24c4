"""A newcomer's first hour: set-up from an empty cache, the demo's verdict, the app's first paint, sizes, minutes.

    python benchmarks/first_hour.py --json FILE [--short] [--before COMMIT]

setup_s and setup_mb: the clock's seconds of what `make demo` sets up from an empty cache, and the megabytes of the
archives that it takes (downloaded, or from a folder that pip was told of). installed_mb: what then lies on the disk.
--before measures the set-up of an earlier commit in the same run, turn by turn, as before_s and before_mb.
first_verdict_s: from the end of the set-up to the demo's first verdict, the model compiled on the way. app_paint_s:
from `tentacle app` to its page drawn in a headless Chromium; left out where there is none.

The rest is measured on a video that is not the tool's own picture of itself: the MuJoCo reference moves the arm in a
current that the declaration leaves out, and the renderer films it. There downloads are left out, but for the build
tool: the fresh environment sees the libraries of this one. import_s and help_s are processor time; path_minutes
is the clock's.
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import os
import re
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))  # before benchmarks/, whose vision.py would hide the room of that name

from vision.render import RenderSettings  # noqa: E402

PAPER_SECONDS = 39.0
PARTS = ("setup", "app", "path")


def processor_seconds() -> float:
    """What this process's ended children have used of the processor [s]."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def seconds_of(
    command: list[str], cwd: Path, environment: dict[str, str], clock: Callable[[], float] = time.perf_counter
) -> float:
    """How long a command takes [s] by a clock; what it said is shown where it fails."""
    start = clock()
    done = subprocess.run(command, cwd=cwd, env=environment, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise SystemExit(f"{' '.join(command)}\n{done.stdout}\n{done.stderr}")
    return clock() - start


def film(folder: Path, seconds: float) -> Path:
    """An import folder: video, motor log and declaration of an arm in a current that nobody declares."""
    import numpy as np

    from mujoco_ref.simulate import simulate
    from tentacle.io.write_folder import write_folder
    from tentacle.model import Estimate, Model
    from tentacle.recording import Camera, Declaration, Recording
    from tentacle.signals import MotorSignal, Video
    from tentacle.specimen import WATER, Cone, Specimen
    from tentacle.waveform import Chirp
    from vision.encode import write_video
    from vision.looks import CLEAN
    from vision.render import render

    arm = Specimen(Cone(0.0125, 0.003), 0.14, 1070.0)
    parameters = {
        "elasticity": {"E": Estimate.exact(2.0e5, "Pa")},
        "damping": {"eta": Estimate.exact(2.0e3, "Pa s")},
        "drag": {"C_perp": Estimate.exact(1.1)},
        "added_mass": {"C_a": Estimate.exact(1.0)},
    }
    waveform = Chirp(0.45, 0.3, 1.5, seconds)
    hidden = {"current": {"U_x": 0.06, "U_y": 0.0}}
    moved = simulate(Model(arm, WATER, parameters=parameters), waveform, seconds, 30.0, hidden=hidden)
    camera = Camera(30.0, 0.0006, (320.0, 40.0), (0.0, 1.0))
    midline = moved.midline
    video = folder.parent / f"{folder.name}.mp4"
    write_video(video, render(midline, arm, camera, RenderSettings((640, 360), CLEAN, 1)), midline.t, crf=18)
    t = np.arange(0.0, seconds + 1.0, 0.01)
    angle = waveform(t)[0]
    recording = Recording(
        folder.name, Declaration(arm, WATER, camera=camera), motor=MotorSignal(t, angle, angle), video=Video(video)
    )
    write_folder(recording, folder)
    return folder


def fresh_environment(folder: Path) -> tuple[Path, float]:
    """This checkout's clone, installed in a new environment that sees the present libraries; and how long it took."""
    start = time.perf_counter()
    clone, place = folder / "clone", folder / "environment"
    ask = dict(os.environ)
    seconds_of(["git", "clone", "--quiet", "--depth", "1", ROOT.as_uri(), str(clone)], folder, ask)
    seconds_of([sys.executable, "-m", "venv", str(place)], folder, ask)
    python = place / "bin" / "python"
    where = "import sysconfig; print(sysconfig.get_path('purelib'))"
    inside = Path(subprocess.run([python, "-c", where], capture_output=True, text=True, check=True).stdout.strip())
    outside = subprocess.run([sys.executable, "-c", where], capture_output=True, text=True, check=True).stdout
    (inside / "libraries.pth").write_text(outside)
    quiet = ["-m", "pip", "install", "--quiet", "--no-deps", "--disable-pip-version-check"]
    seconds_of([str(python), *quiet, str(clone)], folder, ask)
    return place / "bin", time.perf_counter() - start


SIZE = re.compile(r"Downloading \S+ \(([\d.]+) ?([kKM])i?B\)")
FOUND = re.compile(r"Processing (?:file://)?(\S+\.(?:whl|tar\.gz))")


def archives_mb(said: str, place: Path) -> float:
    """Megabytes of the archives that pip says it downloaded, or took from a folder that it was told of."""
    fetched = sum(float(size) / (1.0 if unit == "M" else 1e3) for size, unit in SIZE.findall(said))
    local = sum((place / name).stat().st_size for name in FOUND.findall(said) if (place / name).is_file())
    return fetched + local / 1e6


def set_up(folder: Path, commit: str) -> tuple[float, float, float]:
    """What `make demo` sets up, from an empty cache: seconds, megabytes of archives, megabytes on the disk."""
    clone, ask = folder / "clone", {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    ask |= {"PIP_CACHE_DIR": str(folder / "pip"), "UV_CACHE_DIR": str(folder / "uv")}
    seconds_of(["git", "clone", "--quiet", str(ROOT), str(clone)], folder, ask)
    seconds_of(["git", "checkout", "--quiet", commit], clone, ask)
    start = time.perf_counter()
    done = subprocess.run([".ci/set_up", ".venv"], cwd=clone, env=ask, capture_output=True, text=True, check=False)
    took = time.perf_counter() - start
    if done.returncode != 0:
        raise SystemExit(done.stdout + done.stderr)
    files = [file for file in (clone / ".venv").rglob("*") if file.is_file() and not file.is_symlink()]
    return took, archives_mb(done.stdout + done.stderr, clone), sum(file.stat().st_size for file in files) / 1e6


def set_ups(folder: Path, before: str | None) -> dict[str, float]:
    """The set-up of this commit and of the one before, one after the other."""
    found = {}
    for name, commit in (("setup", "HEAD"), ("before", before)):
        if commit is not None:
            (folder / name).mkdir()
            seconds, archives, installed = set_up(folder / name, commit)
            found |= {f"{name}_s": seconds, f"{name}_mb": archives}
            found |= {"installed_mb" if name == "setup" else "before_installed_mb": installed}
            print(f"set-up of {commit}: {seconds:.0f} s, {archives:.0f} MB of archives, {installed:.0f} MB on the disk")
    return found


def first_verdict(folder: Path, program: Path) -> float:
    """Seconds from `tentacle demo` to its first verdict, nothing compiled before."""
    kernels = {"TENTACLE_KERNELS": str(folder / "kernels"), "TENTACLE_DATA": str(folder / "none")}
    ask = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"} | kernels
    return seconds_of([str(program), "demo", "--out", "demo"], folder, ask)


def app_paint(folder: Path) -> dict[str, float]:
    """Seconds from `tentacle app` to its page drawn; nothing where there is no Chromium or no driver for it."""
    chromium = shutil.which("chromium")
    if chromium is None or any(importlib.util.find_spec(name) is None for name in ("playwright", "nicegui")):
        return {}
    from playwright.sync_api import Error, sync_playwright

    ask = {**os.environ, "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-m", "tentacle", "app", str(folder / "app"), "--no-browser", "--port", "8149"]
    with sync_playwright() as driver:
        page = driver.chromium.launch(executable_path=chromium, args=["--no-sandbox"]).new_page()
        start = time.perf_counter()
        served = subprocess.Popen(command, env=ask, stdout=subprocess.PIPE, text=True)
        try:
            assert served.stdout is not None
            address = served.stdout.readline().split()[0]
            while True:
                try:
                    page.goto(address)
                    break
                except Error:  # the server does not listen yet
                    time.sleep(0.1)
            page.get_by_text("From a film to what the model lacks").wait_for()
            return {"app_paint_s": time.perf_counter() - start}
        finally:
            served.terminate()
            served.wait()


def measure(folder: Path, short: bool) -> dict[str, float]:
    """All figures of the first hour."""
    seconds = 8.0 if short else PAPER_SECONDS
    programs, set_up = fresh_environment(folder)
    ask = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    python, tentacle = str(programs / "python"), str(programs / "tentacle")
    seconds_of([tentacle, "--help"], folder, ask)  # the first run writes bytecode
    imports = [seconds_of([python, "-c", "import tentacle"], folder, ask, processor_seconds) for _ in range(5)]
    helps = [seconds_of([tentacle, "--help"], folder, ask, processor_seconds) for _ in range(5)]
    film(folder / "elsewhere", seconds)
    steps = {
        "import": [tentacle, "import", "elsewhere", "--out", "elsewhere.rrd"],
        "diagnose": [tentacle, "diagnose", "elsewhere.rrd", "--out", "answer"],
    }
    took = {name: seconds_of(command, folder, ask) for name, command in steps.items()}
    verdict = json.loads((folder / "answer" / "verdict.json").read_text())
    before, after = (verdict["error"][which]["midline_mm"] for which in ("before", "after"))
    print(f"verdict: {verdict['verdict']} {verdict['effects']}, midline error {before} mm before, {after} mm after")
    print(f"set-up {set_up:.1f} s, " + ", ".join(f"{name} {value:.1f} s" for name, value in took.items()))
    session = (folder / "answer" / "session.rrd").stat().st_size / 1e6
    if short:
        print(f"session of {seconds:.0f} s: {session:.2f} MB, scaled to {PAPER_SECONDS:.0f} s below")
    return {
        "import_s": statistics.median(imports),
        "help_s": statistics.median(helps),
        "rrd_mb_39s": session * PAPER_SECONDS / seconds,
        "report_mb": (folder / "answer" / "report.html").stat().st_size / 1e6,
        "path_minutes": (set_up + sum(took.values())) / 60.0,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, required=True, metavar="FILE")
    parser.add_argument("--short", action="store_true", help="an 8 s video in place of 39 s")
    parser.add_argument("--before", metavar="COMMIT", help="measure this commit's set-up, too")
    parser.add_argument("--parts", nargs="+", choices=PARTS, default=PARTS, help="what to measure (default: all)")
    arguments = parser.parse_args()
    folder = Path(tempfile.mkdtemp(prefix="first-hour-"))
    try:
        figures = {}
        if "setup" in arguments.parts:
            figures |= set_ups(folder, arguments.before)
            program = folder / "setup" / "clone" / ".venv" / "bin" / "tentacle"
            figures["first_verdict_s"] = first_verdict(folder, program)
        if "app" in arguments.parts:
            figures |= app_paint(folder)
        if "path" in arguments.parts:
            figures |= measure(folder, arguments.short)
    finally:
        shutil.rmtree(folder)
    for name, value in figures.items():
        print(f"{name} {value:.3g}")
    arguments.json.write_text(json.dumps({"figures": figures}, indent=1) + "\n")


if __name__ == "__main__":
    main()
