"""A lab's own servo log becomes the signal that motor.csv holds, whatever wrote it; what is not told is not guessed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tentacle.cli import main
from tentacle.errors import InputError
from tentacle.io.servo_log import ServoColumns, read_servo_log

T = np.array([0.0, 0.01, 0.02])
COMMAND = np.array([0.0, 12.5, -30.0])  # degrees
ANGLE = np.array([0.5, 12.0, -29.5])
ARM = ["--length=0.14", "--base-radius=0.0125", "--tip-radius=0.001", "--density=1070", "--fluid-density=998"]


def log(folder: Path, text: str, encoding: str = "utf-8") -> Path:
    file = folder / "servo.csv"
    file.write_bytes(text.encode(encoding))
    return file


@pytest.mark.parametrize(
    ("text", "encoding"),
    [
        ("time_s,command_deg,angle_deg\n0,0,.5\n.01,12.5,12\n.02,-30,-29.5\n", "utf-8"),
        ("Zeit;Soll_Grad;Ist_Grad\n0,00;0,0;0,5\n0,01;12,5;12,0\n0,02;-30,0;-29,5\n", "utf-8-sig"),
        ("# rig 3\n\nTime [ms]\tServo target [\N{DEGREE SIGN}]\tServo position [\N{DEGREE SIGN}]\tload\r\n"
         "0\t0\t.5\t\r\n10\t12.5\t12\t\r\n20\t-30\t-29.5\t\r\n", "cp1252"),
        ("angle_deg,note,t_us,cmd_deg\n.5,a,0,0\n12,b,10000,12.5\n\n-29.5,c,20000,-30\n", "utf-8"),
    ],
    ids=["commas", "semicolons and decimal commas", "tabs, Windows", "another order, more columns"],
)  # fmt: skip
def test_logs_of_one_motion_in_other_dress_are_one_signal(tmp_path: Path, text: str, encoding: str) -> None:
    signal, words = read_servo_log(log(tmp_path, text, encoding))
    assert signal.t == pytest.approx(T)
    assert signal.command == pytest.approx(np.radians(COMMAND))
    assert signal.angle == pytest.approx(np.radians(ANGLE))
    assert "degrees are turned into rad" in words


def test_a_command_alone_is_the_angle_too_and_the_words_say_so(tmp_path: Path) -> None:
    signal, words = read_servo_log(log(tmp_path, "t,servo_rad\n0,.1\n1,.2\n"))
    assert signal.command.tolist() == signal.angle.tolist() == [0.1, 0.2]
    assert words == "servo.csv: t is the time in s, servo_rad the command and, as there is no other, the angle"


@pytest.mark.parametrize(
    ("text", "stated", "line"),
    [
        ("a,b,c\n0,1,2\n", ServoColumns(), "the columns a, b, c do not say"),
        ("t,command,angle\n0,1,2\n1,2,3\n", ServoColumns(), "command: the column's name has no unit"),
        ("t,command,angle\n0,1,2\n1,2,3\n", ServoColumns(["t", "cmd"], "deg"), "cmd: no such column"),
        ("0,1,2\n1,2,3\n", ServoColumns(), "servo.csv:1: no header"),
        ("t,cmd_deg\n0,1\n0,2\n", ServoColumns(), "servo.csv:3: t: time repeats or goes back"),
        ("t;cmd_deg\n0;1\n1;x\n", ServoColumns(), "servo.csv:3: cmd_deg: 'x' is no number"),
        ("t;cmd_deg\n0;1\n1;2;3\n", ServoColumns(), "servo.csv:3: 3 cells"),
        ("t,cmd_deg\n", ServoColumns(), "fewer than two rows"),
        ("", ServoColumns(), "empty file"),
    ],
)
def test_what_is_not_told_is_one_line(tmp_path: Path, text: str, stated: ServoColumns, line: str) -> None:
    with pytest.raises(InputError, match=line):
        read_servo_log(log(tmp_path, text), stated)


def test_a_recording_begins_with_a_labs_log_or_not_at_all(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, folder = log(tmp_path, "a;b\n0,0;10\n0,5;20\n"), tmp_path / "my_arm"
    ask = ["new", str(folder), *ARM, "--motor", str(file)]
    assert main(ask) == 2
    assert not folder.exists()
    assert main([*ask, "--motor-columns", "a", "b", "--motor-unit", "deg"]) == 0
    written = np.loadtxt(folder / "motor.csv", delimiter=",", skiprows=1)
    assert written == pytest.approx(np.array([[0.0, *np.radians([10, 10])], [0.5, *np.radians([20, 20])]]))
    (folder / "recording.toml").unlink()
    assert main([*ask, "--motor-columns", "a", "b", "--motor-unit", "deg"]) == 2  # the log that lies there stays
    assert "motor.csv: --motor: is there already" in capsys.readouterr().err
