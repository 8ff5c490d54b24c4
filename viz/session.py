"""A session file (.rrd) with its layout inside, written whole or not at all."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from uuid import UUID

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from tentacle.diagnosis import Diagnosis
from tentacle.io.rrd_stream import new_stream, saved
from tentacle.io.written_file import written_file
from tentacle.recording import Declaration, Recording
from viz.blueprints.diagnose import diagnose_blueprint
from viz.blueprints.run import LoggedTopics
from viz.scene import ViewedRun, paired, scene_of
from viz.topics.arms import log_arms
from viz.topics.camera import log_camera
from viz.topics.coordinates import log_coordinates
from viz.topics.events import Event, judged_events, log_events, recording_events
from viz.topics.forces import log_forces, log_missing_force
from viz.topics.paths import run_path
from viz.topics.residual import log_residual, log_spectra
from viz.topics.sensors import log_sensors
from viz.topics.thrust import log_thrust
from viz.topics.tip import log_tip
from viz.topics.verdict import log_verdict


def session_id(*words: str) -> UUID:
    """An identity for a session that depends on its words alone, so that the same input gives the same one."""
    return UUID(bytes=hashlib.sha256("\0".join(words).encode()).digest()[:16])


@contextmanager
def session_file(path: Path, identity: UUID) -> Iterator[rr.RecordingStream]:
    """A stream into path. The file appears under its name only when the block ends without an error."""
    session = new_stream(identity, send_properties=False)
    with written_file(path) as unfinished, saved(session, unfinished):
        yield session


def set_layout(session: rr.RecordingStream, blueprint: rrb.Blueprint) -> None:
    """Put the layout into the session."""
    session.send_blueprint(blueprint, make_active=True, make_default=True)


def log_scene(
    session: rr.RecordingStream, scene: ViewedRun, recording: Recording, events: Sequence[Event] = ()
) -> LoggedTopics:
    """Every topic of one run; says which of the optional ones there were."""
    path = run_path(scene.name)
    log_arms(session, path, scene, recording.declaration)
    forces = log_forces(session, path, scene, recording.declaration.specimen)
    log_coordinates(session, path, scene, recording.shape)
    log_residual(session, path, scene)
    log_spectra(session, path, scene)
    log_sensors(session, path, scene)
    return LoggedTopics(
        scene.name,
        recording.declaration,
        tuple((party.key, party.role.name) for party in scene.models),
        arms=any(bool(np.isfinite(party.xy).any()) for party in scene.parties),
        coordinates=any(party.q is not None and bool(np.isfinite(party.q).any()) for party in scene.parties),
        camera=log_camera(session, path, scene, recording),
        thrust=log_thrust(session, path, scene, recording.load_cell),
        events=log_events(session, path, [*events, *recording_events(recording), *judged_events(scene)]),
        forces=forces,
        tip_mm=log_tip(session, path, scene),
        sensors=scene.sensors,
    )


def diagnosed_declaration(diagnosis: Diagnosis) -> Declaration:
    """What the base model says of the arm, for a run whose recording is not at hand."""
    model = diagnosis.base_model
    return Declaration(model.specimen, model.fluid, model.gravity)


def write_session(diagnosis: Diagnosis, recordings: Sequence[Recording], path: Path | str) -> Path:
    """session.rrd of `tentacle diagnose`: measured, base and augmented of every run, residuals, verdict, the layout.

    recordings are found by the runs' names; a run without its recording is drawn from the comparison alone. Raises
    InputError where a recording's video cannot be read. Returns the path written.
    """
    path = Path(path)
    pairs = paired(diagnosis.runs, recordings)
    names = [run.name for run, _ in pairs]
    shown: list[LoggedTopics] = []
    with session_file(path, session_id("diagnose", str(diagnosis.seed), *names)) as session:
        log_verdict(session, diagnosis)
        for run, recording in pairs:
            found = recording or Recording(run.name, diagnosed_declaration(diagnosis))
            shown.append(log_scene(session, scene_of(run), found))
            log_missing_force(session, scene_of(run), found.declaration.specimen, diagnosis.missing)
        set_layout(session, diagnose_blueprint(shown))
    return path
