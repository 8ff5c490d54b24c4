"""An .rrd file's chunks, one after the other, in bounded memory.

A single wrong bit can make Rerun's reader abort its process. So it reads in a child process, and an abort there is an
InputError here. Only files that this process has written, unchanged since, are read directly. A file that was cut off
is read up to its last whole message.
"""

from __future__ import annotations

import os
import shutil
import struct
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, NamedTuple

import pyarrow as pa

from tentacle.errors import InputError

MAGIC = b"RRF2"
FOOTER_MAGIC = b"RRF2FOOT"  # begins the last 12 bytes of a file that was closed
FOOTER_END = 12
STREAM_HEADER = 12  # bytes: magic, version, encoding options
MESSAGE_HEADER = struct.Struct("<QQ")  # kind, length of what follows
END, KINDS = 0, range(4)  # kinds of messages: the end, a store, rows, a blueprint to show; Rerun stops at any other
HEAD = struct.Struct("<?IQ")  # of a chunk from the child: static, length of the path, length of the batch
CHILD_MEMORY = (
    4 * 2**30
)  # bytes that the child may use besides eight times the file, because a wrong length can ask for any number

_own: dict[str, tuple[int, int, int]] = {}


class Chunk(NamedTuple):
    """Rows of one entity: its path, whether they are static, and the rows as Rerun lays them out."""

    entity: str
    static: bool
    batch: pa.RecordBatch


def just_written(file: Path) -> None:
    """Remembers a file that this process has just written: it may be read without a child."""
    _own[str(file.resolve())] = _identity(file)


def read_chunks(file: Path) -> Iterator[Chunk]:
    """The file's chunks up to its end or the cut. InputError where it is no .rrd or is damaged."""
    with _whole_part(file) as whole:
        direct = _own.get(str(file.resolve())) == _identity(file)
        yield from (_read_here if direct else _read_in_child)(whole, file)


def has_header(file: Path) -> bool:
    """Whether a file begins as an .rrd does. OSError where it cannot be read."""
    if not file.stat().st_size:  # files of /proc have no size, and some of them wait for ever
        return False
    with file.open("rb") as opened:
        return opened.read(len(MAGIC)) == MAGIC


def has_footer(file: Path) -> bool:
    """Whether a file was written to its end and closed. OSError where it cannot be read."""
    with file.open("rb") as opened:
        return _ends_with_footer(opened, file.stat().st_size)


def bytes_lost(file: Path) -> int:
    """How many bytes at the end are no whole message; 0 where the file is whole."""
    return _length(file) - _whole_length(file)


def _length(file: Path) -> int:
    try:
        return file.stat().st_size
    except OSError as error:
        raise InputError(error.strerror or str(error), file=file, expected="an .rrd file") from None


def _identity(file: Path) -> tuple[int, int, int]:
    found = file.stat()
    return found.st_ino, found.st_mtime_ns, found.st_size


@contextmanager
def _whole_part(file: Path) -> Iterator[Path]:
    """The file, or a copy of what is whole of it."""
    whole = _whole_length(file)
    if whole == _length(file):
        yield file
        return
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "recovered.rrd"
        shutil.copyfile(file, copy)
        os.truncate(copy, whole)
        yield copy


def _whole_length(file: Path) -> int:
    """Bytes up to the end of the last whole message: messages follow one another, each led by its length.

    InputError where a message is of no known kind: Rerun would end there without a word.
    """
    length = _length(file)
    if not length:
        raise InputError("not an .rrd file: it is empty", file=file, expected="a file that begins with RRF2")
    with file.open("rb") as opened:
        head = opened.read(STREAM_HEADER)
        if head[: len(MAGIC)] != MAGIC[: len(head)] or not head:
            raise InputError("not an .rrd file", file=file, expected="a file that begins with RRF2")
        closed = _ends_with_footer(opened, length)
        position = STREAM_HEADER
        while position + MESSAGE_HEADER.size <= length:
            opened.seek(position)
            kind, size = MESSAGE_HEADER.unpack(opened.read(MESSAGE_HEADER.size))
            if kind not in KINDS:
                raise InputError(f"damaged: no message begins at byte {position}", file=file, expected="an .rrd file")
            if position + MESSAGE_HEADER.size + size > length:
                break
            position += MESSAGE_HEADER.size + size
            if closed and kind == END:
                return length
    return min(position, length)


def _ends_with_footer(opened: IO[bytes], length: int) -> bool:
    opened.seek(max(0, length - FOOTER_END))
    return opened.read(len(FOOTER_MAGIC)) == FOOTER_MAGIC


def _read_here(whole: Path, file: Path) -> Iterator[Chunk]:
    from rerun.chunk import RrdReader  # it takes a second to import

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # a file without a footer was cut off: that is told by the caller
            for chunk in RrdReader(str(whole)).stream():
                yield Chunk(str(chunk.entity_path), chunk.is_static, chunk.to_record_batch())
    except (RuntimeError, ValueError) as error:
        if "No recording store" not in str(error):
            raise InputError(f"damaged: {error}", file=file, expected="an .rrd file of Rerun 0.41") from None


def _read_in_child(whole: Path, file: Path) -> Iterator[Chunk]:
    with tempfile.TemporaryFile() as said:
        command = [sys.executable, "-m", "tentacle.io.rrd_chunks", str(whole)]
        child = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=said)
        assert child.stdout is not None
        try:
            yield from _received(child.stdout)
            code = child.wait()
        finally:
            child.kill()
            child.wait()
            child.stdout.close()
        if code == 0:
            return
        said.seek(0)
        words = said.read(4000).decode(errors="replace").strip().splitlines()
        reason = words[-1] if code == 3 and words else "its content is not what Rerun writes"
    raise InputError(f"damaged: {reason}", file=file, expected="an .rrd file of Rerun 0.41")


def _received(stream: IO[bytes]) -> Iterator[Chunk]:
    """What the child sends; it ends where the child does."""
    while len(head := stream.read(HEAD.size)) == HEAD.size:
        static, path, size = HEAD.unpack(head)
        entity, content = stream.read(path), stream.read(size)
        if len(content) < size:
            return
        with pa.ipc.open_stream(content) as batches:
            yield Chunk(entity.decode(), static, batches.read_next_batch())


def _send(file: Path, out: IO[bytes]) -> None:
    """In the child: sends the file's chunks."""
    _limit_memory(CHILD_MEMORY + 8 * file.stat().st_size)
    for chunk in _read_here(file, file):
        sink = pa.BufferOutputStream()
        with pa.ipc.new_stream(sink, chunk.batch.schema) as batches:
            batches.write_batch(chunk.batch)
        content, entity = sink.getvalue(), chunk.entity.encode()
        out.write(HEAD.pack(chunk.static, len(entity), content.size))
        out.write(entity)
        out.write(content)
    out.flush()


def _limit_memory(most: int) -> None:
    """So many bytes at most, and no dump of them; where the system can."""
    if sys.platform == "win32":
        return
    import resource

    allowed = resource.getrlimit(resource.RLIMIT_AS)[1]  # who started us may have set less: more cannot be asked for
    if allowed == resource.RLIM_INFINITY or most < allowed:
        resource.setrlimit(resource.RLIMIT_AS, (most, most))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


if __name__ == "__main__":
    try:
        _send(Path(sys.argv[1]), sys.stdout.buffer)
    except InputError as error:
        print(error.problem.removeprefix("damaged: "), file=sys.stderr)
        sys.exit(3)
    except KeyboardInterrupt:
        sys.exit(130)
