"""Tables III and VIII: bits of virtual views and of depth, coded as HEVC, by P frames between I frames."""

import figures
import p_frames
import paper
from measured import Measured
from paired import Mean, mean_of
from report import Curve, Section, markdown_table, write_plot
from setup import SGBM, Setup


def percent(mean: Mean) -> str:
    return mean.text(1) + " %"


def bits(measured: Measured, quantiser: int) -> float:
    """Bits a picture of the virtual views, mean over the sequences."""
    curves = [figures.rate_curve(report) for report in measured.reports]
    return mean_of([point.bits for curve in curves for point in curve if point.qp == quantiser]).mean


def quality(measured: Measured, quantiser: int) -> float:
    """PSNR-Y of the coded virtual views, mean over the sequences."""
    curves = [figures.rate_curve(report) for report in measured.reports]
    return mean_of([point.psnr for curve in curves for point in curve if point.qp == quantiser]).mean


def run(setup: Setup) -> Section:
    series = p_frames.measure(setup, "rates")
    named = [(str(p), measured, p) for p, measured in series.ours.items()] + [(SGBM, series.sgbm, None)]
    anchor = series.ours[0]

    deltas = []
    for name, measured, p in named:
        if p == 0:
            continue
        deltas.append([name, percent(mean_of([figures.bd_rate_views(report) for report in measured.reports])),
                       percent(mean_of([figures.bd_rate_depth(report) for report in measured.reports])),
                       percent(mean_of(paper.values("III", p))) if paper.has("III", p) else ""])
    coded = []
    for quantiser in [point.qp for point in figures.rate_curve(anchor.reports[0])]:
        for name, measured, p in named:
            share = bits(measured, quantiser) / bits(anchor, quantiser)
            known = p and paper.has("VIII", f"QP {quantiser}, {p}")
            coded.append([str(quantiser), name, f"{bits(measured, quantiser) / 1000:.1f}",
                          f"{quality(measured, quantiser):.2f}", "" if p == 0 else f"{100 * (share - 1):+.1f} %",
                          f"{100 * (paper.bits_ratio(quantiser, p) - 1):+.1f} %" if known else ""])

    counts = list(series.ours)
    views = [0.0] + [mean_of([figures.bd_rate_views(r) for r in series.ours[p].reports]).mean for p in counts[1:]]
    depth = [0.0] + [mean_of([figures.bd_rate_depth(r) for r in series.ours[p].reports]).mean for p in counts[1:]]
    curves = [Curve("virtual views", counts, views), Curve("their depth", counts, depth)]
    if not setup.quick:
        theirs = [0.0] + [mean_of(paper.values("III", p)).mean for p in counts[1:]]
        curves.append(Curve("virtual views, the paper, its sequences", counts, theirs, dashed=True))
    write_plot(setup.plot("rates"), curves, "P frames between I frames", "Bjøntegaard delta rate against none, %")

    caption = setup.caption("rates", setup.where_videos(), "--gop P+1", "--against DIR-OF-GOP-1")
    text = (f"{caption} Bjøntegaard delta rate: bits at equal PSNR-Y of the coded views, against no P frames; negative "
            f"is fewer. Ours is coded by {figures.encoder(anchor.reports[0])}, the paper's by HM 16.15, low delay.\n\n"
            + markdown_table(["P frames", "virtual views", "their depth", "paper, virtual views (Table III)"], deltas)
            + "\n\nThe virtual views by quantiser; the paper's change: Table VIII, mean over its sequences.\n\n"
            + markdown_table(["QP", "P frames", "kbit a picture", "PSNR-Y of the coded view, dB", "bits against none",
                              "paper, bits against none"], coded)
            + f"\n\n{setup.picture('rates', 'Bits over P frames')}\n")
    return Section("rates", "P frames: bits (Tables III and VIII)", text)
