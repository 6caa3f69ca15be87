"""Table IV and Fig. 5: how many segments a view."""

import paper
from measured import Measured
from report import Curve, Section, flat, markdown_table, write_plot
from setup import PANEL, SGBM, Setup

COUNTS = [1000, 5000, 10000, 25000, 50000, 100000, 150000]
QUICK = [300, 1000, 3000]


def run(setup: Setup) -> Section:
    counts = QUICK if setup.quick else COUNTS
    reference = 3000 if setup.quick else 100000  # the row the others are compared with: the paper's choice
    levels = [] if setup.options else ["--levels", "40" if setup.quick else "100"]  # few: 150,000 segments take minutes
    sequences = [scene.render(setup.programs) for scene in setup.large_scenes]
    measured: dict[tuple[int, int], Measured] = {}  # segments, rounds of refinement
    for count in counts:
        for rounds in (4, 0):
            measured[count, rounds] = setup.measure(
                sequences, ["--segments", str(count), *levels, "--refine", str(rounds)])
        print(f"segments: {count} done", flush=True)
    sgbm = setup.measure_baseline("sgbm", sequences)

    def row(name: str, plain: Measured, refined: Measured, count: int | None) -> list[str]:
        return [name, *plain.cells(measured[reference, 0]), *refined.cells(measured[reference, 4]),
                plain.cpu_text, paper.mean_text("IV", count), paper.against_text("IV", count, 100000)]

    rows = [row(f"{count:,}", measured[count, 0], measured[count, 4], count) for count in counts]
    rows.append(row(SGBM, sgbm, sgbm, None))
    curves = [Curve("--refine 0", counts, [measured[c, 0].mean_psnr for c in counts]),
              Curve("with refinement", counts, [measured[c, 4].mean_psnr for c in counts]),
              flat(SGBM, counts, sgbm.mean_psnr)]
    if not setup.quick:
        curves.append(Curve("the paper, its sequences", counts, [paper.mean("IV", c) for c in counts], dashed=True))
    write_plot(setup.plot("segments"), curves, "segments a view", "PSNR-Y, dB", log_x=True)
    caption = setup.caption("segments", setup.where(setup.large_scenes),
                            " ".join(["--segments N", *levels, "--refine R"]))
    text = (f"{caption} {PANEL}\n\n"
            + markdown_table(["segments a view", "--refine 0, dB", f"against {reference:,}", "outside the panel",
                              "refined, dB", f"against {reference:,}", "outside the panel", "CPU a view, --refine 0",
                              "paper, dB", "paper, against 100,000"], rows)
            + f"\n\n{setup.picture('segments', 'PSNR over segments')}\n")
    return Section("segments", "Number of segments (Table IV, Fig. 5)", text)
