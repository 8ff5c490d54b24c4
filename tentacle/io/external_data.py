"""Measured data of other labs, used by tests and examples: content, source and presence of each set.

The data are never part of this repository. They lie in the folder named by TENTACLE_DATA (default: ../shared/data
beside the checkout), one folder a set.
"""

from __future__ import annotations

import hashlib
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

CHECKOUT = Path(__file__).resolve().parents[2]


@dataclass(frozen=True)
class DataSet:
    """A set: files maps a path in it to its SHA-256; a path that ends in / stands for all files in that folder."""

    name: str
    what: str
    url: str
    commit: str
    path: str
    licence: str
    files: dict[str, str]


DATA_SETS = (
    DataSet(
        name="silicone_beam",
        what="motion capture (100 Hz) of a clamped silicone beam, 30 x 30 x 100 mm, released from rest; with and "
        "without a weight of 52 g at its tip. One CSV a run, converted from the C3D files of the source: t_s, then "
        "MARKER_x_mm, _y_mm, _z_mm",
        url="https://github.com/srl-ethz/diffPD_sim2real",
        commit="825e7b7c4638d18f0b35707eb192bedf955a7157",
        path="python/realbeam_experiments/Measurement_data/*.c3d",
        licence="MIT (Soft Robotics Lab, ETH Zurich)",
        files={
            "beam_gravity_V2_a.csv": "d84845877a2996d6f2b572d4089e620241abcb8f2fce54bdcb3d86b97333d001",
            "beam_gravity_V2_b.csv": "39526f31b30c911467c36d1884f651e981bc5f0432f4db64a3f684ef4fc8e599",
            "beam_load52_V2_a.csv": "e94630b4c9819833e7e39d1bc632c0400b517fec0d26eb1b2bef5a82394f6d21",
            "beam_load52_V2_b.csv": "339594656d69fed8e0bb803b54deb0def06af0fc1a7b34a3caee8fdaf951f0ae",
        },
    ),
    DataSet(
        name="thrust_bench",
        what="load cell runs of a propeller bench (HX711, about 10 Hz with jitter): raw counts and calibrated grams",
        url="https://github.com/bkiss13/thrust-stand",
        commit="8f8c4814f77b1a2d262f990e506cba4c1eed1a8b",
        path="Dataset A",
        licence="MIT",
        files={
            "datura-2.5.csv": "6cc93821f81eb49c06e733e28ef1e9ffc9d88e4fcb509944e4e878b9ac9f59c1",
            "datura-3.0.csv": "9a44b8de76ee5367c6119c2075f6823d329ce353a0b4cc5239a706d86d0cefe7",
            "datura-3.5.csv": "80e5798682417c3e1349d9c969370a2b72eb29fe5b2c8b970aa5cae55f8b6ef8",
            "datura-4.9.csv": "70089cf1f9eb58371428ce8736fbc114d0ac20d88a4fc53dbbca03169250fbea",
            "robo-2.5.csv": "f0f9c817a64b1326eb72ec11a95015b3dfc420a9ba697860d49c054702b30d6b",
            "robo-3.csv": "5af900d397bee85905f2894a853a32609cc7841780a50032693044851f22ae1c",
        },
    ),
    DataSet(
        name="trunk_payload",
        what="motion capture (100 Hz) of a hanging soft arm of .32 m, three discs: let go by hand with 200 g and 300 g "
        "at its tip, and driven by tendons with 0 g and 100 g (these cut after 3000 rows)",
        url="https://github.com/StanfordASL/trunk-stack",
        commit="8b4b9234b287a0403d1844821bfad79e36e1f66f",
        path="stack/main/data/trajectories/dynamic",
        licence="MIT (Stanford Autonomous Systems Lab)",
        files={
            "control_inputs_controlled_1.csv": "30024acf90259fceef9ef9ee0ec8555053044a335b0eeb0376a5ef8be929a009",
            "observations_controlled_1_0g.csv": "afd419e511019c79b4888d7f6eca1731f07612fd43787ca75f865ae6393d871f",
            "observations_controlled_1_100g.csv": "29c832e13a1f9fea2f6128d2da2b7c045833042174640b6337eecf7f003b5ada",
            "observations_manual_decay_200g.csv": "f018af6fa6af6b56f88eeaff4d89cf4413b2b5196771e7a30c0054ac1a927b22",
            "observations_manual_decay_200g_2.csv": "a8f87d7d05eebaefde9f6c1ff136dfc0afa2a1064312cb15aa74af8b63a9d273",
            "observations_manual_decay_300g.csv": "0e157d5dfb93a66ba649f57e6e9f3de74d9bd21c3472d4a67cf77b6a67ce4097",
        },
    ),
    DataSet(
        name="pressure_arm",
        what="motion capture (100 Hz) of a pneumatic arm of one segment, clamped in air, inflated in a step to 150 or "
        "300 mbar and vented. One CSV a run, converted from the C3D files of the source: t_s, then MARKER_x_mm, _y_mm, "
        "_z_mm",
        url="https://github.com/srl-ethz/diffPD_sim2real",
        commit="825e7b7c4638d18f0b35707eb192bedf955a7157",
        path="python/1segment_arm/Measurement_data/*_V3.c3d",
        licence="MIT (Soft Robotics Lab, ETH Zurich)",
        files={
            "arm_150mbar.csv": "6d68475c39a562c791164f0d3d8c8b84bc8e58a575a27cfa39977ce43af60b08",
            "arm_300mbar.csv": "b50d5b6af19977bdb35755dbb1dc63e455cb1e6d5e8a99de3d8eec7e4baacd6a",
        },
    ),
    DataSet(
        name="worm_crops",
        what="600 grey crops of a crawling worm, 15 frames/s, with midlines by another program "
        "(reference_midlines.npz: the first 600 rows of features.h5)",
        url="https://github.com/iteal/wormpose_data",
        commit="3667721534fc3062b85f165826c0ae944bceeedc",
        path="datasets/sample_data",
        licence="BSD-3-Clause (OIST)",
        files={
            "reference_midlines.npz": "cd5810ce14b622bcf631dbce9e2f7fb593dc7688b7d22f189357fc976350a3bc",
            "frames/": "b4b5db18289954cc3201cc36643b25d860445312a38af83ab160900fcd0d5426",
        },
    ),
)

DataSetState = Literal["present", "absent", "incomplete", "changed"]


def data_folder() -> Path:
    """The folder of the sets: TENTACLE_DATA, or ../shared/data beside the checkout."""
    named = os.environ.get("TENTACLE_DATA")
    return Path(named) if named else CHECKOUT.parent / "shared" / "data"


def check_data_set(data_set: DataSet, folder: Path) -> tuple[DataSetState, list[str]]:
    """Whether a set in a data folder is the version of the tests, and the paths that differ."""
    root = folder / data_set.name
    if not root.is_dir():
        return "absent", []
    missing = [path for path in data_set.files if not (root / path).exists()]
    if missing:
        return "incomplete", missing
    changed = [path for path, expected in data_set.files.items() if file_digest(root / path) != expected]
    return ("changed", changed) if changed else ("present", [])


def file_digest(path: Path) -> str:
    """SHA-256 of a file; of a folder, that of the lines "SHA-256  name" of its files in the order of their names."""
    if path.is_dir():
        lines = "".join(f"{file_digest(file)}  {file.name}\n" for file in sorted(path.iterdir()) if file.is_file())
        return hashlib.sha256(lines.encode()).hexdigest()
    return hashlib.sha256(path.read_bytes()).hexdigest()
