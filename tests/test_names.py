"""A name has one meaning in the program: no two rooms define a class of the same name."""

import ast
from collections import defaultdict
from pathlib import Path

ROOT = Path(__file__).parents[1]
ROOMS = ("affine_model", "discovery", "inference", "mujoco_ref", "rig", "tentacle", "validation", "vision", "viz")


def test_no_two_classes_have_one_name() -> None:
    found: dict[str, list[str]] = defaultdict(list)
    for room in ROOMS:
        for file in sorted((ROOT / room).rglob("*.py")):
            for node in ast.parse(file.read_text(encoding="utf-8")).body:
                if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                    found[node.name].append(file.relative_to(ROOT).as_posix())
    assert len(found) > 300  # the rooms were read
    assert {name: files for name, files in found.items() if len(files) > 1} == {}
