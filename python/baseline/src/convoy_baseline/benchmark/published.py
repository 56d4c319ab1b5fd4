"""The rows of the paper's three tables: SimBEV2X, test split, vehicles and RSUs, on one RTX 4090."""

from __future__ import annotations

MODELS = (
    "bevfusion-c", "coopdet3d-c", "cobevfusion-c", "bevfusion-l", "coopdet3d-l", "cobevfusion-l", "bevfusion", "coopdet3d", "cobevfusion",
)  # fmt: skip
"""In the order of the tables."""
NAMES = {
    "bevfusion": "BEVFusion", "coopdet3d": "CoopDet3D", "cobevfusion": "CoBEVFusion",
}  # fmt: skip
BOX_CLASSES = (
    "traffic_light", "traffic_sign", "pedestrian", "car", "truck", "bus", "motorcycle", "bicycle", "traffic_cone", "barrier",
)  # fmt: skip
MASK_CLASSES = (
    "road", "hazard", "road_line", "sidewalk", "crosswalk", "traffic_cone", "barrier", "car", "truck", "bus", "motorcycle", "bicycle",
    "rider", "pedestrian",
)  # fmt: skip

# mAP, easy, medium, hard, mATE, mAOE, mASE, mAVE, SDS, FPS, GB.
DETECTION = """
25.8 40.6 12.6 5.8 0.797 0.481 0.250 1.210 31.3 30.1 3.4
24.2 35.5 10.9 9.1 0.801 0.577 0.261 1.248 29.1 27.2 3.9
11.1 14.0 3.7 5.4 0.848 0.650 0.282 1.352 20.8 23.2 3.9
63.9 89.1 73.3 25.6 0.272 0.353 0.205 0.373 66.9 6.7 13.8
74.1 85.8 75.8 48.5 0.288 0.339 0.194 0.373 72.1 6.4 14.8
76.1 89.2 78.6 51.7 0.255 0.303 0.198 0.349 74.2 5.2 15.2
65.4 86.2 73.3 28.8 0.300 0.384 0.236 0.403 66.2 5.9 15.7
74.2 85.5 76.0 47.8 0.289 0.323 0.191 0.364 72.5 5.4 16.2
76.2 90.1 79.7 51.3 0.247 0.306 0.196 0.333 74.6 4.6 16.8
"""
# Of BOX_CLASSES.
BY_CLASS = """
25.6 15.4 24.4 49.3 43.3 42.6 26.7 11.5 13.5 5.6
20.7 9.7 26.6 49.4 35.4 34.7 30.3 15.7 12.9 6.7
10.1 1.6 10.7 44.9 11.0 16.8 6.3 1.7 6.4 1.6
51.5 67.2 72.1 75.9 77.4 83.3 68.3 62.0 44.4 36.6
67.6 75.8 88.6 90.1 85.0 86.1 80.7 78.3 48.3 40.9
72.2 82.2 89.4 91.4 86.4 87.1 82.9 79.4 48.7 41.0
48.0 67.4 72.1 83.2 78.2 84.2 67.9 64.6 48.7 40.2
68.4 76.2 87.9 89.9 84.7 86.0 79.5 76.0 50.8 42.4
72.8 81.9 89.1 91.4 86.8 88.0 82.3 78.2 50.6 41.0
"""
# Of MASK_CLASSES; mIoU at 0.5, 0.7, 0.9; rings at 0.5; FPS, GB.
MASKS = """
84.3 8.2 43.4 61.9 41.9 0.0 0.0 27.4 13.0 13.4 0.1 0.0 0.0 0.0 21.0 16.7 10.5 32.2 21.2 12.6 37.5 3.4
85.3 9.5 39.8 62.6 42.3 0.0 0.0 33.7 7.3 4.6 0.2 0.0 0.0 0.0 20.4 15.9 9.9 28.6 20.3 14.5 32.7 3.9
85.2 9.7 39.7 60.1 41.7 0.0 0.0 34.9 9.7 11.4 0.1 0.0 0.0 0.0 21.0 16.5 10.3 30.5 21.0 14.1 27.1 3.9
84.4 39.0 51.8 70.8 48.0 5.7 3.0 66.1 61.0 70.0 24.6 6.0 17.8 11.9 40.0 29.1 15.1 52.5 43.5 27.2 7.0 13.6
87.5 46.2 52.6 76.9 50.9 4.2 3.1 69.8 63.0 70.0 26.2 9.1 16.6 9.3 41.8 29.0 13.6 50.0 44.6 33.0 6.9 14.2
90.3 39.3 55.1 80.2 51.9 2.9 4.7 73.3 67.6 74.0 30.8 17.6 23.7 19.1 45.0 34.2 20.6 52.0 47.9 36.9 6.2 14.2
86.3 44.4 55.0 75.0 52.3 8.1 3.0 67.7 63.2 72.2 27.7 11.9 22.1 15.0 43.1 32.1 18.0 55.5 46.8 30.5 6.2 15.4
88.9 47.1 53.1 76.5 49.6 3.0 4.3 70.9 65.5 71.6 27.8 7.1 18.9 12.2 42.6 30.2 15.5 50.6 45.2 34.1 5.9 16.5
90.7 42.6 55.8 81.0 54.2 3.4 5.3 74.8 69.2 75.0 34.3 23.2 27.4 27.4 47.4 36.2 22.5 56.3 50.0 38.5 5.5 16.4
"""


def rows(table: str) -> list[list[str]]:
    """Cells of a table, a row for each of MODELS."""
    return [line.split() for line in table.strip().splitlines()]


def name_of(model: str) -> str:
    """As the paper writes it: CoBEVFusion-L."""
    kind, _, by = model.partition("-")
    return NAMES.get(kind, kind) + (f"-{by.upper()}" if by else "")
