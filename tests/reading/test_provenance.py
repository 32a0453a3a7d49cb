"""The gas and the solver come back from a file, from many runs, and of the user's own code only when told."""

import numpy as np
import pytest
import xarray as xr
from own_functions import imported

import granstudy as gs

SOLVER = gs.Solver(N=12, R=7.0, method="radial")
SHORT = {"t_final": 1e-3, "dt": 5e-4, "progress": False}


def run(name="maxwellian2d", solver=SOLVER, **words):
    return gs.simulate(gs.load_scene(name, **words), solver, **SHORT)


def test_scene_kernel_and_solver_of_a_run(tmp_path):
    scene = gs.load_scene(
        "two_beams3d", separation=2.5, exponent=0.4, restitution="viscoelastic", A=0.1
    )
    solver = gs.Solver(N=8, R=7.0, N_rho=4, M_sph=6)
    gs.write_dataset(gs.simulate(scene, solver, **SHORT), tmp_path / "run.nc")
    ds = gs.read_dataset(tmp_path / "run.nc").granular
    assert ds.scene == scene and ds.scene.symmetry == scene.symmetry
    assert ds.kernel == scene.kernel
    assert ds.solver.describe() == solver.describe()
    np.testing.assert_array_equal(
        ds.scene.density(gs.VelocityGrid(3, 8, 7.0)), scene.density(gs.VelocityGrid(3, 8, 7.0))
    )


def test_one_of_many_runs_is_known_by_its_coordinates(tmp_path):
    for e in (0.5, 0.9):
        for N in (12, 16):
            solver = gs.Solver(N=N, R=7.0, method="radial")
            gs.write_dataset(
                run(solver=solver, e=e, exponent=e, temperature=2.0), tmp_path / f"{e}{N}.nc"
            )
    runs = gs.unstack_runs(gs.open_runs(tmp_path).isel(run=[0, 3]), ["e"])
    with pytest.raises(ValueError, match="scene: the runs differ in e, exponent; select one"):
        _ = runs.granular.scene
    with pytest.raises(ValueError, match="solver: the runs differ in N; select one"):
        _ = runs.granular.solver
    one = runs.sel(e=0.9).granular
    assert one.scene == gs.load_scene("maxwellian2d", e=0.9, exponent=0.9, temperature=2.0)
    assert one.solver.N == 16 and one.solver.method == "radial" and one.solver.rtol is None
    assert [k.exponent for k in runs.granular.kernel.values] == [0.5, 0.9]


BEAM = "def beam(vx, vy, width=1.0):\n    return 1.0 / (1.0 + (vx**2 + vy**2) / width) ** 4\n"


def test_code_of_a_user_runs_only_when_told(tmp_path, monkeypatch):
    (tmp_path / "beams.py").write_text(BEAM)
    gas = imported(tmp_path / "beams.py", monkeypatch)
    scene = gs.load_scene(gas.beam, width=2.0)
    solver = gs.Solver(N=8, R=7.0, N_rho=4, M_cir=4)
    ds = gs.simulate(scene, solver, **SHORT)
    with pytest.raises(ValueError, match="holds code of its user"):
        _ = ds.granular.scene
    assert ds.granular.load_scene(run_code=True).density(
        gs.VelocityGrid(2, 8, 7.0)
    ) == pytest.approx(scene.density(gs.VelocityGrid(2, 8, 7.0)))


def test_what_is_no_run_is_told():
    for name in ("scene", "solver", "kernel"):
        with pytest.raises(ValueError, match="the dataset"):
            getattr(gs.Granular(xr.Dataset({"a": 1.0})), name)
