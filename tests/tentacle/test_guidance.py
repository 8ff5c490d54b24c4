"""What a newcomer is told: slips of the pen, a recording to begin with, the share done, shells' completion."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tentacle.cli import main
from tentacle.cli._progress import reading_plan, share_done, stages
from tentacle.errors import InputError
from tentacle.io.declaration_file import read_recording_file
from tentacle.io.import_folder import read_folder
from tentacle.io.recording_template import Answers, recording_text, write_recording_file
from tentacle.recording import Camera
from tentacle.specimen import Cone, Rectangle
from tests.docs.desk import film_an_arm

ARM = ["--length=0.14", "--base-radius=0.0125", "--tip-radius=0.001", "--density=1070", "--fluid-density=998"]


def test_an_unknown_verb_is_one_line_with_the_nearest(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["diagnos", "x"]) == 2
    assert capsys.readouterr().err == "tentacle: diagnos: unknown verb; did you mean diagnose?\n"
    assert main(["xyzzy"]) == 2
    assert "`tentacle --help` lists them" in capsys.readouterr().err


def test_a_recording_is_begun_from_flags_and_a_film(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    film_an_arm(tmp_path / "filmed")
    folder = tmp_path / "my_arm"
    assert main(["new", str(folder), *ARM, "--video", str(tmp_path / "filmed" / "video.mp4")]) == 0
    said = capsys.readouterr().out
    assert f"next: tentacle diagnose {folder} --out answer" in said
    assert "without a log the base counts as clamped" in said
    recording = read_folder(folder)
    camera = recording.declaration.camera
    assert camera is not None
    assert camera.base_px == pytest.approx((320, 40), abs=4.0)
    assert camera.metres_per_px == pytest.approx(0.0008, rel=0.05)
    assert camera.arm_px == (0.0, 1.0)  # a level camera: the arm's mean direction is not taken for a roll of it
    assert main(["new", str(folder), *ARM]) == 2  # what is there stays


def test_a_film_that_lies_in_the_folder_stays_as_it_is(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    film_an_arm(tmp_path / "filmed")
    folder, film = tmp_path / "my_arm", tmp_path / "filmed" / "video.mp4"
    folder.mkdir()
    (folder / "video.mkv").write_bytes(b"mine")
    assert main(["new", str(folder), *ARM, "--video", str(film)]) == 2
    assert "video.mkv: --video: is there already" in capsys.readouterr().err
    assert [path.read_bytes() for path in folder.iterdir()] == [b"mine"]
    assert main(["new", str(tmp_path / "filmed"), *ARM, "--video", str(film)]) == 0


def test_without_a_film_the_camera_is_left_to_be_filled_in(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    typed = iter(["", "0,012", "", "", "0"])
    monkeypatch.setattr("builtins.input", lambda _: next(typed))
    monkeypatch.setattr(sys.stdin, "isatty", lambda: True)
    assert main(["new", str(tmp_path / "a")]) == 0
    declared = read_recording_file(tmp_path / "a" / "recording.toml").declaration
    assert declared.specimen.section.half_thickness(0.0) == 0.012
    assert declared.fluid.density == 0.0
    assert declared.camera is None


def test_answers_come_from_a_pipe_line_by_line(tmp_path: Path) -> None:
    done = asked(tmp_path, b"0.2\n0,011\n\n1080\n0\n")
    assert done.returncode == 0, done.stderr
    assert b"Radius at the tip [m] [0.004]: 0.004\n" in done.stdout  # what an empty line took is said
    declared = read_recording_file(tmp_path / "a" / "recording.toml").declaration
    assert declared.specimen.length == 0.2
    assert declared.specimen.section.half_thickness(0.0) == 0.011
    assert declared.fluid.density == 0.0


def test_a_flag_takes_no_line_of_the_pipe(tmp_path: Path) -> None:
    done = asked(tmp_path, b"0.011\n", *(flag for flag in ARM if not flag.startswith("--base")))
    assert done.returncode == 0, done.stderr
    declared = read_recording_file(tmp_path / "a" / "recording.toml").declaration
    assert declared.specimen.section.half_thickness(0.0) == 0.011


@pytest.mark.parametrize(
    ("piped", "said"),
    [
        (b"", b"tentacle: --length: no answer: the input has ended; expected Length of the arm, from clamp to tip [m]"),
        (b"0.2\n0.011\n", b"tentacle: --tip-radius: no answer: the input has ended; expected Radius at the tip [m]"),
        (b"0.2\nthick\n", b"tentacle: --base-radius: 'thick' is no number; expected Radius at the clamp [m]"),
        (b"0.2\n0.0\n", b"tentacle: --base-radius: 0 is out of range; expected Radius at the clamp [m]"),
        (b"0.2\n\xff\xfe\n", b"tentacle: --base-radius: "),
        (b"1" * 5000, b"tentacle: --length: inf is out of range; expected Length of the arm, from clamp to tip [m]"),
    ],
)
def test_too_few_or_wrong_answers_of_a_pipe_write_nothing(tmp_path: Path, piped: bytes, said: bytes) -> None:
    done = asked(tmp_path, piped)
    assert done.returncode == 2
    assert done.stderr.startswith(said)
    assert len(done.stderr.splitlines()) == 1
    assert not (tmp_path / "a").exists()


def test_a_width_and_a_height_make_a_rectangle_that_bends_over_its_height(tmp_path: Path) -> None:
    flags = ("--length", "0.2", "--width", "0.03", "--density", "1080", "--fluid-density", "0")
    done = asked(tmp_path, b"0.01\n", *flags)  # the height is asked, and no radius
    assert done.returncode == 0, done.stderr
    section = read_recording_file(tmp_path / "a" / "recording.toml").declaration.specimen.section
    assert section == Rectangle(section_width=0.03, height=0.01)
    assert section.second_moment(0.0) == pytest.approx(0.03 * 0.01**3 / 12.0)
    (tmp_path / "a" / "recording.toml").unlink()
    both = asked(tmp_path, b"", *flags[:4], "--tip-radius", "0.01", "--height", "0.01")
    assert both.returncode == 2
    assert b"--width: beside a radius" in both.stderr


def asked(place: Path, piped: bytes, *flags: str) -> subprocess.CompletedProcess[bytes]:
    """`tentacle new a` with its answers in a pipe."""
    command = [sys.executable, "-m", "tentacle", "new", "a", *flags]
    shell = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])}
    return subprocess.run(command, cwd=place, env=shell, input=piped, capture_output=True, check=False)


@pytest.mark.parametrize("wrong", [["--length", "-1"], ["--length", "nan"], ["--length", "inf"]])
def test_a_wrong_answer_is_named(tmp_path: Path, wrong: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["new", str(tmp_path / "a"), *wrong]) == 2
    assert "--length: " in capsys.readouterr().err
    assert not (tmp_path / "a").exists()


def test_a_film_under_another_name_is_named_with_the_remedy(tmp_path: Path) -> None:
    film_an_arm(tmp_path / "filmed")
    main(["new", str(tmp_path / "a"), *ARM])
    (tmp_path / "filmed" / "video.mp4").rename(tmp_path / "a" / "GOPR0001.MP4")
    with pytest.raises(InputError, match=r"GOPR0001\.MP4: a film is not read under this name; expected video\.mp4"):
        read_folder(tmp_path / "a")


def test_the_share_done_rises_and_stays_where_a_stage_is_not_in_the_plan(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    plan = [*reading_plan(["a.rrd"]), ("fitting", 4.0)]
    assert share_done(plan, "fitting the declared model", 0.5) == pytest.approx(18.0 / 20.0)
    assert share_done(plan, "something else", 0.0) is None
    monkeypatch.setenv("TENTACLE_PROGRESS", "lines")
    with stages(plan) as stage:
        for words in ("reading a.rrd", "fitting it", "something else", "reading a.rrd"):
            stage(words)
    shares = [float(line.split("\t")[0]) for line in capsys.readouterr().err.splitlines()]
    assert shares == [0.0, 0.8, 0.8, 0.8]


def test_bash_takes_the_completion(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["completion", "bash"]) == 0
    script = tmp_path / "completion.bash"
    script.write_text(capsys.readouterr().out)
    ask = f'source {script}; COMP_WORDS=(tentacle diagn); COMP_CWORD=1; _shtab_tentacle; echo "${{COMPREPLY[@]}}"'
    done = subprocess.run(["bash", "-c", ask], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "diagnose"


@pytest.mark.parametrize("mirrored", [False, True])
def test_a_begun_recording_says_of_the_camera_what_it_was_told(tmp_path: Path, mirrored: bool) -> None:
    camera = Camera(25.0, 4e-4, (310.0, 42.5), (0.6, 0.8), mirrored=mirrored)
    file = write_recording_file(tmp_path, recording_text(Answers(0.14, Cone(0.012, 0.004), 1070.0, 998.0, camera)))
    assert read_recording_file(file).declaration.camera == camera
