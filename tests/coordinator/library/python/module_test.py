"""The Python module: a wall of known depth, options, progress, errors, Ctrl-C, and the same bits as depthfarm run.

usage: module_test.py MODULE-FOLDER PROGRAM-FOLDER
"""
import json
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy as np

MODULE_DIR, PROGRAM_DIR = sys.argv.pop(1), sys.argv.pop(1)
sys.path.insert(0, MODULE_DIR)
import depthfarm  # noqa: E402

WIDTH, HEIGHT, FOCAL, DEPTH = 96, 72, 100.0, 4.0
SMALL = dict(z_near=2, z_far=8, segments=300, levels=24)


def wall(dtype=np.uint8):
    """Three cameras in a row that look at a textured wall, and what each of them sees."""
    cameras, pictures = [], []
    for c in range(3):
        K = np.array([[FOCAL, 0, (WIDTH - 1) / 2], [0, FOCAL, (HEIGHT - 1) / 2], [0, 0, 1]])
        t = np.array([-0.12 * (c - 1), 0, 0])
        cameras.append({"name": f"cam{c}", "K": K, "R": np.eye(3), "t": t})
        y, x = np.mgrid[0:HEIGHT, 0:WIDTH]
        wx, wy = (x - K[0, 2]) / FOCAL * DEPTH - t[0], (y - K[1, 2]) / FOCAL * DEPTH
        rgb = [np.sin(9 * wx + i) * np.cos(7 * wy - i) + np.sin(23 * wx * wy) for i in range(3)]
        pictures.append((128 + 60 * np.stack(rgb, axis=-1)).astype(dtype))
    return cameras, pictures


class EstimateDepth(unittest.TestCase):
    def test_finds_a_wall(self):
        cameras, pictures = wall()
        depth = depthfarm.estimate_depth(cameras, [pictures], threads=2, **SMALL)
        self.assertEqual(len(depth), 1)
        self.assertEqual(len(depth[0]), 3)
        for of_camera in depth[0]:
            z = of_camera["z"]
            self.assertEqual((z.shape, z.dtype), ((HEIGHT, WIDTH), np.float32))
            middle = z[12:-12, 16:-16]
            self.assertGreater(np.mean(np.abs(middle - DEPTH) < 0.1 * DEPTH), 0.95)

    def test_arrays_of_any_layout_are_the_same_pictures(self):
        cameras, pictures = wall()
        plain = depthfarm.estimate_depth(cameras, [pictures], **SMALL)
        odd = [np.asfortranarray(pictures[0]), pictures[1][::-1][::-1], np.pad(pictures[2], ((0, 0), (5, 7), (0, 0)))[:, 5:-7]]
        again = depthfarm.estimate_depth(cameras, [odd], **SMALL)
        for a, b in zip(plain[0], again[0]):
            np.testing.assert_array_equal(a["z"], b["z"])

    def test_is_what_depthfarm_run_makes(self):
        with tempfile.TemporaryDirectory() as folder:
            scene = os.path.join(folder, "scene")
            run = lambda *words: subprocess.run([os.path.join(PROGRAM_DIR, "depthfarm"), *words], check=True, capture_output=True)
            run("scene", "arc", "-o", scene, "--cameras", "3", "--frames", "2", "--size", "160x120")
            run("run", scene + "/sequence.json", "-o", folder + "/out", "--workers", "1", "--no-cache", "--segments", "600", "--levels", "32")
            with open(scene + "/sequence.json") as file:
                sequence = json.load(file)
            with open(folder + "/out/depth.json") as file:
                manifest = json.load(file)
            cameras = [{k: c[k] for k in ("name", "K", "R", "t")} for c in sequence["cameras"]]
            frames = [[read_png(os.path.join(scene, c["images"][f])) for c in sequence["cameras"]] for f in range(2)]
            depth = depthfarm.estimate_depth(cameras, frames, z_near=sequence["zNear"], z_far=sequence["zFar"],
                                             reference=sequence.get("reference"), segments=600, levels=32)
            for c, camera in enumerate(manifest["cameras"]):
                near, far = camera["zNear"], camera["zFar"]
                for f, entry in enumerate(camera["files"]):
                    path = entry if isinstance(entry, str) else entry["path"]
                    code = read_png(os.path.join(folder, "out", path)).astype(np.float64)
                    inverse = 1 / far + (code - 1) / 65534 * (1 / near - 1 / far)
                    expected = np.where(code == 0, 0, 1 / inverse)
                    np.testing.assert_allclose(depth[f][c]["z"], expected, rtol=1e-6)

    def test_options_and_confidence(self):
        cameras, pictures = wall()
        depth = depthfarm.estimate_depth(cameras, [pictures], confidence=True, level_blocks=2, views="cam0,cam1",
                                         preset="fast", **SMALL)
        confidence = depth[0][0]["confidence"]
        self.assertEqual(confidence.shape, (HEIGHT, WIDTH))
        self.assertTrue((confidence >= 0).all() and (confidence <= 1).all())
        self.assertIsNone(depth[0][2]["z"])

    def test_progress_and_cancelling(self):
        cameras, pictures = wall()
        seen = []
        depthfarm.estimate_depth(cameras, [pictures] * 4, threads=1, progress=lambda *now: seen.append(now), **SMALL)
        self.assertTrue(seen)
        self.assertEqual([now[0] for now in seen], sorted(now[0] for now in seen))
        self.assertEqual(seen[0], (0, 0, 4))
        self.assertEqual(seen[-1], (1, 4, 4))
        self.assertEqual(depthfarm.estimate_depth(cameras, [pictures], progress=lambda *now: False, **SMALL), [])

        def fail(*_):
            raise KeyError("mine")
        with self.assertRaises(KeyError):
            depthfarm.estimate_depth(cameras, [pictures] * 4, progress=fail, **SMALL)

    def test_ctrl_c_interrupts(self):
        cameras, pictures = wall()
        timer = threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT))
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            depthfarm.estimate_depth(cameras, [pictures] * 200, threads=1, **SMALL)
        timer.join()

    def test_other_threads_run_meanwhile(self):
        cameras, pictures = wall()
        ticks, over = [], threading.Event()

        def tick():
            while not over.wait(0.005):
                ticks.append(time.monotonic())
        thread = threading.Thread(target=tick)
        thread.start()
        depthfarm.estimate_depth(cameras, [pictures] * 4, threads=1, **SMALL)
        over.set()
        thread.join()
        self.assertGreater(len(ticks), 5)

    def test_bad_input_is_a_value_error_that_says_what(self):
        cameras, pictures = wall()
        change = lambda **keys: [dict(cameras[0], **keys)] + cameras[1:]
        without_k = [{k: v for k, v in cameras[0].items() if k != "K"}] + cameras[1:]
        for arguments, expected in [
            ((cameras, [pictures[:2]]), "frame 0 has 2 pictures of 3 cameras"),
            ((cameras, [[pictures[0], pictures[1], pictures[2].astype(float)]]), "frame 0, camera 'cam2'"),
            ((cameras, [[pictures[0], pictures[1], pictures[2][:, :, :2]]]), "frame 0, camera 'cam2'"),
            ((cameras, [pictures, [p[1:] for p in pictures]]), "frame 1, camera 'cam0' is 96x71"),
            ((cameras, [["a", "b", "c"]]), "frame 0"),
            ((without_k, [pictures]), "camera 0 has no 'K'"),
            ((change(K=np.eye(2)), [pictures]), "camera 0: K"),
            ((change(t="here"), [pictures]), "camera 0: t"),
            ((change(distortion=1), [pictures]), "'distortion'"),
            ((change(name="a/b"), [pictures]), "a/b"),
            ((cameras, []), "no frames"),
        ]:
            with self.assertRaisesRegex(ValueError, expected):
                depthfarm.estimate_depth(*arguments, **SMALL)
        with self.assertRaisesRegex(ValueError, "there is no option 'levles'"):
            depthfarm.estimate_depth(cameras, [pictures], z_near=2, z_far=8, levles=3)
        with self.assertRaisesRegex(ValueError, "zNear"):
            depthfarm.estimate_depth(cameras, [pictures], z_near=9, z_far=8)
        with self.assertRaises(TypeError):
            depthfarm.estimate_depth(cameras, [pictures])

    def test_has_a_version_and_help(self):
        self.assertRegex(depthfarm.__version__, r"^\d+\.\d+\.\d+$")
        self.assertIn("x_cam = R @ X_world + t", depthfarm.estimate_depth.__doc__)


def read_png(path):
    """8-bit colour or 16-bit grey, by matplotlib's reader, back in integers."""
    import matplotlib.image
    picture = matplotlib.image.imread(path)
    return np.round(picture[..., :3] * 255).astype(np.uint8) if picture.ndim == 3 else np.round(picture * 65535).astype(np.uint16)


if __name__ == "__main__":
    unittest.main()
