"""R of each of two hidden effects beside the other, for the committed blind midlines whose answer lacks one of the two.

python benchmarks/beside.py

Trials that benchmarks/results/beside.jsonl already has stay (some right ones too, to compare); every other one is made
again from its seed and measured (validation.trials.beside), half a minute of processor time each. The first line is the
commit that made the last of them.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from benchmarks._commit import commit_of
from benchmarks.series import BESIDE, Series, all_series, read_beside
from validation.trials.beside import sizes_beside
from validation.trials.plant_design import plant_designs
from validation.trials.scores import VISIBLE, counting


def unmeasured(series: Series) -> Iterator[int]:
    """Indices of the wrongly answered pairs of R >= VISIBLE that are not measured yet."""
    pairs = counting(series.outcomes, "pair", VISIBLE)
    return (o.index for o in pairs if not o.hit and o.index not in series.beside)


def measured(series: Series) -> Iterator[dict[str, Any]]:
    """One row for each of them.

    ValueError where the seed no longer makes the trial that was diagnosed.
    """
    missing = list(unmeasured(series))
    if not missing:
        return
    designs = plant_designs(max(missing) + 1, series.seed, kinds=series.kinds, video_share=0.0)
    hidden = {o.index: o.hidden for o in series.outcomes}
    for index in missing:
        if designs[index].effects != hidden[index]:
            raise ValueError(f"seed {series.seed}, trial {index}: {designs[index].effects} in place of {hidden[index]}")
        yield {"seed": series.seed, "index": index, "beside": sizes_beside(designs[index])}


def main() -> None:
    """Measure what is missing, and keep each as it comes."""
    known = [{"seed": seed, "index": index, "beside": r} for (seed, index), r in read_beside().items()]
    for series in all_series():
        for row in measured(series):
            known.append(row)
            header = {"made": "python benchmarks/beside.py", "commit": commit_of(Path(__file__).parent)}
            BESIDE.write_text("".join(json.dumps(line) + "\n" for line in (header, *known)), encoding="utf-8")
            print(row, flush=True)


if __name__ == "__main__":
    main()
