"""Vision's figures: errors against the Cramer-Rao limit over all looks, the real worm video, frames per second.

python benchmarks/vision.py --json FILE [--short] [--films [--seed N]]. The real video is read from TENTACLE_DATA
(default ../shared/data).
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
import time
from pathlib import Path

sys.path[0] = str(Path(__file__).resolve().parents[1])  # this file's own name would hide the room that it measures

sys.path.append(str(Path(__file__).resolve().parent))

import numpy as np  # noqa: E402
from _outside_judge import Judged, judge_film  # noqa: E402
from _outside_motion import FILMS  # noqa: E402
from _outside_pick import judge_pick  # noqa: E402
from _outside_plain import judge_plain  # noqa: E402

from tentacle.recording import Declaration  # noqa: E402
from tentacle.signals import Array, MotorSignal  # noqa: E402
from vision.body import track_body  # noqa: E402
from vision.encode import write_video  # noqa: E402
from vision.frames import read_frames  # noqa: E402
from vision.looks import CLEAN, LOOKS  # noqa: E402
from vision.render import RenderSettings, render  # noqa: E402
from vision.scene import swaying  # noqa: E402
from vision.track import stream_tracking  # noqa: E402
from vision.validate import judge_disturbed, judge_look, look_table, results_json  # noqa: E402

WORM_FPS = 15.0
SHORT_FILMS = ("fish", "light", "debris")


def distances(points: Array, line: Array) -> Array:
    """Distance (N,) of points (N, 2) from a polyline (P, 2)."""
    start, along = line[:-1], np.diff(line, axis=0)
    share = np.clip(np.sum((points[:, None] - start) * along, axis=2) / np.sum(along**2, axis=1), 0.0, 1.0)
    return np.linalg.norm(points[:, None] - start - share[:, :, None] * along, axis=2).min(axis=1)


def worm(short: bool) -> dict[str, float]:
    """Median distance to the outside reference [px], its worst accepted frame, shares accepted and rejected."""
    folder = Path(os.environ.get("TENTACLE_DATA", "../shared/data")) / "worm_crops"
    if not (folder / "reference_midlines.npz").exists():
        print(f"worm video: skipped, {folder} is not there")
        return {}
    reference = np.load(folder / "reference_midlines.npz")["midline_px"]
    frames = list(read_frames(folder / "frames", WORM_FPS))
    step = 5 if short else 1
    body, reference = track_body(frames[::step]), reference[::step]
    known = np.isfinite(reference).all(axis=(1, 2))
    both = np.flatnonzero(known & body.accepted)
    per_frame = [np.median(distances(reference[k], body.midline[k])) for k in both]
    print(f"worm: {len(both)} of {known.sum()} frames with a reference accepted, {body.words()}")
    return {
        "worm_median_px": float(np.median(per_frame)),
        "worm_worst_px": float(max(distances(reference[k], body.midline[k]).max() for k in both)),
        "worm_accepted": float(body.accepted[known].mean()),
        "worm_flagged_without_reference": float((~body.accepted[~known]).mean()),
    }


def frames_per_second(size: tuple[int, int], frames: int, length: int) -> float:
    """Tracking rate with decoding, past the first frames, on a clip that runs to and fro until it has length frames."""
    scene = swaying(seed=1, frames=frames, size=size)
    pictures = list(render(scene.midline, scene.specimen, scene.camera, RenderSettings(scene.size, CLEAN, 1)))
    there_and_back = [*range(frames), *range(frames - 2, 0, -1)]
    order = [there_and_back[k % len(there_and_back)] for k in range(length)]
    times = np.arange(length) / scene.camera.fps
    with tempfile.TemporaryDirectory() as folder:
        video = Path(folder) / "video.mp4"
        write_video(video, (pictures[k] for k in order), times, crf=18)
        motor = MotorSignal(times, scene.theta[order], scene.theta[order])
        _, results = stream_tracking(video, Declaration(scene.specimen, camera=scene.camera), motor)
        begin, busy, accepted = 0.0, 0.0, 0
        for k, seen in enumerate(results):
            accepted += seen.accepted
            if k == length // 3:
                begin, busy = time.perf_counter(), time.process_time()
        measured = length - length // 3 - 1
        rate, busy = measured / (time.perf_counter() - begin), (time.process_time() - busy) / measured
    print(f"{size[0]}x{size[1]}: {rate:.0f} frames/s, {1e3 * busy:.1f} ms CPU a frame, {accepted} of {length} accepted")
    return rate


def rates(short: bool) -> dict[str, float]:
    """Tracking rates [frames/s] of two sizes."""
    return {
        "fps_720p": frames_per_second((1280, 720), 30 if short else 120, 90 if short else 600),
        "fps_4k": frames_per_second((3840, 2160), 10 if short else 30, 45 if short else 150),
    }


def memory_growth(frames: int) -> float:
    """Growth of the resident memory [MB] while a long stream is followed, from its first tenth to its end."""
    scene = swaying(seed=1, frames=40, size=(160, 120))
    pictures = list(render(scene.midline, scene.specimen, scene.camera, RenderSettings(scene.size, CLEAN, 1)))
    there_and_back = [*range(40), *range(38, 0, -1)]
    order = [there_and_back[k % len(there_and_back)] for k in range(frames)]
    times = np.arange(frames) / scene.camera.fps
    with tempfile.TemporaryDirectory() as folder:
        video = Path(folder) / "video.mp4"
        write_video(video, (pictures[k] for k in order), times)
        motor = MotorSignal(times, scene.theta[order], scene.theta[order])
        _, results = stream_tracking(video, Declaration(scene.specimen, camera=scene.camera), motor)
        begin = 0.0
        for k, _ in enumerate(results):
            if k == frames // 10:
                begin = resident_megabytes()
        growth = resident_megabytes() - begin
    print(f"memory: {growth:+.1f} MB over {frames - frames // 10} frames")
    return growth


def outside_films(short: bool, seed: int = 1) -> dict[str, float]:
    """Films of an outside program: share of visible frames accepted, of accepted ones wrong, rms over limit, proposals.

    A film's limit is that of its delivered pictures' own errors; see _outside_limit.
    """
    films = [film for film in FILMS if film.name in SHORT_FILMS] if short else FILMS
    judged: list[Judged] = []
    for film in films:
        judged.append(judge_film(film, seed))
        j = judged[-1]
        print(
            f"{j.film:11s} {j.seen:3d} of {j.visible:3d} visible accepted, {j.wrong} of {j.accepted} wrong,"
            f" rms {j.rms_px:.3f} px, {j.rms_px / j.limit_px:.1f} times the limit, z {j.z_rms:.2f};"
            f" part hidden: {j.hidden_accepted} of {j.hidden}, z {j.hidden_z:.2f}; {j.words}",
            flush=True,
        )
    picked = [judge_pick(film, seed) for film in films]
    for p in picked:
        state = "right" if p.right else "WRONG"
        print(
            f"{p.film:11s} {state}: base {p.base_px:.1f} px off, length {p.longer:+.3f}, {p.turned:.2f} rad; {p.words}"
        )
    plain = [judge_plain(film, seed) for film in films]
    for p in plain:
        state = "tracked" if p.tracked else "NOT tracked"
        print(f"{p.film:11s} plain: {state}, {p.seen} of {p.in_view}, base {p.base_px:.1f} px off; {p.words}")
    accepted = max(sum(j.accepted for j in judged), 1)
    over = [j.rms_px / j.limit_px for j in judged if j.visible]
    return {
        "other_renderer_accepted": sum(j.seen for j in judged) / sum(j.visible for j in judged),
        "other_renderer_false": sum(j.wrong for j in judged) / accepted,
        "other_renderer_over_limit": float(np.nanmax(over)),
        "other_renderer_over_limit_median": float(np.nanmedian(over)),
        "other_renderer_films": float(len(films)),
        "other_renderer_picked": float(np.mean([p.right for p in picked])),
        "other_renderer_plain": float(np.mean([p.tracked for p in plain])),
    }


def resident_megabytes() -> float:
    pages = int(Path("/proc/self/statm").read_text(encoding="utf-8").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, required=True)
    parser.add_argument("--short", action="store_true", help="few frames, few looks: does it run, not how good is it")
    parser.add_argument("--films", action="store_true", help="the worm and the outside program's films alone")
    parser.add_argument("--speed", action="store_true", help="the tracking rates alone")
    parser.add_argument("--seed", type=int, default=1, help="of the outside program's films (default 1)")
    arguments = parser.parse_args()
    short = arguments.short
    figures: dict[str, float] = {}
    if arguments.speed:
        arguments.json.write_text(json.dumps({"figures": rates(short)}, indent=1), encoding="utf-8")
        return
    figures |= worm(short)
    figures |= outside_films(short, arguments.seed)
    if arguments.films:
        arguments.json.write_text(json.dumps({"figures": figures}, indent=1), encoding="utf-8")
        return
    figures |= rates(short)
    figures["memory_growth_mb"] = memory_growth(1500 if short else 20_000)
    looks = ["clean", "tank"] if short else list(LOOKS)
    results = []
    for name in looks:
        size = (640, 360) if short else (1280, 720)
        results.append(judge_look(LOOKS[name], (1,) if short else (1, 2, 3), 30 if short else 150, size))
        print(look_table(results[-1:]) if len(results) == 1 else look_table(results[-1:]).splitlines()[-1], flush=True)
    figures["rms_over_limit_max"] = max(result.rms_over_limit for result in results)
    figures["rms_over_pose_known_max"] = max(result.rms_over_pose_known for result in results)
    figures["z_rms_min"] = min(result.z_rms for result in results)
    figures["z_rms_max"] = max(result.z_rms for result in results)
    figures["false_accepts"] = float(sum(result.false_accepts for result in results))
    for disturb in ("hand", "second_arm"):
        tracked, wrong = judge_disturbed(disturb, 3, 30 if short else 90, (640, 360) if short else (1280, 720))
        figures[f"false_accepts_{disturb}"] = float(wrong)
        print(f"{disturb}: {tracked.shape.accepted.mean():.0%} accepted, {wrong} wrongly; {'; '.join(tracked.remarks)}")
    arguments.json.write_text(
        json.dumps({"figures": figures, "looks": results_json(results)}, indent=1), encoding="utf-8"
    )
    for name, value in figures.items():
        print(f"{name:32s} {value:.4g}")


if __name__ == "__main__":
    main()
