"""Compiles the board's core for this computer, once, into the user's cache; named by a hash of its sources."""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
from pathlib import Path

from tentacle.errors import InputError

FIRMWARE = Path(__file__).parent / "firmware"
_FLAGS = ["-std=c++17", "-O1", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"]


def compiled(program: str) -> Path:
    """The program ("rig_host" or "core_check"), compiled with sanitizers if it is not there yet.

    InputError where there is no C++ compiler.
    """
    source = {"rig_host": "host/main.cpp", "core_check": "check/core_check.cpp"}[program]
    core = sorted(FIRMWARE.glob("core/*.cpp"))
    digest = hashlib.sha256()
    for file in sorted([*FIRMWARE.glob("*/*.hpp"), *FIRMWARE.glob("*/*.cpp")]):
        digest.update(file.name.encode() + b"\0" + file.read_bytes())
    cache = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "tentacle-twin"
    target = cache / f"{program}-{digest.hexdigest()[:16]}"
    if target.exists():
        return target
    compiler = os.environ.get("CXX") or shutil.which("g++") or shutil.which("clang++")
    if compiler is None:
        raise InputError("no C++ compiler here", field="rig emulator", expected="g++ (Debian: apt-get install g++)")
    cache.mkdir(parents=True, exist_ok=True)
    fresh = target.with_suffix(f".{os.getpid()}")
    command = [compiler, *_FLAGS, "-o", str(fresh), str(FIRMWARE / source), *map(str, core)]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    if result.returncode != 0:
        raise InputError(
            f"{Path(compiler).name} failed: {result.stderr.strip().splitlines()[-1:]}", file=FIRMWARE / source
        )
    fresh.replace(target)
    return target
