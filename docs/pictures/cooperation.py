"""Draws docs/pictures/cooperation.jpg: points of all agents from above, and what two of them see by camera.

    convoy run --config docs/pictures/cooperation.toml --store STORE
    python docs/pictures/cooperation.py STORE docs/pictures/cooperation.jpg [SCENE FRAME EGO CAMERA OTHER CAMERA]

Needs the package with its plots: pip install 'python[plots]'.
"""

import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import convoy

STORE, OUT, *CHOSEN = sys.argv[1:]
SCENE, FRAME, EGO, CAMERA, OTHER, OTHER_CAMERA = CHOSEN or (0, 80, "vehicle_4", "CAM_BACK", "rsu_0", "CAM_FRONT_RIGHT")

frame = convoy.Dataset(STORE).scene(int(SCENE)).frame(int(FRAME))
figure = plt.figure(figsize=(16, 9), layout="constrained")
axes = figure.subplot_mosaic([["above", "ego"], ["above", "other"]], width_ratios=[9, 7])
frame.plot_bev(EGO, radius_m=50, ax=axes["above"])
frame.agent(EGO).plot_cameras([CAMERA], axes=[axes["ego"]])
frame.agent(OTHER).plot_cameras([OTHER_CAMERA], axes=[axes["other"]])
axes["ego"].set_title(f"{EGO} {CAMERA}, the ego: what the bus hides from it is orange")
figure.savefig(OUT, dpi=90, pil_kwargs={"quality": 80, "optimize": True, "progressive": True})
