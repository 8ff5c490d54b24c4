"""How the commands that the docs show are run where not as shown: shortened, ended early, or with another ending."""

from __future__ import annotations

from dataclasses import dataclass

from tests.docs.shown import ROOT

EMULATE = "tentacle rig emulate emu"


@dataclass(frozen=True)
class How:
    """How a command is run where not as shown.

    add: options put after it; swap: a text in it and what stands there instead; until: a pattern of files, or words,
    after which it is ended by Ctrl-C; status: those that it may end with; says: what it must say, one of several
    between bars; typed: on standard input.
    """

    add: str = ""
    swap: tuple[str, str] = ("", "")
    until: str = ""
    status: tuple[int, ...] = (0,)
    says: str = ""
    typed: str = ""


OFFLINE = "--dry-run --quiet --no-deps --no-index --no-build-isolation"
QUICK = "--evaluations 60 --no-reference"
NO_SCREEN = How(status=(2,), says="no screen here to open the viewer on; expected --web, or --screenshot OUT.png")
STOPPED_MAKE = f"-o runtime BIN={{programs}} -f {ROOT / 'Makefile'}"
SPECIAL = {
    "make demo": How(add=STOPPED_MAKE, until="out/demo"),
    "make test": How(add=f"-o setup BIN={{programs}} -C {ROOT}", says="tests/rig/test_settle.py"),
    "make firmware-check": How(add=f"-C {ROOT} BUILD={{here}}/build", says="core: all checks passed"),
    "pip install -c constraints.txt .": How(add=OFFLINE),
    "pip install pyelastica": How(add="--dry-run --no-deps --no-index", status=(1,), says="No matching distribution"),
    "tentacle reproduce fig9 --out fig9": How(add="--workers 1", until="fig9/cells"),
    "tentacle reproduce table1 --out table1": How(add="--seconds 3 --workers 1", until="table1/cells"),
    "tentacle reproduce table2 --out table2 --seed 1": How(add="--evaluations 20"),
    "tentacle compare arm.toml --out comparison": How(add="--no-map"),
    "tentacle compare arm.toml --out comparison --tapers 0.5 --slenderness 20":
        How(add="--workers 1", until="comparison"),
    "tentacle compare short.toml long.toml --out grid": How(add="--workers 1", until="grid"),
    "tentacle blind-trial 100 --like my_arm.rrd --out like_mine --workers 4": How(
        add="--workers 1", until="like_mine/trials"
    ),
    "tentacle blind-trial 40 --like sine.rrd --own-errors --baseline chirp.rrd --out like_sine": How(
        add="--workers 1", until="like_sine/trials"
    ),
    "tentacle blind-trial 40 --out blind --seed 1 --workers 4": How(add="--workers 1", until="blind/trials"),
    "tentacle optimise arm.toml --out gait": How(add=QUICK),
    "tentacle optimise arm.toml --out afloat --objective free": How(add=QUICK),
    "tentacle optimise answer/model.toml --out gait": How(add=QUICK),
    "tentacle new my_arm --video film.mp4 --motor servo_log.csv": How(
        swap=("my_arm", "another_arm"), status=(2,), says="servo_log.csv", typed="\n" * 5
    ),
    "tentacle app": How(add="--no-browser", until="(Ctrl-C ends it)"),
    "tentacle track video.mp4 --pick --length 0.14": How(swap=("video.mp4", "films/one.mp4")),
    "tentacle track film_recording --out shapes.csv --reject 120-131,140 --accept 98":
        How(swap=("120-131,140 --accept 98", "20-31,40 --accept 18")),
    "tentacle view session.rrd --web": How(until="(Ctrl-C ends it)"),
    "tentacle track camera.mkv --live 5 --length 0.14 --base-radius 0.0125 --tip-radius 0.0015 --out live.csv":
        How(swap=("--live 5", "--live 1")),
    "tentacle track /dev/video0 --live 5 --length 0.14 --base-radius 0.0125 --tip-radius 0.0015 --out live.csv":
        How(swap=("/dev/video0", "/dev/video99"), status=(2,), says="/dev/video99: there is no such file"),
    "tentacle rig check emu/rig.toml": How(status=(0, 3), says="limits obeyed by the board"),
    "tentacle rig calibrate load-cell emu/rig.toml --masses 0 0.02 0.05 0.1":
        How(add="--seconds 0.5", status=(2,), says="tentacle: the readings", typed="\n" * 4),
    "tentacle rig calibrate servo emu/rig.toml --angles -0.6 -0.3 0 0.3 0.6":
        How(add="--seconds 0.5", typed="-0.6\n-0.3\n0\n0.3\n0.6\n", says="636.6 us/rad"),
    "tentacle rig calibrate camera-offset emu/rig.toml": How(add="--flashes 6", says="after exposure"),
    "tentacle rig calibrate camera-offset emu/rig.toml --tap": How(status=(0, 3), says="frames arrive|WATCHDOG"),
    "tentacle rig record emu/rig.toml wave.toml --seconds 20 --out run.rrd --view": How(add="--seconds 1"),
    "tentacle rig campaign emu/rig.toml examples/campaign.toml --out specimen": How(until="specimen/*.rrd"),
    "tentacle rig campaign emu/rig.toml examples/campaign.toml --out twins --until-split": How(until="twins/*.rrd"),
    "tentacle rig optimise emu/rig.toml --model model.toml --out study --trials 30": How(until="study/*.rrd"),
    "tentacle rig optimise emu/rig.toml --model model.toml --out study-2 --trials 30 --reidentify 10":
        How(until="study-2/*.rrd"),
    f"{EMULATE} --model model.toml --hidden hidden.json": How(until="in another terminal"),
    "rerun analytics disable": How(swap=("disable", "--help"), says="Analytics|analytics"),
    "make hostile": How(add=f"-C {ROOT} -o setup --dry-run", says="-m tests.hostile.run"),
    "tentacle optimise answer/model.toml --out gait --device cuda:0": How(add=QUICK, status=(0, 2), says="cuda"),
    "tentacle diagnose my_arm --out answer --device cuda": How(status=(0, 2), says="cuda|report:"),
    "tentacle reproduce table2 --out table2 --device cuda": How(add="--evaluations 20", status=(0, 2), says="cuda"),
    "python benchmarks/blind.py --json blind.json": How(add="--help", says="--short"),
    "python docs/real_arms_pictures.py": How(swap=("docs/", f"{ROOT}/docs/"), add="{here}/docs", says="real_beam.webp"),
    "python benchmarks/swim.py --json swim.json": How(add="--help", says="--short"),
    "python benchmarks/until_split.py --groups 12 --seed 600": How(add="--help", says="--faults"),
    "python benchmarks/sentinel.py --repeats 20": How(add="--help", says="--repeats"),
    "python benchmarks/library.py --json library.json": How(add="--help", says="--count"),
    "python benchmarks/library_joint.py --json joint.json": How(add="--help", says="--linear"),
}  # fmt: skip
CLUSTER = (
    "dask scheduler --host 127.0.0.1",
    "dask worker tcp://127.0.0.1:8786 --nthreads 1 --nworkers 8",
    "dask scheduler --host 127.0.0.1 --port 8786",
    "dask worker tcp://127.0.0.1:8786 --nthreads 1",
    "tentacle compare arm.toml --out comparison --cluster tcp://127.0.0.1:8786",
)
FOLDER = (  # the firmware's copy: one after the other
    "mkdir -p rig/firmware/due/tentacle_rig/src",
    "cp -r rig/firmware/core rig/firmware/due/tentacle_rig/src/",
)
ELSEWHERE = (*CLUSTER, *FOLDER, EMULATE)  # these run below, with or around others


def how(command: str) -> How:
    """How a command is run: as the table says, else as its kind is, else as shown."""
    if command in SPECIAL:
        return SPECIAL[command]
    if command.startswith("pip install 'tentacle-twin["):
        return How(add=OFFLINE, swap=("tentacle-twin[", ".["))
    if command.startswith("apt-get install "):
        return How(add="--simulate")
    if command.startswith(("pytest ", "python -m pytest ")):
        return How(add="--collect-only --quiet", swap=("tests/", f"{ROOT}/tests/"))
    if command.startswith("tentacle view ") and "--" not in command:
        return NO_SCREEN
    return How()
