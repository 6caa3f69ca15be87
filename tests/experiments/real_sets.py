"""Published sets with real or rendered pictures, where the machine has them: --data DIR holds a folder per set."""

from dataclasses import dataclass
from pathlib import Path


SIZES = {2: "half the size", 4: "a quarter of the size"}  # by --downscale


@dataclass(frozen=True)
class RealSet:
    """What of a set is used: one frame of some views, at some size."""

    name: str  # of the folder; its sequence file is cameras.json
    views: tuple[str, ...] = ()  # all
    downscale: int = 1

    def sequence(self, data: Path) -> Path:
        return data / self.name / "cameras.json"

    def _common(self) -> list[str]:
        return (["--views", ",".join(self.views)] if self.views else []) + (
            ["--downscale", str(self.downscale)] if self.downscale > 1 else [])

    def run_options(self) -> list[str]:
        return ["--frames", "0:1", *self._common()]

    def baseline_options(self) -> list[str]:
        return ["--first-frame", "0", "--end-frame", "1", *self._common()]

    def label(self) -> str:
        """
        >>> RealSet("ring", ("a", "c"), 4).label()
        'ring (a to c, a quarter of the size)'
        """
        parts = ([f"{self.views[0]} to {self.views[-1]}"] if self.views else []) + (
            [SIZES[self.downscale]] if self.downscale > 1 else [])
        return self.name + (f" ({', '.join(parts)})" if parts else "")


REAL_SETS = [
    RealSet("llff_fern", ("image005", "image006", "image007", "image008", "image009")),  # a row of the array
    RealSet("hci_antinous", ("Cam038", "Cam039", "Cam040", "Cam041", "Cam042")),
    RealSet("strecha_fountain_p11", downscale=4),
    RealSet("panoptic_basketball", ("cam10", "cam14", "cam16", "cam23", "cam27")),
    RealSet("middlebury_cones"),  # one pair: no virtual view, but true depth
]


@dataclass(frozen=True)
class LeftOut:
    """Views of a set, and those among them that depth is estimated without."""

    real: RealSet  # of the others
    targets: tuple[str, ...]

    def label(self) -> str:
        """
        >>> LeftOut(RealSet("ring", ("a", "c"), 4), ("b",)).label()
        'ring, a quarter of the size: b from 2 others'
        """
        size = f", {SIZES[self.real.downscale]}" if self.real.downscale > 1 else ""
        return f"{self.real.name}{size}: {', '.join(self.targets)} from {len(self.real.views)} others"


def _others(count: int, name: str, left_out: tuple[int, ...]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names of `count` cameras without those left out, and of those."""
    return (tuple(name.format(i) for i in range(count) if i not in left_out),
            tuple(name.format(i) for i in left_out))


_FERN, _FERN_OUT = _others(20, "image{:03}", (6, 8, 11, 13))  # a grid of 4 x 5, inside
_FOUNTAIN, _FOUNTAIN_OUT = _others(11, "{:04}", (2, 5, 8))
LEFT_OUT = [
    LeftOut(RealSet("llff_fern", _FERN, 2), _FERN_OUT),
    LeftOut(RealSet("strecha_fountain_p11", _FOUNTAIN, 4), _FOUNTAIN_OUT),
    LeftOut(RealSet("panoptic_basketball", ("cam02", "cam03", "cam04", "cam12", "cam22")), ("cam07",)),
    LeftOut(RealSet("panoptic_basketball", ("cam08", "cam11", "cam17", "cam29")), ("cam25",)),
]


def found(data: Path) -> list[RealSet]:
    """Those of the sets that are there."""
    return [real for real in REAL_SETS if real.sequence(data).is_file()]
