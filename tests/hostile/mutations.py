"""Damage, drawn from a seed: to bytes, to TOML and CSV text, and to what kind of thing a path is."""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np

Random = np.random.Generator

VALUES = (
    "nan", "inf", "-inf", "-1", "0", "-0.0", "1e308", "-1e308", "1e-308", "1e30", "9" * 400, "1.7e9", "true", '"text"',
    "[]", "[1, 2]", "{}", "{a = 1}", "1979-05-27", '""', "3", "0.5", "-3.0", "100000", "2147483648", "'\\u001b[31m'",
    '"\\u001b[2J"', '"' + "x" * 5000 + '"', "[nan, nan]", "[1e400, 0]", "0x7fffffffffffffff", "[" * 300 + "]" * 300,
    "[" * 5000, '"\\u0000"', '"../../x"', '"/dev/null"', '"spy:///dev/null?file=spied"', '"alt://x?class=os"',
    "5e-324", "-2147483649", "[1.0, \"a\"]", "{value = nan, sd = 1}", "{value = 0.1, sd = -1}", "{low = 1, high = 0}",
    "{value = 1, low = 0}", "0b1", "07:32:00", "[[1], [2]]", '"\u0661"',
)  # fmt: skip
CELLS = (
    "nan", "inf", "-inf", "", "x", "1e308", "-1e308", "1e999", "1.7e9", "-1", "0", "1_0", "0x10", "9" * 400, "1,5",
    '"1', "1e-320", "\x00", "\x1b[31m", "\u0661", "1e12", "None", "true", "--1", "5e3", "1;2", " ", "\ufeff1",
    "1000000000000",
)  # fmt: skip


def damaged_bytes(data: bytes, random: Random) -> bytes:
    """One damage as disks and wires do it: a bit, a byte, a cut, a block of zeros or noise, a block twice or moved."""
    if not data:
        return b"\x00"
    at = int(random.integers(len(data)))
    size = int(random.integers(1, max(2, min(4096, len(data) - at + 1))))
    kind = int(random.integers(9))
    if kind <= 2:
        return data[:at] + bytes([data[at] ^ (1 << int(random.integers(8)))]) + data[at + 1 :]
    if kind == 3:
        return data[:at] + bytes([int(random.integers(256))]) + data[at + 1 :]
    if kind == 4:
        return data[:at]
    if kind == 5:
        return data[:at] + bytes(size) + data[at + size :]
    if kind == 6:
        return data[:at] + random.bytes(size) + data[at + size :]
    if kind == 7:
        return data[: at + size] + data[at:]
    return data[:at] + data[at + size :]


def damaged_toml(text: str, random: Random) -> str:
    """One wrong line, value, key or section."""
    lines = text.splitlines()
    values = [k for k, line in enumerate(lines) if "=" in line]
    k = int(random.choice(values))
    key = lines[k].partition("=")[0]
    kind = int(random.integers(14))
    if kind >= 12:
        return _other_endings("\n".join(lines) + "\n", random)
    if kind <= 5:
        lines[k] = f"{key}= {VALUES[int(random.integers(len(VALUES)))]}"
    elif kind == 6:
        del lines[k]
    elif kind == 7:
        lines.insert(k, lines[k])
    elif kind == 8:
        lines[k] = lines[k].replace(key.strip(), key.strip()[:-1] + "q", 1)
    elif kind == 9:
        headers = [j for j, line in enumerate(lines) if line.startswith("[")]
        if headers:
            del lines[int(random.choice(headers))]
    elif kind == 10:
        lines.append("[a" + ".a" * 3000 + "]")
    else:
        numbers = [j for j, line in enumerate(lines) if re.search(r"\d", line)]
        j = int(random.choice(numbers))
        lines[j] = re.sub(r"\d+(\.\d+)?", lambda _: VALUES[int(random.integers(13))], lines[j], count=1)
    return "\n".join(lines) + "\n"


def damaged_csv(text: str, random: Random) -> str:
    """One wrong cell, row, column or name."""
    lines = text.splitlines()
    row = int(random.integers(1, len(lines)))
    cells = lines[row].split(",")
    column = int(random.integers(len(cells)))
    kind = int(random.integers(14))
    if kind >= 12:
        return _other_endings("\n".join(lines) + "\n", random)
    if kind <= 6:
        cells[column] = CELLS[int(random.integers(len(CELLS)))]
        lines[row] = ",".join(cells)
    elif kind == 7:
        lines[row] = ",".join(cells[:-1])
    elif kind == 8:
        lines.insert(row, lines[row])
    elif kind == 9:
        lines[0] = lines[0].replace("t_s", "time", 1) if "t_s" in lines[0] else "a," + lines[0]
    elif kind == 10:
        lines = lines[:1]
    else:
        other = int(random.integers(1, len(lines)))
        lines[row], lines[other] = lines[other], lines[row]
    return "\n".join(lines) + "\n"


def _other_endings(text: str, random: Random) -> str:
    """The same text as other programs write it, or as a careless editor leaves it."""
    changed = (
        "\ufeff" + text, text.replace("\n", "\r\n"), text.replace("\n", "\r"), text.rstrip("\n"), text + "\x1a",
        "\n\n" + text, text.replace("\n", "\n\n"), text + text, text.replace("0.", "0,"), text.replace(",", ";"),
        text.replace("=", ":"),
        text.replace(",", "\t"), text.replace("-", "\u2212"), text.upper(), text + "\x00", text.replace(" ", "\u00a0"),
    )  # fmt: skip
    return changed[int(random.integers(len(changed)))]


def damaged_xml(text: str, random: Random) -> str:
    """One wrong number, attribute, element or entity."""
    kind = int(random.integers(8))
    numbers = list(re.finditer(r"-?\d+(\.\d+)?(e-?\d+)?", text))
    at = numbers[int(random.integers(len(numbers)))]
    if kind <= 3:
        return text[: at.start()] + VALUES[int(random.integers(13))] + text[at.end() :]
    if kind == 4:
        head = '<!DOCTYPE m [<!ENTITY a "' + "x" * 1000 + '">' + "".join(
            f'<!ENTITY {b} "{f"&{a};" * 10}">' for a, b in zip("abcdefgh", "bcdefghi", strict=True)) + "]>"  # fmt: skip
        return head + text.replace("<worldbody>", "<custom><text name='t' data='&i;'/></custom><worldbody>")
    elements = re.findall(r"<\w+[^>]*/>", text)
    chosen = elements[int(random.integers(len(elements)))]
    if kind == 5:
        return text.replace(chosen, "", 1)
    if kind == 6:
        return text.replace(chosen, chosen + chosen, 1)
    return text.replace("<worldbody>", "<include file='/etc/passwd'/><worldbody>")


def _remade(path: Path) -> None:
    shutil.rmtree(path) if path.is_dir() and not path.is_symlink() else path.unlink()


def _fifo(path: Path) -> None:
    _remade(path)
    os.mkfifo(path)


def _dangling(path: Path) -> None:
    _remade(path)
    path.symlink_to(".git/annex/objects/xx/yy/SHA256E-s1--0.csv")


def _loop(path: Path) -> None:
    _remade(path)
    path.symlink_to(path.name)


def _folder(path: Path) -> None:
    _remade(path)
    path.mkdir()


def _empty(path: Path) -> None:
    _remade(path)
    path.write_bytes(b"")


def _zeros(path: Path) -> None:
    size = path.stat().st_size if path.is_file() else 4096
    _remade(path)
    path.write_bytes(bytes(min(size, 1 << 20)))


def _device(path: Path) -> None:
    _remade(path)
    path.symlink_to("/dev/full")


def _other_text(path: Path) -> None:
    _remade(path)
    path.write_bytes("päper\n".encode("utf-16"))


KINDS: tuple[tuple[str, Callable[[Path], None]], ...] = (
    ("fifo", _fifo), ("dangling", _dangling), ("loop", _loop), ("folder", _folder), ("empty", _empty),
    ("zeros", _zeros), ("device", _device), ("utf16", _other_text), ("missing", _remade),
)  # fmt: skip
