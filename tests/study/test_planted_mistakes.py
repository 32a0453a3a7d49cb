"""Every planted mistake is told before any work, in a line with its field and value; nothing else is."""

import pytest
from planted_mistakes import NAMES, REQUESTS, STUDY, VALUES, planted

from granstudy.analysis.requests import check_requests


@pytest.fixture
def check(load, tmp_path):
    """Load and check the study with one thing in it changed, as the workflow does before any work."""

    def check(old="", new=""):
        study = load(text=planted(old, new) if old else STUDY)
        check_requests(study, tmp_path / "test.yaml")

    return check


def test_the_study_without_mistakes(check):
    check()


@pytest.mark.fault("C1", "C2")
@pytest.mark.parametrize(("old", "new", "message"), [*NAMES, *VALUES, *REQUESTS])
def test_a_mistake(check, recwarn, old, new, message):
    with pytest.raises(ValueError, match=message) as error:
        check(old, new)
    lines = str(error.value).splitlines()
    assert all("test.yaml: " in line and len(line) < 700 for line in lines)
    assert len(lines) <= 4
    assert not recwarn.list
