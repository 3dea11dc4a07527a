"""How C functions are compiled: numba's settings, and what it lacks. Imported where something is compiled."""

from __future__ import annotations

import os
from typing import Any

import numba
from llvmlite import binding, ir
from numba import cfunc, types
from numba.core.compiler import Compiler
from numba.extending import intrinsic

from pzt_ident.engine.kernel import VECTORS, WIDTH
from pzt_ident.engine.native import loads
from pzt_ident.files import cache_folder

cache_folder()
setattr(numba.config, "CACHE_DIR", os.environ.get("NUMBA_CACHE_DIR", ""))  # noqa: B010

# Three vectors at once, so that none waits for a step of another, and no loop over lanes written out before it is one.
for option in (f"-force-vector-interleave={VECTORS}", f"-unroll-full-max-count={WIDTH - 1}"):
    binding.set_option("pzt_ident", option)
OPTIONS: dict[str, Any] = {"fastmath": {"contract"}, "error_model": "numpy", "cache": not loads()}

pointer = types.CPointer(types.float64)
SIGNATURE = types.void(*[types.intp] * 3, *[pointer] * 4, types.intp)


class NoAliasCompiler(Compiler):
    """Compiles with pointers that never overlap, so that coefficients stay in registers."""

    def define_pipelines(self) -> Any:
        self.state.flags.noalias = True
        return super().define_pipelines()


compiled = cfunc(SIGNATURE, pipeline_class=NoAliasCompiler, **OPTIONS)


@intrinsic
def call(
    context: Any,
    function: Any,
    samples: Any,
    first: Any,
    fresh: Any,
    drive: Any,
    runs: Any,
    scratch: Any,
    tile: Any,
    lanes: Any,
) -> Any:
    """Call the C function at an address; the four ahead of the last are addresses of float64."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        integer, floats = ir.IntType(64), ir.DoubleType().as_pointer()
        function_type = ir.FunctionType(ir.VoidType(), [integer] * 3 + [floats] * 4 + [integer])
        function = builder.inttoptr(args[0], function_type.as_pointer())
        builder.call(function, [*args[1:4], *(builder.inttoptr(argument, floats) for argument in args[4:8]), args[8]])
        return context.get_dummy_value()

    return types.void(*[types.int64] * 9), generate


@intrinsic
def widen(context: Any) -> Any:
    """Use vectors of 512 bits in this function where the processor has them; LLVM's default is 256."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        set.add(builder.function.attributes, '"prefer-vector-width"="512"')
        return context.get_dummy_value()

    return types.void(), generate


@intrinsic
def spread(context: Any, tile: Any, row: Any, value: Any) -> Any:
    """Store the same number in every lane of a row of the tile by one instruction; LLVM would store them one by one."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        scalar = ir.VectorType(ir.DoubleType(), 1)
        first = builder.insert_element(ir.Constant(scalar, ir.Undefined), args[2], ir.Constant(ir.IntType(32), 0))
        lanes = ir.Constant(ir.VectorType(ir.IntType(32), WIDTH), [0] * WIDTH)
        place = builder.gep(args[0], [builder.mul(args[1], ir.Constant(args[1].type, WIDTH))])
        vector = builder.shuffle_vector(first, ir.Constant(scalar, ir.Undefined), lanes)
        builder.store(vector, builder.bitcast(place, vector.type.as_pointer()), align=8)
        return context.get_dummy_value()

    return types.void(tile, types.intp, types.float64), generate
