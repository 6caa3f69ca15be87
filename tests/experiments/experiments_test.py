"""Checks the experiments with the programs of a build: experiments_test.py BIN_FOLDER."""

import doctest
import math
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import experiment_views
import figures
import guide_folders
import measured
import paired
import paper
import real_sets
import report
from scenes import of_size, scene_list, sized

HERE = Path(__file__).parent
BINARIES = ""
PLOTTED = ["methods", "segments", "views", "partition", "gop", "rates", "confidence"]
NAMES = [*PLOTTED, "left_out", "guides", "choices"]


def experiment(*arguments: str) -> subprocess.CompletedProcess:
    return subprocess.run([sys.executable, str(HERE / "experiment.py"), *arguments], capture_output=True, text=True,
                          check=False)


class Examples(unittest.TestCase):
    def test_examples_of_the_modules(self) -> None:
        for module in (paired, report, paper, measured, real_sets, experiment_views, guide_folders):
            result = doctest.testmod(module)
            self.assertGreater(result.attempted, 0, module.__name__)
            self.assertEqual(result.failed, 0, module.__name__)


class Statistics(unittest.TestCase):
    def test_a_worked_example_of_paired_differences(self) -> None:
        # Differences 1.2, 2.4, 1.3, 1.3, 0.0, 1.0, 1.8, 0.8, 4.6, 1.4: the sleep data of Student (1908), whose 95 %
        # interval is 0.70 to 2.46.
        first = [0.7, -1.6, -0.2, -1.2, -0.1, 3.4, 3.7, 0.8, 0.0, 2.0]
        second = [1.9, 0.8, 1.1, 0.1, -0.1, 4.4, 5.5, 1.6, 4.6, 3.4]
        mean = paired.paired(second, first)
        self.assertAlmostEqual(mean.mean, 1.58)
        self.assertAlmostEqual(mean.mean - mean.half, 0.7001, places=4)
        self.assertAlmostEqual(mean.mean + mean.half, 2.4599, places=4)

    def test_unequal_lists_are_refused(self) -> None:
        with self.assertRaises(ValueError):
            paired.paired([1.0], [1.0, 2.0])

    def test_a_single_value_has_no_interval(self) -> None:
        self.assertEqual(paired.mean_of([2.0]).text(), "+2.00")


class Paper(unittest.TestCase):
    def test_columns_average_to_what_the_paper_prints(self) -> None:
        printed = {
            "III": [-19.2, -26.7, -29.7, -32.0],
            "IV": [26.21, 27.55, 27.94, 28.25, 28.59, 28.84, 28.94],
            "V": [28.39, 28.66, 28.73, 28.77, 28.79, 28.82],
            "VI": [28.74, 28.68, 28.60, 28.58, 28.68, 28.63, 28.62],
            "VII": [28.84, 28.80, 28.73, 28.67, 28.59],
        }
        for table, averages in printed.items():
            last_digit = 0.1 if table == "III" else 0.01  # it averages what it does not print
            for column, average in zip(paper.columns(table), averages, strict=True):
                self.assertAlmostEqual(paper.mean(table, column), average, delta=last_digit, msg=(table, column))
        self.assertEqual(paper.against("II", "proposal dB", "DERS dB").text(), "+2.63 ± 1.35")
        self.assertAlmostEqual(paper.time_ratio(), 0.27, delta=0.005)

    def test_columns_the_paper_lacks_are_empty(self) -> None:
        self.assertEqual(paper.mean_text("VI", "blocks 16"), "")
        self.assertEqual(paper.against_text("IV", 300, 100000), "")


class Figures(unittest.TestCase):
    def test_pairs_without_a_view_between_them_have_no_psnr(self) -> None:
        self.assertTrue(math.isnan(figures.psnr({"mean": {"psnrY": None}})))

    def test_errors_are_of_all_pixels_where_occlusions_are_unknown(self) -> None:
        known = {"depthError": {"allViews": {"all": {"bad1PxPercent": 9}, "non-occluded": {"bad1PxPercent": 5}}}}
        self.assertEqual(figures.bad_visible(known, "bad1PxPercent"), 5)
        del known["depthError"]["allViews"]["non-occluded"]
        self.assertEqual(figures.bad_visible(known, "bad1PxPercent"), 9)


class SceneSet(unittest.TestCase):
    def test_lists_share_no_seed_and_have_every_kind(self) -> None:
        tuning, final = scene_list("tuning"), scene_list("final")
        self.assertEqual(len({scene.seed for scene in tuning + final}), 40)
        for scenes in (tuning, final):
            self.assertEqual(len(scenes), 20)
            kinds = {"arc", "line", "grid", "irregular"}
            self.assertEqual({scene.kind for scene in scenes}, kinds)
            self.assertEqual({scene.kind for scene in of_size(scenes, "1024x768")}, kinds)
            self.assertGreaterEqual(len(sized(scenes, 640 * 480)), 8)
            self.assertEqual(len(sized(scenes, 1920 * 1080)), 20)


class Experiments(unittest.TestCase):
    def test_missing_programs_are_named(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            done = experiment("views", "--quick", "--bin", folder + "/no", "--work", folder + "/work")
            self.assertEqual(done.returncode, 1)
            self.assertIn("/no/depthfarm is missing", done.stderr)
            self.assertFalse((Path(folder) / "work").exists())

    def test_folders_without_published_sets_are_named(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            for data, complaint in ((folder + "/no", "is not a folder"), (folder, "has none of llff_fern")):
                done = experiment("methods", "--quick", "--bin", BINARIES, "--data", data)
                self.assertEqual(done.returncode, 1)
                self.assertIn(complaint, done.stderr)

    def test_unknown_names_are_refused(self) -> None:
        self.assertEqual(experiment("colours").returncode, 2)

    def test_quick_mode_writes_every_section_and_repeats_itself_from_what_is_there(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            arguments = ["all", "--quick", "--bin", BINARIES, "--work", folder + "/work", "--docs", folder + "/docs"]
            done = experiment(*arguments)
            self.assertEqual(done.returncode, 0, done.stderr)
            documents = Path(folder) / "docs"
            first = (documents / "experiments.md").read_text()
            for name in NAMES:
                self.assertIn(f"<!-- end {name} -->", first)
                self.assertIn(f"experiment.py {name} --quick", first)
            self.assertEqual(first.count("| two-pair SGBM |") - 4, len(NAMES))  # rates has it at four quantisers too
            self.assertNotIn("nan", first)
            plots = {path.name: path.read_bytes() for path in (documents / "images").iterdir()}
            self.assertEqual(sorted(plots), sorted(f"experiment-{name}.svg" for name in PLOTTED))
            made = sorted((Path(folder) / "work").iterdir())
            self.assertEqual(experiment(*arguments).returncode, 0)
            self.assertEqual((documents / "experiments.md").read_text(), first)
            self.assertEqual({path.name: path.read_bytes() for path in (documents / "images").iterdir()}, plots)
            self.assertEqual(sorted((Path(folder) / "work").iterdir()), made)


if __name__ == "__main__":
    BINARIES = sys.argv.pop(1)
    unittest.main()
