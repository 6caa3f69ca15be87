"""What the paper leaves open, one choice changed at a time."""

import figures
from measured import Measured
from paired import mean_of, paired
from report import Section, markdown_table
from setup import PANEL, SGBM, Setup

CHOICES = [
    ("K 15", ["--matching-offset", "15"]),
    ("K 45", ["--matching-offset", "45"]),
    ("beta_0 0.25", ["--smoothing", "0.25"]),
    ("beta_0 4", ["--smoothing", "4"]),
    ("every match in full", ["--uniqueness", "0"]),
    ("uniqueness 50 %", ["--uniqueness", "50"]),
    ("uniqueness 90 %", ["--uniqueness", "90"]),
    ("window 1x1", ["--matching-window", "1"]),
    ("window 5x5", ["--matching-window", "5"]),
    ("64 levels", ["--levels", "64"]),
    ("250 levels", ["--levels", "250"]),
    ("4 neighbours", ["--neighbors", "4"]),
    ("compactness 20", ["--snic-compactness", "20"]),
    ("2 sweeps", ["--sweeps", "2"]),
    ("8 rounds of refinement", ["--refine", "8"]),
    ("no refinement", ["--refine", "0"]),
]
QUICK = ("K 15", "no refinement")


def run(setup: Setup) -> Section:
    sequences = [scene.render(setup.programs) for scene in setup.scenes]
    defaults = setup.measure(sequences, [])

    def wrong(measured: Measured) -> list[float]:
        return [figures.bad(report, "bad1PxPercent") for report in measured.reports]

    rows = [["defaults", defaults.psnr_text, mean_of(defaults.psnr_outside_panels).text(sign=False),
             mean_of(wrong(defaults)).text(1, False) + " %", defaults.cpu_text]]

    def add(name: str, measured: Measured) -> None:
        rows.append([name, measured.against(defaults).text(), measured.against_outside_panels(defaults).text(),
                     paired(wrong(measured), wrong(defaults)).text(1) + " %", measured.cpu_text])
        print(f"choices: {name} done", flush=True)

    for name, options in CHOICES:
        given = options[0] in setup.options  # an option that every job has cannot be changed
        if not given and (not setup.quick or name in QUICK):
            add(name, setup.measure(sequences, options))
    add(SGBM, setup.measure_baseline("sgbm", sequences))
    caption = setup.caption("choices", setup.where(setup.scenes), "[one option]")
    text = (f"{caption} The defaults (K 30, uniqueness 75 %, beta_0 1, window 3x3, 2 neighbours, compactness 5, "
            "1 sweep, 4 rounds of refinement) with one choice changed: differences from the first row. *Bad > 1 px*: "
            f"of non-occluded pixels of all views. {PANEL}\n\n"
            + markdown_table(["choice", "PSNR-Y, dB", "outside the panel, dB", "bad > 1 px", "CPU a view"], rows)
            + "\n")
    return Section("choices", "Open choices", text)
