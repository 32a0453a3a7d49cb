"""Laws over arrays: every argument may be an array, and labelled arrays broadcast by name."""

import functools
import inspect
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr


class Result(NamedTuple):
    """What a law gives: its long name and symbol, and the dimensions of a vector or a tensor."""

    long_name: str
    symbol: str
    dims: tuple[str, ...] = ()
    name: str = ""
    """Name of its array; "" stands for the law's."""


def over_arrays(
    *results: Result,
    core: Mapping[str, tuple[str, ...]] | None = None,
    native: bool = False,
) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Let a law take arrays for all its arguments.

    With an `xarray.DataArray` among them, the law's answer is one too, with its name, long name, symbol and
    units. Arguments broadcast by the names of their dimensions, and NaN gives NaN. Arrays of NumPy broadcast
    by position. Numbers give what the law gives.

    Parameters
    ----------
    results : Result
        What the law gives; several for a law that gives a tuple.
    core : mapping, optional
        Arguments that the law takes whole, as vectors and tensors, and names of their last dimensions. In
        ``results`` these names stand for those that a labelled argument has.
    native : bool
        Whether the law itself takes arrays of NumPy for all other arguments.
    """
    whole = dict(core or {})

    def decorate(law: Callable[..., Any]) -> Callable[..., Any]:
        signature = inspect.signature(law)

        @functools.wraps(law)
        def over(*args: Any, **kwargs: Any) -> Any:
            given = (*args, *kwargs.values())
            if any(isinstance(value, xr.DataArray) for value in given):
                bound = signature.bind(*args, **kwargs)
                bound.apply_defaults()
                return _labelled(law, bound.arguments, results, whole, native)
            if not native and any(isinstance(value, np.ndarray) for value in given):
                bound = signature.bind(*args, **kwargs)
                bound.apply_defaults()
                if any(np.ndim(v) > 0 for name, v in bound.arguments.items() if name not in whole):
                    return _stacked(law, bound.arguments, results, whole)
            return law(*args, **kwargs)

        return over

    return decorate


def _labelled(
    law: Callable[..., Any],
    given: Mapping[str, Any],
    results: Sequence[Result],
    core: Mapping[str, tuple[str, ...]],
    native: bool,
) -> Any:
    """The law over labelled arrays."""
    called: dict[str, str] = {}
    inputs, arrays = [], []
    for name, plain in given.items():
        dims = core.get(name, ())
        unlabelled = dims and not isinstance(plain, xr.DataArray)
        value = xr.DataArray(plain, dims=dims) if unlabelled else plain
        own = [str(dim) for dim in value.dims[len(value.dims) - len(dims) :]] if dims else []
        called |= dict(zip(dims, own, strict=True))
        inputs.append(own)
        arrays.append(value)
    found = xr.apply_ufunc(
        law if native else _at_numbers(law, results),
        *arrays,
        input_core_dims=inputs,
        output_core_dims=[[called.get(dim, dim) for dim in result.dims] for result in results],
        vectorize=not native,
        dask="parallelized" if native else "forbidden",
        output_dtypes=[float] * len(results),
        keep_attrs=False,
    )
    several = found if len(results) > 1 else (found,)
    named = [
        one.rename(result.name or law.__name__).assign_attrs(
            long_name=result.long_name, symbol=result.symbol, units="1"
        )
        for one, result in zip(several, results, strict=True)
    ]
    return named[0] if len(named) == 1 else tuple(named)


def _stacked(
    law: Callable[..., Any],
    given: Mapping[str, Any],
    results: Sequence[Result],
    core: Mapping[str, tuple[str, ...]],
) -> Any:
    """The law over arrays of NumPy."""
    inputs = ",".join(f"({','.join(core.get(name, ()))})" for name in given)
    outputs = ",".join(f"({','.join(result.dims)})" for result in results)
    otypes = [float] * len(results)
    over = np.vectorize(_at_numbers(law, results), otypes, signature=f"{inputs}->{outputs}")
    return over(*given.values())


def _at_numbers(law: Callable[..., Any], results: Sequence[Result]) -> Callable[..., Any]:
    """The law at one value of each argument; NaN where a number is NaN."""

    def at(*values: Any) -> Any:
        lacking = any(isinstance(v, float | np.floating) and np.isnan(v) for v in values)
        if lacking and not any(result.dims for result in results):
            return np.nan if len(results) == 1 else (np.nan,) * len(results)
        return law(*values)

    return at
