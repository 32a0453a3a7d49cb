"""Time settings that are refused: the message names the field, the value and what is allowed."""

import pytest

import granstudy as gs

GOOD_SOLVER = {"N": 8, "R": 7.0}


@pytest.mark.parametrize(
    ("time", "message"),
    [
        ({"t_final": 1.0, "dt": 0.3}, "t_final=1.0 must be a whole number of steps"),
        ({"t_final": -1.0, "dt": 0.1}, "t_final=-1.0: must be a positive number"),
        ({"t_final": 1.0, "dt": [0.1]}, r"dt=\[0.1\]: must be a positive number"),
        ({"t_final": 1.0, "dt": 0.1, "save_every": 0}, "save_every=0"),
        ({"t_final": 1.0}, "dt=None, time_rtol=None: give one"),
        ({"t_final": 1.0, "dt": 0.1, "time_rtol": 1e-6}, "dt=0.1, time_rtol=1e-06: give one"),
        ({"t_final": 1.0, "time_rtol": 2.0}, "time_rtol=2.0: must be a number between 1e-13 and 1"),
        ({"t_final": 1.0, "time_rtol": "1e-6"}, "time_rtol='1e-6': must be a positive number"),
        ({"t_final": 1.0, "dt": 0.1, "times": [0.5]}, r"times=\[0.5\]: only with time_rtol"),
        ({"t_final": 1.0, "time_rtol": 1e-6, "times": [0.5, 0.2]}, "must be positive and increase"),
        ({"t_final": 1.0, "time_rtol": 1e-6, "times": [0.0, 0.2]}, "must be positive and increase"),
        ({"t_final": 1.0, "time_rtol": 1e-6, "times": [0.5, 2.0]}, "the last must be t_final=1.0"),
        ({"t_final": 1.0, "dt": 0.1, "frame": "scaled"}, "unknown frame 'scaled'.*'rescaled'"),
        ({"t_final": 1.0, "dt": 0.1, "scheme": "rk4"}, "unknown scheme 'rk4'.*'rk3'"),
        ({"t_final": 1.0, "dt": 0.1, "conserve": "mass"}, "conserve='mass': must be a sequence"),
        (
            {"t_final": 1.0, "dt": 0.1, "conserve": ["masss"]},
            "unknown invariant in conserve 'masss'",
        ),
    ],
)
def test_times(time, message):
    with pytest.raises(ValueError, match=message):
        gs.simulate(gs.load_scene("bkw2d", restitution=0.5), gs.Solver(**GOOD_SOLVER), **time)


def test_a_tolerance_where_the_frame_scales_the_restitution():
    scene = gs.load_scene("bkw2d", restitution=gs.Viscoelastic(0.1))
    solver = gs.Solver(N=16, R=7.0, rtol=1e-2)
    with pytest.raises(ValueError, match="rtol=0.01: not where a rescaled frame changes the scale"):
        gs.simulate(scene, solver, t_final=1.0, dt=0.1, frame="rescaled")


def test_a_restitution_that_leaves_its_range_where_the_first_interpolation_needs_it():
    scene = gs.load_scene("bkw2d", restitution=lambda v: 1.0 - v / 7.5)
    with pytest.raises(ValueError, match="impact speeds up to 8.9"):
        gs.simulate(scene, gs.Solver(**GOOD_SOLVER), t_final=1.0, dt=0.1, frame="rescaled")
