"""A long film of a run: memory and time of putting its frames into one video at the end (rig.record.add_film).

python benchmarks/film.py --json FILE [--minutes 60]

The pictures are 720p at 30 frames/s, noisy as a camera's are; they are written as the recorder writes them. Another
process then reads the recording and its film, as every command does.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import resource
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import cv2
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from benchmarks._commit import commit_of
from benchmarks._rig_scene import DECLARED
from rig.camera import CameraFrame
from rig.clock import ClockFit
from rig.record import add_film
from rig.recorder import Recorder
from rig.setup_file import LoadCellCalibration
from tentacle.io.declaration_file import declaration_tables
from tentacle.io.reading import read_recording
from tentacle.io.video_file import frame_stamps

FPS = 30
WIDTH, HEIGHT = 1280, 720
PICTURES = 60  # different ones


def pictures() -> list[bytes]:
    """A dark arm on a light ground at some angles, with a camera's noise, as JPEG."""
    random = np.random.default_rng(1)
    found = []
    for k in range(PICTURES):
        picture = np.full((HEIGHT, WIDTH, 3), 190, np.uint8)
        tip = (WIDTH // 2 + round(0.28 * HEIGHT * np.sin(2 * np.pi * k / PICTURES)), round(0.83 * HEIGHT))
        cv2.line(picture, (WIDTH // 2, HEIGHT // 12), tip, (40, 40, 40), HEIGHT // 12)
        noisy = np.clip(picture + random.normal(0.0, 2.0, picture.shape), 0, 255).astype(np.uint8)
        found.append(cv2.imencode(".jpg", noisy, [cv2.IMWRITE_JPEG_QUALITY, 92])[1].tobytes())
    return found


def memory_mb(kind: str) -> float:
    """VmRSS or VmHWM of this process [MB]."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(float(line.split()[1]) for line in lines if line.startswith(kind)) / 1000


def reading_back(run: Path) -> tuple[int, float]:
    """Pictures of the film that every command sees; peak memory [MB] of this process and of the child that reads."""
    recording = read_recording(run)
    assert recording.video is not None
    count = len(frame_stamps(recording.video.path))
    return count, memory_mb("VmHWM") + resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1000


def read_by_another(run: Path, cache: Path) -> tuple[int, float, float]:
    """reading_back in a new process, which stores the film in `cache`; and the time it took [s]."""
    os.environ["XDG_CACHE_HOME"] = str(cache)
    begun = time.monotonic()
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as other:
        count, peak = other.submit(reading_back, run).result()
    return count, peak, time.monotonic() - begun


def main() -> None:
    """Writes the frames, makes the film, and the figures as JSON."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, required=True)
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--folder", type=Path, help="where 27 GB an hour have room (default: the temporary folder)")
    arguments = parser.parse_args()
    commit = commit_of(Path(__file__).parent)
    count, stills = round(60 * FPS * arguments.minutes), pictures()
    cell = LoadCellCalibration(0.0, 1.0)
    start = {"name": "film", "recording": declaration_tables(DECLARED), "lead_s": 0.0, "load_cell": {}}
    with tempfile.TemporaryDirectory(dir=arguments.folder) as folder:
        path = Path(folder) / "run.rrd"
        with Recorder(path, start, cell.to_newtons) as recorder:
            recorder.clock(ClockFit(0.0, 0.0, 0.0, 1e-4, 1e-3))
            recorder.begin(1)
            for k in range(count):
                recorder.frames([CameraFrame(1.0 + k / FPS, stills[k % PICTURES], np.zeros((12, 16)))])
                if k % 5 == 0:
                    recorder.flush()
            before = memory_mb("VmRSS")
            stop = {"start_us": 1, "camera": {"offset_s": 0.0}, "rest_n": 0.0}
            size, begun = path.stat().st_size, time.monotonic()
            add_film(recorder, path, stop)
            recorder.stop("complete", stop)
        took = time.monotonic() - begun
        peak, whole = memory_mb("VmHWM"), path.stat().st_size
        read, read_peak, read_s = read_by_another(path, Path(folder) / "cache")
        if read != count:
            sys.exit(f"the film holds {read} of {count} pictures")
        figures = {
            "film_minutes": arguments.minutes,
            "film_frames_gb": size / 1e9,
            "film_peak_mb": peak,
            "film_before_mb": before,
            "film_fps": count / took,
            "film_file_gb": whole / 1e9,
            "film_read_peak_mb": read_peak,
            "film_read_fps": count / read_s,
        }
    print(figures)
    arguments.json.write_text(json.dumps({"figures": figures, "commit": commit}, indent=1))


if __name__ == "__main__":
    main()
