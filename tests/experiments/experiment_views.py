"""Table V and Fig. 6: how many views are estimated together."""

from dataclasses import replace

import figures
import paper
from paired import mean_of, paired
from report import Curve, Section, markdown_table, write_plot
from setup import PSNR_NOTE, Setup


def run(setup: Setup) -> Section:
    """The virtual view is always the same, from the same two; the views estimated with them grow outwards."""
    counts = [3, 4] if setup.quick else list(paper.VIEWS)
    cameras = max(counts) + 1  # one is left out
    scenes = [replace(scene, kind="arc", cameras=cameras) for scene in setup.scenes[:4]]
    sequences = [scene.render(setup.programs) for scene in scenes]
    middle = cameras // 2
    outwards = sorted(range(cameras), key=lambda i: (abs(i - middle), i))
    figure_options = ["--view", f"cam{middle}", "--from", f"cam{middle - 1},cam{middle + 1}"]
    psnr: dict[int, list[float]] = {}
    cpu: dict[int, float] = {}
    for count in counts:
        views = [f"cam{i}" for i in sorted(outwards[1:count + 1])]  # without the virtual one itself
        depths = [setup.estimate(s, ["--views", ",".join(views)]) for s in sequences]
        psnr[count] = [figures.psnr(setup.programs.evaluate(s, d, figure_options)) for s, d in zip(sequences, depths)]
        cpu[count] = sum(depth.cpu_per_view for depth in depths) / len(depths)
        print(f"views: {count} done", flush=True)
    sgbm = [figures.psnr(setup.programs.evaluate(s, setup.programs.baseline("sgbm", s, []), figure_options))
            for s in sequences]
    least = min(psnr)
    rows = [[str(count), mean_of(psnr[count]).text(sign=False),
             "" if count == least else paired(psnr[count], psnr[least]).text(), f"{cpu[count]:.1f} s",
             f"{paper.VIEWS[count]:.2f}", f"{paper.VIEWS[count] - paper.VIEWS[least]:+.2f}"] for count in psnr]
    plot = setup.images / "experiment-views.svg"
    write_plot(plot, [Curve("depthfarm", list(psnr), [mean_of(psnr[c]).mean for c in psnr]),
                      Curve("the paper, its sequences", list(psnr), [paper.VIEWS[c] for c in psnr], dashed=True)],
               "views estimated together", "PSNR-Y, dB")
    text = (f"{len(scenes)} arcs with the seeds, sizes and noise of {setup.scene_list}; the virtual view is left out of the "
            f"estimation and always made from the same two. {PSNR_NOTE} Two-pair SGBM, which has the left-out picture "
            f"too: {mean_of(sgbm).text(sign=False)} dB.\n\n" +
            markdown_table(["views", "PSNR-Y, dB", f"against {least}", "CPU a view", "paper, dB",
                            f"paper, against {least}"], rows) +
            f"\n\n![PSNR over views]({setup.images_link}/experiment-views.svg)\n")
    return Section("views", "Number of views (Table V, Fig. 6)", text)
