"""The swimmers' session: both arms with every frame, and the search beside them; the front's figure."""

import numpy as np
from rerun.chunk import RrdReader

from tentacle.specimen import Cone, Specimen
from viz.figures.free_swim import free_swim_figure
from viz.figures.front import front_figure
from viz.figures.style import svg
from viz.swimming import SearchCourse, Swimmer, write_swimming

ARM = Specimen(Cone(0.0125, 0.001), 0.21, 1070.0)


def test_swimmers_are_drawn_frame_by_frame(tmp_path):
    t, s = np.arange(30) / 30.0, np.linspace(0.0, 1.0, 11)
    xy = np.zeros((30, 11, 2))
    xy[:, :, 1] = 0.21 * s - 0.1 * t[:, None]
    swimmers = [Swimmer(name, np.sin(t), 0.1 * t, xy) for name in ("gait", "best sine")]
    path = write_swimming(
        swimmers, t, s, ARM, SearchCourse(np.array([50, 100]), np.array([0.01, 0.02])), tmp_path / "s.rrd"
    )
    rows: dict[str, int] = {}
    for chunk in RrdReader(str(path)).stream():
        if not chunk.is_static:
            entity = str(chunk.entity_path)
            rows[entity] = rows.get(entity, 0) + chunk.to_record_batch().num_rows
    for name in ("gait", r"best\ sine"):
        assert rows[f"/swim/arms/{name}"] == rows[f"/swim/theta/{name}"] == rows[f"/swim/travel/{name}"] == 30
    assert rows["/search/best"] == 2


def test_front_names_its_units():
    page = svg(front_figure(np.array([0.01, 0.02]), np.array([0.001, 0.004]), {"best sine": (0.015, 0.003)}), "f")
    assert "speed [cm/s]" in page
    assert "power to the arm [mW]" in page


def test_a_free_swim_is_drawn_from_above_forward_to_the_right():
    t = np.linspace(0.0, 3.0, 91)
    xy = np.zeros((91, 5, 2))
    xy[:, :, 1] = 0.21 * np.linspace(0.0, 1.0, 5) - 0.1 * t[:, None]  # forward is -y
    figure = free_swim_figure({"gait": (t, xy), "best sine": (t, xy)})
    path = figure.axes[0].lines[-1]
    assert abs(np.asarray(path.get_xdata())[-1] - 30.0) < 1e-9  # cm
    assert len(figure.axes[0].lines) == 2 * 4 + 1  # arm and hull at 0, 1, 2, 3 s, and the path
    assert "sideways [cm]" in svg(figure, "f")
