"""Table V and Fig. 6: how many views are estimated together."""

from dataclasses import replace

import paper
from report import Curve, Section, flat, markdown_table, write_plot
from setup import PANEL, SGBM, Setup


def names(cameras: list[int]) -> str:
    """As --views and --from take them.

    >>> names([4, 2])
    'cam2,cam4'
    """
    return ",".join(f"cam{camera}" for camera in sorted(cameras))


def run(setup: Setup) -> Section:
    """The virtual view is always the same, from the same two; the views estimated with them grow outwards."""
    counts = [3, 4] if setup.quick else [3, 4, 5, 6, 7, 8]
    cameras = max(counts) + 1  # as many again without the middle one
    sequences = [replace(scene, kind="arc", cameras=cameras).render(setup.programs) for scene in setup.scenes[:4]]
    middle = cameras // 2
    outwards = sorted(range(cameras), key=lambda i: (abs(i - middle), i))
    evaluate = ["--view", names([middle]), "--from", names([middle - 1, middle + 1])]
    with_view, without = {}, {}
    for count in counts:
        with_view[count] = setup.measure(sequences, ["--views", names(outwards[:count])], evaluate)
        without[count] = setup.measure(sequences, ["--views", names(outwards[1:count + 1])], evaluate)
        print(f"views: {count} done", flush=True)
    sgbm = setup.measure_baseline("sgbm", sequences, [], evaluate)
    sgbm_without = setup.measure_baseline("sgbm", sequences, ["--views", names(outwards[1:])], evaluate)

    least = min(counts)
    rows = [[str(n), *with_view[n].cells(with_view[least]), *without[n].cells(without[least]), with_view[n].cpu_text,
             paper.mean_text("V", n), paper.against_text("V", n, 3)] for n in counts]
    rows.append([SGBM, *sgbm.cells(with_view[least]), *sgbm_without.cells(without[least]), sgbm.cpu_text, "", ""])
    write_plot(setup.plot("views"),
               [Curve("depthfarm", counts, [with_view[n].mean_psnr for n in counts]),
                Curve("depthfarm, virtual view left out", counts, [without[n].mean_psnr for n in counts]),
                flat(SGBM, counts, sgbm.mean_psnr),
                Curve("the paper, its sequences", counts, [paper.mean("V", n) for n in counts], dashed=True)],
               "views estimated together", "PSNR-Y, dB")
    data = f"{len(sequences)} arcs with the seeds, sizes and noise of {setup.list_name}, one frame each"
    caption = setup.caption("views", data, "--views A,B,...", " ".join(evaluate))
    text = (f"{caption} As in the paper, the picture that is synthesised takes part in the estimation; *left out*: it "
            f"does not, and the two sources are each other's nearest neighbours. {PANEL}\n\n"
            + markdown_table(["views", "PSNR-Y, dB", f"against {least}", "outside the panel", "left out, dB",
                              f"against {least}", "outside the panel", "CPU a view", "paper, dB", "paper, against 3"],
                             rows)
            + f"\n\n{setup.picture('views', 'PSNR over views')}\n")
    return Section("views", "Number of views (Table V, Fig. 6)", text)
