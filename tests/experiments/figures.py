"""What the experiments read from `depthfarm evaluate --json`: the only place that knows its field names."""

import math
from dataclasses import dataclass


def psnr(report: dict) -> float:
    """PSNR-Y of the virtual views, dB, 16-235 BT.601: mean over views and frames; NaN without virtual views."""
    value = report["mean"]["psnrY"]
    return math.nan if value is None else value


def psnr_outside_panels(report: dict) -> float:
    """The same without pixels that show a plain panel, whose depth is a guess; NaN where zones are not known."""
    value = report["mean"]["psnrYOutsidePanels"]
    return math.nan if value is None else value


def psnr_non_hole(report: dict) -> float:
    """As `psnr`, over the pixels that a source saw."""
    value = report["mean"]["psnrYNonHole"]
    return math.nan if value is None else value


def exact_psnr(report: dict) -> float:
    """The same with exact depth; NaN where it is not known."""
    values = [view["exact"]["psnrY"] for view in report["virtualViews"] if "exact" in view]
    return sum(values) / len(values) if values else math.nan


def iv_psnr(report: dict) -> float:
    """IV-PSNR of the virtual views, dB."""
    return report["mean"]["ivPsnr"]


def bad(report: dict, field: str, zone: str = "non-occluded") -> float:
    """Share of wrong pixels of all views, percent; `field` as "bad1PxPercent"."""
    zones = report.get("depthError", {}).get("allViews", {})
    return zones[zone][field] if zone in zones else math.nan


def mean_error(report: dict, zone: str) -> float:
    """Mean absolute error of a zone of all views, pixels of motion in the nearest view."""
    zones = report.get("depthError", {}).get("allViews", {})
    return zones[zone]["meanPx"] if zone in zones else math.nan


def bad_visible(report: dict, field: str) -> float:
    """Share of wrong pixels among the non-occluded; where occlusions are not known, among all."""
    value = bad(report, field)
    return bad(report, field, "all") if math.isnan(value) else value


def share_of_zone(report: dict, zone: str) -> float:
    """Share of a zone in all pixels of known depth, percent."""
    zones = report["depthError"]["allViews"]
    return 100 * zones[zone]["pixels"] / zones["all"]["pixels"] if zone in zones else 0.0


def agreement(report: dict) -> float:
    """Non-occluded pixels on which the two sources of a virtual view agree, percent; mean over views."""
    values = [view["agreement"]["nonOccludedPercent"] for view in report["virtualViews"] if "agreement" in view]
    return sum(values) / len(values) if values else math.nan


def flicker(report: dict) -> float:
    """Still pixels whose depth changed by more than a level from one frame to the next, percent."""
    return report["stability"]["allViews"]["changedPercent"] if "stability" in report else math.nan


def bd_rate_views(report: dict) -> float:
    """Bjøntegaard delta rate of the virtual views against the other folder, percent."""
    value = report["against"]["meanBdRateVirtualViewsPercent"]
    return math.nan if value is None else value


def bd_rate_depth(report: dict) -> float:
    """The same of the sources' depth."""
    value = report["against"]["meanBdRateDepthPercent"]
    return math.nan if value is None else value


def confidence(report: dict) -> dict:
    """How well confidence tells right depth from wrong, all views: auseBad1PxPercent, auseMeanPx, curve, ..."""
    return report["confidence"]["allViews"]


@dataclass(frozen=True)
class RatePoint:
    """One quantiser: means over the virtual views."""

    qp: int
    bits: float  # a picture
    psnr: float  # PSNR-Y of the coded view against the view before coding, dB


def rate_curve(report: dict) -> list[RatePoint]:
    """The virtual views of a report, coded."""
    result = []
    for points in zip(*report["rates"]["virtualViews"].values()):
        result.append(RatePoint(points[0]["qp"], sum(p["bitsPerPicture"] for p in points) / len(points),
                                sum(p["psnrY"] for p in points) / len(points)))
    return result


def encoder(report: dict) -> str:
    """What the views were coded by."""
    return report["rateEncoder"]
