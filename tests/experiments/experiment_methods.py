"""Table II: the method against a pixel-level cut, two-pair SGBM and views estimated one by one."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import figures
import paper
import real_sets
from measured import Measured
from paired import mean_of, paired
from real_sets import RealSet
from report import Curve, Section, markdown_table, write_plot
from setup import PANEL, SGBM, Setup

OURS = "depthfarm"
PLANES = "depthfarm --refine 0 (the paper's planes)"
PIXELS = "pixel-level cut (DERS's structure)"
ALONE = "views one by one (as --refine 0)"


@dataclass(frozen=True)
class Method:
    """A row of the table."""

    name: str
    command: str = ""  # of depthfarm-experiments; empty: depthfarm run
    options: tuple[str, ...] = ()

    def measure(self, setup: Setup, sequences: list[Path], real: RealSet | None = None) -> Measured:
        if self.command:
            return setup.measure_baseline(self.command, sequences, real.baseline_options() if real else [])
        return setup.measure(sequences, [*(real.run_options() if real else []), *self.options])


METHODS = [
    Method(OURS),
    Method(PLANES, options=("--refine", "0")),
    Method(SGBM, "sgbm"),
    Method(PIXELS, "pixel-cut"),
    Method(ALONE, "per-view"),
]


def mean_cell(values: list[float], unit: str = " %", digits: int = 1) -> str:
    mean = mean_of(values)
    return "" if math.isnan(mean.mean) else mean.text(digits, sign=False) + unit


def rendered_rows(measured: dict[Method, Measured], ours: Measured) -> list[list[str]]:
    exact = [figures.exact_psnr(report) for report in ours.reports]

    def over(reports: list[dict], figure: Callable[[dict], float]) -> list[float]:
        return [figure(report) for report in reports]

    rows = []
    for method, this in measured.items():
        rows.append([
            method.name, this.psnr_text, paired(this.psnr, exact).text(),
            "" if method.name == OURS else this.against(ours).text(),
            mean_of(this.psnr_outside_panels).text(sign=False),
            "" if method.name == OURS else this.against_outside_panels(ours).text(),
            mean_cell(over(this.reports, figures.iv_psnr), "", 2),
            mean_cell(over(this.reports, lambda report: figures.bad(report, "bad1PxPercent"))),
            mean_cell(over(this.reports, lambda report: figures.bad(report, "bad1PxPercent", "thin"))),
            mean_cell(over(this.reports, lambda report: figures.bad(report, "bad1PxPercent", "panel"))),
            mean_cell(over(this.reports, figures.agreement)), this.cpu_text])
    return rows


def beside_the_paper(measured: dict[Method, Measured]) -> str:
    """What Table II is about, in a sentence each: segments against pixels, views together against one by one."""
    named = {method.name: this for method, this in measured.items()}
    gain = paper.against("II", "proposal dB", "DERS dB")
    text = (f"The paper, on eight other sequences: its method {paper.mean('II', 'proposal dB'):.2f} dB, DERS "
            f"{paper.mean('II', 'DERS dB'):.2f} dB ({gain.text()} dB) in {100 * paper.time_ratio():.0f} % of DERS's "
            "time. DERS itself is not measured here: the pixel-level cut stands for its structure.")
    planes, pixels, alone = named[PLANES], named[PIXELS], named[ALONE]
    shares = [own.cpu_seconds / other.cpu_seconds for own, other in zip(planes.depths, pixels.depths)]
    text += (f" Ours with --refine 0 against it: {planes.against(pixels).text()} dB, outside the panel "
             f"{planes.against_outside_panels(pixels).text()} dB, in {100 * mean_of(shares).mean:.0f} % of its CPU.")
    return text + (f" All views together against one by one, both with --refine 0: {planes.against(alone).text()} dB, "
                   f"outside the panel {planes.against_outside_panels(alone).text()} dB.")


def real_table(setup: Setup, data: Path) -> str:
    """Single sets, no intervals: a gap below half a decibel says nothing."""
    sets = real_sets.found(data)
    rows = []
    for real in sets:
        for method in METHODS:
            this = method.measure(setup, [real.sequence(data)], real)
            wrong = [figures.bad_visible(report, "bad1PxPercent") for report in this.reports]
            rows.append([real.label(), method.name, mean_cell(this.psnr, "", 2), mean_cell(wrong), this.cpu_text])
        print(f"methods: {real.name} done", flush=True)
    absent = [real.name for real in real_sets.REAL_SETS if real not in sets]
    note = f" Not on this machine: {', '.join(absent)}." if absent else ""
    return ("\n\nPublished sets, which are not part of the repository, the first frame of each; bad > 1 px where true "
            "depth is known: of non-occluded pixels, of hci_antinous of all. One set is one sample: gaps below 0.5 dB "
            f"say nothing.{note}\n\n"
            + markdown_table(["set", "method", "PSNR-Y, dB", "bad > 1 px", "CPU a view"], rows))


def run(setup: Setup) -> Section:
    sequences = [scene.render(setup.programs) for scene in setup.scenes]
    measured = {}
    for method in METHODS:
        measured[method] = method.measure(setup, sequences)
        print(f"methods: {method.name} done", flush=True)
    ours = measured[METHODS[0]]
    write_plot(setup.plot("methods"),
               [Curve(method.name, [this.cpu_per_view], [this.mean_psnr]) for method, this in measured.items()],
               "CPU seconds a view", "PSNR-Y, dB", log_x=True)
    commands = [method.command for method in METHODS if method.command]
    caption = setup.caption("methods", setup.where(setup.scenes), "[--refine 0]", baselines="|".join(commands))
    text = (f"{caption} *Bad > 1 px*: of non-occluded pixels of all views; *views agree*: of the pixels that the two "
            f"sources of a virtual view both see. CPU is that of the whole command. {PANEL}\n\n"
            + markdown_table(["method", "PSNR-Y, dB", "against exact depth", "against depthfarm",
                              "outside the panel, dB", "against depthfarm", "IV-PSNR, dB", "bad > 1 px",
                              "bad > 1 px, thin objects", "bad > 1 px, panel", "views agree", "CPU a view"],
                             rendered_rows(measured, ours))
            + f"\n\n{beside_the_paper(measured)}"
            + (real_table(setup, setup.data) if setup.data else "")
            + f"\n\n{setup.picture('methods', 'PSNR over CPU')}\n")
    return Section("methods", "Against other methods (Table II)", text)
