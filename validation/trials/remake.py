"""The recordings of chosen trials made again, with the truth beside each."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from pathlib import Path

from tentacle.errors import InputError
from tentacle.io.recording_rrd import write_rrd
from tentacle.io.result_folder import written
from validation.trials.series import AnyDesign, made


def remake(designs: Sequence[AnyDesign], chosen: Sequence[int], out: Path) -> Iterator[Path]:
    """Write the chosen trials' recordings for `tentacle diagnose`; yields the path of each .rrd file once it is
    written.
    """
    for index in chosen:
        if not 0 <= index < len(designs):
            expected = f"0 to {len(designs) - 1}"
            raise InputError(f"the series has no trial {index}", field="--only", expected=expected)
        recording, truth = made(designs[index])
        with written(out) as folder:
            write_rrd(recording, folder / f"{recording.name}.rrd")
            (folder / f"{recording.name}.truth.json").write_text(json.dumps(truth, indent=1) + "\n")
        yield out / f"{recording.name}.rrd"
