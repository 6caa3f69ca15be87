"""Table IV and Fig. 5: how many segments a view."""

import figures
import paper
from paired import mean_of, paired
from report import Curve, Section, markdown_table, write_plot
from setup import PSNR_NOTE, Setup

QUICK = [300, 1000, 3000]
REFERENCE = {False: 100000, True: 3000}  # the row the others are compared with


def run(setup: Setup) -> Section:
    counts = QUICK if setup.quick else list(paper.SEGMENTS)
    scenes = setup.scenes[:3]  # 150,000 segments a view take minutes
    sequences = [scene.render(setup.programs) for scene in scenes]
    psnr: dict[tuple[int, int], list[float]] = {}  # (segments, rounds) -> per scene
    cpu: dict[int, list[float]] = {}
    for count in counts:
        for rounds in (4, 0):
            depths = [setup.estimate(s, ["--segments", str(count), "--refine", str(rounds)]) for s in sequences]
            psnr[count, rounds] = [figures.psnr(setup.programs.evaluate(s, d, [])) for s, d in zip(sequences, depths)]
            if rounds == 0:
                cpu[count] = [depth.cpu_per_view for depth in depths]
        print(f"segments: {count} done", flush=True)
    reference = REFERENCE[setup.quick]
    sgbm = [figures.psnr(setup.programs.evaluate(s, setup.programs.baseline("sgbm", s, []), [])) for s in sequences]
    rows = []
    for count in counts:
        rows.append([f"{count:,}", mean_of(psnr[count, 0]).text(sign=False),
                     "" if count == reference else paired(psnr[count, 0], psnr[reference, 0]).text(),
                     mean_of(psnr[count, 4]).text(sign=False),
                     "" if count == reference else paired(psnr[count, 4], psnr[reference, 4]).text(),
                     f"{sum(cpu[count]) / len(cpu[count]):.1f} s",
                     f"{paper.SEGMENTS[count]:.2f}" if count in paper.SEGMENTS else "",
                     f"{paper.SEGMENTS[count] - paper.SEGMENTS[100000]:+.2f}" if count in paper.SEGMENTS else ""])
    plot = setup.images / "experiment-segments.svg"
    curves = [Curve("--refine 0", counts, [mean_of(psnr[c, 0]).mean for c in counts]),
              Curve("with refinement", counts, [mean_of(psnr[c, 4]).mean for c in counts])]
    if not setup.quick:
        curves.append(Curve("the paper, its sequences", counts, [paper.SEGMENTS[c] for c in counts], dashed=True))
    write_plot(plot, curves, "segments a view", "PSNR-Y, dB", log_x=True)
    text = (f"{setup.where(scenes)}. {PSNR_NOTE} Two-pair SGBM: {mean_of(sgbm).text(sign=False)} dB.\n\n" +
            markdown_table(["segments a view", "--refine 0, dB", f"against {reference:,}", "refined, dB",
                            f"against {reference:,}", "CPU a view, --refine 0", "paper, dB", "paper, against 100,000"],
                           rows) +
            f"\n\n![PSNR over segments]({setup.images_link}/experiment-segments.svg)\n")
    return Section("segments", "Number of segments (Table IV, Fig. 5)", text)
