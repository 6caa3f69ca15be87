"""Table II: the method against a pixel-level cut, two-pair SGBM and views estimated one by one."""

from pathlib import Path

import figures
import paper
from paired import mean_of, paired
from report import Section, markdown_table
from setup import PSNR_NOTE, Setup

OURS = "depthfarm"
METHODS = [(OURS, []), ("depthfarm --refine 0 (the paper's planes)", ["--refine", "0"])]
BASELINES = [("two-pair SGBM", "sgbm"), ("pixel-level cut (DERS's structure)", "pixel-cut"),
             ("views one by one", "per-view")]


def measure(setup: Setup, sequence: Path) -> dict[str, tuple[dict, float]]:
    """Per method: the figures and CPU seconds a view."""
    result = {}
    for name, options in METHODS:
        depth = setup.estimate(sequence, options)
        result[name] = (setup.programs.evaluate(sequence, depth, []), depth.cpu_per_view)
    for name, command in BASELINES:
        depth = setup.programs.baseline(command, sequence, [])
        result[name] = (setup.programs.evaluate(sequence, depth, []), depth.cpu_per_view)
    return result


def run(setup: Setup) -> Section:
    scenes = []
    for scene in setup.scenes:
        scenes.append(measure(setup, scene.render(setup.programs)))
        print(f"methods: {scene.name} done", flush=True)
    names = list(scenes[0])
    ours = [figures.psnr(scene[OURS][0]) for scene in scenes]
    exact = [figures.exact_psnr(scene[OURS][0]) for scene in scenes]
    rows = []
    for name in names:
        reports = [scene[name][0] for scene in scenes]
        values = [figures.psnr(report) for report in reports]
        rows.append([name, mean_of(values).text(sign=False), paired(values, exact).text(),
                     "" if name == OURS else paired(values, ours).text(),
                     mean_of([figures.iv_psnr(report) for report in reports]).text(sign=False),
                     mean_of([figures.bad(report, "bad1PxPercent") for report in reports]).text(1, False) + " %",
                     mean_of([figures.bad(report, "bad1PxPercent", "thin") for report in reports]).text(1, False) + " %",
                     mean_of([figures.agreement(report) for report in reports]).text(1, False) + " %",
                     f"{sum(scene[name][1] for scene in scenes) / len(scenes):.1f} s"])
    text = (f"{setup.where()}. {PSNR_NOTE}\n\n" +
            markdown_table(["method", "PSNR-Y, dB", "against exact depth", "against depthfarm", "IV-PSNR, dB",
                            "bad > 1 px, non-occluded", "thin objects", "views agree", "CPU a view"], rows) +
            f"\n\nThe paper, on eight other sequences: DERS {paper.DERS_PSNR} dB, its method {paper.PROPOSAL_PSNR} dB "
            f"(+{paper.PROPOSAL_GAIN}) in {100 * paper.PROPOSAL_TIME_RATIO:.0f} % of the time.\n")
    return Section("methods", "Against other methods (Table II)", text)
