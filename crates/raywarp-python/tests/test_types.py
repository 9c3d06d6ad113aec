"""The stubs are what is there. Needs mypy, and says so where it is missing."""

import subprocess
import sys

import pytest


def test_stubs_agree_with_the_package():
    pytest.importorskip("mypy")
    for words in (["mypy.stubtest", "raywarp"], ["mypy", "--strict", "-p", "raywarp"]):
        done = subprocess.run([sys.executable, "-m", *words], capture_output=True, text=True)
        assert done.returncode == 0, done.stdout
