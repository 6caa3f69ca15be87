"""Published sets with real or rendered pictures, where the machine has them: --data DIR holds a folder per set."""

from dataclasses import dataclass
from pathlib import Path


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
        'ring (a to c, a 4th of the size)'
        """
        parts = ([f"{self.views[0]} to {self.views[-1]}"] if self.views else []) + (
            [f"a {self.downscale}th of the size"] if self.downscale > 1 else [])
        return self.name + (f" ({', '.join(parts)})" if parts else "")


REAL_SETS = [
    RealSet("llff_fern", ("image005", "image006", "image007", "image008", "image009")),  # a row of the array
    RealSet("hci_antinous", ("Cam038", "Cam039", "Cam040", "Cam041", "Cam042")),
    RealSet("strecha_fountain_p11", downscale=4),
    RealSet("panoptic_basketball", ("cam10", "cam14", "cam16", "cam23", "cam27")),
    RealSet("middlebury_cones"),  # one pair: no virtual view, but true depth
]


def found(data: Path) -> list[RealSet]:
    """Those of the sets that are there."""
    return [real for real in REAL_SETS if real.sequence(data).is_file()]
