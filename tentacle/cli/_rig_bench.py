"""Bodies of `tentacle rig`: ports, check, emulate, import."""

from __future__ import annotations

import argparse
import signal
import time
from pathlib import Path

from tentacle.cli._output import remark, say, say_text
from tentacle.errors import InputError

LATE = 0.25  # s; the board's watchdog bites then


def ports(_arguments: argparse.Namespace) -> int:
    """The serial ports, the Due's marked."""
    from rig.link import serial_ports as found_ports

    found = found_ports()
    for port in found:
        say(f"{port.device}  {port.description}{'  <- Arduino Due, programming port' if port.due else ''}")
    if not found:
        say("no serial port is there; without hardware: tentacle rig emulate FOLDER")
    return 0


def check(arguments: argparse.Namespace) -> int:
    """The findings, one a line; exit code 3 where one is not good enough."""
    import json
    from dataclasses import asdict

    from rig.check import check_rig as findings
    from rig.connection import connected, opened_camera
    from rig.setup_file import read_setup

    setup = read_setup(arguments.rig)
    with connected(setup) as board, opened_camera(setup, board.time) as camera:
        items = findings(setup, board, camera)
    if arguments.json:
        say_text(json.dumps([asdict(item) for item in items], indent=1))
    else:
        for item in items:
            words = "" if item.good or not item.words else f"  <- {item.words}"
            say(f"{'ok ' if item.good else 'NOT'}  {item.name:32s} {item.value:10.4g} {item.unit}{words}")
    return 0 if all(item.good for item in items) else 3


def emulate(arguments: argparse.Namespace) -> int:
    """Runs until Ctrl-C or a polite kill, both of which a shell may have ignored for us; the board ends with it."""
    for name in (signal.SIGINT, signal.SIGTERM):
        signal.signal(name, signal.default_int_handler)
    from rig.emulated_setup import EmulatedArm, emulated_setup, seconds_behind
    from rig.emulator import Emulator
    from rig.setup_file import write_setup

    setup, settings = emulated_setup(
        arguments.folder,
        EmulatedArm(arguments.model, arguments.hidden),
        seed=arguments.seed,
        rate=arguments.rate,
        camera=not arguments.no_camera,
    )
    with Emulator(arguments.folder, settings) as running:
        if arguments.line is not None:
            running.say("line", *arguments.line)
        write_setup(setup, arguments.folder / "rig.toml")
        say(f"port {running.url}; in another terminal: tentacle rig check {arguments.folder / 'rig.toml'}")
        late = False
        try:
            while running.exit_status() is None:
                time.sleep(0.2)
                if not late and seconds_behind(running) > LATE:
                    late = True
                    remark("this computer is too busy: the board falls behind its clock; try --rate", "")
        except KeyboardInterrupt:
            say("ended")
            return 0
    raise InputError("the emulated board has ended", file=arguments.folder)


def convert(arguments: argparse.Namespace) -> int:
    """A log or a run as an import folder."""
    import tempfile

    from rig.bench_recording import LogOptions, bench_recording
    from tentacle.io.write_folder import write_folder

    if arguments.log.suffix == ".rrd":
        from rig.run_file import read_run, to_recording

        with tempfile.TemporaryDirectory() as folder:
            run = read_run(arguments.log)
            write_folder(to_recording(run, video=Path(folder) / "video.mp4"), arguments.out)
        say(f"wrote {arguments.out}; the run was {run.outcome}")
        if run.missing:
            say(run.missing)
        return 0
    columns = None if arguments.columns is None else tuple(arguments.columns)
    calibration = None if arguments.calibration is None else tuple(arguments.calibration)
    recording, words = bench_recording(arguments.log, LogOptions(arguments.declare, columns, calibration))
    write_folder(recording, arguments.out)
    say(words)
    say(f"wrote {arguments.out}")
    return 0
