"""The paper's tables, sequence by sequence: its differences get the same intervals as ours.

D. Mieloch, O. Stankiewicz, M. Domański: Depth Map Estimation for Free-Viewpoint Television. Its eight sequences are
others than our scenes: trends can be compared, decibels cannot.
"""

import json
from functools import cache
from pathlib import Path

from paired import Mean, mean_of, paired


@cache
def _tables() -> dict:
    return json.loads((Path(__file__).parent / "paper_tables.json").read_text())


def values(table: str, column: object) -> list[float]:
    """A column over the eight sequences.

    >>> values("IV", 1000)[0]
    26.55
    """
    entries = dict(_tables()[table])
    index = entries.pop("columns").index(str(column))
    return [row[index] for row in entries.values()]


def columns(table: str) -> list[str]:
    """What the columns of a table are called."""
    return _tables()[table]["columns"]


def has(table: str, column: object) -> bool:
    """Whether the paper has such a column."""
    return str(column) in columns(table)


def mean(table: str, column: object) -> float:
    """What the paper prints as the average.

    >>> round(mean("V", 8), 2)
    28.82
    """
    return mean_of(values(table, column)).mean


def mean_text(table: str, column: object) -> str:
    """The average with two digits; empty where the paper has none."""
    return f"{mean(table, column):.2f}" if has(table, column) else ""


def against(table: str, column: object, anchor: object) -> Mean:
    """Paired difference of two columns over the sequences."""
    return paired(values(table, column), values(table, anchor))


def against_text(table: str, column: object, anchor: object) -> str:
    """The same as text; empty where the paper lacks a column or both are one.

    >>> against_text("VI", "interleaved 6", "whole 1")
    '-0.16 ± 0.19'
    """
    if column == anchor or not has(table, column) or not has(table, anchor):
        return ""
    return against(table, column, anchor).text()


def time_ratio() -> float:
    """Time of the paper's method as a share of DERS's, mean of the ratios (Table II)."""
    pairs = zip(values("II", "proposal s a view"), values("II", "DERS s a view"))
    ratios = [own / other for own, other in pairs]
    return sum(ratios) / len(ratios)


def bits_ratio(quantiser: int, p_frames: int) -> float:
    """Bits of the coded virtual views with P frames as a share of those without, mean of the ratios (Table VIII)."""
    pairs = zip(values("VIII", f"QP {quantiser}, {p_frames}"), values("VIII", f"QP {quantiser}, 0"))
    ratios = [coded / anchor for coded, anchor in pairs]
    return sum(ratios) / len(ratios)
