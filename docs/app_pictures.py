"""Pictures of `tentacle app` with a film and its answer, from Chromium without a screen."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from viz.viewer import free_port

LOOKS = {"app_desktop": ((1100, 900), "light"), "app_phone": ((390, 844), "dark")}
ARM = {  # the arm in the film of `tentacle demo`
    "length of the arm": "0.14",
    "radius at the base": "0.0125",
    "radius at the tip": "0.004",
    "density of the material": "1070",
    "density of the fluid": "998",
}
PATIENCE = 600_000  # ms


def photograph_app(folder: Path, recording: Path) -> dict[str, Path]:
    """A picture a look: the first before anything runs, the last while a diagnosis runs."""
    from playwright.sync_api import sync_playwright

    command = [sys.executable, "-m", "tentacle", "app", str(folder / "app"), "--no-browser", "--port", str(free_port())]
    served = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    pictures = {}
    try:
        assert served.stdout is not None
        address = served.stdout.readline().split()[0]
        with sync_playwright() as driver:
            browser = driver.chromium.launch(executable_path="/usr/bin/chromium", args=["--no-sandbox"])
            for name, ((width, height), scheme) in LOOKS.items():
                context = browser.new_context(viewport={"width": width, "height": height}, color_scheme=scheme)
                page = context.new_page()
                page.wait_for_timeout(15_000)  # the address is told before the server listens
                page.goto(address)
                page.set_input_files("input[type=file]", [recording / "video.mp4", recording / "motor.csv"])
                page.get_by_text("Proposed from the film").wait_for(timeout=PATIENCE)
                for words, number in ARM.items():
                    page.get_by_label(words).fill(number)
                page.get_by_text("does the yellow outline cover the arm").click()
                if name == "app_phone":
                    page.get_by_role("button", name="diagnose", exact=True).click()
                    page.get_by_text("fitting the declared model").wait_for(timeout=PATIENCE)
                page.wait_for_timeout(3000)
                pictures[name] = folder / f"{name}.png"
                page.screenshot(path=str(pictures[name]), full_page=True)
                context.close()
            browser.close()
    finally:
        served.terminate()
        served.wait()
    return pictures
