"""Models of cooperative perception on Convoy's datasets, in plain PyTorch: lidar and cameras, max or attention fusion, boxes and masks.

python -m convoy_baseline.train --store dataset --mode x2x --out model.pt
python -m convoy_baseline.predict --store dataset --model model.pt --modes none,x2x --out predictions.parquet
python -m convoy_baseline.benchmark --plan python/baseline/benchmark.toml --store benchmark-store --out benchmark
"""

__version__ = "0.1.0"
