"""Table VII and Fig. 8: P frames between I frames; quality and time."""

import figures
import p_frames
import paper
from measured import Measured, seconds
from paired import mean_of
from report import Curve, Section, markdown_table, write_plot
from setup import PANEL, SGBM, Setup


def run(setup: Setup) -> Section:
    series = p_frames.measure(setup, "gop")
    anchor = series.ours[0]

    def row(name: str, measured: Measured, p: int | None) -> list[str]:
        cpu, cut = measured.cpu_per_frame(), measured.cpu_per_frame("refine")
        return [name, *measured.cells(anchor), seconds(cpu), f"{100 * cpu / anchor.cpu_per_frame():.0f} %",
                "" if p is None else f"{100 * cut / anchor.cpu_per_frame('refine'):.0f} %",
                f"{mean_of([figures.flicker(report) for report in measured.reports]).mean:.2f} %",
                paper.mean_text("VII", p), paper.against_text("VII", p, 0)]

    rows = [row(str(p), measured, p) for p, measured in series.ours.items()]
    rows.append(row(SGBM, series.sgbm, None))
    counts = list(series.ours)
    curves = [Curve("depthfarm", counts, [series.ours[p].against(anchor).mean for p in counts]),
              Curve("outside the panel", counts, [series.ours[p].against_outside_panels(anchor).mean for p in counts])]
    if not setup.quick:
        theirs = [paper.against("VII", p, 0).mean for p in counts]
        curves.append(Curve("the paper, its sequences", counts, theirs, dashed=True))
    write_plot(setup.plot("gop"), curves, "P frames between I frames", "PSNR-Y against none, dB")
    caption = setup.caption("gop", setup.where_videos(), "--gop P+1", "--against DIR-OF-GOP-1")
    text = (f"{caption} CPU a frame is that of all views; *share*: of the CPU without P frames; *cut*: the same "
            "without refinement, which the paper does not have (it reports a tenth of the time with 49 P frames). "
            "*Flicker*: still pixels whose depth changes by more than a level from one frame to the next. "
            f"{PANEL}\n\n"
            + markdown_table(["P frames", "PSNR-Y, dB", "against none", "outside the panel", "CPU a frame", "share",
                              "share, cut", "flicker", "paper, dB", "paper, against none"], rows)
            + f"\n\n{setup.picture('gop', 'PSNR over P frames')}\n")
    return Section("gop", "P frames: quality and time (Table VII, Fig. 8)", text)
