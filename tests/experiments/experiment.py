#!/usr/bin/python3
"""Reruns the paper's tables with the programs of a build and writes them, beside the paper's, into docs/experiments.md.

--quick takes minutes and checks that everything works; the full mode takes hours. What is done is kept in --work: an
interrupted run goes on where it was.
"""

import argparse
import sys
from pathlib import Path

import experiment_choices
import experiment_gop
import experiment_methods
import experiment_partition
import experiment_segments
import experiment_views
from programs import ProgramError, Programs
from report import write_section
from scenes import SceneSpec, scene_list, sized
from setup import Setup

EXPERIMENTS = {
    "methods": experiment_methods.run,
    "segments": experiment_segments.run,
    "views": experiment_views.run,
    "partition": experiment_partition.run,
    "gop": experiment_gop.run,
    "choices": experiment_choices.run,
}

HEADING = """# Experiments

The paper's experiments on our own data: trend against trend, for the sequences differ. Rendered scenes: `scene-set.md`. Each
section is written by `tests/experiments/experiment.py NAME`.
"""

VGA = 640 * 480


def make_setup(arguments: argparse.Namespace) -> Setup:
    docs = arguments.docs
    work = arguments.work
    if arguments.quick:
        scenes = [SceneSpec("arc", 4, "192x144", 1), SceneSpec("line", 4, "192x144", 2)]
        videos = [SceneSpec("arc", 4, "192x144", 3)]
        return Setup(Programs(arguments.bin, work, 2), True, scenes, videos, 6, docs / "images", "the quick mode")
    scenes = sized(scene_list(arguments.scenes), arguments.pixels)[:arguments.count]
    videos = [SceneSpec("arc", 5, "640x480", 301 + i) for i in range(arguments.videos)]
    name = f"*{arguments.scenes}* of at most {arguments.pixels:,} pixels"
    return Setup(Programs(arguments.bin, work, arguments.workers), False, scenes, videos, 50, docs / "images", name)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="+", choices=[*EXPERIMENTS, "all"], metavar="NAME",
                        help=", ".join(EXPERIMENTS) + " or all")
    parser.add_argument("--quick", action="store_true", help="tiny scenes, minutes: figures mean nothing")
    parser.add_argument("--scenes", choices=["tuning", "final"], default="final", help="list of scene set v1 (default: final)")
    parser.add_argument("--count", type=int, default=20, help="use the first so many of its scenes (default: all)")
    parser.add_argument("--pixels", type=int, default=VGA,
                        help="use scenes with at most so many pixels a picture (default: 640x480)")
    parser.add_argument("--videos", type=int, default=2, help="sequences of 50 frames that gop uses (default: 2)")
    parser.add_argument("--workers", type=int, default=2, help="worker processes (default: 2); changes no figure but CPU's noise")
    parser.add_argument("--bin", type=Path, default=Path("build/release/bin"), help="folder of the programs")
    parser.add_argument("--work", type=Path, default=Path("experiments"), help="folder for scenes and results, kept")
    parser.add_argument("--docs", type=Path, default=Path("docs"), help="experiments.md and images/ are written there")
    arguments = parser.parse_args()
    try:
        setup = make_setup(arguments)
        for name in (EXPERIMENTS if "all" in arguments.names else arguments.names):
            write_section(arguments.docs / "experiments.md", EXPERIMENTS[name](setup), HEADING)
            print(f"{name}: written to {arguments.docs / 'experiments.md'}", flush=True)
    except ProgramError as error:
        print(f"experiment.py: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
