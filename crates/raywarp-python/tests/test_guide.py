"""What docs/python.md shows runs as it stands there."""

import re
from pathlib import Path

import pytest
import raywarp

GUIDE = Path(__file__).parents[3] / "docs" / "python.md"
NEEDS_GPU = "# Needs torch and a GPU."


def has_gpu():
    try:
        import torch

        return torch.cuda.is_available() and raywarp.Scene("cuda") is not None
    except (ImportError, raywarp.DeviceError):
        return False


@pytest.mark.skipif(not GUIDE.exists(), reason="the guide is not beside the tests")
def test_the_guide_runs():
    blocks = re.findall(r"^```python\n(.*?)^```", GUIDE.read_text(), re.DOTALL | re.MULTILINE)
    assert len(blocks) >= 9
    names = {}
    for block in blocks:
        if NEEDS_GPU not in block or has_gpu():
            exec(compile(block, str(GUIDE), "exec"), names)
