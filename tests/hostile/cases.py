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
from tests.hostile.mutations import KINDS, damaged_bytes, damaged_csv, damaged_toml, damaged_xml
from tests.hostile.odd_inputs import odd_cases
from tests.hostile.tables import BYTES, CSV, NUMBERS, OPTIONS, OUTS, PLACES, TOML, WORDS, WORK

Damage = Callable[[Path], None]
LABELS = ("names", "gauges", "accelerometers")  # fields of a signal that hold no numbers


def cases(seed: int) -> list[Case]:
    """All of them, in an order that mixes the kinds, so that a part of them is a fair sample."""
    found = [*_texts(seed), *_bytes(seed), *_stored(seed), *_places(), *_options(seed), *_disks(seed), *_outs(seed),
             *_signals(seed), *_surroundings(), *odd_cases()]  # fmt: skip
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

    for k in range(30):
        name = f"arm.xml: import-arm #{k}"
        prepare = partial(_rewrite, "arm.xml", damaged_xml, _random(seed, name))
        yield Case(name, ("import-arm", "arm.xml", "--out", "out.toml"), ("arm.xml",), prepare, stop=4.0)


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
    for name in ("motor", "load_cell", "midline", "markers", "strain", "acceleration"):
        a, b = getattr(found, name), getattr(true, name)
        if (a is None) != (b is None):
            return f"{name} is gone and nothing said"
        for field in () if a is None else vars(a):
            if not np.array_equal(getattr(a, field), getattr(b, field), equal_nan=field not in LABELS):
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
        if len(options) > 1:  # two that are wrong at once, or one twice
            for k in range(4):
                random = _random(seed, f"{' '.join(arguments[:2])} pair {k}")
                flags = [options[j].split() for j in random.choice(len(options), size=2)]
                more = [word for flag, *rest in flags for word in (flag, *_drawn(random, max(1, len(rest))))]
                name = f"{' '.join(arguments[:2])} {' '.join(word[:20] for word in more)}"
                yield Case(name, (*arguments, *more), inputs, stop=4.0)
    for word in WORDS:
        yield Case(f"library --where {word!r}", ("library", "library", "--where", word), ("library",), stop=10.0)
        yield Case(f"library --sort {word!r}", ("library", "library", "--sort", word), ("library",), stop=10.0)


def _drawn(random: np.random.Generator, count: int) -> list[str]:
    return [NUMBERS[int(random.integers(len(NUMBERS)))]] * count


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


def _outs(seed: int) -> Iterator[Case]:
    """Places that a careless command writes to: what was there before must be there afterwards."""
    for arguments, inputs in WORK:
        name = " ".join(arguments[:2])
        out = next(k for k, word in enumerate(arguments) if word.startswith("out"))
        drawn = _random(seed, f"outs {name}").choice(len(OUTS), size=6, replace=False)
        for place in (*(OUTS[k] for k in drawn), *inputs[:1]):
            changed = (*arguments[:out], place, *arguments[out + 1 :])
            yield Case(
                f"{name} to {place[:20]!r}", changed, inputs, _traps, stop=6.0, kept=("mine/notes.txt", "taken.rrd")
            )


def _traps(folder: Path) -> None:
    _take(folder)
    (folder / "taken.rrd").write_text("not a recording")
    (folder / "mine").mkdir()
    (folder / "mine" / "notes.txt").write_text("mine")
    (folder / "loop").symlink_to("loop")
    (folder / "dangling").symlink_to("nowhere")
    (folder / "full").symlink_to("/dev/full")
    os.mkfifo(folder / "fifo")


def _signals(seed: int) -> Iterator[Case]:
    for arguments, inputs in WORK:
        name = f"{' '.join(arguments[:2])}"
        random = _random(seed, name)
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT):
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
