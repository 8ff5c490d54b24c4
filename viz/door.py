"""Files as web pages on this machine only, for those who were given the address.

The address holds a secret word (a token) as the first part of its path. A request without it is refused. A request with
a Host other than this machine's own name is refused too, because a foreign web page can make its name resolve to
127.0.0.1.
"""

from __future__ import annotations

import hmac
import secrets
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from urllib.parse import urlsplit

LOOPBACK = "127.0.0.1"
# A page may ask this door alone: Rerun's would fetch a font and a version number elsewhere, and send statistics.
OWN_ALONE = "default-src 'self' 'unsafe-inline' 'unsafe-eval' data: blob:"
SILENCE = 60.0  # s; a silent connection is closed after this time


@dataclass(frozen=True)
class ServedFile:
    """A file, and what kind of thing it is, such as "text/html"."""

    file: Path
    kind: str


@contextmanager
def door(places: Mapping[str, ServedFile]) -> Iterator[str]:
    """Gives the files, by their paths under the token, while the block lasts; yields the address of the empty path."""
    token = secrets.token_urlsafe(24)

    class Visit(BaseHTTPRequestHandler):
        timeout = SILENCE

        def do_GET(self) -> None:
            hosts = (f"{LOOPBACK}:{server.server_port}", f"localhost:{server.server_port}")
            first, _, place = urlsplit(self.path).path.lstrip("/").partition("/")
            if self.headers.get("Host", "") not in hosts or not _same(first, token):
                self.send_error(HTTPStatus.FORBIDDEN, "open the address that was printed")
            elif place not in places:
                self.send_error(HTTPStatus.NOT_FOUND)
            else:
                self._give(places[place])

        def _give(self, given: ServedFile) -> None:
            try:
                stream = given.file.open("rb")
            except OSError:
                self.send_error(HTTPStatus.NOT_FOUND)
                return
            with stream, suppress(OSError):  # a page may be closed while it loads
                self.send_response(HTTPStatus.OK)
                self.send_header("Content-Length", str(given.file.stat().st_size))
                self.send_header("Content-Type", given.kind)
                self.send_header("Referrer-Policy", "no-referrer")  # the address stays here
                self.send_header("Content-Security-Policy", OWN_ALONE)
                self.send_header("X-Content-Type-Options", "nosniff")
                self.end_headers()
                shutil.copyfileobj(stream, self.wfile)

        def log_message(self, format: str, *args: object) -> None:
            """Nothing: only the address is printed."""

    with ThreadingHTTPServer((LOOPBACK, 0), Visit) as server:
        Thread(target=server.serve_forever, daemon=True).start()
        try:
            yield f"http://{LOOPBACK}:{server.server_port}/{token}/"
        finally:
            server.shutdown()


def _same(given: str, token: str) -> bool:
    return hmac.compare_digest(given.encode("utf-8", "surrogateescape"), token.encode())
