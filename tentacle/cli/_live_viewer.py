"""The Rerun viewer of a live run: a window, or a page for a browser if there is no screen. It stays open."""

from __future__ import annotations

import socket
import subprocess

from tentacle.cli._output import remark
from tentacle.errors import InputError

LOOPBACK = "127.0.0.1"
PAGE_PORT = 9090


def start_viewer(port: int, page_port: int = PAGE_PORT) -> subprocess.Popen[bytes] | None:
    """Starts a viewer that listens on this machine alone; None where one is there. InputError where it fails."""
    from viz.viewer import end_group, has_screen, viewer_environment, viewer_program, wait_until_listening

    with socket.socket() as probe:
        if probe.connect_ex((LOOPBACK, port)) == 0:
            return None  # of an earlier run
    command = [viewer_program(), "--bind", LOOPBACK, "--port", str(port), "--hide-welcome-screen"]
    if not has_screen():
        command += ["--serve-web", "--web-viewer-port", str(page_port)]
    process = subprocess.Popen(
        command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True,
        env=viewer_environment(),
    )  # fmt: skip
    try:
        address = wait_until_listening(process, port)
    except BaseException as error:
        end_group(process)
        if not isinstance(error, ConnectionError):
            raise
        raise InputError(str(error), field="--view", expected="a viewer that starts; try: rerun") from None
    if not has_screen():
        page = f"http://{LOOPBACK}:{page_port}/?url={address.replace('+', '%2B')}"
        remark(f"no screen here: open {page} in a browser; the viewer is process {process.pid}", "")
    return process
