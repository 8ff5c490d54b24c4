"""report.html: one valid page that needs nothing from elsewhere, reads in light and dark, and says the verdict."""

from __future__ import annotations

import re
import shutil
import subprocess
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from tentacle.diagnosis import ErrorMeasure
from viz.diagnosis_report import diagnosis_report, twin_words
from viz.report import MAXIMUM_BYTES, write_report

VOID = {"meta", "link", "br", "img", "hr", "input"}


class Checker(HTMLParser):
    """Balanced elements, unique ids, no reference to anything outside the page."""

    def __init__(self) -> None:
        super().__init__(convert_charrefs=True)
        self.open: list[str] = []
        self.ids: list[str] = []
        self.references: list[str] = []
        self.problems: list[str] = []
        self.text: list[str] = []

    def handle_starttag(self, tag, attrs):
        names = [name for name, _ in attrs]
        if len(names) != len(set(names)):
            self.problems.append(f"<{tag}> has an attribute twice")
        for name, value in attrs:
            if name == "id":
                self.ids.append(value or "")
            if name in ("href", "xlink:href", "src"):
                self.references.append(value or "")
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.problems.append(f"</{tag}> closes nothing")

    def handle_data(self, data):
        self.text.append(data)


def make_page(case) -> str:
    versions, inputs = {"numpy": "2.4.6"}, {"run/video.mp4": "ab" * 32}
    return diagnosis_report(case.diagnosis, case.recordings, "tentacle diagnose <run> --out x", versions, inputs)


@pytest.fixture(scope="module")
def page(case) -> str:
    return make_page(case)


@pytest.fixture(scope="module")
def checked(page) -> Checker:
    checker = Checker()
    checker.feed(page)
    checker.close()
    return checker


def test_elements_balance_and_ids_are_unique(checked):
    assert checked.problems == []
    assert checked.open == []
    assert len(checked.ids) == len(set(checked.ids))


def test_nothing_is_loaded_from_elsewhere(page, checked):
    inside = {f"#{name}" for name in checked.ids}
    assert [r for r in checked.references if r not in inside and not r.startswith("data:image/png;base64,")] == []
    assert re.findall(r"@import|url\((?!#)", page) == []
    assert set(re.findall(r"https?://[^\"' <]+", page)) <= {
        "http://www.w3.org/2000/svg",
        "http://www.w3.org/1999/xlink",
    }


def test_it_says_the_verdict_the_errors_and_how_to_reproduce(case, checked):
    text = " ".join(" ".join(checked.text).split())
    assert case.diagnosis.headline in text
    for wanted in ("midline mm 10.5 0.31 0.21", "current speed 0.052 0.047 to 0.058 m/s not in the model", "Seed 7",
                   "tentacle diagnose <run> --out x", "ab" * 32, "grows towards the tip & is <0.3 mm"):  # fmt: skip
        assert wanted in text


def test_every_axis_has_its_unit(checked):
    labels = [" ".join(t.split()) for t in checked.text]
    for axis in ("q1 [rad]", "q2 [rad]", "t [s]", "x [mm]", "thrust [N]", "frequency [Hz]", "tip, amplitude [mm]",
                 "distance to measured [mm]", "arc length s [1] (0 clamp, 1 tip)", "probability [1]"):  # fmt: skip
        assert axis in labels


def test_under_three_megabytes_and_the_same_again(case, page):
    assert len(page.encode()) < MAXIMUM_BYTES
    assert make_page(case) == page


@pytest.mark.parametrize("verdict", ["nothing_missing", "group", "unknown"])
def test_every_verdict_has_a_page_even_where_little_was_measured(case, verdict):
    run = replace(case.diagnosis.runs[0], q_measured=np.full((180, 2), np.nan), thrust_base=None, thrust_augmented=None)
    nothing = ErrorMeasure()
    bare = replace(
        case.diagnosis, verdict=verdict, effects=("current", "gravity_tilt") if verdict == "group" else (),
        parameters={}, before=nothing, after=nothing, floor=nothing, ranking=(), gates=(), twin_names=(),
        twin_cosines=np.zeros((0, 0)),
        runs=(replace(run, points="markers"),), words=(), next_experiment=None, held_out=False,
    )  # fmt: skip
    checker = Checker()
    checker.feed(diagnosis_report(bare, [], "tentacle diagnose run", {}, {}))
    assert checker.problems == []
    assert bare.headline in " ".join(" ".join(checker.text).split())


def test_twins_are_named_in_words():
    cosines = np.array([[1, -0.995, 0.2], [-0.995, 1, 0.1], [0.2, 0.1, 1]])
    assert "intrinsic curvature / gravity tilt (0.995)" in twin_words(
        ("gravity_tilt", "intrinsic_curvature", "current"), cosines
    )
    assert "separates them" in twin_words(("a", "b", "c"), np.eye(3))


def photograph(page: Path, picture: Path, profile: Path, *options: str) -> np.ndarray:
    import cv2

    quiet = ["--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking", "--disable-sync"]
    what = [f"--user-data-dir={profile}", "--window-size=1000,5200", "--hide-scrollbars", *options]
    command = ["chromium", "--headless", *quiet, *what, f"--screenshot={picture}", page.as_uri()]
    subprocess.run(command, check=True, capture_output=True, timeout=60)
    image = cv2.imread(str(picture))
    assert image is not None
    return image


@pytest.mark.skipif(shutil.which("chromium") is None, reason="chromium is not installed")
def test_a_browser_shows_it_light_and_dark(page, tmp_path):
    path = write_report(page, tmp_path / "report.html")
    light = photograph(path, tmp_path / "light.png", tmp_path / "a")
    dark = photograph(path, tmp_path / "dark.png", tmp_path / "b", "--blink-settings=preferredColorScheme=0")
    assert light[:, :10].min() > 240  # the margin is paper
    assert dark[:, :10].max() < 60
    # ink is there all the way down: each fifth of the page has at least 1 % of its pixels far from the paper
    for picture, paper in ((light, 255), (dark, 24)):
        for part in np.array_split(picture, 5):
            assert np.mean(np.abs(part.astype(int) - paper).max(axis=-1) > 60) > 0.01
