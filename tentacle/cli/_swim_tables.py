"""The result of `optimise` as plain data."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from affine_model.swim import GaitTrial, Promise, Swimming
    from tentacle.model import Model


def promise_table(promise: Promise) -> dict[str, Any]:
    """A promise as plain data, units in the names; a gait that does not swim has no cost of transport."""
    table = {
        "thrust_n": promise.thrust,
        "speed_m_s": promise.speed,
        "power_w": promise.power,
        "peak_torque_n_m": promise.torque,
    }
    afloat = (promise.free_speed, promise.yaw_drift, promise.free_power)
    names = ("free_speed_m_s", "yaw_drift_rad_s", "free_power_w")
    table |= {name: value for name, value in zip(names, afloat, strict=True) if value is not None}
    return table if promise.speed <= 0.0 else {**table, "transport_j_m": promise.transport}


def posterior_table(trial: GaitTrial, model: Model, found: Swimming) -> dict[str, Any]:
    """The gait's promise under the model's posterior: 95 % of draws lie within. It knows nothing of the model's own
    error.
    """
    import numpy as np

    from affine_model.swim import OBJECTIVES
    from affine_model.swim.optimise import for_objective
    from affine_model.swim.robust import drawn_from, promised_interval

    objective = OBJECTIVES[found.objective]
    ready = for_objective(trial, objective).refined()
    low, high = promised_interval(ready, model, objective, np.array(found.gait.alpha))
    return {"low": low, "high": high, "unit": objective.unit, "drawn_from": drawn_from(model)}


def result_tables(found: Swimming, waveform_table: Any) -> dict[str, Any]:
    """result.toml's tables: the gait as a [waveform] that every command reads, its promise, the sine, the search."""
    return {
        "waveform": waveform_table(found.gait),
        "promise": promise_table(found.promise),
        "sine": {"waveform": waveform_table(found.sine), "promise": promise_table(found.sine_promise)},
        "peaks": dict(zip(("angle_rad", "speed_rad_s", "acceleration_rad_s2"), found.peaks.tolist(), strict=True)),
        "search": {
            "objective": found.objective,
            "method": found.method,
            "seed": found.seed,
            "origin": found.origin,
            "evaluations": int(found.evaluations[-1]),
            "value": found.value,
            "sine_value": found.sine_value,
            "gain": found.gain,
        },
    }
