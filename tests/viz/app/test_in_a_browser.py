"""From a film to a verdict in a real browser: wide and narrow, light and dark, wrong inputs included."""

from __future__ import annotations

import json
import urllib.error
import urllib.request
from pathlib import Path

import pytest

from docs import app_pictures
from docs.arm import shown_arm
from tests.viz.app.conftest import Served

PATIENCE = 600_000  # ms: the first diagnosis on a computer compiles its kernels
ARM = {**app_pictures.ARM, "radius at the tip": "0.0015"}  # as docs/arm.py declares it
SIZES = {"desktop": (1100, 900), "phone": (390, 844)}


def opened(browser, served: Served, size: tuple[int, int], scheme: str):
    context = browser.new_context(viewport={"width": size[0], "height": size[1]}, color_scheme=scheme)
    page = context.new_page()
    page.set_default_timeout(90_000)  # of a machine that others use, too
    for _ in range(40):  # the address is told before the server listens
        try:
            page.goto(served.address)
            break
        except Exception as error:
            assert "ERR_CONNECTION_REFUSED" in str(error)  # noqa: PT017
            page.wait_for_timeout(500)
    page.wait_for_selector("text=From a film to what the model lacks", timeout=60_000)
    return page


@pytest.fixture(scope="module")
def page(browser, served):
    return opened(browser, served, SIZES["desktop"], "light")


@pytest.fixture(scope="module")
def film(tmp_path_factory) -> Path:
    """A short swing of a cone, filmed: as much as a diagnosis takes."""
    from tentacle.cli import main

    folder = tmp_path_factory.mktemp("film")
    (folder / "arm.toml").write_text(shown_arm())
    swing = [
        "--chirp",
        "0.5",
        "0.3",
        "2",
        "--duration",
        "2.5",
        "--fps",
        "20",
        "--video",
        "clean",
        "--size",
        "320",
        "240",
    ]
    assert main(["simulate", str(folder / "arm.toml"), "--out", str(folder / "lab"), *swing]) == 0
    return folder / "lab"


@pytest.mark.usefixtures("page")
def test_without_the_token_nothing_is_given(served):
    bare = served.address.partition("?")[0]
    for address, host in ((bare, None), (served.address, "elsewhere.example:80")):
        request = urllib.request.Request(address, headers={} if host is None else {"Host": host})
        with pytest.raises(urllib.error.HTTPError) as refused:
            urllib.request.urlopen(request)
        refused.value.close()
        assert refused.value.code == 403


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("notes.txt", b"hello", "notes.txt: is not read; expected a film"),
        ("motor.csv", b"a;b;c\n0,0;0,1;0,1\n", "the columns a, b, c do not say which is the time"),
        ("servo.csv", b"t_s;servo_rad\n0,0;0,1\n0,0;0,2\n", "servo.csv:3: t_s: time repeats or goes back"),
        ("swing.mp4", b"no film at all", "swing.mp4: unreadable video"),
    ],
)
def test_a_wrong_file_is_named_and_not_kept(page, served, name, content, said):
    page.set_input_files("input[type=file]", [{"name": name, "mimeType": "x/y", "buffer": content}])
    page.get_by_role("alert").get_by_text(said).wait_for(timeout=20_000)
    assert [file for file in served.folder.rglob("*") if file.is_file()] == []


def test_running_without_a_film_says_what_is_missing(page):
    page.get_by_role("button", name="diagnose", exact=True).click()
    page.get_by_role("alert").get_by_text("no film yet").wait_for(timeout=20_000)


def test_numbers_that_only_the_user_knows_stop_a_run_until_they_are_given(page, served, film):
    """With a film and its proposed marks alone nothing runs; nor before a person has looked at the outline."""
    bad = {"name": "servo.csv", "mimeType": "x/y", "buffer": b"a;b\n"}
    page.set_input_files("input[type=file]", [bad])
    page.get_by_role("alert").get_by_text("servo.csv").wait_for(timeout=20_000)
    page.set_input_files("input[type=file]", [film / "video.mp4", film / "motor.csv"])
    page.get_by_text("Proposed from the film").wait_for(timeout=60_000)
    page.wait_for_function("() => document.querySelectorAll('.missing').length == 6")  # five numbers, and the look
    assert page.locator("polygon").count() == 0
    page.get_by_role("button", name="diagnose", exact=True).click()
    alarm = page.get_by_role("alert")
    alarm.get_by_text("not given yet; expected the numbers of your arm").wait_for(timeout=20_000)
    for words in ("length of the arm", "radius at the tip", "density of the fluid"):
        assert words in alarm.inner_text()
    for words, number in ARM.items():
        page.get_by_label(words).fill(number)
    page.locator("polygon").first.wait_for()
    page.get_by_role("button", name="track", exact=True).click()
    alarm.get_by_text("where the arm is: not confirmed yet").wait_for(timeout=20_000)
    assert not (served.folder / "my_arm" / "recording.toml").exists()


def test_from_a_film_to_a_verdict(page, served):
    """Goes on where the test before ends."""
    before = page.locator("polygon").first.get_attribute("points")
    page.get_by_role("button", name="ruler start").click()
    page.locator(".film img").click(position={"x": 20, "y": 20})
    page.locator("circle").nth(3).wait_for()
    page.locator(".q-slider").click(position={"x": 30, "y": 8})  # the arm turns as the servo would turn it
    page.wait_for_function("old => document.querySelector('polygon').getAttribute('points') != old", arg=before)
    page.get_by_text("does the yellow outline cover the arm").click()
    page.locator(".looked:not(.missing)").wait_for()
    page.get_by_role("button", name="diagnose", exact=True).click()
    page.get_by_text("100 %").wait_for(timeout=PATIENCE)
    verdict = json.loads((served.folder / "my_arm_answer" / "verdict.json").read_text())
    assert verdict["error"]["before"]["midline_mm"] > 0.0
    report = page.frame_locator("iframe.report")
    report.get_by_text("What to do next").first.wait_for(timeout=20_000)
    said = page.locator("code").first.inner_text()
    assert "tentacle diagnose my_arm --out my_arm_answer" in said
    assert (served.folder / "my_arm" / "recording.toml").exists()


def test_the_session_is_shown_and_asks_this_machine_alone(page):
    """Rerun's page would fetch a font and a version number elsewhere, and send statistics: the browser refuses that."""
    asked, refused = [], []
    page.on("request", lambda request: asked.append(request.url))
    page.on("requestfailed", lambda request: refused.append((request.url, request.failure)))
    page.get_by_role("button", name="show the session here").click()
    page.frame_locator("iframe.session").locator("canvas").first.wait_for(timeout=60_000)
    page.wait_for_timeout(8000)  # the viewer asks only when it is up
    elsewhere = [url for url in asked if not url.startswith(("http://127.0.0.1:", "blob:", "data:"))]
    assert elsewhere
    assert [url for url in elsewhere if (url, "csp") not in refused] == []
    assert any("session.rrd" in url for url in asked)


def test_what_runs_can_be_stopped_and_leaves_nothing_half_written(page, served):
    page.locator("iframe.session").evaluate("frame => frame.remove()")  # its drawing would slow the page down
    page.get_by_role("button", name="identify", exact=True).click()
    page.wait_for_function("() => !document.querySelector('.doing').innerText.includes('done')")
    page.get_by_role("button", name="stop").click()
    page.get_by_text("stopped").first.wait_for(timeout=20_000)
    assert not (served.folder / "my_arm_identified").exists()


def test_an_earlier_recording_is_shown_as_it_was_declared(browser, served):
    page = opened(browser, served, SIZES["phone"], "dark")
    page.get_by_label("go on with an earlier recording").click()
    page.get_by_role("option", name="my_arm").click()
    page.get_by_text("As it was declared").wait_for(timeout=20_000)
    page.locator("polygon").first.wait_for()
    assert {words: page.get_by_label(words).input_value() for words in ARM} == ARM
    assert page.locator(".missing").count() == 0
    page.context.close()


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("size", SIZES)
def test_nothing_is_cut_off_at_any_width(browser, served, size, scheme):
    page = opened(browser, served, SIZES[size], scheme)
    assert page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
    paper = page.evaluate("getComputedStyle(document.body).backgroundColor")
    assert (paper in ("rgb(255, 255, 255)", "rgba(0, 0, 0, 0)")) == (scheme == "light")
    page.context.close()
