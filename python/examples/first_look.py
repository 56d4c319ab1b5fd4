# ---
# jupyter:
#   jupytext:
#     text_representation: {extension: .py, format_name: percent}
# ---
# %% [markdown]
# # A first look at a dataset
#
# Open this file as a notebook with jupytext (`jupytext --to notebook first_look.py`) or in an editor that knows
# cells, or run it. It wants `pip install 'python[plots]' pandas` and a store called `dataset` (`convoy demo --out dataset`).

# %%
import matplotlib

if not hasattr(__builtins__, "__IPYTHON__"):
    matplotlib.use("Agg")  # outside a notebook: no windows
import convoy

dataset = convoy.Dataset("dataset")
print(dataset.summary())

# %% [markdown]
# A scene is a sequence of frames, 20 a second. A frame has agents, an agent has sensors.

# %%
scene = dataset.scenes()[0]
frame = scene[len(scene) // 20 * 10]
ego = frame.agent("vehicle_0")
print(scene, frame, ego, ego.sensors, sep="\n")

# %% [markdown]
# Who saw what: blue boxes were seen by the ego, orange ones by others only, grey ones by nobody.

# %%
frame.plot_bev("vehicle_0", radius_m=60).figure.savefig("above.png")
ego.plot_cameras()
print(ego.boxes(valid=True))

# %% [markdown]
# What do partners add? Objects that the ego did not see, by class and distance.

# %%
heard = frame.cooperative("vehicle_0", mode="x2x")
boxes = frame.boxes(valid=True).transformed(convoy.invert(ego.pose))
seen = heard.seen_by(boxes.id)
table = boxes.to_pandas().assign(by_ego=seen[0], by_partners=seen[1:].any(axis=0))
table["distance_m"] = (table.x_m**2 + table.y_m**2) ** 0.5
print(heard)
print(table[table.by_partners & ~table.by_ego].groupby("class").distance_m.describe()[["count", "min", "max"]])

# %% [markdown]
# Over all scenes: how long objects were in sight. Ids are unique within a scene only, so there is a column `scene`.

# %%
tracks = dataset.to_pandas("tracks")
print(tracks.groupby("class").size().sort_values(ascending=False))
