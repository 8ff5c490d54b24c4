"""The emulated camera draws the declared arm, no longer and no thicker."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks._rig_scene import CAMERA, DECLARED
from rig.emulated_camera import ARM, GROUND, EmulatedOptics, draw_picture
from tentacle.specimen import Cone


@pytest.mark.parametrize("turn", [0.0, 0.3, -0.7])
def test_a_straight_arm_is_as_long_and_as_wide_as_declared(turn: float) -> None:
    """Area and first moment about the base of a cone cut flat, both in closed form. The moment grows with the cube of
    the length: half a pixel more at the tip is 0.6 %. Grey is rounded to 1/160 of a pixel, at some 500 edge pixels:
    0.1 % of the area at most.
    """
    optics, arm = EmulatedOptics.of(DECLARED), DECLARED.specimen
    assert isinstance(arm.section, Cone)
    base, tip, length = arm.section.base_radius, arm.section.tip_radius, arm.length
    along = np.array([np.sin(turn), np.cos(turn)])
    image = draw_picture(np.linspace(0.0, length, 24)[:, None] * along, 0.0, optics).astype(float)
    image[:32, 280:] = GROUND  # the lamp
    share = (GROUND - image) / (GROUND - ARM)
    rows, columns = np.indices(share.shape)
    place = CAMERA.to_base_frame(np.stack([columns, rows], axis=-1).astype(float)) @ along
    pixel = CAMERA.metres_per_px**2
    assert pixel * share.sum() == pytest.approx(length * (base + tip), rel=2e-3)
    moment = 2.0 * length**2 * (base / 2.0 + (tip - base) / 3.0)
    assert pixel * (share * place).sum() == pytest.approx(moment, rel=3e-3)
