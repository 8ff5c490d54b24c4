"""rig.toml: the board's port, its limits, its calibration, its camera, and the specimen in the tank."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import tomli_w

from rig.link import require_scheme
from rig.safety import SafetyLimits, ServoCalibration
from rig.settle import SettleRule
from tentacle.errors import InputError
from tentacle.io.declaration_file import RecordingFile, declaration_tables, parse_recording_file
from tentacle.io.toml_table import Table, read_toml
from tentacle.io.written_file import write_text

EMULATED = "emulated"


@dataclass(frozen=True)
class LoadCellCalibration:
    """thrust [N] = (counts - offset) / slope; slope [counts/N]; rms [N] of the calibration's residuals."""

    offset: float
    slope: float
    rms: float = 0.0

    def to_newtons(self, counts: Any) -> Any:
        """Raw counts as force [N]."""
        return (counts - self.offset) / self.slope


@dataclass(frozen=True)
class CameraSettings:
    """source: an OpenCV index, a video file standing in, or EMULATED; offset [s]: how much later a frame arrives
    than the middle of its exposure, sigma [s] of that.
    """

    source: str
    offset: float = 0.0
    sigma: float = 0.0


@dataclass(frozen=True)
class RigSetup:
    """A rig as rig.toml declares it. rate is 1 on hardware; an emulator that runs faster says so here."""

    port: str
    limits: SafetyLimits
    settle: SettleRule
    load_cell: LoadCellCalibration
    recording: RecordingFile
    servo: ServoCalibration = field(default_factory=ServoCalibration)
    camera: CameraSettings | None = None
    rate: float = 1.0


def read_setup(file: Path) -> RigSetup:
    """rig.toml from disk. InputError names line and field of the first thing that is missing or wrong."""
    text, values = read_toml(file)
    document = Table(values, file=file, text=text)
    folder = file.parent
    try:
        setup = RigSetup(
            port=_port_in(document.string("port"), folder),
            limits=_parse_limits(document.required_table("limits")),
            settle=_parse_settle(document.required_table("settle")),
            load_cell=_parse_load_cell(document.required_table("load_cell")),
            recording=_parse_recording(document.required_table("recording"), file, text),
            servo=_parse_servo(document.table("servo", optional=True)),
            camera=_parse_camera(document.table("camera", optional=True), folder),
            rate=document.number("rate", 1.0, above=0),
        )
    except InputError as error:
        if error.file is not None:
            raise
        raise InputError(error.problem, file=file, field=error.field, expected=error.expected) from None
    document.finish()
    return setup


def write_setup(setup: RigSetup, file: Path) -> None:
    """rig.toml, whole or not at all."""
    tables = setup_tables(setup)
    tables["port"] = _beside(setup.port, file.parent)
    if setup.camera is not None:
        tables["camera"]["source"] = _beside(setup.camera.source, file.parent)
    write_text(file, tomli_w.dumps(tables))


def setup_tables(setup: RigSetup) -> dict[str, Any]:
    """A setup as rig.toml's tables; read_setup gives it back exactly."""
    limits, servo, settle, cell = setup.limits, setup.servo, setup.settle, setup.load_cell
    tables: dict[str, Any] = {"port": setup.port}
    if setup.rate != 1.0:
        tables["rate"] = setup.rate
    tables["limits"] = {
        "min_angle_rad": limits.min_angle,
        "max_angle_rad": limits.max_angle,
        "max_speed_rad_s": limits.max_speed,
        "max_current_a": limits.max_current,
    }
    tables["servo"] = {"centre_us": servo.centre_us, "us_per_rad": servo.us_per_rad}
    tables["settle"] = {"threshold_n": settle.threshold, "samples": settle.samples, "timeout_s": settle.timeout}
    tables["load_cell"] = {"offset_counts": cell.offset, "counts_per_newton": cell.slope, "rms_n": cell.rms}
    if setup.camera is not None:
        camera = setup.camera
        tables["camera"] = {"source": camera.source, "offset_s": camera.offset, "offset_sigma_s": camera.sigma}
    tables["recording"] = declaration_tables(setup.recording.declaration)
    return tables


def _port_in(port: str, folder: Path) -> str:
    """A device, a url, or a path from rig.toml's folder: an emulator's port lies beside it."""
    require_scheme(port)
    if "://" in port or re.fullmatch(r"COM\d+", port):
        return port
    return str(folder / port)  # an absolute path stays what it is


def _beside(path: str, folder: Path) -> str:
    """The text from which _port_in and _parse_camera read `path` back."""
    return path.removeprefix(f"{folder}{os.sep}")


def _parse_limits(table: Table) -> SafetyLimits:
    limits = SafetyLimits(
        min_angle=table.number("min_angle_rad"),
        max_angle=table.number("max_angle_rad"),
        max_speed=table.number("max_speed_rad_s", above=0),
        max_current=table.number("max_current_a", above=0),
    )
    table.finish()
    return limits


def _parse_settle(table: Table) -> SettleRule:
    rule = SettleRule(
        threshold=table.number("threshold_n", above=0),
        samples=table.whole_number("samples", least=3),
        timeout=table.number("timeout_s", above=0),
    )
    table.finish()
    return rule


def _parse_load_cell(table: Table) -> LoadCellCalibration:
    slope = table.number("counts_per_newton")
    if slope == 0:
        raise table.error(
            "0 is not usable", "counts_per_newton", "counts per newton, negative where the cell is upside down"
        )
    cell = LoadCellCalibration(table.number("offset_counts"), slope, table.number("rms_n", 0.0, least=0))
    table.finish()
    return cell


def _parse_servo(table: Table | None) -> ServoCalibration:
    if table is None:
        return ServoCalibration()
    default = ServoCalibration()
    servo = ServoCalibration(
        centre_us=table.number("centre_us", default.centre_us, least=900, most=2100),
        us_per_rad=table.number("us_per_rad", default.us_per_rad, least=-3000, most=3000),
    )
    table.finish()
    return servo


def _parse_camera(table: Table | None, folder: Path) -> CameraSettings | None:
    if table is None:
        return None
    source = table.string("source")
    camera = CameraSettings(
        source=source if source.isdigit() or source == EMULATED else str(folder / source),
        offset=table.number("offset_s", 0.0),
        sigma=table.number("offset_sigma_s", 0.0, least=0),
    )
    table.finish()
    return camera


def _parse_recording(table: Table, file: Path, text: str) -> RecordingFile:
    values = {key: table.raw(key, "a table of recording.toml") for key in table}
    return parse_recording_file(values, file=file, text=text)
