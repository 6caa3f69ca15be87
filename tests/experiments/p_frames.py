"""What `gop` and `rates` both look at: sequences estimated with more and more P frames between I frames."""

from dataclasses import dataclass

from measured import Measured
from setup import Setup


@dataclass(frozen=True)
class Series:
    """Every result is evaluated `--against` that without P frames."""

    ours: dict[int, Measured]  # by the number of P frames between I frames; 0 is there
    sgbm: Measured


def measure(setup: Setup, name: str) -> Series:
    p_frames = [0, 2, 5] if setup.quick else [0, 4, 9, 24, 49]
    sequences = [video.render(setup.programs, setup.frames) for video in setup.videos]
    anchors = [setup.programs.estimate(s, [*setup.options, "--gop", "1"]) for s in sequences]
    against = [["--against", str(anchor.folder)] for anchor in anchors]
    ours = {}
    for p in p_frames:
        depths = [setup.programs.estimate(s, [*setup.options, "--gop", str(p + 1)]) for s in sequences]
        ours[p] = Measured(depths, [setup.programs.evaluate(*each) for each in zip(sequences, depths, against)])
        print(f"{name}: {p} P frames done", flush=True)
    depths = [setup.programs.baseline("sgbm", s, []) for s in sequences]
    return Series(ours, Measured(depths, [setup.programs.evaluate(*each) for each in zip(sequences, depths, against)]))
