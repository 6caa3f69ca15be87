"""What an experiment is run with: the programs, the scenes, and how large everything is."""

from dataclasses import dataclass, field
from pathlib import Path

from measured import Measured
from programs import Programs
from scenes import SceneSpec

PSNR_NOTE = ("PSNR-Y in 16-235 BT.601 (full range is 1.3 dB lower) of the views that lie between two others, each "
             "synthesised by `depthfarm evaluate` from the pictures and depth of these two.")
INTERVALS = "Differences are paired; ± is the 95 % interval over scenes, of the paper's over its eight sequences."
PANEL = ("A plain panel fills a tenth of each scene; where its depth is wrong it decides the PSNR of the whole view: hence "
         "also figures without the pixels that show it.")
SGBM = "two-pair SGBM"


@dataclass
class Setup:
    """Scenes and sizes of one run of the experiments."""

    programs: Programs
    quick: bool
    scenes: list[SceneSpec]  # single frames
    large_scenes: list[SceneSpec]  # single frames that have room for many segments
    videos: list[SceneSpec]  # sequences
    frames: int  # of a video
    images: Path  # folder for plots
    list_name: str  # what the tables call the list the scenes are from
    invocation: str = ""  # the options of experiment.py that change what is measured
    data: Path | None = None  # folder of real sets
    options: list[str] = field(default_factory=list)  # of every `depthfarm run`

    def measure(self, sequences: list[Path], options: list[str], evaluate: list[str] | None = None) -> Measured:
        """`depthfarm run` and `depthfarm evaluate` of every sequence."""
        depths = [self.programs.estimate(s, [*self.options, *options]) for s in sequences]
        return Measured(depths, [self.programs.evaluate(s, d, evaluate or []) for s, d in zip(sequences, depths)])

    def measure_baseline(self, method: str, sequences: list[Path], options: list[str] | None = None,
                         evaluate: list[str] | None = None) -> Measured:
        """`depthfarm-experiments METHOD` and `depthfarm evaluate` of every sequence."""
        depths = [self.programs.baseline(method, s, options or []) for s in sequences]
        return Measured(depths, [self.programs.evaluate(s, d, evaluate or []) for s, d in zip(sequences, depths)])

    def where(self, scenes: list[SceneSpec]) -> str:
        """The data of an experiment on single frames."""
        sizes = ", ".join(sorted({scene.size for scene in scenes}))
        count = "One scene" if len(scenes) == 1 else f"{len(scenes)} scenes"
        return f"{count} of {self.list_name} ({sizes}), one frame each"

    def where_videos(self) -> str:
        """The data of an experiment on sequences."""
        names = ", ".join(f"{v.kind} seed {v.seed}, {v.cameras} views of {v.size}" for v in self.videos)
        count = "One rendered sequence" if len(self.videos) == 1 else f"{len(self.videos)} rendered sequences"
        return f"{count} of {self.frames} frames ({names})"

    def caption(self, name: str, data: str, run_options: str, evaluate_options: str = "",
                baselines: str = "sgbm") -> str:
        """What was measured on what, how, and by which commands."""
        workers = str(self.programs.workers)
        run = " ".join(["depthfarm run SEQUENCE -o DIR --workers", workers, *self.options, run_options])
        evaluate = f"depthfarm evaluate SEQUENCE DIR {evaluate_options}"
        call = f"experiment.py {name} {self.invocation}"
        return (f"{data}. {PSNR_NOTE} {INTERVALS}\n\n`{run.strip()}`, `depthfarm-experiments {baselines} SEQUENCE -o "
                f"DIR`, each with `{evaluate.strip()}`; all by `{call.strip()}`.")

    def picture(self, name: str, title: str) -> str:
        """The link to an experiment's plot, which is at `plot(name)`."""
        return f"![{title}](images/experiment-{name}.svg)"

    def plot(self, name: str) -> Path:
        return self.images / f"experiment-{name}.svg"
