"""The recordings of chosen trials made again, with the truth beside each."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from pathlib import Path

from tentacle.errors import InputError
from tentacle.io.recording_rrd import write_rrd
from tentacle.io.result_folder import written
from validation.trials.plant_design import PlantDesign
from validation.trials.plant_recording import plant_baseline
from validation.trials.series import AnyDesign, made


def remake(designs: Sequence[AnyDesign], chosen: Sequence[int], out: Path) -> Iterator[Path]:
    """Write the chosen trials' recordings, and the baselines that were made for them, for `tentacle diagnose`; yields
    the path of each trial's .rrd file once it is written.
    """
    for index in chosen:
        if not 0 <= index < len(designs):
            expected = f"0 to {len(designs) - 1}"
            raise InputError(f"the series has no trial {index}", field="--only", expected=expected)
        design = designs[index]
        recording, truth = made(design)
        own_baseline = plant_baseline(design) if isinstance(design, PlantDesign) else []
        with written(out) as folder:
            for one in own_baseline:
                write_rrd(one, folder / f"{one.name}.rrd")
            write_rrd(recording, folder / f"{recording.name}.rrd")
            (folder / f"{recording.name}.truth.json").write_text(json.dumps(truth, indent=1) + "\n")
        yield out / f"{recording.name}.rrd"
