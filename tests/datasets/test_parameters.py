"""What datasets say of their parameters, the user's own arguments among them."""

import numpy as np
import pytest
from own_functions import in_notebook

import granstudy as gs
from granstudy.datasets.parameters import ABSENT, PARAMETERS, parameter
from granstudy.model.identity import VARIABLES

RADIAL = {"N": 8, "R": 7.0, "method": "radial"}


def runs():
    gas = gs.load_scene("maxwellian2d", e=0.5, diffusion=0.0, exponent=1.0)
    times = {"t_final": 0.2, "dt": 0.1, "save_every": 1, "progress": False}
    fixed = gs.Solver(N=8, R=7.0, N_rho=4, M_cir=4)
    yield gs.simulate(gas, fixed, **times)
    yield gs.simulate(gas, fixed, frame="rescaled", **times)
    yield gs.simulate(gas, gs.Solver(**RADIAL), frame="rescaled", **times)
    particles = gs.Solver(N=8, R=7.0, method="dsmc", particles=400, batches=4)
    yield gs.simulate(gas, particles, **times | {"save_every": None})
    yield gs.cooling_state(gas, gs.Solver(N=16, R=7.0, method="radial"))


def test_no_argument_takes_the_name_of_a_variable():
    for ds in runs():
        own = {str(name) for name in [*ds.variables, *ds.dims]} - PARAMETERS.keys()
        derived = ("_error", "_exact", "_estimate", "_by_batch")
        assert {name for name in own if not name.endswith(derived)} <= VARIABLES
        for name in PARAMETERS.keys() & ds.coords.keys():
            assert ds[name].attrs == PARAMETERS[name].attributes


def test_own_arguments_are_coordinates(tmp_path):
    cell = in_notebook(
        "import numpy as np\n"
        "def warm(vx, vy, temperature=1.0, wide_tail=0.0, u=(0.0, 0.0)):\n"
        "    return np.exp(-vx**2 / temperature - vy**2)\n"
        "law = lambda v, kappa: 1 - kappa * v\n"
    )
    scene = gs.load_scene(cell["warm"], temperature=2, restitution=cell["law"], kappa=0.01)
    solver = gs.Solver(N=8, R=7.0, N_rho=4, M_cir=4)
    ds = gs.simulate(scene, solver, t_final=0.1, dt=0.1, progress=False)
    gs.write_dataset(ds, tmp_path / "run.nc")
    back = gs.read_dataset(tmp_path / "run.nc")
    assert str(back["scene"].values) == "warm" and str(back["restitution"].values) == "lambda"
    assert (float(back["initial_temperature"]), float(back["kappa"])) == (2.0, 0.01)
    assert str(back["u"].values) == "(0.0, 0.0)"
    assert back["wide_tail"].attrs == {"long_name": "wide tail", "units": "1"}
    assert "e" not in back.coords
    assert "def warm" in back.attrs["source"] and "1 - kappa * v" in back.attrs["source"]
    opened = gs.open_runs([tmp_path / "run.nc"])
    assert opened["kappa"].attrs["long_name"] == "kappa"


def test_the_source_of_named_scenes_is_granstudys():
    ds = gs.simulate(gs.load_scene("maxwellian2d", e=0.5), gs.Solver(**RADIAL), t_final=0.1, dt=0.1)
    assert "source" not in ds.attrs
    assert list(ds.coords)[-1] and str(ds["scene"].values) == "maxwellian2d"


@pytest.mark.fault("C5")
def test_constant_and_viscoelastic_runs_open_together(tmp_path):
    solver = gs.Solver(N=8, R=7.0, N_rho=4, M_cir=4)
    for name, law in (("constant", {"e": 0.5}), ("law", {"restitution": "viscoelastic", "A": 0.1})):
        ds = gs.simulate(gs.load_scene("bkw2d", **law), solver, t_final=0.1, dt=0.1)
        gs.write_dataset(ds, tmp_path / f"{name}.nc")
    both = gs.open_runs(tmp_path)
    np.testing.assert_array_equal(both["e"], [0.5, np.nan])
    np.testing.assert_array_equal(both["A"], [np.nan, 0.1])
    assert both["restitution"].values.tolist() == ["", "viscoelastic"]


@pytest.mark.parametrize("name", PARAMETERS)
def test_every_parameter_says_what_it_is(name):
    assert PARAMETERS[name].long_name and PARAMETERS[name].units == "1"
    assert parameter(name) is PARAMETERS[name]


def test_absent_values_are_of_one_kind():
    for name, value in ABSENT.items():
        assert isinstance(value, float) or not PARAMETERS[name].real
    assert next(iter(PARAMETERS)) == "scene"
