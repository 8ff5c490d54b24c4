"""report.html: one valid page that needs nothing from elsewhere, reads in light and dark, and says the verdict."""

from __future__ import annotations

import re
import shutil
import subprocess
from dataclasses import replace
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from discovery.answer import cannot_tell
from tentacle.cli.pages.diagnosis import answer_lines
from tentacle.diagnosis import FINER_SHAPE, NEXT_SECONDS, CredibleSet, ErrorMeasure
from tentacle.model import Estimate
from tests.page import parsed, problems
from viz.candidate_section import twin_words
from viz.diagnosis_report import diagnosis_report
from viz.report import write_report
from viz.topics.verdict import verdict_markdown
from viz.verdict_sections import DECLARED_AS, limits_sections, sure_words, title_of
from viz.words import in_words


def text_of(page: str) -> str:
    """The page's words, figures' labels included, with single spaces between."""
    tree, _ = parsed(page)
    return " ".join(" ".join(tree.itertext()).split())


def make_page(case) -> str:
    versions, inputs = {"numpy": "2.4.6"}, {"run/video.mp4": "ab" * 32}
    return diagnosis_report(case.diagnosis, case.recordings, "tentacle diagnose <run> --out x", versions, inputs)


@pytest.fixture(scope="module")
def page(case) -> str:
    return make_page(case)


def test_it_is_valid_whole_and_legible(page):
    assert problems(page) == []


def test_it_explains_the_words_that_it_uses(page):
    words = page[page.index('<section id="words">') : page.index('<section id="reproduce">')]
    assert "<dt>floor</dt><dd>the error that noise" in words
    assert "<dt>weak form</dt>" not in words


def test_what_is_wrong_with_a_page_is_found(page):
    """The check itself: each of these is a mistake that a browser forgives."""
    for wrong, said in (
        (page.replace("</h1>", "</p>", 1), "line"),
        (page.replace('<html lang="en">', "<html>"), "no language"),
        (page.replace('id="section2"', 'id="section1"'), "id section1 twice"),
        (page.replace("--ink: #e8e8e8", "--ink: #4a4a4a"), "ink on paper"),
        (page.replace('role="img"', "", 1), "a figure without words"),
        (page.replace("stroke: #56b4e9", "stroke: #f4fbff"), "stroke #f4fbff on light"),
    ):
        assert any(said in problem for problem in problems(wrong)), said


def test_nothing_is_loaded_from_elsewhere(page):
    assert re.findall(r"@import|url\((?!#)", page) == []
    assert set(re.findall(r"https?://[^\"' <]+", page)) <= {
        "http://www.w3.org/2000/svg",
        "http://www.w3.org/1999/xlink",
    }


def test_it_says_the_verdict_the_errors_and_how_to_reproduce(case, page):
    text = text_of(page)
    assert case.diagnosis.headline in text
    for wanted in ("midline mm 10.5 0.31 0.21", "current speed 0.052 0.047 to 0.058 m/s not in the model", "Seed 7",
                   "tentacle diagnose <run> --out x", "ab" * 32, "grows towards the tip & is <0.3 mm"):  # fmt: skip
        assert wanted in text


def test_every_axis_has_its_unit(page):
    labels = [" ".join(text.split()) for text in parsed(page)[0].itertext()]
    for axis in ("q1 [rad]", "q2 [rad]", "t [s]", "x [mm]", "thrust [N]", "frequency [Hz]", "tip, amplitude [mm]",
                 "distance to measured [mm]", "arc length s [1] (0 clamp, 1 tip)"):  # fmt: skip
        assert axis in labels


def test_under_three_megabytes_and_the_same_again(case, page):
    assert len(page.encode()) < 3_000_000
    assert make_page(case) == page


@pytest.mark.parametrize("verdict", ["nothing_missing", "group", "unknown"])
def test_every_verdict_has_a_page_even_where_little_was_measured(case, verdict):
    run = replace(case.diagnosis.runs[0], q_measured=np.full((180, 2), np.nan), thrust_base=None, thrust_augmented=None)
    nothing = ErrorMeasure()
    bare = replace(
        case.diagnosis, verdict=verdict, effects=("current", "gravity_tilt") if verdict == "group" else (),
        parameters={}, before=nothing, after=nothing, floor=nothing, ranking=(), twin_names=(),
        twin_cosines=np.zeros((0, 0)),
        runs=(replace(run, points="markers"),), words=(), next_experiment=None, held_out=False,
    )  # fmt: skip
    page = diagnosis_report(bare, [], "tentacle diagnose run", {}, {})
    assert problems(page) == []
    assert in_words(bare.headline, bare) in text_of(page)


def test_data_that_show_too_little_have_a_page_that_says_so_once(case):
    untold = cannot_tell(case.recordings[0], "The arm hardly moves.", 0)
    page = diagnosis_report(untold, case.recordings, "tentacle diagnose run", {}, {"run": "0" * 64})
    assert problems(page) == []
    assert text_of(page).count("The arm hardly moves.") == 1
    assert "These data cannot tell</h1>" in page
    assert "<figure" not in page  # no empty budget
    assert '<pre class="command"><code>tentacle view run</code></pre>' in page
    assert verdict_markdown(untold).count("cannot tell") == 2  # title and headline
    assert answer_lines(untold) == ["These data cannot tell. The arm hardly moves."]


def test_the_terminal_has_the_confidence_and_each_parameter_with_its_interval(case):
    lines = answer_lines(case.diagnosis)
    assert lines[0] == case.diagnosis.headline
    assert f"Confidence {case.diagnosis.confidence:.0%}." in lines[1]
    assert "  current.speed = 0.052 m/s (95 %: 0.047 to 0.058)" in lines


def test_it_leads_with_the_film_at_the_worst_moment_and_both_models(page):
    before_headline = page[: page.index('class="headline"')]
    assert "data:image/png;base64," in before_headline
    assert "as declared and with current" in before_headline


def test_the_next_step_can_be_copied_and_names_what_is_asked_for(page):
    assert '<pre class="command"><code>tentacle diagnose next.rrd &lt;run&gt; --out x</code></pre>' in page
    assert 'href="next_experiment.toml"' in page
    assert f"next_experiment.toml --seconds {NEXT_SECONDS:.0f} --out" in page


def test_where_no_motion_is_worth_running_none_is_offered(case):
    bare = replace(case.diagnosis, next_experiment=None, next_nats=0.3)
    page = diagnosis_report(bare, case.recordings, "tentacle diagnose run", {}, {})
    assert "next_experiment.toml" not in page
    assert "rig record" not in page


def test_a_gait_and_a_thrust_are_offered_where_there_is_water_and_a_base_that_turns(case):
    wet = replace(case.diagnosis, next_experiment=None)
    base = wet.base_model
    clamped = tuple(replace(run, theta=np.zeros_like(run.theta)) for run in wet.runs)
    dry = replace(wet, base_model=replace(base, fluid=replace(base.fluid, density=1.2)))
    for diagnosis, offered in ((wet, True), (dry, False), (replace(wet, runs=clamped), False)):
        page = text_of(diagnosis_report(diagnosis, [], "tentacle diagnose run", {}, {}))
        assert ("tentacle optimise" in page) == offered
        assert ("Thrust, as a load cell" in page) == offered
    measured = text_of(diagnosis_report(dry, case.recordings, "tentacle diagnose run", {}, {}))
    assert "Thrust, as a load cell" in measured  # it was measured


def test_three_probabilities_of_one_answer_say_what_each_is(case):
    answer = replace(case.diagnosis, sets=(CredibleSet(("current",), 0.84),))
    page = text_of(diagnosis_report(answer, [], "tentacle diagnose run", {}, {}))
    assert "these effects probability of these, alone or beside others current 84.0 %" in page
    assert "probability of all sets with it" in page
    assert "The confidence at the top is another number" in page


def test_what_the_likelihood_says_is_shown_where_it_is_there(case):
    told = case.diagnosis.verdict_json() | {
        "explained": {"share": 0.93, "low": 0.88, "high": 0.96},
        "certain": ["current"],
        "sets": [{"effects": ["current"], "probability": 0.9}, {"effects": ["current", "wall"], "probability": 0.06}],
        "where": {"a": ["current"], "b": []},
        "laws": [{"expression": "k v^3", "acts": "along n", "place": "tip", "evidence": 31.0,
                  "held_out_midline_mm": 0.4, "file": "law.py"}],
        "detection_limits": {"wall": {"distance": {"value": 0.03, "unit": "m"}}},
    }  # fmt: skip
    assert sure_words(told) == [
        "What was found explains 93 % of the force that was missing (88 to 96 %).",
        "All likely answers contain current.",
        "By recording: a: current; b: nothing.",
    ]
    almost_all = {"share": 0.9991, "low": 0.9985, "high": 0.9996}  # an interval never has two equal ends
    words = sure_words({"explained": almost_all})
    assert words == ["What was found explains 99.91 % of the force that was missing (99.85 to 99.96 %)."]
    _, laws, _ = limits_sections(told | {"verdict": "effect"})
    assert "as well as the named effects" in laws.paragraphs[0]
    titles = [section.title for section in limits_sections(told)]
    assert titles == ["Likely answers", "Laws proposed", "What would have been detected"]
    assert limits_sections(case.diagnosis.verdict_json()) == []


@pytest.mark.parametrize(
    ("value", "low", "high", "shown"),
    [(0.04001, 0.04, 0.04002, ("0.040010", "0.040000 to 0.040020")),
     (160010.0, 159960.0, 160070.0, ("160010", "159960 to 160070")),
     (3e-9, 2.5e-9, 3.5e-9, ("3.0e-09", "2.5e-09 to 3.5e-09")), (5.0, 5.0, 5.0, ("5", "given"))],
)  # fmt: skip
def test_numbers_have_the_digits_that_their_interval_needs(value, low, high, shown):
    estimate = Estimate(value, low, high)
    assert (estimate.value_words, estimate.interval_words) == shown


def test_twins_are_named_in_words():
    cosines = np.array([[1, -0.995, 0.2], [-0.995, 1, 0.1], [0.2, 0.1, 1]])
    assert "intrinsic curvature / gravity tilt (0.995)" in twin_words(
        ("gravity_tilt", "intrinsic_curvature", "current"), cosines
    )
    assert "separates them" in twin_words(("a", "b", "c"), np.eye(3))


def test_twins_that_the_answer_tells_apart_are_not_said_to_need_more_data():
    names, cosines = ("gravity_tilt", "tip_mass", "buoyancy"), np.ones((3, 3))
    told = twin_words(names, cosines, [("tip_mass",), ("tip_mass", "current")])
    assert "tip mass / gravity tilt (1.000)" in told
    assert "tip mass / buoyancy (1.000)" in told
    assert "Every likely answer holds the first, and none the second." in told
    assert "Of the other pairs" in told  # buoyancy and gravity tilt: neither
    assert "Only much more data" not in told
    left = twin_words(names[:2], cosines[:2, :2], [("tip_mass",), ("gravity_tilt",)])
    assert "Only much more data" in left
    assert "told apart" not in left


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


def test_an_effect_that_a_wrong_declared_number_looks_like_says_which_number(case):
    turned = replace(case.diagnosis, effects=("current", "camera_roll"))
    page = text_of(diagnosis_report(turned, [], "tentacle diagnose run", {}, {}))
    assert "The camera roll may be a wrong number of the declaration: check arm_px in [camera]." in page
    assert "The current may be" not in page


def test_positions_that_no_camera_of_the_folder_gave_are_not_sent_to_its_table(case):
    wrong = replace(case.diagnosis, effects=("camera_scale", "camera_roll"))
    filmed, measured = case.recordings, []
    for recording in filmed:
        measured.append(replace(recording, video=None, declaration=replace(recording.declaration, camera=None)))
    for recordings, camera in ((filmed, True), (measured, False)):
        page = text_of(diagnosis_report(wrong, recordings, "tentacle diagnose run", {}, {}))
        assert ("[camera]" in page) == camera
        assert "length_m in [specimen]" in page


def test_the_numbers_to_check_belong_to_effects_of_the_catalogue():
    for effect in DECLARED_AS:
        import_module(f"affine_model.effects.{effect}")


def test_more_coordinates_are_no_missing_effect(case):
    only = replace(case.diagnosis, verdict="effect", effects=(FINER_SHAPE,), certain=())
    assert "The declared laws explain these data with more than two curvature coordinates: no missing" in only.headline
    assert title_of(only) == "No effect is missing; the arm needs more curvature coordinates"
    group = replace(only, verdict="group", effects=("gravity_tilt", "intrinsic_curvature", FINER_SHAPE))
    assert "lacks one of gravity_tilt / intrinsic_curvature; these data cannot tell which. It also" in group.headline
    assert title_of(group) == "Missing: gravity tilt or intrinsic curvature"


def test_a_group_says_what_is_certain_beside_what_is_open(case):
    group = replace(
        case.diagnosis, verdict="group", effects=("current", "skin_drag", "wall"), certain=("current",), sets=()
    )
    assert "lacks current and one of skin_drag / wall; these data cannot tell which." in group.headline
    assert title_of(group) == "Missing: current, beside skin drag or wall"
    none_certain = replace(group, certain=())
    assert "lacks one of current / skin_drag / wall;" in none_certain.headline
    assert title_of(none_certain) == "Missing: current, skin drag or wall"


def test_an_effect_that_acts_beside_another_alone_is_no_alternative_of_its_own(case):
    likely = [(("servo_lag", "amplitude_damping"), 0.6), (("servo_lag",), 0.2), (("time_offset",), 0.2)]
    sets = tuple(CredibleSet(names, mass) for names, mass in likely)
    effects = ("servo_lag", "amplitude_damping", "time_offset")
    group = replace(case.diagnosis, verdict="group", effects=effects, certain=(), sets=sets)
    assert "lacks one of servo_lag + amplitude_damping / servo_lag / time_offset; these data" in group.headline
