"""How well confidence tells right depth from wrong: pixels are removed, the least confident first."""

import figures
from paired import mean_of
from report import Curve, Section, markdown_table, write_plot
from setup import SGBM, Setup

OURS = "depthfarm --confidence on"
MARGIN = "the same depth, margin of raw matching costs"
BEST = "the same depth, by its errors: the best there can be"


def run(setup: Setup) -> Section:
    sequences = [scene.render(setup.programs) for scene in setup.scenes]
    depths = [setup.programs.estimate(s, [*setup.options, "--confidence", "on"]) for s in sequences]
    margins = [setup.programs.margin(s, d) for s, d in zip(sequences, depths)]
    print("confidence: margins done", flush=True)

    def reports(of: list) -> list[dict]:
        return [figures.confidence(setup.programs.evaluate(s, d, [])) for s, d in zip(sequences, of)]

    ours, raw = reports(depths), reports(margins)
    kept = [point["keptPercent"] for point in ours[0]["curve"]]

    def curve(of: list[dict], field: str) -> list[float]:
        return [mean_of([report["curve"][i][field] for report in of]).mean for i in range(len(kept))]

    def mean(of: list[dict], field: str, digits: int) -> str:
        return mean_of([report[field] for report in of]).text(digits, sign=False)

    def row(name: str, of: list[dict], calibrated: bool) -> list[str]:
        return [name, *(f"{value:.2f} %" for value in curve(of, "bad1PxPercent")), mean(of, "auseBad1PxPercent", 3),
                mean(of, "auseMeanPx", 3), mean(of, "calibrationErrorPercent", 2) + " %" if calibrated else ""]

    best = [f"{value:.2f} %" for value in curve(ours, "bestBad1PxPercent")]
    sgbm = setup.measure_baseline("sgbm", sequences)
    wrong = mean_of([figures.bad(report, "bad1PxPercent", "all") for report in sgbm.reports]).mean
    rows = [row(OURS, ours, True), row(MARGIN, raw, False), [BEST, *best, "0", "0", ""],
            [SGBM, f"{wrong:.2f} %", *([""] * (len(kept) + 2))]]
    write_plot(setup.plot("confidence"),
               [Curve("confidence", kept, curve(ours, "bad1PxPercent")),
                Curve("margin of raw costs", kept, curve(raw, "bad1PxPercent")),
                Curve("best possible", kept, curve(ours, "bestBad1PxPercent"))],
               "pixels kept, %", "off by more than 1 px, %")
    ratio = mean_of([a["auseBad1PxPercent"] / b["auseBad1PxPercent"] for a, b in zip(ours, raw)])
    ratio_px = mean_of([a["auseMeanPx"] / b["auseMeanPx"] for a, b in zip(ours, raw)])
    caption = setup.caption("confidence", setup.where(setup.scenes), "--confidence on")
    text = (f"{caption} The margins are those of `depthfarm-experiments margin SEQUENCE DIR -o DIR`: by how much the best "
            "level of a pixel beats the second best local minimum of its matching costs, 3x3 pixels, the better of two "
            "neighbours. Columns: of the N % most confident pixels of all views, occluded ones too, those off by more "
            "than 1 px. *AUSE*: area between that curve and the best one, in % and, of mean errors, in px. *Calibration*: "
            "by how much confidence and the share of right pixels differ.\n\n"
            + markdown_table(["order", *(f"{k:g} %" for k in kept), "AUSE, %", "AUSE, px", "calibration"], rows)
            + f"\n\nOur AUSE is {ratio.text(3, sign=False)} of the margins' by wrong pixels and "
            f"{ratio_px.text(2, sign=False)} by mean errors.\n\n{setup.picture('confidence', 'Wrong pixels over kept ones')}\n")
    return Section("confidence", "Confidence", text)
