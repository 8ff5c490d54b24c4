"""Arms that move in space: their plane is found at import, and a motion that leaves it too far is refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from inference.prepare import MOST_OUT_OF_PLANE, CannotTellError, prepare
from tentacle.io.import_folder import read_folder
from tentacle.io.write_folder import write_folder
from tests.made_recordings import as_markers, record

TURN = 0.6  # rad about the arm: the plane of motion against the camera's


def in_space(folder, share):
    """A planar run's markers, turned about the arm; out of the plane they move by this share, in quadrature."""
    flat = replace(as_markers(record(seconds=4.0)), motor=None)
    markers = flat.markers
    across = markers.xy[..., 0] - markers.xy[..., 0].mean(axis=0)
    swing = np.sqrt(2.0) * np.sin(17.0 * markers.t)[:, None] * across.std(axis=0)
    out = swing * share / np.sqrt(1.0 - share**2)
    x = np.cos(TURN) * markers.xy[..., 0] - np.sin(TURN) * out
    z = np.sin(TURN) * markers.xy[..., 0] + np.cos(TURN) * out
    write_folder(flat, folder)
    names = [f"{name}_{axis}_m" for name in markers.names for axis in "xyz"]
    columns = np.stack([x, markers.xy[..., 1], z], axis=-1).reshape(len(markers.t), -1)
    table = np.column_stack([markers.t, columns])
    np.savetxt(folder / "markers.csv", table, delimiter=",", header=",".join(["t_s", *names]), comments="", fmt="%.9g")
    return flat, read_folder(folder)


def test_the_plane_is_found_and_its_share_is_told(tmp_path):
    flat, read = in_space(tmp_path / "arm", 0.1)
    assert read.declaration.out_of_plane == pytest.approx(0.1, abs=0.01)  # the two swings are not quite orthogonal
    sign = np.sign(np.corrcoef(read.markers.xy[:, -1, 0], flat.markers.xy[:, -1, 0])[0, 1])
    # rms in the plane: the axis is turned by the swings' correlation
    assert np.sqrt(np.mean((sign * read.markers.xy - flat.markers.xy)[..., 0] ** 2)) < 0.1 * flat.markers.xy.std()
    (words,) = [sentence for sentence in prepare(read, hold_out=False).words if "plane" in sentence]
    assert "10." in words or "9." in words


def test_a_motion_that_leaves_the_plane_too_far_is_refused_with_both_shares(tmp_path):
    _, read = in_space(tmp_path / "arm", 0.4)
    with pytest.raises(CannotTellError, match=rf"40 %.*{100 * MOST_OUT_OF_PLANE:.0f} %"):
        prepare(read, hold_out=False)


def test_the_declared_share_is_written_and_read(tmp_path):
    made = as_markers(record(seconds=4.0))
    declared = replace(made, declaration=replace(made.declaration, out_of_plane=0.05))
    assert read_folder(write_folder(declared, tmp_path / "arm")).declaration.out_of_plane == 0.05
