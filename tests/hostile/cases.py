"""The cases: damage of each kind to each input of each verb, all drawn from one seed."""

from __future__ import annotations

import os
import signal
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from zlib import crc32

import numpy as np

from tests.hostile.judge import Case
from tests.hostile.mutations import KINDS, damaged_bytes, damaged_csv, damaged_toml

Damage = Callable[[Path], None]

# name of the material that is damaged, the file in it, the command, the other material it needs
TOML = (
    ("folder", "recording.toml", ("import", "folder", "--out", "out.rrd"), (), 40),
    ("film", "recording.toml", ("import", "film", "--out", "out.rrd"), (), 30),
    ("folder", "recording.toml", ("identify", "folder", "--out", "out", "--order", "2"), (), 12),
    ("folder", "recording.toml", ("diagnose", "folder", "--out", "out"), (), 8),
    ("film", "recording.toml", ("track", "film", "--out", "out.csv"), (), 12),
    ("model.toml", "", ("simulate", "model.toml", "--out", "out", "--duration", "1"), (), 40),
    ("model.toml", "", ("optimise", "model.toml", "--out", "out", "--no-reference", "--evaluations", "100"), (), 10),
    ("model.toml", "", ("compare", "model.toml", "--out", "out", "--no-map"), (), 8),
    ("model.toml", "", ("figure", "9", "--model", "model.toml", "--out", "out.svg"), (), 8),
    ("waveform.toml", "", ("simulate", "model.toml", "--waveform", "waveform.toml", "--duration", "1", "--out", "out"),
     ("model.toml",), 20),
    ("samples.toml", "", ("simulate", "model.toml", "--waveform", "samples.toml", "--duration", "1", "--out", "out"),
     ("model.toml",), 12),
    ("rig.toml", "", ("rig", "check", "rig.toml"), (), 30),
    ("rig.toml", "", ("rig", "record", "rig.toml", "waveform.toml", "--seconds", "2", "--out", "out.rrd"),
     ("waveform.toml",), 10),
    ("waveform.toml", "", ("rig", "record", "rig.toml", "waveform.toml", "--seconds", "2", "--out", "out.rrd"),
     ("rig.toml",), 12),
    ("campaign.toml", "", ("rig", "campaign", "rig.toml", "campaign.toml", "--out", "out"), ("rig.toml",), 30),
    ("model.toml", "", ("rig", "optimise", "rig.toml", "--model", "model.toml", "--out", "out"), ("rig.toml",), 6),
    ("limits.toml", "", ("optimise", "model.toml", "--limits", "limits.toml", "--out", "out", "--no-reference",
                         "--evaluations", "100"), ("model.toml",), 12),
    ("calibration.toml", "", ("diagnose", "folder", "--calibration", "calibration.toml", "--out", "out"),
     ("folder",), 12),
    ("lens.toml", "", ("track", "film", "--lens", "lens.toml", "--out", "out.csv"), ("film",), 12),
)  # fmt: skip
CSV = (
    ("folder", "motor.csv", ("import", "folder", "--out", "out.rrd"), (), 20),
    ("folder", "load_cell.csv", ("import", "folder", "--out", "out.rrd"), (), 16),
    ("folder", "midline.csv", ("import", "folder", "--out", "out.rrd"), (), 24),
    ("folder", "markers.csv", ("import", "folder", "--out", "out.rrd"), (), 16),
    ("folder", "midline.csv", ("identify", "folder", "--out", "out", "--order", "2"), (), 6),
    ("folder", "motor.csv", ("diagnose", "folder", "--out", "out"), (), 6),
    ("folder", "motor.csv", ("render", "folder", "--out", "out", "--seed", "1"), (), 4),
    ("log.csv", "", ("rig", "import", "log.csv", "--declare", "film/recording.toml", "--out", "out"), ("film",), 16),
    ("speeds.csv", "", ("figure", "10", "speeds.csv", "--out", "out.svg"), (), 10),
)
BYTES = (
    ("film", "video.mp4", ("import", "film", "--out", "out.rrd"), (), 16),
    ("film", "video.mp4", ("track", "film", "--out", "out.csv"), (), 14),
    ("film.mp4", "", ("track", "film.mp4", "--length", "0.14", "--base-radius", "0.0125", "--tip-radius", "0.003",
                      "--out", "out.csv"), (), 8),
    ("stills", "frames/00001.png", ("track", "stills", "--out", "out.csv"), (), 10),
    ("frames", "00002.png", ("calibrate", "frames", "--out", "out.toml"), (), 4),
    ("film.rrd", "", ("track", "film.rrd", "--out", "out.csv"), (), 10),
    ("film.rrd", "", ("replay", "film.rrd", "--out", "out"), (), 4),
    ("run.rrd", "", ("rig", "import", "run.rrd", "--out", "out"), (), 40),
    ("whole.rrd", "", ("identify", "whole.rrd", "--out", "out", "--order", "2"), (), 6),
    ("whole.rrd", "", ("view", "whole.rrd", "--screenshot", "out.png"), (), 4),
)  # fmt: skip
PLACES = (
    ("folder", "recording.toml", ("import", "folder", "--out", "out.rrd"), ()),
    ("folder", "midline.csv", ("import", "folder", "--out", "out.rrd"), ()),
    ("folder", "motor.csv", ("identify", "folder", "--out", "out"), ()),
    ("film", "video.mp4", ("track", "film", "--out", "out.csv"), ()),
    ("whole.rrd", "", ("import", "whole.rrd", "--out", "out.rrd"), ()),
    ("run.rrd", "", ("rig", "import", "run.rrd", "--out", "out"), ()),
    ("model.toml", "", ("simulate", "model.toml", "--duration", "1", "--out", "out"), ()),
    ("rig.toml", "", ("rig", "check", "rig.toml"), ()),
    ("stills", "frames/00001.png", ("track", "stills", "--out", "out.csv"), ()),
    ("calibration.toml", "", ("diagnose", "folder", "--calibration", "calibration.toml", "--out", "out"), ("folder",)),
    ("lens.toml", "", ("track", "film", "--lens", "lens.toml", "--out", "out.csv"), ("film",)),
    ("speeds.csv", "", ("figure", "10", "speeds.csv", "--out", "out.svg"), ()),
    ("log.csv", "", ("rig", "import", "log.csv", "--declare", "film/recording.toml", "--out", "out"), ("film",)),
)
NUMBERS = ("-1", "0", "nan", "inf", "1e30", "1000000000000", "-5", "1e-30", "100000", "30000", "9" * 400, "x")
OPTIONS = (
    (("simulate", "model.toml", "--out", "out", "--duration", "1"), ("model.toml",),
     ("--links", "--seed", "--fps", "--duration", "--noise-mm")),
    (("simulate", "model.toml", "--out", "out", "--duration", "1", "--video", "clean"), ("model.toml",),
     ("--size W H",)),
    (("render", "--out", "out", "--seed", "1", "--seconds", "0.2"), (),
     ("--seed", "--seconds", "--fps", "--amplitude", "--frequency", "--exposure", "--compress", "--size W H")),
    (("identify", "folder", "--out", "out"), ("folder",), ("--order", "--bootstrap", "--seed")),
    (("diagnose", "folder", "--out", "out"), ("folder",), ("--seed",)),
    (("optimise", "model.toml", "--out", "out", "--no-reference", "--evaluations", "50"), ("model.toml",),
     ("--evaluations", "--seed", "--robust", "--restarts")),
    (("compare", "model.toml", "--out", "out", "--no-map"), ("model.toml",), ("--amplitude", "--frequency")),
    (("blind-trial", "1", "--out", "out"), (), ("--seed", "--workers", "--video-share", "--only")),
    (("validate", "--out", "out", "--looks", "clean", "--seeds", "1", "--frames", "3"), (),
     ("--seeds", "--frames", "--size W H")),
    (("track", "frames", "--out", "out.csv", "--length", "0.14", "--base-radius", "0.0125", "--tip-radius", "0.003"),
     ("frames",), ("--fps", "--length", "--base-radius", "--m-per-px", "--exposure")),
    (("rig", "record", "rig.toml", "waveform.toml", "--out", "out.rrd"), ("rig.toml", "waveform.toml"),
     ("--seconds",)),
    (("rig", "optimise", "rig.toml", "--out", "out"), ("rig.toml",),
     ("--trials", "--first", "--harmonics", "--reidentify", "--seed", "--frequency W H")),
    (("rig", "calibrate", "camera-scale", "rig.toml", "--points", "1", "2", "3", "4"), ("rig.toml",), ("--metres",)),
    (("calibrate", "--print-board", "out.png"), (), ("--across", "--down", "--square", "--marker")),
    (("figure", "3", "film", "--out", "out.svg"), ("film",), ("--at",)),
)  # fmt: skip
WORK = (
    (("import", "folder", "--out", "out.rrd"), ("folder",)),
    (("import", "film", "--out", "out.rrd"), ("film",)),
    (("simulate", "model.toml", "--out", "out", "--duration", "2"), ("model.toml",)),
    (("simulate", "model.toml", "--out", "out.rrd", "--duration", "2"), ("model.toml",)),
    (("track", "film", "--out", "out.rrd"), ("film",)),
    (("track", "film", "--out", "out.csv", "--overlay", "out.mp4"), ("film",)),
    (("identify", "folder", "--out", "out", "--order", "2"), ("folder",)),
    (("diagnose", "folder", "--out", "out"), ("folder",)),
    (("optimise", "model.toml", "--out", "out", "--no-reference", "--evaluations", "400"), ("model.toml",)),
    (("render", "--out", "out", "--seed", "1", "--seconds", "0.5"), ()),
    (("rig", "import", "run.rrd", "--out", "out"), ("run.rrd",)),
    (("rig", "import", "log.csv", "--declare", "film/recording.toml", "--out", "out"), ("film", "log.csv")),
    (("figure", "10", "speeds.csv", "--out", "out.svg"), ("speeds.csv",)),
    (("calibrate", "--print-board", "out.png"), ()),
)


def cases(seed: int) -> list[Case]:
    """All of them, in an order that mixes the kinds, so that a part of them is a fair sample."""
    found = [*_texts(seed), *_bytes(seed), *_stored(seed), *_places(), *_options(seed), *_disks(seed), *_signals(seed),
             *_surroundings()]  # fmt: skip
    met: Counter[str] = Counter()
    for place, case in enumerate(found):  # two commands may begin alike: the second says that it is one more
        met[case.name] += 1
        if met[case.name] > 1:
            found[place] = replace(case, name=f"{case.name}, {met[case.name]}")
    order = np.random.default_rng(seed).permutation(len(found))
    return [found[k] for k in order]


def _random(seed: int, name: str) -> np.random.Generator:
    return np.random.default_rng((seed, crc32(name.encode())))


def _rewrite(path: str, damage: Callable[..., str], random: np.random.Generator, folder: Path) -> None:
    file = folder / path
    file.write_text(damage(file.read_text(), random), errors="surrogatepass")


def _spoil(path: str, random: np.random.Generator, folder: Path) -> None:
    file = folder / path
    file.write_bytes(damaged_bytes(file.read_bytes(), random))


def _texts(seed: int) -> Iterator[Case]:
    for table, damage in ((TOML, damaged_toml), (CSV, damaged_csv)):
        for material, file, arguments, others, count in table:
            path = f"{material}/{file}" if file else material
            for k in range(count):
                name = f"{path}: {' '.join(arguments[:2])} #{k}"
                prepare = partial(_rewrite, path, damage, _random(seed, name))
                yield Case(name, arguments, (material, *others), prepare, stop=4.0)


def _bytes(seed: int) -> Iterator[Case]:
    for material, file, arguments, others, count in BYTES:
        path = f"{material}/{file}" if file else material
        for k in range(count):
            name = f"{path} bytes: {' '.join(arguments[:2])} #{k}"
            yield Case(name, arguments, (material, *others), partial(_spoil, path, _random(seed, name)),
                       same_run if arguments[1] == "import" else None, stop=4.0)  # fmt: skip


def same_run(folder: Path, said: str) -> str:
    """What differs between the logs of a run as imported and as it was measured, where nothing was said of it."""
    if "cut off" in said:
        return ""
    for name in ("motor.csv", "load_cell.csv"):
        found, true = folder / "out" / name, Path(os.environ["HOSTILE_MATERIAL"]) / "run_as_folder" / name
        if not found.exists() or found.read_bytes() != true.read_bytes():
            return f"{name} was changed and nothing said"
    return ""


def _stored(seed: int) -> Iterator[Case]:
    """Damage to a stored recording must be told: what is imported again is what was stored, or less and told so."""
    for material, count in (("whole.rrd", 70), ("stills.rrd", 20), ("film.rrd", 20)):
        for k in range(count):
            name = f"{material} again #{k}"
            arguments = ("import", material, "--out", "again.rrd")
            yield Case(name, arguments, (material,), partial(_spoil, material, _random(seed, name)), same_signals)
    for k in range(20):
        name = f"check whole.rrd #{k}"
        yield Case(name, ("check", "whole.rrd"), ("whole.rrd",), partial(_spoil, "whole.rrd", _random(seed, name)),
                   same_after_check)  # fmt: skip


def same_signals(folder: Path, said: str) -> str:
    """What differs between the material's signals and the ones stored again, where nothing was said of it."""
    if "cut off" in said:
        return ""
    return _difference(folder / "again.rrd", _material_of(folder, "again.rrd"))


def same_after_check(folder: Path, _said: str) -> str:
    """`tentacle check` has called it sound: then it reads as it was."""
    return _difference(folder / "whole.rrd", _material_of(folder, "whole.rrd"))


def _material_of(folder: Path, other: str) -> Path:
    names = [path.name for path in folder.glob("*.rrd") if path.name != other] or ["whole.rrd"]
    return Path(os.environ["HOSTILE_MATERIAL"]) / names[0]


def _difference(one: Path, other: Path) -> str:
    from tentacle.io.reading import read_recording

    found, true = read_recording(one), read_recording(other)
    if found.declaration != true.declaration:
        return "the declaration was changed and nothing said"
    for name in ("motor", "load_cell", "midline", "markers"):
        a, b = getattr(found, name), getattr(true, name)
        if (a is None) != (b is None):
            return f"{name} is gone and nothing said"
        for field in () if a is None else vars(a):
            if not np.array_equal(getattr(a, field), getattr(b, field), equal_nan=field not in ("names",)):
                return f"{name}.{field} was changed and nothing said"
    if (found.video is None) != (true.video is None):
        return "the video is gone and nothing said"
    if found.video is not None and true.video is not None and _content(found.video.path) != _content(true.video.path):
        return "the video was changed and nothing said"
    return ""


def _content(path: Path) -> list[bytes]:
    return [file.read_bytes() for file in sorted(path.iterdir())] if path.is_dir() else [path.read_bytes()]


def _places() -> Iterator[Case]:
    for material, file, arguments, others in PLACES:
        path = f"{material}/{file}" if file else material
        for kind, change in KINDS:
            optional = kind == "missing" and file in ("motor.csv", "midline.csv")
            yield Case(f"{path} is {kind}: {' '.join(arguments[:2])}", arguments, (material, *others),
                       partial(_change, path, change), must_refuse=not optional, stop=20.0)  # fmt: skip


def _change(path: str, change: Damage, folder: Path) -> None:
    change(folder / path)


def _options(seed: int) -> Iterator[Case]:
    for arguments, inputs, options in OPTIONS:
        for option in options:
            flag, *more = option.split()
            name = f"{' '.join(arguments[:2])} {flag}"
            chosen = _random(seed, name).choice(len(NUMBERS), size=4, replace=False)
            for value in (NUMBERS[k] for k in chosen):
                yield Case(f"{name}={value[:20]}", (*arguments, *(flag, *[value] * max(1, len(more)))), inputs,
                           stop=4.0)  # fmt: skip


def _disks(seed: int) -> Iterator[Case]:
    """Disks that are full after so many bytes, that take nothing, and places that cannot be written."""
    for arguments, inputs in WORK:
        name = f"full disk: {' '.join(arguments[:2])}"
        for size in _random(seed, name).choice([1000, 4096, 20000, 60000], size=2, replace=False).tolist():
            yield Case(f"{name} after {size}", arguments, inputs, file_size=size, stop=20.0)
        out = next(k for k, word in enumerate(arguments) if word.startswith("out"))
        for place in ("/dev/full", "/proc/out", "no/such/folder/" + arguments[out], "taken/" + arguments[out]):
            changed = (*arguments[:out], place, *arguments[out + 1 :])
            yield Case(f"{' '.join(arguments[:2])} to {place}", changed, inputs, _take, stop=20.0)


def _take(folder: Path) -> None:
    (folder / "taken").write_text("a file where a folder is to be")


def _signals(seed: int) -> Iterator[Case]:
    for arguments, inputs in WORK:
        name = f"{' '.join(arguments[:2])}"
        random = _random(seed, name)
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            yield Case(f"{number.name} in {name} ({arguments[-1]})", arguments, inputs,
                       stop=float(random.uniform(0.02, 1.5)), signal=number)  # fmt: skip


def _surroundings() -> Iterator[Case]:
    """Terminals that know no Greek, names with escapes in them, caches that are torn or cannot be written."""
    for arguments, inputs in WORK:
        name = " ".join(arguments[:2])
        yield Case(f"{name} in ASCII", arguments, inputs, encoding="ascii", stop=5.0)
        yield Case(f"{name} without a cache", arguments, inputs,
                   environment={"TENTACLE_CACHE": "/proc/none", "TENTACLE_KERNELS": "/proc/none", "HOME": "/proc"},
                   stop=5.0)  # fmt: skip
    for command in (("import",), ("identify",), ("diagnose",), ("rig", "check"), ("view",), ("check",), ("track",)):
        odd = "odd\x1b[31m\nname\x07.rrd"
        more = ("--out", "out.rrd" if command[0] in ("import", "track") else "out")
        yield Case(f"{command[-1]} of a name with escapes", (*command, odd, *(more if command[0] in (
            "import", "identify", "diagnose", "track") else ())), must_refuse=True)  # fmt: skip
