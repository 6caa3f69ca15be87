"""Views that were not used in the estimation, synthesised from the depth of their neighbours."""

import json
import math
from dataclasses import dataclass
from pathlib import Path

import figures
import real_sets
from paired import mean_of
from programs import Depth
from report import Section, markdown_table
from setup import SGBM, Setup

OURS = "depthfarm"


@dataclass(frozen=True)
class Method:
    """A row of the table."""

    name: str
    command: str = ""  # of depthfarm-experiments; empty: depthfarm run
    options: tuple[str, ...] = ()

    def estimate(self, setup: Setup, sequence: Path, views: list[str], downscale: int) -> Depth:
        common = ["--views", ",".join(views), *(["--downscale", str(downscale)] if downscale > 1 else [])]
        if self.command:
            return setup.programs.baseline(self.command, sequence, ["--first-frame", "0", "--end-frame", "1", *common])
        options = [] if self.options else setup.options  # a preset has its own
        return setup.programs.estimate(sequence, ["--frames", "0:1", *common, *options, *self.options])


METHODS = [
    Method(OURS),
    Method("depthfarm --preset paper", options=("--preset", "paper")),
    Method(SGBM, "sgbm"),
    Method("views one by one (as --refine 0)", "per-view"),
]


@dataclass(frozen=True)
class Case:
    """Depth of some views of a sequence, judged by others."""

    label: str
    sequence: Path
    views: list[str]
    targets: list[str]
    downscale: int = 1


IN_A_ROW = ("arc", "line")  # their middle camera lies between two others


def rendered_cases(setup: Setup) -> list[Case]:
    cases = []
    for scene in setup.scenes:
        if scene.kind not in IN_A_ROW:
            continue
        sequence = scene.render(setup.programs)
        names = [camera["name"] for camera in json.loads(sequence.read_text())["cameras"]]
        target = names[len(names) // 2]
        cases.append(Case(scene.name, sequence, [name for name in names if name != target], [target]))
    return cases


def real_cases(data: Path) -> list[Case]:
    return [Case(left.label(), left.real.sequence(data), list(left.real.views), list(left.targets),
                 left.real.downscale)
            for left in real_sets.LEFT_OUT if left.real.sequence(data).is_file()]


def measure(setup: Setup, case: Case, method: Method) -> tuple[list[dict], Depth]:
    """A report for each target."""
    depth = method.estimate(setup, case.sequence, case.views, case.downscale)
    return [setup.programs.evaluate(case.sequence, depth, ["--view", target]) for target in case.targets], depth


def over(reports: list[dict], figure) -> float:
    return mean_of([figure(report) for report in reports]).mean


def run(setup: Setup) -> Section:
    rendered = rendered_cases(setup)
    columns = {method: [measure(setup, case, method) for case in rendered] for method in METHODS}
    print("left_out: rendered scenes done", flush=True)
    ours = [over(reports, figures.psnr) for reports, _ in columns[METHODS[0]]]
    rows = []
    for method, measured in columns.items():
        psnr = [over(reports, figures.psnr) for reports, _ in measured]
        outside = [over(reports, figures.psnr_outside_panels) for reports, _ in measured]
        difference = mean_of([theirs - own for theirs, own in zip(psnr, ours)])
        rows.append([f"{len(rendered)} rendered scenes" if method.name == OURS else "", method.name, mean_of(psnr).text(sign=False),
                     "" if method.name == OURS else difference.text(),
                     "" if math.isnan(mean_of(outside).mean) else mean_of(outside).text(sign=False),
                     f"{mean_of([over(reports, figures.psnr_non_hole) for reports, _ in measured]).mean:.2f}",
                     f"{mean_of([depth.cpu_per_view for _, depth in measured]).mean:.2f} s"])
    for case in real_cases(setup.data) if setup.data else []:
        best = None
        for method in METHODS:
            reports, depth = measure(setup, case, method)
            psnr = over(reports, figures.psnr)
            best = psnr if best is None else best  # ours comes first
            rows.append([case.label if method.name == OURS else "", method.name, f"{psnr:.2f}", "" if method.name == OURS else f"{psnr - best:+.2f}",
                         "", f"{over(reports, figures.psnr_non_hole):.2f}", f"{depth.cpu_per_view:.2f} s"])
        print(f"left_out: {case.label} done", flush=True)
    caption = setup.caption("left_out", setup.where([scene for scene in setup.scenes if scene.kind in IN_A_ROW]),
                            "--views OTHERS [--preset paper]", "--view LEFT_OUT",
                            baselines="sgbm|per-view")
    text = (f"{caption} Of rendered scenes the middle view is left out, of published sets those named; depth of their "
            "neighbours, which are twice as far apart as with all views, makes them. *Non-hole*: over the pixels that a "
            "source saw. One set is one sample: gaps below 0.5 dB say little.\n\n"
            + markdown_table(["views", "method", "PSNR-Y, dB", "against depthfarm", "outside the panel, dB",
                              "non-hole, dB", "CPU a view"], rows) + "\n")
    return Section("left_out", "Views that were left out", text)
