"""C functions in object files, which LLVM loads: who finds them in the cache folder needs no numba, whose import takes
longer than a short search."""

from __future__ import annotations

import ctypes
import hashlib
import os
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from importlib.metadata import version
from pathlib import Path
from threading import RLock
from time import thread_time
from typing import Any

from llvmlite import binding

from pzt_ident.files import cache_folder, write_bytes

NUMBA = version("numba")
LIBRARY = ("exp", "expm1", "log", "pow", "sin", "cos", "memset", "memmove", "memcpy")
"""What LLVM may call without saying so before."""
ERROR_PATH = (
    *("numba_gil_ensure", "numba_gil_release", "numba_do_raise", "numba_unpickle"),
    *("numba_runtime_build_excinfo_struct", "NRT_Free"),
)
"""What is called, from the first on, where a function raised an error."""

_lock = RLock()
_spent = [0.0]  # s


def name_of(word: str, *made_of: str) -> str:
    """The name of a function, with the hash of all that it is made of and of the processor that it is made for."""
    content = "\0".join((*made_of, *processor()))
    return f"{word}_{hashlib.sha256(content.encode()).hexdigest()[:16]}"


def compiling_time() -> float:
    """CPU seconds that this process has spent on compiling."""
    return _spent[0]


def address_of(name: str, compiled: Callable[[], Any]) -> int:
    """The address of a C function in this process; numba's `compiled()` where there is no whole object file of it."""
    with _lock:
        begun = thread_time() - _spent[0]  # what one function compiles for another is counted once
        try:
            return _address_of(name, compiled)
        finally:
            _spent[0] = thread_time() - begun


def _address_of(name: str, compiled: Callable[[], Any]) -> int:
    if not loads():
        return int(compiled().address)
    path = cache_folder() / f"{name}.o"
    kept = read(path)
    if not kept:
        function = compiled()
        if not stands_alone(function):
            return int(function.address)
        kept = write(path, *emitted(function))
    return load(*kept)


@cache
def loads() -> bool:
    """Whether LLVM finds the C library in this process."""
    engine()
    return all(binding.address_of_symbol(word) for word in LIBRARY)


def stands_alone(function: Any) -> bool:
    """Whether code needs numba's run time only to say that it raised an error."""
    text = function.inspect_llvm()
    declared = [f.name for f in binding.parse_assembly(text).functions if f.is_declaration]
    outside = {name for name in declared if not name.startswith("llvm.")} - {*ERROR_PATH}
    return "@llvm.powi" not in text and all(binding.address_of_symbol(name) for name in outside)


def read(path: Path) -> tuple[str, bytes] | None:
    """Symbol and code of an object file, None where it is not whole."""
    with suppress(OSError, ValueError):
        head, code = path.read_bytes().split(b"\n", 1)
        digest, symbol = head.decode().split()
        if digest == hashlib.sha256(code).hexdigest():
            return symbol, code
    return None


def write(path: Path, symbol: str, code: bytes) -> tuple[str, bytes]:
    write_bytes(path, f"{hashlib.sha256(code).hexdigest()} {symbol}\n".encode() + code)
    return symbol, code


def emitted(function: Any) -> tuple[str, bytes]:
    """Symbol and code of what numba compiled."""
    return function.native_name, machine().emit_object(binding.parse_assembly(function.inspect_llvm()))


def load(symbol: str, code: bytes) -> int:
    """The address of the function, now in this process."""
    for word in ERROR_PATH:
        if not binding.address_of_symbol(word):
            binding.add_symbol(word, ctypes.cast(_raised, ctypes.c_void_p).value)
    engine().add_object_file(binding.ObjectFileRef.from_data(code))
    engine().finalize_object()
    return int(engine().get_function_address(symbol))


@ctypes.CFUNCTYPE(None)
def _raised() -> None:
    """Nobody up the stack could take the error: the caller is C."""
    os.write(2, b"Error: a function of a block raised an error when it was called from C\n")
    os._exit(1)


def processor() -> tuple[str, ...]:
    """What a function is compiled for: platform, processor, and what the user says of them to numba."""
    said = [f"{name}={value}" for name, value in sorted(os.environ.items()) if name.startswith("NUMBA_CPU")]
    return binding.get_process_triple(), binding.get_host_cpu_name(), binding.get_host_cpu_features().flatten(), *said


def machine() -> Any:
    """As numba sets LLVM."""
    with suppress(RuntimeError):  # newer ones need no word
        binding.initialize()
    binding.initialize_native_target()
    binding.initialize_native_asmprinter()
    target = binding.Target.from_default_triple()
    return target.create_target_machine(
        cpu=binding.get_host_cpu_name(),
        features=binding.get_host_cpu_features().flatten(),
        opt=3,
        reloc="static" if target.name.startswith("x86") else "default",
        codemodel="jitdefault",
        jit=True,
    )


@cache
def engine() -> Any:
    return binding.create_mcjit_compiler(binding.parse_assembly(""), machine())
