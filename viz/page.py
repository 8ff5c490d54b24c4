"""Recordings as a web page on this machine only: Rerun's own page and the recordings, behind a door of ours.

Rerun's program could serve both itself. But it has no token and does not check Host. After it has read a recording it
polls for more without a pause, which uses a whole core (rerun-io/rerun#10944). Therefore this module copies the parts
of its page, ends the program, and gives the page the address of the recordings.
"""

from __future__ import annotations

import re
import tempfile
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from threading import Event
from urllib.error import HTTPError, URLError
from urllib.parse import quote
from urllib.request import urlopen

from tentacle.errors import InputError
from viz.door import LOOPBACK, ServedFile, door
from viz.viewer import free_port, require_recordings, running, wait_until_listening

PART = re.compile(r"""["'`(](?:\./)?([\w-]+\.(?:js|wasm|ico|png))["'`)]""")
PAGE_PATIENCE = 60.0  # s for one part of the page


def serve_web(files: Sequence[Path], told: Callable[[str], None]) -> int:
    """Serve the viewer as a web page on 127.0.0.1 until Ctrl-C; the exit status. told is given its address.

    Raises InputError where it does not come up.
    """
    found = require_recordings(files)
    with tempfile.TemporaryDirectory(prefix="tentacle-page-") as folder:
        places = taken_page(Path(folder))
        recordings = {f"{number}/{file.name}": file for number, file in enumerate(found)}
        places |= {name: ServedFile(file, "application/octet-stream") for name, file in recordings.items()}
        # a request's path is compared as a browser writes it
        with door({quote(name): given for name, given in places.items()}) as address:
            query = "&".join(f"url={quote(address + quote(name), safe='')}" for name in recordings)
            told(f"{address}?{query}  (Ctrl-C ends it)")
            with suppress(KeyboardInterrupt):
                Event().wait()
            return 0


def taken_page(folder: Path) -> dict[str, ServedFile]:
    """The parts of the viewer's page, put into a folder: path -> file. The viewer that gave them has ended.

    Raises InputError where it does not come up.
    """
    port, places = free_port(), {}
    # with an address to read from, the program serves its page alone and receives nothing
    asked = ["--serve-web", "--web-viewer-port", str(port), f"http://{LOOPBACK}:{port}/none.rrd"]
    with tempfile.TemporaryFile() as said, running(asked, said) as process:
        try:
            wait_until_listening(process, port)
            names = [""]
            for name in names:  # it grows by what the page itself names
                part = folder / (name or "index.html")
                try:
                    with urlopen(f"http://{LOOPBACK}:{port}/{name}", timeout=PAGE_PATIENCE) as answer:
                        part.write_bytes(answer.read())
                        places[name] = ServedFile(part, answer.headers.get("Content-Type", "application/octet-stream"))
                except HTTPError:
                    continue  # named, and not there
                if not name:
                    names += sorted(set(PART.findall(part.read_text(encoding="utf-8"))))
        except (ConnectionError, URLError) as error:
            raise InputError(str(error), field="--web", expected="a viewer that serves a page") from None
    return places
