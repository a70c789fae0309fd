"""Shared-memory segments of DDS that killed processes left behind."""

import shutil
import subprocess
import sys
from pathlib import Path


def clean_shared_memory() -> None:
    """Remove segments that no living process uses; does nothing where Fast DDS's tool is not installed."""
    tool = shutil.which("fastdds", path=str(Path(sys.executable).parent)) or shutil.which("fastdds")
    if tool is not None:
        subprocess.run([tool, "shm", "clean"], check=False, capture_output=True, timeout=30.0)
