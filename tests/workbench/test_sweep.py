"""Sweeps: over every word, extended, with points that fail, and stopped."""

import numpy as np
import pytest
import xarray as xr
from gases import FAST, RADIAL, SHORT, my_gas, stored, sweep
from own_functions import imported

import granstudy as gs
from granstudy.runs import execute
from granstudy.trust.flags import Status

MAXWELLIAN = "maxwellian2d"


def is_held_by_a_file(ds):
    """Whether a file gives the dataset back, but for what a file says of itself."""
    gs.write_dataset(ds, "sweep.nc")
    read = gs.read_dataset("sweep.nc")
    assert ds.attrs.items() <= read.attrs.items()
    return read.drop_attrs(deep=False).identical(ds.drop_attrs(deep=False))


def check(ds, over):
    """What holds for every sweep: labelled dimensions, scalars where nothing varies, a file that holds it."""
    assert ds["temperature"].dims[: len(over)] == tuple(over)
    for name, values in over.items():
        assert ds[name].values.tolist() == values, name
        assert ds[name].attrs["long_name"] and ds[name].attrs["units"]
    assert (ds["status"] == Status.OK).all()
    for name, c in ds.coords.items():
        along = [dim for dim in c.dims if dim in over]
        assert name in over or not along or np.unique(c.values).size > 1, f"{name} does not vary"
    assert is_held_by_a_file(ds)


@pytest.mark.parametrize(
    ("scene", "over", "fixed"),
    [
        (MAXWELLIAN, {"e": [0.5, 0.7], "exponent": [0.0, 1.0]}, {}),
        (MAXWELLIAN, {"diffusion": [0.0, 0.05]}, {}),
        (MAXWELLIAN, {"strength": [0.1, 0.2]}, {}),
        (MAXWELLIAN, {"symmetry": ["inversion", "none"]}, {}),
        ("power_law2d", {"tail": [7.0, 8.0]}, {}),
        ("two_beams2d", {"separation": [1.0, 2.0]}, {"symmetry": "none"}),
        (MAXWELLIAN, {"A": [0.1, 0.2]}, {"restitution": "viscoelastic"}),
        (MAXWELLIAN, {"scene": ["bkw2d", MAXWELLIAN]}, {}),
        (MAXWELLIAN, {"N_rho": [3, 4], "M_cir": [4, 6]}, {}),
        (MAXWELLIAN, {"N": [8, 12]}, {}),
        (MAXWELLIAN, {"R": [6.0, 7.0]}, {}),
        (MAXWELLIAN, {"variant": ["full", "separate"]}, {}),
        (MAXWELLIAN, {"scheme": ["exponential", "rk3"]}, {"diffusion": 0.01}),
    ],
)
def test_every_word_can_be_swept(scene, over, fixed):
    ds = sweep(scene, FAST, over=over, **SHORT, **fixed)
    check(ds, over)
    # A scene in the hand takes the same words, and its runs are the same.
    if scene == MAXWELLIAN and "scene" not in over:
        again = sweep(gs.load_scene(scene), FAST, over=over, **SHORT, **fixed)
        assert again.identical(ds)


def test_the_temperature_of_a_density_does_not_hide_that_of_the_run():
    ds = sweep(MAXWELLIAN, RADIAL, over={"temperature": [1, 2]}, **SHORT)
    check(ds, {"initial_temperature": [1.0, 2.0]})
    assert ds["temperature"].isel(time=0).values == pytest.approx([1.0, 2.0], rel=1e-3)


def test_times_that_differ_lie_side_by_side():
    over = {"dt": [0.1, 0.05]}
    ds = sweep(MAXWELLIAN, RADIAL, over=over, t_final=0.1, e=0.5)
    check(ds, {"dt": [0.05, 0.1]})
    assert ds["time"].dims == ("dt", "output") and ds["outputs"].values.tolist() == [3, 2]
    assert ds["time"].sel(dt=0.1).values[:2].tolist() == [0.0, 0.1]
    assert np.isnan(ds["temperature"].sel(dt=0.1).values[2])
    ds = sweep(MAXWELLIAN, RADIAL, over={"t_final": [0.1, 0.2]}, dt=0.05, e=0.5)
    check(ds, {"t_final": [0.1, 0.2]})
    assert ds["time"].values == pytest.approx([0.0, 0.05, 0.1, 0.15, 0.2])
    assert ds["temperature"].notnull().sum("time").values.tolist() == [3, 5]
    ds = sweep(MAXWELLIAN, RADIAL, over={"time_rtol": [1e-3, 1e-4]}, t_final=0.1, e=0.5)
    check(ds, {"time_rtol": [1e-4, 1e-3]})


def test_ranges_are_written_as_in_study_files(computed):
    ds = sweep(MAXWELLIAN, RADIAL, over={"e": {"start": 0.5, "stop": 0.7, "step": 0.1}}, **SHORT)
    check(ds, {"e": [0.5, 0.6, 0.7]})
    log = {"start": 0.01, "stop": 1, "count": 3, "spacing": "log"}
    assert sweep(MAXWELLIAN, RADIAL, over={"strength": log}, **SHORT).sizes["strength"] == 3
    made = len(computed)
    again = sweep(MAXWELLIAN, RADIAL, over={"e": np.linspace(0.5, 0.7, 3).round(12)}, **SHORT)
    assert len(computed) == made and again.identical(ds)


def test_states_are_swept(computed):
    ds = sweep(MAXWELLIAN, RADIAL, over={"e": [0.5, 0.7]}, state="cooling", diffusion=0.0)
    assert ds["a2"].dims == ("e",) and (ds["a2"] > -0.2).all() and "time" not in ds
    assert is_held_by_a_file(ds)
    heated = sweep(MAXWELLIAN, RADIAL, over={"e": [0.5]}, state="heated", diffusion=0.05)
    assert float(heated["temperature"].isel(e=0)) > 0.0


def test_refinement_goes_up_until_each_point_settles(computed):
    ladder = {"N": [8, 12, 16, 24], "temperature": 1e-4, "a2": 1e-3}
    ds = sweep(
        MAXWELLIAN, None, over={"e": [0.5, 0.9]}, refine=ladder, method="radial", R=7.0, **SHORT
    )
    assert (ds["temperature_change"] <= 1e-4).all() and (ds["a2_change"] <= 1e-3).all()
    assert 4 <= len(computed) < 8 and (ds["status"] == Status.OK).all()
    stopped = sweep(
        MAXWELLIAN, over={"e": [0.5]}, refine={"N": [6, 8], "temperature": 1e-13},
        method="radial", R=7.0, **SHORT,
    )  # fmt: skip
    assert "add finer values to refine.N" in str(stopped["reason"].values[0])


# Functions of one's own


def test_arguments_of_an_own_density_are_swept_by_reference_and_by_scene(
    here, monkeypatch, computed
):
    module = imported(my_gas(here), monkeypatch)
    over = {"e": [0.5, 0.9], "ratio": [1, 2.0]}
    ds = sweep("my_gas.py:anisotropic", FAST, over=over, **SHORT)
    check(ds, over)
    assert len(computed) == 4
    anisotropy = ds["pressure"].sel(component="x", component_="x").isel(time=0)
    assert (anisotropy.sel(ratio=2.0) > 1.1 * anisotropy.sel(ratio=1.0)).all()
    by_scene = sweep(gs.load_scene(module.anisotropic), FAST, over=over, **SHORT)
    bound = sweep(gs.load_scene(module.anisotropic, ratio=5.0), FAST, over=over, **SHORT)
    assert len(computed) == 4, "the same gas was computed twice"
    for other in (by_scene, bound):
        assert other["run_key"].identical(ds["run_key"])


def test_arguments_of_an_own_law_are_swept(here, monkeypatch, computed):
    module = imported(my_gas(here), monkeypatch)
    over = {"kappa": [0.1, 0.3]}
    ds = sweep(MAXWELLIAN, FAST, over=over, restitution="my_gas.py:softening", **SHORT)
    check(ds, over)
    assert ds["restitution"].item() == "my_gas.py:softening"
    scene = gs.load_scene(MAXWELLIAN, restitution=module.softening)
    ways = [
        sweep(scene, FAST, over=over, **SHORT),
        sweep(gs.load_scene(MAXWELLIAN), FAST, over=over, restitution=module.softening, **SHORT),
        sweep(
            gs.load_scene(MAXWELLIAN), FAST, over=over, restitution="my_gas.py:softening", **SHORT
        ),
    ]
    assert len(computed) == 2
    for other in ways:
        assert other["run_key"].identical(ds["run_key"])


def test_scenes_laws_and_kernels_themselves_are_swept(here, monkeypatch):
    module = imported(my_gas(here), monkeypatch)
    laws = sweep(
        MAXWELLIAN, FAST, over={"restitution": [module.softening, module.hardening]}, **SHORT
    )
    check(laws, {"restitution": ["hardening", "softening"]})
    scenes = [module.anisotropic, gs.load_scene("bkw2d"), "maxwellian2d"]
    check(
        sweep(MAXWELLIAN, FAST, over={"scene": scenes}, **SHORT),
        {"scene": ["anisotropic", "bkw2d", "maxwellian2d"]},
    )
    kernels = [gs.VHS(0.0, 0.1), gs.VHS(1.0, 0.1)]
    ds = sweep(MAXWELLIAN, RADIAL, over={"kernel": kernels}, **SHORT)
    check(ds, {"kernel": list(map(repr, kernels))})
    velocities = sweep(MAXWELLIAN, FAST, over={"velocity": [(0, 0), (0.5, 0)]}, **SHORT)
    check(velocities, {"initial_velocity": ["(0.0, 0.0)", "(0.5, 0.0)"]})


def test_functions_of_one_name_are_told_apart_or_refused(here, computed):
    def law(kappa):
        return lambda v: 1.0 - kappa / (1.0 + v)

    with pytest.raises(ValueError, match=r"over\['restitution'\].*the same name.*lambda"):
        sweep(MAXWELLIAN, FAST, over={"restitution": [law(0.1), law(0.2)]}, **SHORT)
    scenes = [gs.load_scene(MAXWELLIAN, e=e) for e in (0.5, 0.7)]
    ds = sweep(MAXWELLIAN, RADIAL, over={"scene": scenes}, **SHORT)
    assert ds["scene"].values.tolist() == list(map(repr, scenes))
    assert ds["e"].dims == ("scene",) and ds["e"].values.tolist() == [0.5, 0.7]


def test_what_a_function_says_of_the_whole_scene_follows_its_arguments(here):
    source = """
        import granstudy as gs

        def gas(heating=0.0):
            return gs.load_scene("maxwellian2d", diffusion=heating, exponent=1.0, e=0.8)
    """
    my_gas(here, source=source)
    over = {"heating": [0.0, 0.1]}
    by_name = sweep("my_gas.py:gas", RADIAL, over=over, **SHORT)
    assert by_name["diffusion"].values.tolist() == [0.0, 0.1]
    by_scene = sweep(gs.load_scene("my_gas.py:gas"), RADIAL, over=over, **SHORT)
    assert by_scene["run_key"].identical(by_name["run_key"])
    other = sweep(gs.load_scene("my_gas.py:gas", e=0.5), RADIAL, over=over, **SHORT)
    assert other["e"].item() == 0.5 and other["diffusion"].values.tolist() == [0.0, 0.1]


def test_a_declared_symmetry_stays_while_arguments_vary(here):
    my_gas(here)
    over = {"ratio": [1.0, 2.0]}
    by_name = sweep("my_gas.py:anisotropic", FAST, over=over, symmetry="reflections", **SHORT)
    scene = gs.load_scene("my_gas.py:anisotropic", symmetry="reflections")
    by_scene = sweep(scene, FAST, over=over, **SHORT)
    assert by_scene["run_key"].identical(by_name["run_key"])


# One run for each point


def test_new_values_extend_what_is_there(computed):
    first = sweep(MAXWELLIAN, RADIAL, over={"e": [0.5, 0.7]}, **SHORT)
    assert len(computed) == 2
    more = sweep(MAXWELLIAN, RADIAL, over={"e": [0.5, 0.6, 0.7], "N": [12]}, **SHORT)
    assert [one.scene.restitution for one in computed[2:]] == [0.6]
    for e in (0.5, 0.7):
        assert (
            more["temperature"]
            .sel(e=e, N=12)
            .equals(first["temperature"].sel(e=e).assign_coords(N=12))
        )


def test_how_a_run_is_written_makes_no_second_run(computed):
    sweep(MAXWELLIAN, RADIAL, over={"exponent": [1], "e": [0.5]}, t_final=0.1, dt=0.05)
    ways = [
        sweep(MAXWELLIAN, RADIAL, over={"e": [0.5], "exponent": [1.0]}, dt=0.05, t_final=0.1),
        sweep(MAXWELLIAN, over={"e": [np.float64(0.5)]}, exponent=np.int64(1), method="radial", R=7,
              N=np.int32(12), scheme="rk3", **SHORT),
        sweep(gs.load_scene(MAXWELLIAN, exponent=1), RADIAL, over={"restitution": [0.5]}, **SHORT),
    ]  # fmt: skip
    assert len(computed) == 1
    assert len({way["run_key"].values.item() for way in ways}) == 1


def test_points_that_are_one_run_share_it(computed):
    """By method radial the nodes on the circle play no part in N = 12, R = 7, e = 0.5 but in its name."""
    ds = sweep(MAXWELLIAN, RADIAL, over={"save_every": [1, 2], "e": [0.5]}, t_final=0.05, dt=0.05)
    assert ds.sizes["save_every"] == 2 and len(computed) == 2


# What goes wrong


def failing(monkeypatch, errors):
    """Let runs of these restitutions fail; returns what was tried."""
    compute, tried = execute.execute, []

    def maybe(computation, *more):
        tried.append(computation.scene.restitution)
        if error := errors.get(computation.scene.restitution):
            raise error
        return compute(computation, *more)

    monkeypatch.setattr(execute, "execute", maybe)
    return tried


def test_a_point_that_fails_keeps_its_cause_and_the_rest_stays(here, monkeypatch):
    tried = failing(monkeypatch, {0.6: OverflowError("too large")})
    over = {"e": [0.5, 0.6, 0.7]}
    ds = sweep(MAXWELLIAN, RADIAL, over=over, **SHORT)
    assert ds["status"].values.tolist() == [Status.OK, Status.FAILED, Status.OK]
    assert ds["reason"].values.tolist() == ["", "OverflowError: too large", ""]
    assert ds["temperature"].notnull().all("time").values.tolist() == [True, False, True]
    assert ds["N"].dims == () and ds["e"].values.tolist() == over["e"]
    assert is_held_by_a_file(ds)
    # It is its own parameters' fault: it is kept, and not tried again.
    assert len(stored(here / "results")) == 3
    assert sweep(MAXWELLIAN, RADIAL, over=over, **SHORT).identical(ds) and len(tried) == 3


@pytest.mark.parametrize("first", [True, False])
def test_a_failure_of_the_machine_is_shown_and_not_kept(here, monkeypatch, first):
    lost = 0.5 if first else 0.7
    tried = failing(monkeypatch, {lost: MemoryError()})
    over = {"e": [0.5, 0.6, 0.7], "exponent": [0.0]}
    ds = sweep(MAXWELLIAN, RADIAL, over=over, **SHORT).squeeze()
    bad = ds.sel(e=lost)
    assert bad["status"] == Status.FAILED and bad["reason"].item() == "MemoryError"
    assert bad["temperature"].isnull().all()
    assert (ds["status"].drop_sel(e=lost) == Status.OK).all()
    assert ds["N"].dims == () and ds["N"].dtype == np.int64
    assert all(variable.dtype != object for variable in ds.variables.values())
    assert is_held_by_a_file(ds)
    assert len(stored(here / "results")) == 2
    monkeypatch.undo()
    monkeypatch.chdir(here)
    whole = sweep(MAXWELLIAN, RADIAL, over=over, **SHORT)
    assert (whole["status"] == Status.OK).all() and len(tried) == 3


def test_nothing_computed_is_an_error(monkeypatch):
    failing(monkeypatch, {0.5: MemoryError("none left")})
    with pytest.raises(RuntimeError, match="no point could be computed.*MemoryError: none left"):
        sweep(MAXWELLIAN, RADIAL, over={"e": [0.5]}, **SHORT)


def test_what_was_done_before_an_interrupt_stays_and_the_same_call_goes_on(here, monkeypatch):
    stop = {0.7: KeyboardInterrupt()}
    tried = failing(monkeypatch, stop)
    over = {"e": [0.5, 0.6, 0.7, 0.8]}
    with pytest.raises(KeyboardInterrupt, match="2 of 4 runs are done and kept"):
        sweep(MAXWELLIAN, RADIAL, over=over, **SHORT)
    assert len(stored(here / "results")) == 2
    stop.clear()
    ds = sweep(MAXWELLIAN, RADIAL, over=over, **SHORT)
    assert tried == [0.5, 0.6, 0.7, 0.7, 0.8] and (ds["status"] == Status.OK).all()


@pytest.mark.parametrize(
    ("over", "more", "told"),
    [
        ({"e": [0.5, 1.7]}, {}, "e=1.7: e=1.7: must be a number between 0 and 1"),
        ({"e": [0.5], "N": [12, 1]}, {}, "e=0.5, N=1: N=1: "),
        ({"ee": [0.5]}, {}, "ee=0.5: unknown field of scene .*did you mean 'e'"),
        ({"e": [0.5]}, {"exponnent": 1.0}, "unknown field .*did you mean 'exponent'"),
        ({"e": [0.5]}, {"dt": 0.03}, "e=0.5: dt=0.03: t_final=0.1 must be a whole number of steps"),
        ({"e": [0.5]}, {"restitution": 0.5}, "e=0.5: .*both say the same; give one"),
        ({"e": [0.5]}, {"e": 0.7}, "e=0.7: is in over too; give it once"),
        ({"e": []}, {}, r"over\['e'\]: is empty"),
        ({}, {}, "over={}: give at least one parameter"),
        ({"e": 0.5}, {}, r"over\['e'\]=0.5: must be a list of values, or a range"),
        ({"scene": "bkw2d"}, {}, r"over\['scene'\]='bkw2d': must be a list"),
        ({"e": [0.5, 0.5]}, {}, r"over\['e'\]=\[0.5, 0.5\]: has a value twice"),
        ({"N": [12, 12.0]}, {}, r"over\['N'\]=\[12, 12.0\]: has a value twice"),
        ({"e": {"start": 0, "stop": 1}}, {}, r"over\['e'\]: count, step: give one$"),
        ({"e": {"start": 0, "stopp": 1}}, {}, r"over\['e'\]: stop: .*; stopp: .*"),
        ({"e": [0.5]}, {"state": "warm"}, "unknown state 'warm': allowed are cooling, heated"),
        ({"e": [0.5]}, {"state": "cooling"}, "e=0.5: t_final, dt: not for a cooling state"),
        ({"N": [8, 12]}, {"refine": {"N": [8, 12]}}, "N: refine goes up its values"),
        ({"e": [0.5]}, {"refine": {"M": [8, 12]}}, "refine: 'M': must be N or R"),
        ({"e": [0.5]}, {"refine": {"N": [12]}}, "must be two or more increasing values"),
        ({"e": [0.5]}, {"name": "a/b"}, "name='a/b': must be letters"),
    ],
)
def test_bad_words_are_one_error_before_any_work(here, over, more, told, computed):
    fixed = {**SHORT, **more}
    with pytest.raises(ValueError, match=told) as caught:
        sweep(MAXWELLIAN, RADIAL, over=over, **fixed)
    assert "\n" not in str(caught.value)
    assert not computed and not (here / "results").exists()


def test_errors_of_scenes_in_the_hand_name_what_they_take():
    with pytest.raises(ValueError, match="ee=0.5: unknown parameter 'ee'.*temperature, velocity"):
        sweep(gs.load_scene(MAXWELLIAN), RADIAL, over={"ee": [0.5]}, **SHORT)
    with pytest.raises(ValueError, match="kernel, exponent: both say the same"):
        over = {"exponent": [1.0]}
        sweep(gs.load_scene(MAXWELLIAN), RADIAL, over=over, kernel=gs.VHS(1.0, 0.1), **SHORT)
    with pytest.raises(ValueError, match="solver: give one"):
        sweep(MAXWELLIAN, over={"e": [0.5]}, **SHORT)
    with pytest.raises(ValueError, match="t_final: must be given"):
        sweep(MAXWELLIAN, RADIAL, over={"e": [0.5]}, dt=0.05)


def test_densities_are_read_when_they_are_used():
    ds = sweep(MAXWELLIAN, RADIAL, over={"e": [0.5, 0.7]}, densities=True, save_every=1, **SHORT)
    assert ds["f"].dims[0] == "e" and ds["f"].chunks is not None
    assert float(ds["f"].sel(e=0.7).isel(snapshot=-1).max()) > 0.0
    assert isinstance(ds, xr.Dataset)
