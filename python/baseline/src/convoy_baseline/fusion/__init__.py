"""What several views say of the same ground becomes one."""

from convoy_baseline.fusion.attention import AxialFusion
from convoy_baseline.fusion.greatest import MaxFusion, greatest

__all__ = ["AxialFusion", "MaxFusion", "greatest"]
