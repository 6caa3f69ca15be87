"""Table VI and Fig. 7: the levels split into parts, in blocks or interleaved."""

import paper
from measured import Measured
from report import Curve, Section, markdown_table, write_plot
from setup import PANEL, SGBM, Setup

WHOLE = ("whole", 1)
REFINED = (1, 6, 16)  # refinement starts from what the cut left: a few rows show how much of the loss it keeps


def paper_column(split: tuple[str, int]) -> str:
    return f"{split[0]} {split[1]}"


def run(setup: Setup) -> Section:
    parts = [1, 2, 6] if setup.quick else [1, 2, 4, 6, 8, 16]
    sequences = [scene.render(setup.programs) for scene in setup.scenes]
    splits = [WHOLE] + [(kind, n) for kind in ("interleaved", "blocks") for n in parts if n > 1]
    measured: dict[tuple[str, int, int], Measured] = {}  # partition, parts, rounds of refinement
    for kind, n in splits:
        options = ["--level-blocks", str(n)] + (["--partition", kind] if n > 1 else [])
        for rounds in (0, 4) if n in REFINED else (0,):
            measured[kind, n, rounds] = setup.measure(sequences, [*options, "--refine", str(rounds)])
        print(f"partition: {kind} {n} done", flush=True)
    sgbm = setup.measure_baseline("sgbm", sequences)

    rows = []
    for kind, n in splits:
        row = [str(n), kind]
        for rounds in (0, 4):
            this = measured.get((kind, n, rounds))
            row += this.cells(measured[*WHOLE, rounds]) if this else ["", "", ""]
        row.append(measured[kind, n, 0].cpu_text)
        row.append(paper.mean_text("VI", paper_column((kind, n))))
        row.append(paper.against_text("VI", paper_column((kind, n)), paper_column(WHOLE)))
        rows.append(row)
    rows.append([SGBM, "", *sgbm.cells(measured[*WHOLE, 0]), *sgbm.cells(measured[*WHOLE, 4]), sgbm.cpu_text, "", ""])

    curves = []
    for kind in ("interleaved", "blocks"):
        for rounds in (0, 4):
            counts = [n for k, n in splits if k == kind and (k, n, rounds) in measured]
            losses = [measured[kind, n, rounds].against(measured[*WHOLE, rounds]).mean for n in counts]
            curves.append(Curve(f"{kind}, --refine {rounds}", [1, *counts], [0.0, *losses]))
    for kind in ("interleaved", "blocks"):
        losses = [paper.against("VI", paper_column((kind, n)), paper_column(WHOLE)).mean for n in (2, 4, 6)]
        curves.append(Curve(f"the paper, {kind}", [1, 2, 4, 6], [0.0, *losses], dashed=True))
    write_plot(setup.plot("partition"), curves, "parts", "PSNR-Y against one part, dB")
    caption = setup.caption("partition", setup.where(setup.scenes), "--level-blocks N --partition P --refine R")
    text = (f"{caption} CPU is that of all parts and merges: what splitting costs in total, not how long it takes on N "
            f"machines. {PANEL}\n\n"
            + markdown_table(["parts", "levels", "--refine 0, dB", "against one part", "outside the panel",
                              "refined, dB", "against one part", "outside the panel", "CPU a view, --refine 0",
                              "paper, dB", "paper, against one part"], rows)
            + f"\n\n{setup.picture('partition', 'Loss over parts')}\n")
    return Section("partition", "Splitting the levels (Table VI, Fig. 7)", text)
