"""Commands as they are typed in a folder of their own."""

import shlex
from pathlib import Path

import pytest
from click.testing import CliRunner

from granstudy.commands.main import granstudy

STUDY = """
title: Cooling
experiments:
  cooling:
    title: cooling
    run: evolution
    scene: {name: maxwellian2d, diffusion: 0.0}
    solver: {method: radial, N: 12, R: 7.0}
    time: {t_final: 0.1, dt: 0.05}
    sweep:
      - e: [0.5, 0.7]
    table: {quantity: temperature}
"""


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    """A folder with a study file in it."""
    monkeypatch.chdir(tmp_path)
    Path("mine.yaml").write_text(STUDY)
    return tmp_path


@pytest.fixture
def type_():
    """Type a line after `granstudy`; returns exit status and output."""

    def typed(line):
        result = CliRunner().invoke(granstudy, shlex.split(line))
        assert result.exception is None or isinstance(result.exception, SystemExit), (
            result.exception
        )
        assert "Traceback" not in result.output
        return result.exit_code, result.output

    return typed
