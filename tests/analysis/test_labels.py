"""What runs are called."""

from granstudy.analysis.labels import families


def test_tolerances_are_a_family_of_their_own(front):
    assert families(front) == ["literal", "fast", "fast, rtol", "fast, rtol", "fast"]


def test_runs_on_a_gpu_are_too(front):
    device = ["cpu", "cpu", "gpu", "gpu", "gpu"]
    swept = front.assign_coords(device=("run", device))
    names = ["literal", "fast", "fast, rtol, gpu", "fast, rtol, gpu", "fast, gpu"]
    assert families(swept) == names
    single = front.assign_coords(device="gpu", precision="single")
    assert families(single)[1:3] == ["fast, single, gpu", "fast, rtol, single, gpu"]
