"""Runs depthfarm's programs and keeps what they gave: an experiment that was interrupted goes on where it was."""

import hashlib
import json
import os
import resource
import shutil
import subprocess
from dataclasses import dataclass, replace
from pathlib import Path


class ProgramError(Exception):
    """A program failed; the message has its command and what it said."""


@dataclass(frozen=True)
class Depth:
    """Depth of a sequence, and what it cost."""

    folder: Path
    stages: dict[str, float]  # CPU seconds, user + system, by stage of the job; a baseline is one stage
    views: int
    frames: int

    @property
    def cpu_seconds(self) -> float:
        return sum(self.stages.values())

    @property
    def cpu_per_view(self) -> float:
        """Of one frame."""
        return self.cpu_seconds / (self.views * self.frames)

    def cpu_per_frame(self, *without: str) -> float:
        """Of all views, but not of the stages named."""
        return sum(cpu for stage, cpu in self.stages.items() if stage not in without) / self.frames


class Programs:
    """The programs of one build, and a folder for what they make.

    Results are named by the digest of the command and of the bytes of the programs that make them: another build
    measures anew, for its --version does not tell whether its depth is the same.
    """

    def __init__(self, binaries: Path, work: Path, workers: int) -> None:
        self.binaries = binaries.resolve()
        self.work = work.resolve()
        self.workers = workers
        for name in ("depthfarm", "depthfarm-media", "depthfarm-coordinator", "depthfarm-worker"):
            if not os.access(self.binaries / name, os.X_OK):
                raise ProgramError(
                    f"{self.binaries / name} is missing: build depthfarm and name its bin folder with --bin")
        self.work.mkdir(parents=True, exist_ok=True)
        self._digests: dict[str, str] = {}

    def has_baselines(self) -> bool:
        """Whether depthfarm-experiments was built (it needs OpenCV's calib3d)."""
        return os.access(self.binaries / "depthfarm-experiments", os.X_OK)

    def scene(self, kind: str, cameras: int, size: str, seed: int, frames: int = 1, noise: float = 1.5,
              gain: float = 0.01) -> Path:
        """The sequence file of a rendered scene."""
        arguments = [kind, "--cameras", str(cameras), "--size", size, "--seed", str(seed), "--frames", str(frames),
                     "--noise", str(noise), "--gain", str(gain)]
        folder = self._folder(f"{kind}{seed}-{size}", ["depthfarm-media"], ["scene", *arguments])
        if not (folder / "sequence.json").exists():
            self._make(folder, lambda part: self._run("depthfarm-media", ["scene", *arguments, "-o", str(part)]))
        return folder / "sequence.json"

    def estimate(self, sequence: Path, options: list[str]) -> Depth:
        """`depthfarm run` on this machine."""
        folder = self._folder(sequence.parent.name, ["depthfarm", "depthfarm-coordinator", "depthfarm-worker"],
                              ["run", str(sequence), *options])
        if not (folder / "run.json").exists():
            self._make(folder, lambda part: self._run(
                "depthfarm",
                ["run", str(sequence), "-o", str(part), "--workers", str(self.workers), "--no-cache", *options]))
        report = json.loads((folder / "run.json").read_text())
        manifest = json.loads((folder / "depth.json").read_text())
        stages = {stage["stage"]: stage["cpuSeconds"] for stage in report["stages"]}
        return Depth(folder, stages, len(manifest["cameras"]), report["framesTotal"])

    def margin(self, sequence: Path, depth: Depth) -> Depth:
        """`depthfarm-experiments margin`: the same depth with another confidence."""
        self._check_baselines()
        folder = self._folder(f"{depth.folder.name}-margin", ["depthfarm-experiments"],
                              ["margin", str(sequence), str(depth.folder)])
        if not (folder / "depth.json").exists():
            self._make(folder, lambda part: self._run(
                "depthfarm-experiments", ["margin", str(sequence), str(depth.folder), "-o", str(part)]))
        return replace(depth, folder=folder)

    def _check_baselines(self) -> None:
        if not self.has_baselines():
            raise ProgramError(f"{self.binaries}/depthfarm-experiments is missing: it is built with the tests (preset "
                               "ci) where libopencv-calib3d-dev is installed")

    def baseline(self, method: str, sequence: Path, options: list[str]) -> Depth:
        """`depthfarm-experiments METHOD`."""
        self._check_baselines()
        folder = self._folder(f"{sequence.parent.name}-{method}", ["depthfarm-experiments"],
                              [method, str(sequence), *options])
        if not (folder / "cost.json").exists():
            def make(part: Path) -> None:
                before = resource.getrusage(resource.RUSAGE_CHILDREN)
                self._run("depthfarm-experiments", [method, str(sequence), "-o", str(part), *options])
                after = resource.getrusage(resource.RUSAGE_CHILDREN)
                seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
                (part / "cost.json").write_text(json.dumps({"cpuSeconds": seconds}))
            self._make(folder, make)
        manifest = json.loads((folder / "depth.json").read_text())
        cpu = json.loads((folder / "cost.json").read_text())["cpuSeconds"]
        return Depth(folder, {method: cpu}, len(manifest["cameras"]), len(manifest["cameras"][0]["files"]))

    def evaluate(self, sequence: Path, depth: Depth, options: list[str]) -> dict:
        """`depthfarm evaluate --json`."""
        name = self._folder(depth.folder.name + "-figures", ["depthfarm-media"],
                            ["evaluate", str(sequence), str(depth.folder), *options])
        path = name.with_suffix(".json")
        if not path.exists():
            text = self._run("depthfarm-media", ["evaluate", str(sequence), str(depth.folder), "--json", *options])
            part = path.with_suffix(".part")
            part.write_text(text)
            os.replace(part, path)
        return json.loads(path.read_text())

    def _folder(self, label: str, programs: list[str], arguments: list[str]) -> Path:
        key = hashlib.sha256(json.dumps([self._digest(p) for p in programs] + arguments).encode()).hexdigest()
        return self.work / f"{label[:60]}-{key[:12]}"

    def _digest(self, program: str) -> str:
        if program not in self._digests:
            self._digests[program] = hashlib.sha256((self.binaries / program).read_bytes()).hexdigest()
        return self._digests[program]

    def _make(self, folder: Path, make) -> None:
        part = folder.with_name(folder.name + ".part")
        shutil.rmtree(part, ignore_errors=True)
        shutil.rmtree(folder, ignore_errors=True)
        make(part)
        os.replace(part, folder)

    def _run(self, program: str, arguments: list[str]) -> str:
        command = [str(self.binaries / program), *arguments]
        try:
            process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        except OSError as error:
            raise ProgramError(f"{command[0]} cannot be run: {error.strerror}") from error
        with process:
            try:
                output, log = process.communicate()
            except BaseException:
                process.terminate()  # `depthfarm run` ends its workers; killed, it could not
                raise
        if process.returncode != 0:
            raise ProgramError(f"{' '.join(command)}\nended with {process.returncode}: {log.strip()}")
        return output
