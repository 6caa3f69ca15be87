"""What an experiment is run with: the programs, the scenes, and how large everything is."""

from dataclasses import dataclass, field
from pathlib import Path

from programs import Depth, Programs
from scenes import SceneSpec


@dataclass
class Setup:
    """Scenes and sizes of one run of the experiments."""

    programs: Programs
    quick: bool
    scenes: list[SceneSpec]  # single frames
    videos: list[SceneSpec]  # sequences
    frames: int  # of a video
    images: Path  # folder for plots
    scene_list: str  # what the tables call `scenes`
    data: Path | None = None  # folder of real sets
    images_link: str = "images"  # the same as seen from the document
    options: list[str] = field(default_factory=list)  # of every `depthfarm run`

    def estimate(self, sequence: Path, options: list[str]) -> Depth:
        return self.programs.estimate(sequence, [*self.options, *options])

    def where(self, scenes: list[SceneSpec] | None = None) -> str:
        """A sentence on the data."""
        return f"{len(scenes or self.scenes)} scenes of {self.scene_list}, one frame each"

    def where_videos(self) -> str:
        names = ", ".join(f"{v.kind} seed {v.seed}, {v.cameras} views of {v.size}" for v in self.videos)
        return f"rendered sequences of {self.frames} frames ({names})"


PSNR_NOTE = ("PSNR-Y in 16-235 BT.601 (full range is 1.3 dB lower) of the views that lie between two others, synthesised by "
             "`depthfarm evaluate` from these two. Intervals: 95 %, over scenes.")
