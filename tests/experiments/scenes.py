"""Scene set v1: two lists of rendered scenes, one to tune on and one to report."""

import json
from dataclasses import dataclass
from pathlib import Path

from programs import Programs


@dataclass(frozen=True)
class SceneSpec:
    """What `depthfarm scene` is told."""

    kind: str
    cameras: int
    size: str
    seed: int
    noise: float = 1.5
    gain: float = 0.01

    @property
    def name(self) -> str:
        return f"{self.kind} {self.seed}"

    def render(self, programs: Programs, frames: int = 1) -> Path:
        return programs.scene(self.kind, self.cameras, self.size, self.seed, frames, self.noise, self.gain)


def scene_list(name: str) -> list[SceneSpec]:
    """'tuning' or 'final', in order."""
    lists = json.loads((Path(__file__).parent / "scenes_v1.json").read_text())
    return [SceneSpec(**scene) for scene in lists[name]]


def sized(scenes: list[SceneSpec], largest_pixels: int) -> list[SceneSpec]:
    """Those whose pictures have at most so many pixels."""
    def pixels(scene: SceneSpec) -> int:
        width, height = scene.size.split("x")
        return int(width) * int(height)
    return [scene for scene in scenes if pixels(scene) <= largest_pixels]


def of_size(scenes: list[SceneSpec], size: str) -> list[SceneSpec]:
    """Those whose pictures are of that size."""
    return [scene for scene in scenes if scene.size == size]
