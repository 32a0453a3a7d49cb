import dataclasses
import hashlib
import json
import pickle
from pathlib import Path

import numpy as np
import pytest

import granstudy as gs
from granstudy.model import solver as solver_module
from granstudy.model.methods import METHODS
from granstudy.model.solver import SizedSolver
from granstudy.quadrature import radial, sphere
from granstudy.support.machine import cores


def test_the_paper_is_the_default():
    solver = gs.Solver(N=32, R=7.0)
    assert (solver.N_rho, solver.M_sph, solver.M_cir) == (30, 32, 30)
    assert (solver.variant, solver.method) == ("separate", "fast")
    assert (solver.sphere_rule, solver.radial_rule) == ("design", "legendre")


def test_grid():
    assert gs.Solver(N=8, R=5.0).grid(3) == gs.VelocityGrid(3, 8, 5.0)


@pytest.mark.fault("B1")
def test_numbers_of_numpy_become_numbers_of_python():
    given = gs.Solver(
        N=np.int64(16), R=np.float32(7), N_rho=np.int16(8), M_sph=(np.int64(6), np.int64(8)),
        sphere_rule="gauss-theta-phi", dealias=np.False_, threads=np.int64(1),
    )  # fmt: skip
    plain = gs.Solver(16, 7, N_rho=8, M_sph=[6, 8], sphere_rule="gauss-theta-phi", threads=1)
    assert json.dumps(given.describe()) == json.dumps(plain.describe())
    assert given.describe()["R"] == 7.0 and type(given.R) is float
    particles = gs.Solver(16, 7.0, method="dsmc", particles=np.int64(400), seed=np.int64(3))
    json.dumps(particles.describe())
    json.dumps(gs.Solver(16, 7.0, rtol=np.float64(1e-3)).describe())


def test_threads_change_no_description():
    assert gs.Solver(8, 5.0, threads=1).describe() == gs.Solver(8, 5.0, threads=3).describe()
    assert "threads" not in gs.Solver(8, 5.0).describe()
    assert gs.Solver(8, 5.0, threads=3).thread_count == 3
    assert gs.Solver(8, 5.0).thread_count == cores()


def test_the_device_is_described_where_it_is_not_the_cpu():
    assert gs.Solver(8, 5.0, device="gpu").describe()["device"] == "gpu"
    assert "device" not in gs.Solver(8, 5.0, device="cpu").describe()


def test_a_tolerance_takes_the_place_of_sizes():
    solver = gs.Solver(8, 5.0, rtol=1e-3)
    assert solver.describe()["rtol"] == 1e-3
    assert not {"N_rho", "M_sph", "sphere_rule"} & set(solver.describe())
    assert "rtol" not in gs.Solver(8, 5.0).describe()


def test_a_sized_solver_is_the_same_solver():
    solver = gs.Solver(8, 5.0, method="radial")
    sized = solver.sized()
    assert isinstance(sized, SizedSolver) and sized.sized() is sized
    assert solver == sized and hash(solver) == hash(sized)
    assert solver.describe() == sized.describe()
    assert solver != gs.Solver(8, 5.0)


def test_an_open_solver_has_no_size():
    with pytest.raises(ValueError, match="N=None: choose N and R first"):
        gs.Solver(rtol=1e-3).sized()
    with pytest.raises(ValueError, match="N=None: choose N and R first"):
        gs.Solver(rtol=1e-3).grid(2)


def test_every_field_is_explained():
    for field in dataclasses.fields(gs.Solver):
        assert field.metadata["help"], field.name


def test_methods_name_fields_of_the_solver():
    fields = {field.name for field in dataclasses.fields(gs.Solver)}
    for name, method in METHODS.items():
        assert method.takes | method.unused <= fields, name


@pytest.mark.fault("A5")
def test_a_file_of_directions_is_described_by_its_content(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = Path("nodes.txt")
    made = []
    for text in ("1 0 0\n", "0 1 0\n"):
        path.write_text(text)
        made.append(gs.Solver(8, 5.0, M_sph=1, sphere_rule="nodes.txt"))
    path.unlink()
    digests = [hashlib.sha256(text).hexdigest() for text in (b"1 0 0\n", b"0 1 0\n")]
    assert [solver.describe()["sphere_rule_sha256"] for solver in made] == digests
    assert made[0] != made[1] and hash(made[0]) != hash(made[1])
    assert pickle.loads(pickle.dumps(made[0])) == made[0]


@pytest.mark.parametrize("settings", [{}, {"sphere_rule": "lebedev"}, {"sphere_rule": "none.txt"}])
def test_other_rules_have_no_content(tmp_path, monkeypatch, settings):
    monkeypatch.chdir(tmp_path)
    Path("lebedev").write_text("a file that no rule is read from")
    assert "sphere_rule_sha256" not in gs.Solver(8, 5.0, M_sph=6, **settings).describe()


def test_rules_have_one_list_of_names():
    assert solver_module.SPHERE_RULES == sphere.SPHERE_RULES
    assert solver_module.RADIAL_RULES == radial.RADIAL_RULES
