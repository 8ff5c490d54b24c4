"""Recordings as a web page on this machine only: Rerun's own page, and a server that gives it the files.

Rerun's program would give them itself, but once it has read them it asks without a pause whether more is to come, and
so keeps a core busy (rerun-io/rerun#10944). A page that is told where the files lie fetches them, and nothing is busy.
"""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from urllib.parse import quote

from tentacle.errors import InputError
from viz.viewer import LOOPBACK, free_port, require_recordings, running, wait_until_listening


def serve_web(files: Sequence[Path], told: Callable[[str], None]) -> int:
    """Serve the viewer as a web page on 127.0.0.1 until Ctrl-C; the exit status. told is given its address.

    Raises InputError where it does not come up.
    """
    found, port = require_recordings(files), free_port()
    page = f"http://{LOOPBACK}:{port}"
    with tempfile.TemporaryFile() as said, given(found, page) as addresses:
        asked = ["--serve-web", "--web-viewer-port", str(port), *addresses]
        with running(asked, said) as process:
            try:
                wait_until_listening(process, port)
            except ConnectionError as error:
                raise InputError(str(error), field="--web", expected="a viewer that serves a page") from None
            query = "&".join(f"url={quote(address, safe='')}" for address in addresses)
            told(f"{page}/?{query}  (Ctrl-C ends it)")
            with suppress(KeyboardInterrupt):
                return process.wait()
            return 0


@contextmanager
def given(files: Sequence[Path], page: str) -> Iterator[list[str]]:
    """The files' addresses while they are served on 127.0.0.1, for scripts of that page (its origin) alone."""
    places = {f"/{number}/{quote(file.name)}": file for number, file in enumerate(files)}

    class Giver(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            file = places.get(self.path)
            if file is None:
                self.send_error(HTTPStatus.NOT_FOUND)
                return
            self.send_response(HTTPStatus.OK)
            self.send_header("Content-Length", str(file.stat().st_size))
            self.send_header("Content-Type", "application/octet-stream")
            self.send_header("Access-Control-Allow-Origin", page)
            self.end_headers()
            with file.open("rb") as stream, suppress(ConnectionError):  # a page may be closed while it loads
                shutil.copyfileobj(stream, self.wfile)

        def log_message(self, format: str, *args: object) -> None:
            """Nothing: the address is all that a reader is told."""

    with ThreadingHTTPServer((LOOPBACK, 0), Giver) as server:
        Thread(target=server.serve_forever, daemon=True).start()
        try:
            yield [f"http://{LOOPBACK}:{server.server_port}{place}" for place in places]
        finally:
            server.shutdown()
