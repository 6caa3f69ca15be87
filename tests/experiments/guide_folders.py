"""Folders of prior depth and of masks made from a rendered scene's exact depth, right ones and wrong ones."""

import json
import math
from pathlib import Path

import numpy
from matplotlib import image
from scipy import ndimage

THIN, PERSON = 4, 5  # zones that a studio masks


def read_pfm(path: Path) -> numpy.ndarray:
    """A little-endian map of `depthfarm scene`, the top row first."""
    with path.open("rb") as file:
        if file.readline() != b"Pf\n":
            raise ValueError(f"{path} is no map of one channel")
        width, height = map(int, file.readline().split())
        file.readline()
        return numpy.frombuffer(file.read(), "<f4").reshape(height, width)[::-1].copy()


def write_pfm(path: Path, values: numpy.ndarray) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    height, width = values.shape
    path.write_bytes(b"Pf\n%d %d\n-1.0\n" % (width, height) + values[::-1].astype("<f4").tobytes())


def smooth_noise(generator: numpy.random.Generator, shape: tuple, width: float, height: float) -> numpy.ndarray:
    """Hills about `width` pixels wide and `height` high (root mean square)."""
    hills = ndimage.gaussian_filter(generator.normal(0, 1, shape), width)
    return hills * (height / hills.std())


# What a prior makes of u = pixels of motion in the nearest view: (what prior.json says, values).
PRIORS = {
    "exact": lambda u, rng: ("inverse-depth", u),
    "exact, up to scale and shift": lambda u, rng: ("relative-depth", 300 + 50 * u),
    "3 px too near": lambda u, rng: ("inverse-depth", u + 3),
    "8 px to the right": lambda u, rng: ("inverse-depth", numpy.roll(u, 8, axis=1)),
    "noise of 2 px": lambda u, rng: ("inverse-depth", numpy.maximum(u + rng.normal(0, 2, u.shape), 0.01)),
    "hills of 1.5 px": lambda u, rng: ("inverse-depth", numpy.maximum(u + smooth_noise(rng, u.shape, 25, 1.5), 0.01)),
    "blurred, bent": lambda u, rng: ("relative-depth",
                                     ndimage.gaussian_filter(u, 3) ** 0.8 + smooth_noise(rng, u.shape, 40, 0.5) + 10),
    "one plane": lambda u, rng: ("inverse-depth", numpy.full_like(u, numpy.median(u))),
}
MASKS = {
    "exact": lambda mask: mask,
    "grown by 3 px": lambda mask: ndimage.binary_dilation(mask, iterations=3),
    "5 px to the right": lambda mask: numpy.roll(mask, 5, axis=1),
}


def _folder(sequence: Path, kind: str, name: str) -> Path:
    return sequence.parent / kind / name.replace(" ", "-").replace(",", "")


def _centre(camera: dict) -> numpy.ndarray:
    return -numpy.array(camera["R"]).T @ numpy.array(camera["t"])


def prior_folder(sequence: Path, name: str) -> Path:
    """Of frame 0 of the scene, made once."""
    folder = _folder(sequence, "priors", name)
    if (folder / "prior.json").exists():
        return folder
    cameras = json.loads(sequence.read_text())["cameras"]
    generator = numpy.random.default_rng(1)
    holds = ""
    for camera in cameras:
        z = read_pfm(sequence.parent / "truth" / camera["name"] / "0000.pfm")
        others = [numpy.linalg.norm(_centre(camera) - _centre(o)) for o in cameras if o is not camera]
        motion = camera["K"][0][0] * min(others)
        inverse = numpy.divide(1, z, out=numpy.zeros_like(z), where=z > 0)
        holds, values = PRIORS[name](inverse * motion, generator)
        scale = motion if holds == "inverse-depth" else 1
        write_pfm(folder / "depth" / camera["name"] / "0000.pfm", numpy.where(z > 0, values / scale, 0))
    (folder / "prior.json").write_text(json.dumps({"holds": holds}))  # last: the folder is whole
    return folder


def mask_folder(sequence: Path, name: str) -> Path:
    """Of frame 0 of the scene: people and thin objects."""
    folder = _folder(sequence, "masks", name)
    for camera in json.loads(sequence.read_text())["cameras"]:
        path = folder / camera["name"] / "0000.png"
        if path.exists():
            continue
        zones = image.imread(sequence.parent / "truth" / camera["name"] / "0000_zones.png")
        zones = numpy.rint(zones * 255).astype(int)
        path.parent.mkdir(parents=True, exist_ok=True)
        image.imsave(path, MASKS[name](numpy.isin(zones, [THIN, PERSON])), cmap="gray", vmin=0, vmax=1)
    return folder


def share(part: float, whole: float) -> float:
    """Of two errors; NaN where there was none.

    >>> share(1, 4), math.isnan(share(0, 0))
    (0.25, True)
    """
    return part / whole if whole else math.nan
