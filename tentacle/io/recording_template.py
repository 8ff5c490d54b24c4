"""recording.toml as a text with comments, for a new recording; for a missing number the comment says how to find it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from tentacle.errors import InputError
from tentacle.io.declaration_file import parse_recording_file
from tentacle.io.toml_table import parse_toml
from tentacle.io.written_file import write_text
from tentacle.recording import Camera
from tentacle.specimen import Rectangle, Section

MIRRORED = "# mirrored = true              # where a positive angle in motor.csv turns the arm the other way"


@dataclass(frozen=True)
class Answers:
    """Length [m], section and density [kg/m^3] of the arm; fluid_density [kg/m^3], 0 in air. camera None: not known
    yet.
    """

    length: float
    section: Section
    density: float
    fluid_density: float
    camera: Camera | None = None


def require_usable(answers: Answers) -> None:
    """InputError where a recording.toml with these answers would be refused."""
    parse_recording_file(parse_toml(recording_text(answers), None))


def recording_text(answers: Answers) -> str:
    """The file's text: every table that a film needs, each number with a comment."""
    return f"""\
# What you believe to be in this recording. Lengths in metres, angles in rad, densities in kg/m3.
# A number may also be {{ value = 0.14, sd = 0.001 }} or {{ low = 0.139, high = 0.141 }} where you know it only so well.

[specimen]
{_section_text(answers)}
{_line("density_kg_m3", answers.density, "of the material: weigh a piece in air and in water")}
# tip_mass_kg = 0.005          # a payload that you know of
# shear_compliance = 1.0       # how much a thick arm's sections shear: 1, as an incompressible solid; 0, not at all
# clamp_length_m = 0.003       # how much a soft clamp gives: it turns as this length of the arm's root would bend

[fluid]
{_line("density_kg_m3", answers.fluid_density, "998: water at 20 C; 0: air")}

[gravity]
angle_rad = 0.0                # 0: the arm hangs down; 3.1416: it stands up; 1.5708: held horizontally

{camera_text(answers.camera)}
# Beside this file: the film as video.mp4 (.mkv .avi .mov .webm .gif), and where you have them
#   motor.csv         t_s,command_rad,angle_rad  the servo, in the film's time; without it the base is clamped
#                     (`tentacle new FOLDER --motor LOG` makes it of a log in degrees, ms, with semicolons)
#   base.csv          t_s,x_m,y_m                where the base is, if it travels (shaken, on a cart, towed)
#   load_cell.csv     t_s,thrust_n
#   strain.csv        t_s,NAME_strain            a strain gauge: [strain] NAME = {{ s = 0.1, d = 0.01 }}
#   acceleration.csv  t_s,NAME_m_s2              one axis: [acceleration] NAME = {{ s = 1, d = 0, axis = "normal" }}
"""


def _section_text(answers: Answers) -> str:
    """The kind of section, the length, and the sizes of that section."""
    section, length = answers.section, _line("length_m", answers.length, "from the clamp to the tip")
    if isinstance(section, Rectangle):
        return f"""\
section = "rectangle"          # a strip; "cone" takes base_radius_m and tip_radius_m in place of width and height
{length}
{_line("width_m", section.section_width, "across the plane in which the arm bends")}
{_line("height_m", section.height, "its thickness in that plane")}"""
    return f"""\
section = "cone"               # a round arm; "rectangle" takes width_m and height_m in place of the radii
{length}
{_line("base_radius_m", section.base_radius, "half the thickness at the clamp")}
{_line("tip_radius_m", section.tip_radius, "half the thickness at the tip")}"""


def _line(key: str, value: float | str, words: str) -> str:
    """A key with its value, and a comment in the column of the other comments."""
    return f"{f'{key} = {value}':<30} # {words}"


def camera_text(camera: Camera | None) -> str:
    """[camera] from the film, or as comments that say how to find it."""
    if camera is None:
        return f"""\
# [camera]                     # found from the film: tentacle new FOLDER --video FILM, or in the page of: tentacle app
# fps = 30.0                   # pictures a second
# m_per_px = 0.0005            # length of a ruler in the arm's plane, in metres, over its length in pixels
# base_px = [320.0, 40.0]      # where the arm leaves its clamp: pixels to the right and down from the upper left corner
# arm_px = [0.0, 1.0]          # the direction of the straight arm in the picture: [0, 1] is down
{MIRRORED}
"""
    (u, v), (along, down) = camera.base_px, camera.arm_px
    ruler = "the arm's length over its pixels; a ruler in the arm's plane is better"
    return f"""\
[camera]                       # proposed from the film's first picture: look at it with `tentacle view`
fps = {camera.fps:.6g}
{_line("m_per_px", f"{camera.metres_per_px:.5g}", ruler)}
{_line("base_px", f"[{u:.1f}, {v:.1f}]", "where the arm leaves its clamp: pixels to the right and down")}
{_line("arm_px", f"[{along:g}, {down:g}]", "the direction of the straight arm; [0, 1] is down")}
{MIRRORED.removeprefix("# ") if camera.mirrored else MIRRORED}
"""


def write_recording_file(folder: Path, text: str) -> Path:
    """recording.toml in the folder, which is made; InputError where there is one already."""
    file = folder / "recording.toml"
    if file.exists():
        raise InputError("is there already", file=file, expected="a folder without one, or edit it")
    folder.mkdir(parents=True, exist_ok=True)
    write_text(file, text)
    return file
