"""A lab's folder, as plain texts."""

from __future__ import annotations

from pathlib import Path

CONE = """\
[specimen]
section = "cone"
length_m = 0.14
base_radius_m = 0.0125
tip_radius_m = 0.001
density_kg_m3 = 1070
"""
CAMERA = """\
[camera]
fps = 60
m_per_px = 0.0005
base_px = [320, 80]
arm_px = [0, 1]
"""
MOTOR = "t_s,command_rad,angle_rad\n0.0,0.1,0.1\n0.01,0.2,0.15\n0.02,0.3,0.25\n"
LOAD_CELL = "t_s,thrust_n\n0.0,0.01\n0.1,0.02\n"
MIDLINE = "t_s,s,x_m,y_m,sigma_m\n0,0,0,0,1e-4\n0,1,0.01,0.13,1e-4\n0.1,0,0,0,1e-4\n0.1,1,0.02,0.12,1e-4\n"
MARKERS = "t_s,tip_x_m,tip_y_m\n0,0.01,0.13\n0.1,0.02,0.13\n"


def lab_folder(path: Path, **files: str) -> Path:
    path.mkdir()
    for name, text in files.items():
        (path / name.replace("__", ".")).write_text(text, encoding="utf-8", newline="")
    return path
