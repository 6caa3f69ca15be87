"""Depth of cameras in a row: depth_of_pictures.py FOCAL BASELINE NEAR FAR cam0.png cam1.png ..."""
import sys

import depthfarm
import matplotlib.image
import numpy as np

focal, baseline, near, far = map(float, sys.argv[1:5])
pictures = [np.round(matplotlib.image.imread(name)[..., :3] * 255).astype(np.uint8) for name in sys.argv[5:]]
height, width = pictures[0].shape[:2]
K = [[focal, 0, (width - 1) / 2], [0, focal, (height - 1) / 2], [0, 0, 1]]
cameras = [{"K": K, "R": np.eye(3), "t": [-baseline * i, 0, 0]} for i in range(len(pictures))]

depth = depthfarm.estimate_depth(cameras, [pictures], z_near=near, z_far=far,
                                 progress=lambda done, *_: print(f"\r{done:.0%}", end="", file=sys.stderr))
for i, of_camera in enumerate(depth[0]):
    np.save(f"cam{i}.npy", of_camera["z"])
    matplotlib.image.imsave(f"cam{i}-depth.png", 1 / np.maximum(of_camera["z"], near), cmap="turbo")
