#!/usr/bin/python3
"""Renders scene set v1 and records what exact depth and two-pair SGBM reach on each scene."""

import argparse
import sys
from pathlib import Path

import figures
from paired import mean_of, paired
from programs import ProgramError, Programs
from report import Section, markdown_table, write_section
from scenes import SceneSpec, scene_list

HEADING = """# Scene set v1

`depthfarm scene KIND --cameras N --size WxH --seed S --noise SIGMA --gain SPREAD` for every row: each has people, rods
thinner than five pixels, a slanted floor and wall, a plain panel, crates and round things, noise and cameras of unequal
gain. *tuning* is what choices are made on, *final* what is reported. A change of the generator makes another set
(`tests/common/scene` notices), with another number.

PSNR-Y in 16-235 BT.601 by `depthfarm evaluate`, mean of all views that lie between two others, each synthesised from
these two. *plain*: share of pixels that show the panel. SGBM: `depthfarm-experiments sgbm`; errors over non-occluded
pixels of all views. Written by `tests/experiments/scene_set.py`.
"""


def measure(programs: Programs, scene: SceneSpec) -> list[float]:
    """Plain share, PSNR of exact depth and of SGBM, SGBM's wrong pixels by level and by px."""
    sequence = scene.render(programs)
    report = programs.evaluate(sequence, programs.baseline("sgbm", sequence, []), [])
    return [figures.share_of_zone(report, "panel"), figures.exact_psnr(report), figures.psnr(report),
            figures.bad(report, "bad1LevelPercent"), figures.bad(report, "bad1PxPercent")]


def section(programs: Programs, name: str, scenes: list[SceneSpec]) -> Section:
    rows, columns = [], []
    for scene in scenes:
        values = measure(programs, scene)
        columns.append(values)
        plain, exact, sgbm, levels, px = values
        rows.append([str(scene.seed), scene.kind, str(scene.cameras), scene.size, f"{scene.noise:g}", f"{scene.gain:g}",
                     f"{plain:.1f} %", f"{exact:.2f}", f"{sgbm:.2f}", f"{levels:.1f} %", f"{px:.1f} %"])
        print(f"{name} {scene.name}: exact {exact:.2f} dB, SGBM {sgbm:.2f} dB", flush=True)
    plain, exact, sgbm, levels, px = (list(column) for column in zip(*columns))
    rows.append(["mean", "", "", "", "", "", f"{sum(plain) / len(plain):.1f} %", mean_of(exact).text(sign=False),
                 mean_of(sgbm).text(sign=False), f"{mean_of(levels).text(1, False)} %",
                 f"{mean_of(px).text(1, False)} %"])
    text = markdown_table(["seed", "kind", "views", "size", "noise", "gain", "plain", "exact depth, dB", "SGBM, dB",
                           "SGBM bad > 1 level", "SGBM bad > 1 px"], rows)
    large = sum(share >= 8 for share in plain)
    text += (f"\n\nSGBM is {paired(sgbm, exact).text()} dB from exact depth (paired mean, 95 % interval, {len(scenes)} "
             f"scenes); {large} of {len(scenes)} scenes have a plain panel of at least 8 % of the picture.\n")
    return Section(f"scenes-{name}", name, text)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("list", nargs="*", default=["tuning", "final"], help="tuning, final or both (default)")
    parser.add_argument("--bin", type=Path, default=Path("build/ci/bin"), help="folder of the programs")
    parser.add_argument("--work", type=Path, default=Path("build/experiments"),
                        help="folder for scenes and results, kept")
    parser.add_argument("--docs", type=Path, default=Path("docs"), help="scene-set.md is written there")
    arguments = parser.parse_args()
    try:
        programs = Programs(arguments.bin, arguments.work, 1)
        for name in arguments.list:
            if name not in ("tuning", "final"):
                parser.error(f"unknown list '{name}', expected tuning or final")
            write_section(arguments.docs / "scene-set.md", section(programs, name, scene_list(name)), HEADING)
    except ProgramError as error:
        print(f"scene_set.py: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
