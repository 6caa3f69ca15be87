"""One method, or one setting of ours, over all scenes of an experiment."""

from dataclasses import dataclass

import figures
from paired import Mean, mean_of, paired
from programs import Depth


@dataclass(frozen=True)
class Measured:
    """Depth and what `depthfarm evaluate` says of it, scene by scene."""

    depths: list[Depth]
    reports: list[dict]

    @property
    def psnr(self) -> list[float]:
        """PSNR-Y of the virtual views, dB."""
        return [figures.psnr(report) for report in self.reports]

    @property
    def psnr_outside_panels(self) -> list[float]:
        """The same without the pixels that show a plain panel, dB."""
        return [figures.psnr_outside_panels(report) for report in self.reports]

    @property
    def mean_psnr(self) -> float:
        return mean_of(self.psnr).mean

    @property
    def psnr_text(self) -> str:
        return mean_of(self.psnr).text(sign=False)

    def against(self, other: "Measured") -> Mean:
        """Difference of PSNR-Y, paired over the scenes."""
        return paired(self.psnr, other.psnr)

    def against_outside_panels(self, other: "Measured") -> Mean:
        return paired(self.psnr_outside_panels, other.psnr_outside_panels)

    def cells(self, anchor: "Measured") -> list[str]:
        """PSNR-Y, its difference from `anchor`, and that outside the panel; no differences of the anchor itself."""
        if self is anchor:
            return [self.psnr_text, "", ""]
        return [self.psnr_text, self.against(anchor).text(), self.against_outside_panels(anchor).text()]

    @property
    def cpu_per_view(self) -> float:
        """CPU seconds a view and frame, mean over the scenes."""
        return sum(depth.cpu_per_view for depth in self.depths) / len(self.depths)

    @property
    def cpu_text(self) -> str:
        return seconds(self.cpu_per_view)

    def cpu_per_frame(self, *without: str) -> float:
        """CPU seconds a frame of all views, without the stages named; mean over the scenes."""
        return sum(depth.cpu_per_frame(*without) for depth in self.depths) / len(self.depths)


def seconds(value: float) -> str:
    """
    >>> seconds(0.184), seconds(18.4)
    ('0.18 s', '18.4 s')
    """
    return f"{value:.{2 if value < 10 else 1}f} s"
