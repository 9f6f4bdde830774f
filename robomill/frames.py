"""Tables for pandas and arrays with names for xarray: both imported when first asked for, nowhere else in the core."""

from __future__ import annotations

import sys
from collections.abc import Hashable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeGuard

import numpy as np
from numpy.typing import NDArray

from robomill.extras import needed

if TYPE_CHECKING:
    from pandas import DataFrame as DataFrame, Series as Series
    from xarray import DataArray as DataArray, Dataset as Dataset

Columns = dict[str, NDArray[Any]]
"""Columns of one length by name, which ends in the unit: numbers, flags or texts."""


def data_frame(columns: Mapping[str, NDArray[Any]], about: Mapping[str, str], rows: Any = None) -> DataFrame:
    """The columns as a DataFrame of its own, ``about`` in its ``attrs``; ``rows`` is the index (None: from 0).

    Raises MissingExtraError without pandas.
    """
    with needed("A DataFrame"):
        import pandas as pd
    index = None if rows is None else pd.Index(np.array(rows), name="row")
    frame = pd.DataFrame({name: np.array(values) for name, values in columns.items()}, index=index)
    frame.attrs = dict(about)
    return frame


def is_frame(value: object) -> TypeGuard[DataFrame]:
    """Whether a value is a pandas DataFrame; without pandas there is none."""
    pandas = sys.modules.get("pandas")
    return pandas is not None and isinstance(value, pandas.DataFrame)


def data_array(
    values: NDArray[Any],
    coordinates: Mapping[str, tuple[Sequence[str], NDArray[Any] | float, Mapping[str, str]]],
    dims: Sequence[str],
    name: str,
    about: Mapping[str, Hashable],
) -> DataArray:
    """Values as a DataArray of its own over ``dims``; of each coordinate its dims, values and attributes.

    Raises MissingExtraError without xarray.
    """
    with needed("A DataArray"):
        import xarray as xr
    return xr.DataArray(np.array(values), coords=dict(coordinates), dims=tuple(dims), name=name, attrs=dict(about))


def data_set(arrays: Iterable[DataArray], about: Mapping[str, Hashable]) -> Dataset:
    """Arrays over the same coordinates as a Dataset. Raises MissingExtraError without xarray."""
    with needed("A Dataset"):
        import xarray as xr
    return xr.Dataset({array.name: array for array in arrays}, attrs=dict(about))
