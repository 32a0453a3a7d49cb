"""The pause of the search for garbage ends as it began."""

import gc

import pytest

from granstudy.support.garbage import paused_collection


@pytest.fixture(autouse=True)
def collection():
    before = gc.isenabled()
    yield
    (gc.enable if before else gc.disable)()


@pytest.mark.parametrize("collects", [True, False])
def test_it_pauses_and_goes_on_as_before(collects):
    (gc.enable if collects else gc.disable)()
    with paused_collection():
        assert not gc.isenabled()
    assert gc.isenabled() == collects


def test_it_goes_on_after_an_error():
    gc.enable()
    with pytest.raises(ZeroDivisionError), paused_collection():
        raise ZeroDivisionError
    assert gc.isenabled()
