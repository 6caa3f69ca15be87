"""What priors and masks are worth, and what wrong ones cost."""

from pathlib import Path

import figures
from guide_folders import MASKS, PRIORS, mask_folder, prior_folder, share
from measured import Measured
from paired import mean_of, paired
from report import Section, markdown_table
from setup import SGBM, Setup


def measure_guided(setup: Setup, sequences: list[Path], option: str, folders: list[Path]) -> Measured:
    depths = [setup.programs.estimate(s, [*setup.options, option, str(f)]) for s, f in zip(sequences, folders)]
    return Measured(depths, [setup.programs.evaluate(s, d, []) for s, d in zip(sequences, depths)])


def run(setup: Setup) -> Section:
    sequences = [scene.render(setup.programs) for scene in setup.scenes]
    without = setup.measure(sequences, [])

    def row(name: str, of: Measured) -> list[str]:
        cells = [name, mean_of([figures.psnr(r) for r in of.reports]).text(sign=False).split(" ±")[0]]
        cells.append("" if of is without else paired([figures.psnr(r) for r in of.reports],
                                                     [figures.psnr(r) for r in without.reports]).text())
        for zone in ("non-occluded", "thin", "panel"):
            cells.append(f"{mean_of([figures.bad(r, 'bad1PxPercent', zone) for r in of.reports]).mean:.2f} %")
        cells.append(f"{mean_of([figures.mean_error(r, 'panel') for r in of.reports]).mean:.3f} px")
        cells.append(f"{mean_of([figures.agreement(r) for r in of.reports]).mean:.2f} %")
        return cells

    rows = [row("no prior, no mask", without)]
    priors = {}
    for name in PRIORS:
        priors[name] = measure_guided(setup, sequences, "--prior", [prior_folder(s, name) for s in sequences])
        rows.append(row(f"prior: {name}", priors[name]))
        print(f"guides: prior '{name}' done", flush=True)
    for name in MASKS:
        of = measure_guided(setup, sequences, "--mask", [mask_folder(s, name) for s in sequences])
        rows.append(row(f"mask: {name}", of))
        print(f"guides: mask '{name}' done", flush=True)
    rows.append(row(SGBM, setup.measure_baseline("sgbm", sequences)))

    def left(zone_error) -> str:
        ratios = [share(zone_error(a), zone_error(b)) for a, b in zip(priors["exact"].reports, without.reports)]
        return f"{100 * mean_of([r for r in ratios if r == r]).mean:.0f} %"

    caption = setup.caption("guides", setup.where(setup.scenes), "--prior DIR or --mask DIR")
    text = (f"{caption} Priors are the exact depth of every view with an error, pixels being those of motion in the "
            "nearest view; masks are of people and thin objects. *dB*: against the same without. Shares of pixels off by "
            "more than 1 px, of the plain panel also the mean error.\n\n"
            + markdown_table(["guided by", "PSNR-Y", "dB", "wrong", "thin", "panel", "panel, mean", "views agree"], rows)
            + "\n\nWith the exact prior the mean error of the plain panel is "
            + left(lambda r: figures.mean_error(r, "panel")) + " of what it was, the share of wrong pixels of thin objects "
            + left(lambda r: figures.bad(r, "bad1PxPercent", "thin")) + ".\n")
    return Section("guides", "Priors and masks", text)
