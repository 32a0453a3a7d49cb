"""Runs computed anew from their own datasets."""

import math

import numpy as np
import pytest
from gases import FAST, RADIAL, SHORT, my_gas
from own_functions import imported, in_notebook

import granstudy as gs
from granstudy.model.own_functions import own_density
from granstudy.runs import execute
from granstudy.runs.computation import Computation, Refinement
from granstudy.runs.execute import obtain
from granstudy.runs.run_key import run_key
from granstudy.runs.store import Store
from granstudy.support.errors import DamagedFileError
from granstudy.workbench.verifying import verify_dataset

ADAPTIVE = {"t_final": 0.5, "time_rtol": 1e-4, "frame": "rescaled", "times": [0.1, 0.2]}
PARTICLES = gs.Solver(N=8, R=7.0, method="dsmc", particles=400, batches=4)


def scene(name="maxwellian2d", **words):
    return gs.load_scene(name, **{"e": 0.5, "diffusion": 0.0} | words)


def law(name="maxwellian2d", **words):
    return gs.load_scene(name, diffusion=0.0, **words)


def kept(computation):
    """The file of a run in a store."""
    store, key = Store.beside("results"), run_key(computation)
    assert obtain(computation, key, store).computed
    return store.path(key)


RUNS = {
    "radial": Computation("evolution", scene(), RADIAL, SHORT | {"save_every": 1}),
    "rescaled": Computation("evolution", scene(exponent=1.0), RADIAL, ADAPTIVE),
    "conserving": Computation(
        "evolution", scene(), FAST, SHORT | {"conserve": ("mass", "momentum")}
    ),
    "moving": Computation("evolution", scene(velocity=(0.5, 0.0), temperature=1.2), FAST, SHORT),
    "beams": Computation("evolution", scene("two_beams2d", separation=1.0), FAST, SHORT),
    "symmetry": Computation("evolution", scene("two_beams2d", symmetry="none"), FAST, SHORT),
    "viscoelastic": Computation("evolution", law(restitution="viscoelastic", A=0.1), FAST, SHORT),
    "kernel": Computation("evolution", scene(kernel=gs.VHS(0.5, 0.2)), RADIAL, SHORT),
    "particles": Computation("evolution", scene(), PARTICLES, SHORT),
    "open": Computation("evolution", scene(), gs.Solver(rtol=0.05, method="auto"), SHORT),
    "refined": Computation(
        "evolution", scene(), RADIAL, SHORT, refinement=Refinement("N", (8, 12, 16), 1e-3, 1e-3)
    ),
    "collision": Computation("collision", scene(), FAST),
    "pair of nodes": Computation(
        "collision",
        scene("bkw3d"),
        gs.Solver(N=8, R=7.0, N_rho=3, M_sph=(2, 4), sphere_rule="gauss-theta-phi"),
    ),
    "cooling state": Computation("cooling state", scene(), RADIAL),
    "heated state": Computation("heated state", scene(diffusion=0.05), RADIAL),
}


@pytest.mark.parametrize("name", RUNS)
def test_a_run_is_the_same_bit_for_bit(name):
    verdict = verify_dataset(kept(RUNS[name]))
    assert verdict.same_code and verdict.differences == {} and verdict.largest == 0.0


CELL = """
    import numpy as np
    import granstudy as gs

    WIDTH = 2.0

    def plain(vx, vy, ratio=1.0, widths=(1.0, 2.0)):
        return np.exp(-(vx**2) / (ratio * widths[0]) - vy**2 / WIDTH)

    def any_dimension(*v):
        return np.exp(-sum(x**2 for x in v))

    def maker(ratio: float = 1.0) -> "density":
        return lambda vx, vy: np.exp(-(vx**2) / ratio - vy**2)

    def whole_gas(heating=0.1):
        return gs.load_scene("maxwellian2d", diffusion=heating, e=0.5)

    class Ring:
        dim = 2

        def __init__(self, radius):
            self.r = radius

        def __call__(self, vx, vy):
            return np.exp(-((np.sqrt(vx**2 + vy**2) - self.r) ** 2))

    def softening(v, kappa=0.1):
        return 1.0 / (1.0 + kappa * v)

    nameless = lambda vx, vy: np.exp(-(vx**2) - vy**2)
"""


@pytest.mark.parametrize(
    "made",
    [
        lambda own: scene(own["plain"], ratio=2.0, widths=[1.0, 3.0]),
        lambda own: gs.Scene(2, own["plain"], gs.maxwell(2), 0.5),
        lambda own: scene(own["any_dimension"], dim=2),
        lambda own: scene(own["maker"], ratio=2.0),
        lambda own: gs.load_scene(own["whole_gas"], heating=0.2),
        lambda own: gs.Scene(2, own["Ring"](1.0), gs.maxwell(2), 0.5),
        lambda own: gs.Scene(2, own_density(own["Ring"], {"radius": 1.0}), gs.maxwell(2), 0.5),
        lambda own: gs.Scene(2, own["nameless"], gs.maxwell(2), 0.5),
        lambda own: law(restitution=own["softening"], kappa=0.2),
        lambda own: law(own["plain"], restitution=own["softening"], ratio=2.0),
    ],
)
def test_code_of_the_user_runs_from_the_file_when_it_is_told_to(made):
    file = kept(Computation("evolution", made(in_notebook(CELL)), FAST, SHORT))
    with pytest.raises(ValueError, match="holds code of its user .*--run-code"):
        verify_dataset(file)
    verdict = verify_dataset(file, run_code=True)
    assert verdict.same_code and verdict.differences == {}


def test_a_gas_of_a_file_is_verified_without_the_file(here):
    path = my_gas(here)
    words = {"restitution": "my_gas.py:softening", "ratio": 2.0, "kappa": 0.2}
    file = kept(Computation("evolution", law("my_gas.py:anisotropic", **words), FAST, SHORT))
    path.unlink()
    assert verify_dataset(file, run_code=True).differences == {}


def test_a_changed_number_is_found_and_measured():
    file = kept(RUNS["radial"])
    ds = gs.read_dataset(file)
    ds["temperature"][1] *= 1.0 + 1e-6
    gs.write_dataset(ds, file)
    verdict = verify_dataset(file)
    assert list(verdict.differences) == ["temperature"]
    assert verdict.largest == pytest.approx(1e-6, rel=1e-2)


@pytest.mark.parametrize("change", ["hole", "shape", "word", "gone", "parameter"])
def test_what_cannot_be_compared_differs(change):
    file = kept(RUNS["radial"])
    ds = gs.read_dataset(file)
    if change == "hole":
        ds["a2"][1] = np.nan
    elif change == "shape":
        ds = ds.isel(time=slice(1))
    elif change == "word":
        ds["status"].attrs["reason"] = "it was late"
    elif change == "gone":
        ds = ds.drop_vars("a2")
    else:
        ds = ds.assign_coords(N=13)
    gs.write_dataset(ds, file)
    assert verify_dataset(file).largest == (1 / 13 if change == "parameter" else math.inf)


def test_the_code_that_changed_since_is_told(monkeypatch):
    file = kept(RUNS["radial"])
    gs.write_dataset(gs.read_dataset(file).assign_attrs(run_key="0" * 32), file)
    verdict = verify_dataset(file)
    assert not verdict.same_code and verdict.differences == {}


def test_a_failed_run_is_the_same_where_it_fails_again(monkeypatch):
    def fail(computation, *more):
        raise OverflowError("too large")

    with monkeypatch.context() as patch:
        patch.setattr(execute, "execute", fail)
        file = kept(RUNS["radial"])
    with monkeypatch.context() as patch:
        patch.setattr("granstudy.workbench.verifying.execute", fail)
        assert verify_dataset(file).differences == {}
    assert verify_dataset(file).largest == math.inf


def test_files_that_are_damaged_or_say_too_little_are_told(here):
    file = kept(RUNS["radial"])
    content = bytearray(file.read_bytes())
    content[len(content) // 2] ^= 1
    file.write_bytes(content)
    with pytest.raises(DamagedFileError):
        verify_dataset(file)
    ds = gs.simulate(scene(), RADIAL, progress=False, **SHORT)
    gs.write_dataset(ds, "own.nc")
    with pytest.raises(ValueError, match="no attribute 'parameters'"):
        verify_dataset("own.nc")


def test_an_edit_of_the_file_since_does_not_matter(here, monkeypatch):
    """What counts is the source in the dataset."""
    path = my_gas(here)
    module = imported(path, monkeypatch)
    file = kept(Computation("evolution", scene(module.anisotropic, ratio=2.0), FAST, SHORT))
    path.write_text(path.read_text().replace("2.0 / (1.0 + ratio)", "1.0"))
    assert verify_dataset(file, run_code=True).differences == {}
