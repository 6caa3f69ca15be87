#!/usr/bin/python3
"""Reruns the paper's tables with the programs of a build and writes them, beside the paper's, into docs/experiments.md.

  methods    Table II           ours, the paper's planes, two-pair SGBM, pixel-level cut, views one by one
  segments   Table IV, Fig. 5   1,000 to 150,000 segments a view
  views      Table V, Fig. 6    3 to 8 views estimated together
  partition  Table VI, Fig. 7   the levels in 1 to 16 parts, interleaved or in blocks
  gop        Table VII, Fig. 8  0 to 49 P frames between I frames: quality and time
  rates      Tables III, VIII   the same, coded as HEVC
  left_out   -                  views that were not used in the estimation, against other methods
  confidence -                  how well confidence tells right depth from wrong
  guides     -                  what priors and masks are worth, and what wrong ones cost
  choices    -                  what the paper leaves open, one choice changed at a time

--quick takes two minutes and checks that everything works; the full mode takes from ten minutes to hours an experiment.
What is done is kept in --work: an interrupted run goes on where it was.
"""

import argparse
import signal
import sys
from pathlib import Path

import experiment_choices
import experiment_confidence
import experiment_gop
import experiment_guides
import experiment_left_out
import experiment_methods
import experiment_partition
import experiment_rates
import experiment_segments
import experiment_views
import real_sets
from programs import ProgramError, Programs
from report import write_section
from scenes import SceneSpec, of_size, scene_list, sized
from setup import Setup

EXPERIMENTS = {
    "methods": experiment_methods.run,
    "segments": experiment_segments.run,
    "views": experiment_views.run,
    "partition": experiment_partition.run,
    "gop": experiment_gop.run,
    "rates": experiment_rates.run,
    "left_out": experiment_left_out.run,
    "confidence": experiment_confidence.run,
    "guides": experiment_guides.run,
    "choices": experiment_choices.run,
}

HEADING = """# Experiments

The paper's experiments on our own data: trend against trend, for the sequences differ. Rendered scenes: `scene-set.md`.
Each section is written by `tests/experiments/experiment.py NAME`.
"""

VGA = 640 * 480
LARGE = "1024x768"  # for 150,000 segments a view: five pixels each


def parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="+", choices=[*EXPERIMENTS, "all"], metavar="NAME",
                        help="of an experiment, or all")
    mode = parser.add_mutually_exclusive_group()
    mode.add_argument("--quick", action="store_true", help="tiny scenes: the figures mean nothing")
    mode.add_argument("--full", action="store_true", help="what is published (default)")
    parser.add_argument("--scenes", choices=["tuning", "final"], default="final",
                        help="list of scene set v1 (default: final; choices are made on tuning)")
    parser.add_argument("--count", type=int, default=20, help="use the first so many of its scenes (default: all)")
    parser.add_argument("--pixels", type=int, default=VGA,
                        help=f"use its scenes of at most so many pixels a picture (default: {VGA}, which is 640x480); "
                        f"segments uses those of {LARGE}")
    parser.add_argument("--videos", type=int, default=2, help="sequences of 50 frames for gop and rates (default: 2)")
    parser.add_argument("--levels", help="depth levels of every job (default: chosen by depthfarm; segments: 100)")
    parser.add_argument("--workers", type=int, default=2,
                        help="worker processes (default: 2); changes no figure but CPU's noise")
    parser.add_argument("--bin", type=Path, default=Path("build/ci/bin"),
                        help="folder of the programs (default: build/ci/bin)")
    parser.add_argument("--work", type=Path, default=Path("build/experiments"),
                        help="folder for scenes and results, kept (default: build/experiments)")
    parser.add_argument("--data", type=Path,
                        help="folder of published sets, a folder each: methods and left_out measure on them too")
    parser.add_argument("--docs", type=Path, default=Path("docs"),
                        help="experiments.md and images/ are written there (default: docs)")
    return parser


def invocation(arguments: argparse.Namespace) -> str:
    """The options that change what is measured, as they were given."""
    given = ["--quick"] if arguments.quick else []
    defaults = {"scenes": "final", "count": 20, "pixels": VGA, "videos": 2, "levels": None}
    for name, default in defaults.items():
        if getattr(arguments, name) != default:
            given += [f"--{name}", str(getattr(arguments, name))]
    return " ".join([*given, *(["--data DIR"] if arguments.data else [])])


def make_setup(arguments: argparse.Namespace) -> Setup:
    if arguments.data and not arguments.data.is_dir():
        raise ProgramError(f"--data {arguments.data} is not a folder")
    if arguments.data and not real_sets.found(arguments.data):
        wanted = ", ".join(real.name for real in real_sets.REAL_SETS)
        raise ProgramError(f"--data {arguments.data} has none of {wanted}")
    common = {"programs": Programs(arguments.bin, arguments.work, arguments.workers),
              "images": arguments.docs / "images", "invocation": invocation(arguments), "data": arguments.data,
              "options": ["--levels", arguments.levels] if arguments.levels else []}
    if arguments.quick:
        scenes = [SceneSpec("arc", 4, "192x144", 1), SceneSpec("line", 4, "192x144", 2)]
        videos = [SceneSpec("arc", 4, "192x144", 3)]
        return Setup(quick=True, scenes=scenes, large_scenes=scenes, videos=videos, frames=6,
                     list_name="the quick mode", **common)
    scenes = scene_list(arguments.scenes)
    videos = [SceneSpec("arc", 5, "640x480", 301 + i) for i in range(arguments.videos)]
    setup = Setup(quick=False, scenes=sized(scenes, arguments.pixels)[:arguments.count],
                  large_scenes=of_size(scenes, LARGE)[:arguments.count], videos=videos, frames=50,
                  list_name=f"scene set v1, list *{arguments.scenes}*", **common)
    if not setup.scenes:
        raise ProgramError(
            f"--count {arguments.count} --pixels {arguments.pixels} leaves no scene of {arguments.scenes}")
    if not setup.videos:
        raise ProgramError(f"--videos {arguments.videos} leaves no sequence")
    return setup


def interrupt(signum: int, frame: object) -> None:
    raise KeyboardInterrupt


def main() -> int:
    arguments = parser().parse_args()
    signal.signal(signal.SIGTERM, interrupt)
    try:
        setup = make_setup(arguments)
        for name in (EXPERIMENTS if "all" in arguments.names else arguments.names):
            write_section(arguments.docs / "experiments.md", EXPERIMENTS[name](setup), HEADING)
            print(f"{name}: written to {arguments.docs / 'experiments.md'}", flush=True)
    except ProgramError as error:
        print(f"experiment.py: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("experiment.py: interrupted; the same command goes on from here", file=sys.stderr)
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main())
