"""What the paper leaves open, one choice changed at a time."""

import figures
from paired import mean_of, paired
from report import Section, markdown_table
from setup import PSNR_NOTE, Setup

CHOICES = [
    ("K 15", ["--matching-offset", "15"]),
    ("K 45", ["--matching-offset", "45"]),
    ("beta_0 0.25", ["--smoothing", "0.25"]),
    ("beta_0 4", ["--smoothing", "4"]),
    ("window 1x1", ["--matching-window", "1"]),
    ("window 5x5", ["--matching-window", "5"]),
    ("64 levels", ["--levels", "64"]),
    ("250 levels", ["--levels", "250"]),
    ("4 neighbours", ["--neighbors", "4"]),
    ("compactness 20", ["--snic-compactness", "20"]),
    ("1 sweep", ["--sweeps", "1"]),
    ("8 rounds of refinement", ["--refine", "8"]),
    ("no refinement", ["--refine", "0"]),
]
QUICK = ("K 15", "no refinement")


def run(setup: Setup) -> Section:
    sequences = [scene.render(setup.programs) for scene in setup.scenes]

    def measure(options: list[str]) -> tuple[list[float], list[float], float]:
        depths = [setup.estimate(s, options) for s in sequences]
        reports = [setup.programs.evaluate(s, d, []) for s, d in zip(sequences, depths)]
        return ([figures.psnr(r) for r in reports], [figures.bad(r, "bad1PxPercent") for r in reports],
                sum(d.cpu_per_view for d in depths) / len(depths))

    psnr, bad, cpu = measure([])
    rows = [["defaults", mean_of(psnr).text(sign=False), mean_of(bad).text(1, False) + " %", f"{cpu:.1f} s"]]
    for name, options in CHOICES:
        if setup.quick and name not in QUICK:
            continue
        changed_psnr, changed_bad, changed_cpu = measure(options)
        rows.append([name, paired(changed_psnr, psnr).text(), paired(changed_bad, bad).text(1) + " %",
                     f"{changed_cpu:.1f} s"])
        print(f"choices: {name} done", flush=True)
    sgbm = [setup.programs.evaluate(s, setup.programs.baseline("sgbm", s, []), []) for s in sequences]
    rows.append(["two-pair SGBM", paired([figures.psnr(r) for r in sgbm], psnr).text(),
                 paired([figures.bad(r, "bad1PxPercent") for r in sgbm], bad).text(1) + " %", ""])
    text = (f"{setup.where()}, the defaults (K 30, beta_0 1, window 3x3, 2 neighbours, compactness 5, 2 sweeps, 4 rounds of "
            f"refinement) with one choice changed: differences from the first row. {PSNR_NOTE}\n\n" +
            markdown_table(["choice", "PSNR-Y, dB", "bad > 1 px, non-occluded", "CPU a view"], rows) + "\n")
    return Section("choices", "Open choices", text)
