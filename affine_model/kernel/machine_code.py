"""The kernel in machine code: its text as LLVM's source, compiled for this processor.

numba compiles the same text in 12 to 35 s: it must find the types, and that the lanes do not disturb each other. Here
both are known, so that 1 to 2 s are left, which LLVM's own optimiser takes.
"""

from __future__ import annotations

import ast
import ctypes
import hashlib
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, cast

import llvmlite
import llvmlite.binding as llvm

from affine_model.kernel.arguments import ARGUMENTS
from affine_model.kernel.instructions import Instructions
from affine_model.kernel.vector_code import Writer

CompiledCall = Callable[[int, int], None]  # (block, address of the packed arguments)


@dataclass(frozen=True)
class Machine:
    """The processor that is compiled for, as LLVM names it and its features."""

    name: str
    features: str

    @property
    def width(self) -> int:
        """Doubles in its vector register."""
        features = self.features.split(",")
        return 8 if "+avx512f" in features else 4 if "+avx" in features else 2


@lru_cache(maxsize=1)
def this_machine() -> Machine:
    """The processor of this computer."""
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    return Machine(llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten())


def arguments_of(text: str) -> list[str]:
    """The names in the head of a kernel's `advance`, without the block's number."""
    functions = {node.name: node for node in ast.parse(text).body if isinstance(node, ast.FunctionDef)}
    return [argument.arg for argument in functions["advance"].args.args[1:]]


def llvm_source(text: str, block: int, machine: Machine) -> str:
    """LLVM's source of a kernel's text: advance(block, words), the words as packed() makes them."""
    functions = {node.name: node for node in ast.parse(text).body if isinstance(node, ast.FunctionDef)}
    whole = functions.pop("advance")
    emit = Instructions(min(machine.width, block))
    writer, heads = Writer(emit, block, functions), list[str]()
    for name in (argument.arg for argument in whole.args.args):
        argument = ARGUMENTS[name]
        own = [f"%{name}", *(f"%{name}.{axis}" for axis in range(argument.axes))]
        heads.append(f"ptr noalias {own[0]}" if argument.axes else f"{argument.kind} {own[0]}")
        heads += [f"i64 {extent}" for extent in own[1:]]
        writer.take(name, argument, own)
    writer.statements([statement for statement in whole.body if not isinstance(statement, ast.Expr)])
    return "\n".join([
        *_declared(emit), f"define internal void @run({', '.join(heads)}) {{",
        *writer.begin, *emit.lines, "  ret void", "}", *_entry(heads),
        "attributes #0 = { nounwind willreturn memory(none) }", "",
    ])  # fmt: skip


def _entry(heads: list[str]) -> list[str]:
    """The function that is called: it reads the arguments from a row of words."""
    text, given = ["define void @advance(i64 %block, ptr %words) {"], ["i64 %block"]
    for place, head in enumerate(heads[1:]):
        kind = head.split(" ", 1)[0]
        text.append(f"  %at{place} = getelementptr i64, ptr %words, i64 {place}")
        text.append(f"  %word{place} = load {'i64' if kind == 'i1' else kind}, ptr %at{place}")
        if kind == "i1":
            text.append(f"  %flag{place} = icmp ne i64 %word{place}, 0")
        given.append(f"{kind} %{'flag' if kind == 'i1' else 'word'}{place}")
    return [*text, f"  call void @run({', '.join(given)})", "  ret void", "}"]


def _declared(emit: Instructions) -> list[str]:
    """The C library's functions, and each for a vector."""
    vector, text = f"<{emit.width} x double>", list[str]()
    for function in sorted(emit.library):
        count = 2 if function == "pow" else 1
        text.append(f"declare double @{function}({', '.join(['double'] * count)}) #0")
        heads = ", ".join(f"{vector} %x{k}" for k in range(count))
        text.append(f"define internal {vector} @lanes_{function}({heads}) noinline #0 {{")
        for lane in range(emit.width):
            text += [f"  %e{lane}_{k} = extractelement {vector} %x{k}, i64 {lane}" for k in range(count)]
            given = ", ".join(f"double %e{lane}_{k}" for k in range(count))
            before = f"%y{lane - 1}" if lane else "poison"
            text.append(f"  %c{lane} = call double @{function}({given})")
            text.append(f"  %y{lane} = insertelement {vector} {before}, double %c{lane}, i64 {lane}")
        text += [f"  ret {vector} %y{emit.width - 1}", "}"]
    return text


@lru_cache(maxsize=1)
def compiler() -> str:
    """What decides over the machine code beside the kernel's text: this room's files, LLVM, the processor."""
    files = sorted(Path(__file__).parent.glob("*.py"))
    machine = this_machine()
    parts = [llvmlite.__version__, machine.name, machine.features, *(file.read_text("utf-8") for file in files)]
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()


def _target(machine: Machine) -> Any:
    triple = llvm.get_process_triple() + ("-elf" if sys.platform == "win32" else "")  # the loader reads no COFF there
    return llvm.Target.from_triple(triple).create_target_machine(
        cpu=machine.name, features=machine.features, opt=3, reloc="default", codemodel="jitdefault", jit=True
    )


def object_code(text: str, block: int) -> bytes:
    """A kernel's text compiled for this processor, for a block of so many lanes."""
    machine = this_machine()
    target, module = _target(machine), llvm.parse_assembly(llvm_source(text, block, machine))
    module.triple, module.data_layout = target.triple, str(target.target_data)
    tuning = llvm.create_pipeline_tuning_options(speed_level=2)
    tuning.loop_vectorization = tuning.slp_vectorization = False  # it is written in vectors
    builder = llvm.create_pass_builder(target, tuning)
    builder.getModulePassManager().run(module, builder)
    return target.emit_object(module)


class Loaded:
    """Machine code in memory. run lets other threads of Python run meanwhile."""

    def __init__(self, code: bytes) -> None:
        self._engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), _target(this_machine()))
        self._engine.add_object_file(llvm.ObjectFileRef.from_data(code))
        self._engine.finalize_object()
        kind = ctypes.CFUNCTYPE(None, ctypes.c_int64, ctypes.c_void_p)
        self.run = cast(CompiledCall, kind(self._engine.get_function_address("advance")))
