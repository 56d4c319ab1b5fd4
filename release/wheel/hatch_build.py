"""Names the wheel by what it holds: programs for one kind of machine, and Python that any version of 3 runs."""

import os
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class Programs(BuildHookInterface):  # type: ignore[type-arg]
    """The tag of the wheel."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Before the wheel is written."""
        glibc = os.environ["CONVOY_GLIBC"].replace(".", "_")
        build_data["pure_python"] = False
        folder = os.path.join(self.root, "scripts")
        build_data["shared_scripts"] = {os.path.join(folder, name): name for name in sorted(os.listdir(folder))}
        build_data["tag"] = f"py3-none-manylinux_{glibc}_x86_64"
