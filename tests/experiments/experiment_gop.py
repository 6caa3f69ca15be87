"""Tables III, VII and VIII and Fig. 8: P frames between I frames; quality, time, bits of the virtual views."""

import figures
import paper
from paired import Mean, mean_of, paired
from programs import Depth
from report import Curve, Section, markdown_table, write_plot
from setup import PSNR_NOTE, Setup


def percent(mean: Mean) -> str:
    return mean.text(1) + " %"


def run(setup: Setup) -> Section:
    p_frames = [0, 2, 5] if setup.quick else list(paper.P_FRAMES)
    sequences = [video.render(setup.programs, setup.frames) for video in setup.videos]
    depths: dict[int, list[Depth]] = {}
    reports: dict[int, list[dict]] = {}
    for p in p_frames:
        depths[p] = [setup.estimate(s, ["--gop", str(p + 1)]) for s in sequences]
        reports[p] = [setup.programs.evaluate(s, d, ["--against", str(anchor.folder)])
                      for s, d, anchor in zip(sequences, depths[p], depths[0])]
        print(f"gop: {p} P frames done", flush=True)
    sgbm_depths = [setup.programs.baseline("sgbm", s, []) for s in sequences]
    sgbm = [setup.programs.evaluate(s, d, ["--against", str(anchor.folder)])
            for s, d, anchor in zip(sequences, sgbm_depths, depths[0])]
    psnr = {p: [figures.psnr(report) for report in reports[p]] for p in p_frames}
    cpu = {p: sum(d.cpu_seconds / d.frames for d in depths[p]) / len(sequences) for p in p_frames}

    def row(name: str, own: list[dict], seconds: float, p: int | None) -> list[str]:
        values = [figures.psnr(report) for report in own]
        anchor = p == 0
        return [name, mean_of(values).text(sign=False), "" if anchor else paired(values, psnr[0]).text(),
                f"{seconds:.2f} s", f"{100 * seconds / cpu[0]:.0f} %",
                f"{sum(figures.flicker(r) for r in own) / len(own):.2f} %",
                "" if anchor else percent(mean_of([figures.bd_rate_views(r) for r in own])),
                "" if anchor else percent(mean_of([figures.bd_rate_depth(r) for r in own])),
                f"{paper.P_FRAMES[p] - paper.P_FRAMES[0]:+.2f}" if p in paper.P_FRAMES and p else "",
                f"{paper.P_FRAMES_RATE[p]:+.1f} %" if p in paper.P_FRAMES_RATE else ""]

    rows = [row(str(p), reports[p], cpu[p], p) for p in p_frames]
    rows.append(row("SGBM", sgbm, sum(d.cpu_seconds / d.frames for d in sgbm_depths) / len(sequences), None))
    bits = []
    for qp_index, (qp, _, _) in enumerate(figures.rate_curve(reports[0][0])):
        cells = [str(qp)]
        for p in p_frames:
            points = [figures.rate_curve(report)[qp_index] for report in reports[p]]
            megabits = sum(point[1] for point in points) / len(points) * 25 / 1e6
            cells.append(f"{megabits:.2f} ({sum(point[2] for point in points) / len(points):.1f})")
        bits.append(cells)
    curves = [Curve("depthfarm", p_frames, [mean_of(psnr[p]).mean - mean_of(psnr[0]).mean for p in p_frames])]
    if not setup.quick:
        curves.append(Curve("the paper, its sequences", p_frames,
                            [paper.P_FRAMES[p] - paper.P_FRAMES[0] for p in p_frames], dashed=True))
    write_plot(setup.images / "experiment-gop.svg", curves, "P frames between I frames", "PSNR-Y against none, dB")
    text = (f"{setup.where_videos()}. {PSNR_NOTE} CPU a frame: of all views. *Flicker*: share of still pixels whose depth changes "
            f"by more than a level from frame to frame. *BD rate*: bits at equal PSNR against no P frames "
            f"(`depthfarm evaluate --against`: libx265, low delay).\n\n" +
            markdown_table(["P frames", "PSNR-Y, dB", "against none", "CPU a frame", "share", "flicker",
                            "BD rate, virtual views", "BD rate, depth", "paper, PSNR", "paper, BD rate"], rows) +
            "\n\nBits of the virtual views by quantiser, Mbit/s at 25 frames a second (PSNR-Y of the coded view, dB):\n\n" +
            markdown_table(["QP"] + [f"{p} P frames" for p in p_frames], bits) +
            f"\n\n![PSNR over P frames]({setup.images_link}/experiment-gop.svg)\n")
    return Section("gop", "P frames (Tables III, VII, VIII, Fig. 8)", text)
