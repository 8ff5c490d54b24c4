"""Every shell command that README and docs show is executed; one that is added is executed as it stands.

Marked blocks run whole (test_documentation.py); all other commands run here, each in a copy of the desk. What would
take long is shortened by its own documented options, or ended by Ctrl-C once it has begun to write; what needs
hardware, a screen or a network says so in one line, and that line is what is held here.
"""

from __future__ import annotations

import importlib.util
import os
import re
import shutil
import signal
import subprocess
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

import pytest

from tentacle.io.external_data import data_folder
from tests.docs.desk import begun, environment
from tests.docs.shown import PAGES, ROOT, shown
from tests.docs.special_commands import CLUSTER, ELSEWHERE, EMULATE, FOLDER, how
from tests.page import problems
from viz.viewer import free_port

COMMANDS = shown([ROOT / "README.md", *PAGES])
PATIENCE = 900.0  # s: a model of a new order is compiled first, 35 s of a processor that eight may share
RIG_TRIES = 5
BOARD = re.compile(r"(emu/)?rig\.toml|run\.rrd")  # what only an emulated rig gives


@pytest.fixture(scope="module")
def bench(desk: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """`tentacle rig emulate emu &` as it runs; and a run that was recorded on it."""
    if shutil.which("g++") is None:
        pytest.skip("no g++ here: the board's core cannot be compiled (Debian: apt-get install g++)")
    pytest.importorskip("serial", reason="pyserial is not installed: pip install tentacle-twin[rig]")
    lab = tmp_path_factory.mktemp("lab")
    shell = environment(lab)
    shutil.copy(desk / "wave.toml", lab)
    with begun(EMULATE, lab, shell, "in another terminal"):
        record = "tentacle rig record emu/rig.toml wave.toml --seconds 2 --out run.rrd"
        done = asked(record, lab, shell, tries=RIG_TRIES)
        assert done.returncode == 0, done.stdout + done.stderr
        yield lab


def asked(
    line: str, place: Path, shell: dict[str, str], typed: str = "", tries: int = 1
) -> subprocess.CompletedProcess[str]:
    """A command, run to its end. It is asked again, after a fault of the rig (3), until all tries are spent.

    The rig's watchdog bites where this computer is too busy to feed it for a quarter of a second.
    """
    while True:
        done = subprocess.run(["bash", "-c", line], cwd=place, env=shell, input=typed, capture_output=True,
                              text=True, timeout=PATIENCE, check=False)  # fmt: skip
        close_the_viewer(done.stdout + done.stderr)
        tries -= 1
        if done.returncode != 3 or tries == 0:
            return done
        without_its_output(line, place)


def beside_the_rig(place: Path, bench: Path) -> None:
    """The emulated rig in a folder of one's own: a copy of its rig.toml, links to its port and camera."""
    for folder in (place, place / "emu"):
        folder.mkdir(exist_ok=True)
        shutil.copy(bench / "emu" / "rig.toml", folder)
        for name in ("port", "truth"):
            (folder / name).symlink_to(bench / "emu" / name)
    shutil.copy(bench / "run.rrd", place)


@pytest.fixture(scope="module")
def tried(
    request: pytest.FixtureRequest, desk: Path, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[dict[str, Future[None]]]:
    """The selected commands, two at a time: most wait for a child, a port or a file. One rig takes one at a time."""
    selected = [item.callspec.params["command"] for item in request.session.items if of_this_test(item)]
    found: dict[str, Future[None]] = {command: Future() for command in selected}
    board = [command for command in selected if BOARD.search(command)]
    bench = request.getfixturevalue("bench") if board else None

    def settle(command: str) -> None:
        try:
            place = tmp_path_factory.mktemp("reader")
            execute(command, desk, place, bench if command in board else None)
            found[command].set_result(None)
        except BaseException as outcome:  # a skip is one, too; the test raises it
            found[command].set_exception(outcome)

    with ThreadPoolExecutor(2) as pool:
        pool.submit(lambda: [settle(command) for command in board])
        for command in set(selected) - set(board):
            pool.submit(settle, command)
        yield found


def of_this_test(item: pytest.Item) -> bool:
    return item.originalname == "test_a_command_that_is_shown_does_what_is_shown"  # type: ignore[attr-defined]


def without_its_output(command: str, place: Path) -> None:
    """What the command is to write is not there yet."""
    for name in re.findall(r"--out (\S+)", command):
        if f" {name}/" not in command:
            shutil.rmtree(place / name) if (place / name).is_dir() else (place / name).unlink(missing_ok=True)


@pytest.mark.parametrize("command", [command for command in COMMANDS if command not in ELSEWHERE], ids=str)
def test_a_command_that_is_shown_does_what_is_shown(command: str, tried: dict[str, Future[None]]) -> None:
    tried[command].result()


def execute(command: str, desk: Path, place: Path, bench: Path | None) -> None:
    """A shown command in a copy of the desk: its status, what it says, the files it names, and any report it wrote."""
    needs(command)
    run, shell = how(command), environment(place)
    if command.startswith("pip "):
        place = bare_source(place / "desk")
    else:
        place = Path(shutil.copytree(desk, place / "desk"))
    if bench is not None:
        beside_the_rig(place, bench)
    if command == "make test":
        shell["PYTEST_ADDOPTS"] = "--collect-only --quiet -p no:cacheprovider"
    (place / "docs").mkdir(exist_ok=True)
    without_its_output(command, place)
    line = f"{command.replace(*run.swap) if run.swap[0] else command} {run.add}".strip()
    line = line.replace("{programs}", str(place.parent / "programs")).replace("{here}", str(place))
    if run.until:
        with begun(line, place, shell, run.until):
            return
    done = asked(line, place, shell, run.typed, tries=RIG_TRIES if bench is not None else 1)
    said = done.stdout + done.stderr
    if done.returncode == 2 and "mesa-vulkan-drivers" in said:
        pytest.skip(f"this machine draws no picture: {said.strip()}")
    assert done.returncode in run.status, f"{line}\n{said}"
    assert any(words in said for words in run.says.split("|")), f"{line}\n{said}"
    assert "does not provide the extra" not in said
    assert "Traceback" not in said
    if command.startswith("python -m affine_model.formulas"):
        assert (place / "docs" / "catalogue.md").read_text() == (ROOT / "docs" / "catalogue.md").read_text()
    for option, name in re.findall(r"--(out|screenshot) (\S+)", command) if run.status == (0,) else ():
        assert (place / name).exists(), f"{line}: --{option}\n{said}"
    for page in place.rglob("report.html"):
        assert problems(page.read_text()) == [], page


def needs(command: str) -> None:
    """Skip, saying what is missing, a command whose program is not on this machine."""
    program = command.partition(" ")[0]
    if program in ("make", "apt-get") and shutil.which(program) is None:
        pytest.skip(f"{program} is not installed")
    reads_data = command.startswith("tentacle data convert") or "real_arms" in command
    if reads_data and not data_folder().is_dir():
        pytest.skip(f"{data_folder()} is not there (TENTACLE_DATA)")
    if command == "make firmware-check" and shutil.which("g++") is None:
        pytest.skip("no g++ here: the board's core cannot be compiled (Debian: apt-get install g++)")
    if program == "pip":
        for name in ("pip", "setuptools"):
            if importlib.util.find_spec(name) is None:
                pytest.skip(f"{name} is not here: no wheel can be built without a download")
    if command.startswith("apt-get install"):
        names = command.split()[2:]
        known = subprocess.run(["apt-cache", "show", *names], capture_output=True, check=False)
        if known.returncode != 0:
            pytest.skip(f"apt-get's lists do not have {', '.join(names)} (apt-get update)")


def bare_source(folder: Path) -> Path:
    """What pip reads of a checkout to know the package and its extras."""
    (folder / "tentacle").mkdir(parents=True)
    for name in ("pyproject.toml", "README.md", "LICENSE", "constraints.txt", "tentacle/__init__.py"):
        shutil.copy(ROOT / name, folder / name)
    return folder


def close_the_viewer(said: str) -> None:
    """The viewer that `--view` leaves open, and tells the process of."""
    told = re.search(r"the viewer is process (\d+)", said)
    if told is not None:
        os.killpg(int(told[1]), signal.SIGTERM)


def test_a_cluster_of_this_machine_takes_a_comparison(desk: Path, tmp_path: Path) -> None:
    """The commands of both pages, the port a free one; ended by Ctrl-C once a worker has written a result."""
    pytest.importorskip("distributed", reason="distributed is not installed: pip install tentacle-twin[cluster]")
    place, shell, port = Path(shutil.copytree(desk, tmp_path / "desk")), environment(tmp_path), str(free_port())
    plain, many, scheduler, one, compare = (command.replace("8786", port) for command in CLUSTER)
    with (
        begun(f"{plain} --port {port} --no-dashboard", place, shell, "Scheduler at"),
        begun(f"{many} --nworkers 2 --no-dashboard", place, shell, "Registered to"),
    ):
        pass
    with (
        begun(f"{scheduler} --no-dashboard", place, shell, "Scheduler at"),
        begun(f"{one} --no-dashboard", place, shell, "Registered to"),
        begun(compare, place, shell, "comparison/cells/*"),
    ):
        pass


def test_the_core_is_copied_to_where_the_sketch_looks(tmp_path: Path) -> None:
    ignored = shutil.ignore_patterns("build", "src")
    shutil.copytree(ROOT / "rig" / "firmware", tmp_path / "rig" / "firmware", ignore=ignored)
    done = subprocess.run(["bash", "-euc", "\n".join(FOLDER)], cwd=tmp_path, check=False)
    assert done.returncode == 0
    sketch = tmp_path / "rig" / "firmware" / "due" / "tentacle_rig"
    for name in re.findall(r'#include "(src/[^"]+)"', (sketch / "tentacle_rig.ino").read_text()):
        assert (sketch / name).is_file(), name
