"""Table VI and Fig. 7: the levels split into parts, in blocks or interleaved."""

import figures
import paper
from paired import mean_of, paired
from report import Curve, Section, markdown_table, write_plot
from setup import PSNR_NOTE, Setup


def run(setup: Setup) -> Section:
    parts = [1, 2, 6] if setup.quick else [1, 2, 4, 6, 8, 16]
    sequences = [scene.render(setup.programs) for scene in setup.scenes]
    sgbm = [figures.psnr(setup.programs.evaluate(s, setup.programs.baseline("sgbm", s, []), [])) for s in sequences]
    psnr: dict[tuple[str, int, int], list[float]] = {}  # (partition, parts, rounds) -> per scene
    cpu: dict[tuple[str, int], float] = {}
    kinds = [("", 1)] + [(kind, n) for kind in ("interleaved", "blocks") for n in parts if n > 1]
    refined = (1, 6, 16)  # refinement starts from what the cut left: a few rows show how much of the loss it keeps
    for kind, n in kinds:
        options = ["--level-blocks", str(n)] + (["--partition", kind] if kind else [])
        for rounds in (0, 4) if n in refined else (0,):
            depths = [setup.estimate(s, [*options, "--refine", str(rounds)]) for s in sequences]
            psnr[kind, n, rounds] = [figures.psnr(setup.programs.evaluate(s, d, [])) for s, d in zip(sequences, depths)]
            if rounds == 0:
                cpu[kind, n] = sum(depth.cpu_per_view for depth in depths) / len(depths)
        print(f"partition: {kind or 'whole'} {n} done", flush=True)
    rows = []
    for kind, n in kinds:
        row = [str(n), kind or "whole"]
        for rounds in (0, 4):
            if (kind, n, rounds) not in psnr:
                row += ["", ""]
                continue
            row.append(mean_of(psnr[kind, n, rounds]).text(sign=False))
            row.append("" if n == 1 else paired(psnr[kind, n, rounds], psnr["", 1, rounds]).text())
        row.append(f"{cpu[kind, n]:.1f} s")
        known = (kind, n) in paper.PARTITION
        row.append(f"{paper.PARTITION[kind, n] - paper.PARTITION['', 1]:+.2f}" if known and n > 1 else "")
        rows.append(row)
    curves = []
    for kind in ("interleaved", "blocks"):
        for rounds in (0, 4):
            measured = [n for k, n in kinds if k == kind and (k, n, rounds) in psnr]
            losses = [paired(psnr[kind, n, rounds], psnr["", 1, rounds]).mean for n in measured]
            curves.append(Curve(f"{kind}, --refine {rounds}", [1, *measured], [0.0, *losses]))
    curves += [Curve(f"the paper, {kind}", [1, 2, 4, 6],
                     [0.0] + [paper.PARTITION[kind, n] - paper.PARTITION["", 1] for n in (2, 4, 6)], dashed=True)
               for kind in ("interleaved", "blocks")]
    write_plot(setup.images / "experiment-partition.svg", curves, "parts", "PSNR-Y against one part, dB")
    text = (f"{setup.where()}. {PSNR_NOTE} Two-pair SGBM: {mean_of(sgbm).text(sign=False)} dB.\n\n" +
            markdown_table(["parts", "levels", "--refine 0, dB", "against one part", "refined, dB", "against one part",
                            "CPU a view, --refine 0", "paper, against one part"], rows) +
            f"\n\n![Loss over parts]({setup.images_link}/experiment-partition.svg)\n")
    return Section("partition", "Splitting the levels (Table VI, Fig. 7)", text)
