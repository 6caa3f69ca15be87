"""What the experiments read from `depthfarm evaluate --json`: the only place that knows its field names."""

import math


def psnr(report: dict) -> float:
    """PSNR-Y of the virtual views, dB, 16-235 BT.601: mean over views and frames."""
    return report["mean"]["psnrY"]


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


def rate_curve(report: dict) -> list[tuple[int, float, float]]:
    """(QP, bits a picture, PSNR-Y of the coded picture), means over the virtual views."""
    curves = list(report["rates"]["virtualViews"].values())
    result = []
    for points in zip(*curves):
        count = len(points)
        result.append((points[0]["qp"], sum(p["bitsPerPicture"] for p in points) / count,
                       sum(p["psnrY"] for p in points) / count))
    return result
