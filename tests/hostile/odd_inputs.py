"""Inputs that are odd rather than damaged: expressions, campaigns, films, recordings and names as nobody should write
them.
"""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import numpy as np

from tests.hostile.judge import Case

Damage = Callable[[Path], None]
EXPRESSIONS = (
    "(" * 3000 + "F" + ")" * 3000, "F" + "+F" * 20000, "F^2^2^2^2", "-" * 5000 + "F", "F.__class__",
    "__import__('os').system('touch spied')", "(lambda: F)()", "[F for F in ()]", "\uff26", "F/0", "F*log(0-1)",
    "F*0^(0-1)", "F*10^10^10", "nan*F", "F if x > 0 else F", "F*exp(exp(exp(x/reference*100)))", "", "F\n+F", "F[0]",
    "F*1j", "1" * 5000 + "*F", "F; import os",
)  # fmt: skip
WAVEFORMS = (
    'kind = "samples"\nt_s = [0.0]\nangle_rad = [0.1]', 'kind = "samples"\nt_s = []\nangle_rad = []',
    'kind = "samples"\nt_s = [0, 1]\nangle_rad = [0]', 'kind = "samples"\nt_s = [0, 0, 0]\nangle_rad = [0, 1, 0]',
    'kind = "samples"\nt_s = [0, 1e-300, 2e-300]\nangle_rad = [0, 1, 0]', "kind = 3", 'kind = ["sine"]',
    'kind = "sine"\namplitude_rad = 0.1\nfrequency_hz = 1e9', 'kind = "sine"\namplitude_rad = 1e9\nfrequency_hz = 1',
    'kind = "multisine"\namplitudes_rad = [1]\nfrequencies_hz = [1, 2]\nphases_rad = [0]',
    'kind = "gait"\nalpha = [1, 2]', 'kind = "chirp"\namplitude_rad = 0.1\nstart_hz = 3\nstop_hz = 0\nduration_s = 0',
)  # fmt: skip
RUN = '[[run]]\nname = {name}\nduration_s = {seconds}\n[run.waveform]\nkind = "rest"\n'
RUN_NAMES = (
    '"/../../x"', '".."', '"a\\nb"', '"' + "x" * 300 + '"', '"~root"', '"$HOME"', '""', '"a\\u0000b"', '".hidden"',
    "3", '["a"]', '"\\u202eabc"',
)  # fmt: skip
LENGTHS = (
    "[0.14]", "{value = {value = 1}}", "1979-05-27T07:32:00+23:59", "true", "-0.0", "+nan", "9" * 5000, '"0.14"',
    "{value = 0.14, sd = 0.01, low = 0}", "0.14\nlength_m = 0.15", "0.14\n[specimen.length_m]\nvalue = 1",
    "0.14\n[specimen]",
)  # fmt: skip
VERDICTS = ('reject = ["0-999999999"]', "reject = [1, -1]", "reject = 3", "rejekt = []", "reject = [[[]]]")
NAMES = ("new\nline", "$HOME", "x" * 250, "it's", "a;touch spied", "*", "\u202eabc", "%s", "{x}", "C:", "-x")


def odd_cases() -> Iterator[Case]:
    """All of them; none depends on a seed."""
    yield from _texts()
    yield from _films()
    yield from _recordings()
    for name in NAMES:
        yield Case(f"import of a folder named {name[:12]!r}", ("import", f"./{name}", "--out", "out.rrd"),
                   ("folder",), partial(_renamed, "folder", name), stop=6.0)  # fmt: skip
        yield Case(f"export to {name[:12]!r}", ("export", "model.toml", f"--out={name}"), ("model.toml",), stop=6.0)


def _texts() -> Iterator[Case]:
    simulate = ("simulate", "model.toml", "--out", "out", "--duration", "1")
    for k, expression in enumerate(EXPRESSIONS):
        force = f"force_x = {json.dumps(expression)}"
        yield Case(f"effect with an odd expression #{k}", (*simulate, "--effects", "effect.toml"),
                   ("model.toml", "effect.toml"), partial(_replaced, "effect.toml", "force_x = .*", force),
                   stop=6.0)  # fmt: skip
    for k, text in enumerate(WAVEFORMS):
        yield Case(f"odd waveform #{k}", (*simulate, "--waveform", "waveform.toml"), ("model.toml",),
                   partial(_written, "waveform.toml", f"[waveform]\n{text}\n"), stop=6.0)  # fmt: skip
    runs = [RUN.format(name=name, seconds=1.0) for name in RUN_NAMES]
    runs += [RUN.format(name='"a"', seconds=seconds) for seconds in ("nan", "0", "1e12", "[1]")]
    runs += [RUN.format(name='"a"', seconds=1) * 2, RUN.format(name='"a"', seconds="1\nrepeat = 1000000000")]
    runs += ["".join(RUN.format(name=f'"r{k}"', seconds=1) for k in range(3000)), "run = 3\n", "run = [1, 2]\n"]
    for k, text in enumerate(runs):
        yield Case(f"odd campaign #{k}", ("rig", "campaign", "rig.toml", "campaign.toml", "--out", "out"),
                   ("rig.toml",), partial(_written, "campaign.toml", f'name = "odd"\n{text}'), stop=6.0)  # fmt: skip
    for k, value in enumerate(LENGTHS):
        for file, command in (("model.toml", simulate), ("rig.toml", ("rig", "check", "rig.toml"))):
            yield Case(f"{file} with an odd length #{k}", command, (file,),
                       partial(_replaced, file, "length_m = .*", f"length_m = {value}"), stop=6.0)  # fmt: skip
    for k, text in enumerate(VERDICTS):
        change = partial(_written, "film/video.mp4.proofread.toml", f"{text}\n")
        yield Case(f"odd verdicts on frames #{k}", ("track", "film", "--out", "out.csv"), ("film",), change,
                   must_refuse=True, stop=6.0)  # fmt: skip


def _films() -> Iterator[Case]:
    kinds: tuple[tuple[str, bool, Damage], ...] = (
        ("of one picture", False, partial(_film, 1)), ("of two pictures", False, partial(_film, 2)),
        ("of sound alone", True, _sound), ("without its index", True, _no_index),
        ("that is a playlist", True, partial(_written, "film/video.mp4", "#EXTM3U\n#EXTINF:9,\n/etc/passwd\n")),
        ("that is a list of files", True, partial(_written, "film/video.mp4", "ffconcat version 1.0\nfile /etc/x\n")),
        ("with a box of length 0", False, _empty_box),
    )  # fmt: skip
    for words, refuse, change in kinds:
        yield Case(f"import of a film {words}", ("import", "film", "--out", "out.rrd"), ("film",), change,
                   must_refuse=refuse, stop=10.0)  # fmt: skip
        yield Case(f"track of a film {words}", ("track", "film", "--out", "out.csv"), ("film",), change,
                   must_refuse=refuse, stop=10.0)  # fmt: skip


def _recordings() -> Iterator[Case]:
    kinds: tuple[tuple[str, Damage], ...] = (
        ("twice in one file", _doubled), ("of two runs in one file", _joined), ("of a newer version", _newer),
    )  # fmt: skip
    for words, change in kinds:
        for command in (("check", "whole.rrd"), ("import", "whole.rrd", "--out", "out.rrd"),
                        ("identify", "whole.rrd", "--out", "out"), ("rig", "import", "whole.rrd", "--out", "out"),
                        ("track", "whole.rrd", "--out", "out.csv")):  # fmt: skip
            yield Case(f"{' '.join(command[:2])} {words}", command, ("whole.rrd", "run.rrd"), change, stop=10.0)


def _written(path: str, text: str, folder: Path) -> None:
    (folder / path).write_text(text)


def _replaced(path: str, pattern: str, text: str, folder: Path) -> None:
    found = re.sub(pattern, lambda _: text, (folder / path).read_text(), count=1)
    (folder / path).write_text(found)


def _renamed(path: str, name: str, folder: Path) -> None:
    shutil.copytree(folder / path, folder / name)


def _film(count: int, folder: Path) -> None:
    import av

    with av.open(str(folder / "film" / "video.mp4"), "w") as container:
        stream = container.add_stream("libx264", rate=20)
        stream.width, stream.height, stream.pix_fmt = 160, 240, "yuv420p"
        for k in range(count):
            picture = np.full((240, 160, 3), 200 - k, np.uint8)
            container.mux(stream.encode(av.VideoFrame.from_ndarray(picture, format="rgb24")))
        container.mux(stream.encode(None))


def _sound(folder: Path) -> None:
    import av

    with av.open(str(folder / "film" / "video.mp4"), "w") as container:
        stream = container.add_stream("aac", rate=44100)
        silence = av.AudioFrame.from_ndarray(np.zeros((1, 1024), np.float32), format="fltp", layout="mono")
        silence.sample_rate, silence.pts = 44100, 0
        container.mux(stream.encode(silence))
        container.mux(stream.encode(None))


def _no_index(folder: Path) -> None:
    film = folder / "film" / "video.mp4"
    content = film.read_bytes()
    film.write_bytes(content[: content.rfind(b"moov") - 4])


def _empty_box(folder: Path) -> None:
    film = folder / "film" / "video.mp4"
    content = bytearray(film.read_bytes())
    at = content.rfind(b"ilst")
    content[at - 4 : at] = bytes(4)
    film.write_bytes(content)


def _doubled(folder: Path) -> None:
    file = folder / "whole.rrd"
    file.write_bytes(2 * file.read_bytes())


def _joined(folder: Path) -> None:
    file = folder / "whole.rrd"
    file.write_bytes(file.read_bytes() + (folder / "run.rrd").read_bytes())


def _newer(folder: Path) -> None:
    content = bytearray((folder / "whole.rrd").read_bytes())
    content[4:8] = bytes([0, 99, 0, 0])
    (folder / "whole.rrd").write_bytes(content)
