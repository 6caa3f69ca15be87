"""Differences between two methods over the same scenes."""

import math
import statistics
from dataclasses import dataclass

from scipy import stats


@dataclass(frozen=True)
class Mean:
    """A mean and half the width of its 95 % interval (Student's t); NaN of a single value."""

    mean: float
    half: float
    count: int

    def text(self, digits: int = 2, sign: bool = True) -> str:
        """'-0.12 ± 0.05', or without the interval where there is none."""
        mean = f"{self.mean:{'+' if sign else ''}.{digits}f}"
        return mean if math.isnan(self.half) else f"{mean} ± {self.half:.{digits}f}"


def mean_of(values: list[float]) -> Mean:
    """Mean of independent values.

    >>> m = mean_of([1.0, 2.0, 3.0, 4.0])  # t(0.975, 3) = 3.1824, s = 1.2910
    >>> round(m.mean, 4), round(m.half, 4)
    (2.5, 2.0543)
    """
    if len(values) < 2:
        return Mean(values[0] if values else math.nan, math.nan, len(values))
    error = statistics.stdev(values) / math.sqrt(len(values))
    return Mean(statistics.fmean(values), float(stats.t.ppf(0.975, len(values) - 1)) * error, len(values))


def paired(tested: list[float], anchor: list[float]) -> Mean:
    """Mean of tested - anchor, scene by scene: what the scenes have in common drops out.

    >>> paired([30.0, 20.0, 25.0], [29.0, 19.0, 24.0]).text()
    '+1.00 ± 0.00'
    """
    if len(tested) != len(anchor):
        raise ValueError(f"{len(tested)} values against {len(anchor)}")
    return mean_of([a - b for a, b in zip(tested, anchor)])
