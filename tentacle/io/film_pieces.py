"""A video file of any length inside an .rrd: its bytes in pieces, one for each row, so that it is never in memory as a
whole.

Entity /camera/film: rows on the timeline `row` with piece (bytes) and sha256; static suffix and count of the pieces.
The viewer shows no picture of it; a rig's own recording has its frames beside it.
"""

from __future__ import annotations

import hashlib
from pathlib import Path

import rerun as rr

from tentacle.errors import InputError
from tentacle.io.rrd_chunks import read_chunks
from tentacle.io.rrd_columns import EntityColumns, add
from tentacle.io.video_store import video_folder

FILM_ENTITY = "/camera/film"
LARGE_VIDEO = 64 * 2**20  # bytes; up to here a video is one message, which the viewer plays
PIECE = 4 * 2**20  # bytes


def log_film(stream: rr.RecordingStream, file: Path) -> None:
    """Writes a video file's bytes."""
    count = -(-file.stat().st_size // PIECE)
    stream.log(FILM_ENTITY, rr.AnyValues(suffix=file.suffix, count=count), static=True)
    with file.open("rb") as opened:
        number = 0
        while piece := opened.read(PIECE):
            stream.set_time("row", sequence=number)
            stream.log(FILM_ENTITY, rr.AnyValues(piece=[piece], sha256=hashlib.sha256(piece).hexdigest()))
            stream.flush()  # else the writer would hold them all
            number += 1
    stream.reset_time()


def stored_film(file: Path) -> Path | None:
    """The video of an .rrd as a file in the cache; None where it holds none, or not all of it.

    InputError where a piece does not agree with its checksum.
    """
    found = file.stat()
    key = hashlib.sha256(f"{file.resolve()} {found.st_size} {found.st_mtime_ns}".encode()).hexdigest()[:32]
    partial = video_folder() / f".{key}.partial"
    head, count = EntityColumns(), 0
    total = hashlib.sha256()
    try:
        with partial.open("wb") as out:
            for chunk in read_chunks(file):
                if chunk.entity != FILM_ENTITY:
                    continue
                if chunk.static:
                    add(head, chunk.batch, static=True)
                    continue
                rows = EntityColumns()
                add(rows, chunk.batch, static=False)
                for number, piece, sha256 in zip(
                    rows.times("row").tolist(), rows.row_bytes("piece"), rows.texts("sha256"), strict=True
                ):
                    if number != count or hashlib.sha256(piece).hexdigest() != sha256:
                        raise InputError(f"piece {number} is damaged", file=file, field="camera")
                    out.write(piece)
                    total.update(piece)
                    count += 1
        if not head.has_static("suffix", "count") or count != int(head.static("count")[0]):
            return None
        stored = video_folder() / f"{total.hexdigest()[:32]}{head.static('suffix')[0]}"
        partial.replace(stored)
        return stored
    finally:
        partial.unlink(missing_ok=True)
