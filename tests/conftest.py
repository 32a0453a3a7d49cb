"""Floating-point errors are errors in every test (code that Numba compiled is not affected)."""

import dask
import numpy as np
import pytest
from studies import Package, load_text, replaced

from granstudy.support import fingerprint

np.seterr(all="raise", under="ignore")

# netCDF4 under Dask's threads crashed once in some hundred runs; the tests must not.
dask.config.set(scheduler="synchronous")


@pytest.fixture(scope="session", autouse=True)
def cache(tmp_path_factory):
    """A cache folder of the tests' own, for the processes they start too."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("GRANSTUDY_CACHE", str(tmp_path_factory.mktemp("cache")))
        yield


@pytest.fixture
def exact_sinc(monkeypatch):
    """`literal` and the circular `direct` without the paper's shift of sinc, an error of 1e-8."""
    monkeypatch.setattr("granstudy.velocity.sphere.PAPER_SHIFT", 0.0)


@pytest.fixture
def load(request, tmp_path):
    """Load a test file's `STUDY`, or other text, with something in it replaced."""

    def load(old="", new="", text=None):
        text = request.module.STUDY if text is None else text
        return load_text(tmp_path, replaced(text, old, new))

    return load


@pytest.fixture
def package(tmp_path, monkeypatch):
    """A copy of the package, for fingerprints to read and tests to edit."""
    copy = Package(tmp_path)
    monkeypatch.setattr(fingerprint, "PACKAGE", copy.path)
    copy.forget()
    yield copy
    copy.forget()
