"""Memory that is asked for before it is used, so that it is there in time: a hint to the processor, and no number
depends on it. The cells under a cutter lie far apart in memory; waited for one by one they cost more than all sums."""

from typing import Any

import numpy as np

from robomill.compiled import taught


def soon(array: np.ndarray, i: int, j: int) -> None:
    """Entry (i, j, 0) of an array is needed soon; it need not be within. Nothing happens in plain Python."""


def _teach() -> None:
    """Make it the processor's own instruction in compiled code."""
    from llvmlite import ir
    from numba import types
    from numba.core import cgutils
    from numba.extending import intrinsic, overload
    from numba.np.arrayobj import make_array

    @intrinsic  # type: ignore[untyped-decorator]
    def fetch(_typing: Any, array: Any, i: Any, j: Any) -> Any:
        def made(context: Any, builder: Any, signature: Any, given: Any) -> Any:
            kind, place = signature.args[0], [*given[1:], context.get_constant(types.intp, 0)]
            entry = cgutils.get_item_pointer(
                context, builder, kind, make_array(kind)(context, builder, given[0]), place, wraparound=False
            )
            byte, number = ir.IntType(8).as_pointer(), ir.IntType(32)
            takes = ir.FunctionType(ir.VoidType(), [byte, number, number, number])
            hint = cgutils.get_or_insert_function(builder.module, takes, "llvm.prefetch.p0i8")
            builder.call(hint, [builder.bitcast(entry, byte), number(0), number(3), number(1)])  # read, keep, data
            return context.get_dummy_value()

        return types.void(array, types.intp, types.intp), made

    @overload(soon, jit_options={"forceinline": True}, strict=False)
    def compiled(array: Any, i: Any, j: Any) -> Any:
        return lambda array, i, j: fetch(array, i, j)  # type: ignore[call-arg]


taught(_teach)
