"""Checks the experiments with the programs of a build: experiments_test.py BIN_FOLDER."""

import doctest
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import paired
import report
from scenes import scene_list, sized

HERE = Path(__file__).parent
BINARIES = ""


def experiment(*arguments: str) -> subprocess.CompletedProcess:
    return subprocess.run([sys.executable, str(HERE / "experiment.py"), *arguments], capture_output=True, text=True,
                          check=False)


class Statistics(unittest.TestCase):
    def test_examples(self) -> None:
        for module in (paired, report):
            self.assertEqual(doctest.testmod(module).failed, 0, module.__name__)

    def test_unequal_lists_are_refused(self) -> None:
        with self.assertRaises(ValueError):
            paired.paired([1.0], [1.0, 2.0])

    def test_a_single_value_has_no_interval(self) -> None:
        self.assertEqual(paired.mean_of([2.0]).text(), "+2.00")


class SceneSet(unittest.TestCase):
    def test_lists_share_no_seed_and_have_every_kind(self) -> None:
        tuning, final = scene_list("tuning"), scene_list("final")
        self.assertEqual(len({scene.seed for scene in tuning + final}), 40)
        for scenes in (tuning, final):
            self.assertEqual(len(scenes), 20)
            self.assertEqual({scene.kind for scene in scenes}, {"arc", "line", "grid", "irregular"})
            self.assertLess(len(sized(scenes, 640 * 480)), 20)
            self.assertEqual(len(sized(scenes, 1920 * 1080)), 20)


class Experiments(unittest.TestCase):
    def test_missing_programs_are_named(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            done = experiment("views", "--quick", "--bin", folder + "/no", "--work", folder + "/work")
            self.assertEqual(done.returncode, 1)
            self.assertIn("/no/depthfarm is missing", done.stderr)

    def test_unknown_names_are_refused(self) -> None:
        self.assertEqual(experiment("colours").returncode, 2)

    def test_quick_mode_writes_every_section_and_repeats_itself_from_what_is_there(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            arguments = ["all", "--quick", "--bin", BINARIES, "--work", folder + "/work", "--docs", folder + "/docs"]
            done = experiment(*arguments)
            self.assertEqual(done.returncode, 0, done.stderr)
            documents = Path(folder) / "docs"
            first = (documents / "experiments.md").read_text()
            for name in ("methods", "segments", "views", "partition", "gop", "choices"):
                self.assertIn(f"<!-- end {name} -->", first)
            self.assertNotIn("nan", first)
            plots = {path.name: path.read_bytes() for path in (documents / "images").iterdir()}
            self.assertEqual(sorted(plots), [f"experiment-{name}.svg" for name in ("gop", "partition", "segments", "views")])
            made = sorted((Path(folder) / "work").iterdir())
            self.assertEqual(experiment(*arguments).returncode, 0)
            self.assertEqual((documents / "experiments.md").read_text(), first)
            self.assertEqual({path.name: path.read_bytes() for path in (documents / "images").iterdir()}, plots)
            self.assertEqual(sorted((Path(folder) / "work").iterdir()), made)


if __name__ == "__main__":
    BINARIES = sys.argv.pop(1)
    unittest.main()
