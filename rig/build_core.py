"""Compiles the board's core for this computer, once, into the user's cache; named by a hash of its sources.

A program whose hash does not agree with the stored one is damaged, and is compiled again.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
from pathlib import Path

from tentacle.errors import InputError
from tentacle.private_cache import cache_folder

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
    cache = cache_folder("boards", "TENTACLE_BOARDS")
    target = cache / f"{program}-{digest.hexdigest()[:16]}"
    proof = target.with_name(f"{target.name}.sha256")
    if target.exists() and proof.exists() and proof.read_text() == hashlib.sha256(target.read_bytes()).hexdigest():
        return target
    compiler = os.environ.get("CXX") or shutil.which("g++") or shutil.which("clang++")
    if compiler is None:
        raise InputError("no C++ compiler here", field="rig emulator", expected="g++ (Debian: apt-get install g++)")
    fresh = target.with_suffix(f".{os.getpid()}")
    command = [compiler, *_FLAGS, "-o", str(fresh), str(FIRMWARE / source), *map(str, core)]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    if result.returncode != 0:
        raise InputError(
            f"{Path(compiler).name} failed: {result.stderr.strip().splitlines()[-1:]}", file=FIRMWARE / source
        )
    fresh.replace(target)
    proof.write_text(hashlib.sha256(target.read_bytes()).hexdigest())
    return target
