"""One vocabulary: the words that a scene takes."""

import json
from functools import partial

import cloudpickle
import numpy as np
import pytest
from own_functions import in_file, in_notebook

import granstudy as gs

FILE = '''
import cloudpickle
import numpy as np
import granstudy as gs

def anisotropic(vx, vy, Tx=1.0, Ty=1.0):
    """Two temperatures."""
    return np.exp(-vx**2 / Tx - vy**2 / Ty)

def law(v, kappa):
    return np.clip(1 - kappa * v, 0.0, 1.0)

def greedy(v, Tx=1.0):
    return 0 * v + 0.5

def many(*v, width=1.0):
    return np.exp(-sum(vi**2 for vi in v) / width)

def gas(T):
    return gs.load_scene("maxwellian2d", temperature=T, exponent=1.0, e=0.7, diffusion=0.0)

def wrong(vx, vy, N=3):
    return vx
'''


@pytest.fixture
def folder(tmp_path, monkeypatch):
    in_file(tmp_path, FILE)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_flat_words_are_fields():
    flat = gs.load_scene("bkw2d", e=0.5, exponent=1.0, strength=0.2, diffusion=0.1)
    assert flat == gs.load_scene("bkw2d", restitution=0.5, kernel=gs.VHS(1.0, 0.2), diffusion=0.1)
    assert gs.load_scene("bkw3d", exponent=1.0).kernel == gs.hard_spheres(3)


def test_epsilon_is_the_old_word():
    with pytest.warns(
        DeprecationWarning, match="epsilon: is called diffusion now; write diffusion=0.1"
    ):
        scene = gs.load_scene("bkw2d", epsilon=0.1)
    assert scene.diffusion == 0.1


def test_laws_by_name_and_from_files(folder):
    assert gs.load_scene("bkw2d", restitution="viscoelastic", A=0.1).restitution == gs.Viscoelastic(
        0.1
    )
    scene = gs.load_scene("bkw2d", restitution="my_gas.py:law", kappa=0.3)
    assert repr(scene.restitution) == "my_gas.py:law(kappa=0.3)"
    own = in_notebook("law = lambda v, kappa: 1 - kappa * v")["law"]
    np.testing.assert_allclose(
        gs.load_scene("bkw2d", restitution=own, kappa=0.2).restitution(np.ones(2)), 0.8
    )


def test_densities_from_files(folder):
    scene = gs.load_scene("my_gas.py:anisotropic", Tx=2.0, e=0.5)
    assert (scene.dim, repr(scene.initial)) == (2, "my_gas.py:anisotropic(Tx=2.0, Ty=1.0)")
    assert scene.kernel == gs.maxwell(2) and scene.diffusion == 1e-6
    assert scene == gs.load_scene("my_gas.py:anisotropic", beside=folder, Tx=2.0, Ty=1, e=0.5)
    assert hash(scene) == hash(gs.load_scene("my_gas.py:anisotropic", Tx=2.0, e=0.5))
    assert gs.load_scene("my_gas.py:many", dim=3, width=2.0).dim == 3


def test_a_function_that_makes_the_scene(folder):
    scene = gs.load_scene("my_gas.py:gas", T=2.0, e=0.9)
    assert (scene.kernel, scene.restitution, scene.diffusion) == (gs.hard_spheres(2), 0.9, 0.0)
    assert scene.moments.temperature == 2.0
    assert scene.coordinates()["scene"] == "my_gas.py:gas" and scene.coordinates()["T"] == 2.0
    scene.density(gs.VelocityGrid(2, 16, 8.0))


@pytest.mark.parametrize(
    ("name", "words", "message"),
    [
        (
            "bkw2d",
            {"e": 0.5, "restitution": 0.5},
            "e=0.5, restitution=0.5: both say the same; give one",
        ),
        ("bkw2d", {"kernel": gs.maxwell(2), "exponent": 1.0}, "kernel=.*, exponent=1.0: both say"),
        ("bkw2d", {"kernel": gs.maxwell(2), "strength": 1.0}, "kernel=.*, strength=1.0: both say"),
        (
            "bkw2d",
            {"diffusion": 0.1, "epsilon": 0.1},
            "diffusion=0.1, epsilon=0.1: both say the same",
        ),
        ("bkw2d", {"e": "0.5"}, "e='0.5': must be a number between 0 and 1"),
        ("bkw2d", {"e": True}, "e=True: must be a number"),
        ("bkw2d", {"exponent": "1"}, "exponent='1': must be a number between 0 and 1"),
        (
            "bkw2d",
            {"restitution": "viscoelstic"},
            "unknown restitution 'viscoelstic' .did you mean 'visc",
        ),
        ("bkw2d", {"restitution": "viscoelastic"}, "restitution='viscoelastic': needs A"),
        ("bkw2d", {"dim": 3}, "dim=3: bkw2d has dim 2"),
        (
            "maxwellian2d",
            {"temprature": 1.0, "restitution": "viscoelastic"},
            "'maxwellian2d' 'temprature' .did you mean 'temperature'.*: allowed are A, .*velocity",
        ),
        (
            "my_gas.py:anisotropic",
            {"Tz": 1.0},
            "scene 'my_gas.py:anisotropic' 'Tz'.*: allowed are Tx, Ty",
        ),
        (
            "my_gas.py:anisotropic",
            {"Tx": 1.0, "restitution": "my_gas.py:greedy"},
            "Tx=1.0: the density my_gas.py:anisotropic and the restitution my_gas.py:greedy both have",
        ),
        ("my_gas.py:anisotropik", {}, "my_gas.py has no 'anisotropik' .did you mean 'anisotropic'"),
        ("my_gas.py:wrong", {}, "my_gas.py:wrong: its argument 'N' is a word of scenes, solvers"),
        ("my_gas.py:many", {}, "my_gas.py:many: takes any number of velocity components; give dim"),
        ("my_gaz.py:gas", {"T": 1.0}, "my_gaz.py:gas: there is no file"),
    ],
)
@pytest.mark.usefixtures("folder")
def test_what_is_wrong_is_said_in_one_error(name, words, message):
    with pytest.raises(ValueError, match=message):
        gs.load_scene(name, **words)


def test_own_functions_are_described_by_content(folder):
    scene = gs.load_scene("my_gas.py:anisotropic", Tx=2.0, restitution="my_gas.py:law", kappa=0.3)
    described = json.loads(json.dumps(scene.describe()))
    assert described["initial"]["function"] == "my_gas.py:anisotropic"
    assert described["initial"]["arguments"] == {"Tx": 2.0, "Ty": 1.0}
    assert described["restitution"]["arguments"] == {"kappa": 0.3}
    cell = in_notebook(FILE)
    initial, law = partial(cell["anisotropic"], Tx=2), partial(cell["law"], kappa=0.3)
    own = gs.Scene(2, initial, gs.maxwell(2), law, 1e-6)
    assert own.identity() == scene.identity()
    assert own.describe()["initial"]["digest"] == described["initial"]["digest"]
    assert own.describe()["initial"]["function"] == "anisotropic"


def test_a_bare_function_is_its_defaults(folder):
    cell = in_notebook(FILE)
    bare = gs.Scene(2, cell["anisotropic"], gs.maxwell(2), 1.0, 1e-6)
    assert bare.identity() == gs.load_scene("my_gas.py:anisotropic", Ty=1.0).identity()
    assert bare.coordinates()["Tx"] == 1.0
    many = gs.Scene(3, cell["many"], gs.maxwell(3), 1.0, 1e-6)
    assert many.identity() == gs.load_scene("my_gas.py:many", dim=3).identity()


def test_the_source_of_own_functions(folder):
    scene = gs.load_scene("my_gas.py:anisotropic", restitution="my_gas.py:law", kappa=0.3)
    assert "def anisotropic" in scene.source and "def law" in scene.source
    assert "greedy" not in scene.source
    again = in_notebook(scene.source)
    assert again["anisotropic"](0.0, 0.0) == 1.0
    assert gs.load_scene("bkw2d", restitution="viscoelastic", A=0.1).source == ""


def test_a_function_that_cannot_be_known_is_no_key():
    cell = in_notebook(
        "import numpy as np\nrng = np.random.default_rng(1)\ndef f(x, y):\n    return x + y + rng.random()"
    )
    scene = gs.Scene(2, cell["f"], gs.maxwell(2))
    assert "random" in scene.describe()["initial"]["unidentified"]
    assert scene.source == ""
    with pytest.raises(ValueError, match="f: 'rng' is of type"):
        scene.identity()


def test_coordinates():
    scene = gs.load_scene(
        "maxwellian3d", temperature=2, velocity=(0.5, -0.5, -0.0), restitution="viscoelastic", A=0.1
    )
    assert scene.coordinates() == {
        "scene": "maxwellian3d",
        "restitution": "viscoelastic",
        "exponent": 0.0,
        "strength": 1 / (4 * np.pi),
        "diffusion": 1e-6,
        "initial_temperature": 2.0,
        "initial_velocity": "(0.5, -0.5, 0.0)",
        "A": 0.1,
    }
    assert next(iter(scene.coordinates())) == "scene"
    plain = gs.load_scene("two_beams2d", e=0.5, separation=3.0).coordinates()
    assert (plain["e"], plain["separation"]) == (0.5, 3.0) and "restitution" not in plain
    for name in ("bkw2d", "double_well3d", "power_law2d", "uniform_ball3d", "three_gaussians3d"):
        assert gs.load_scene(name).coordinates()["scene"] == name


@pytest.mark.fault("C6")
def test_zero_has_one_sign():
    for scenes in (
        [gs.load_scene("bkw2d", e=e) for e in (0.0, -0.0)],
        [gs.load_scene("bkw2d", diffusion=e) for e in (0.0, -0.0, 0)],
        [gs.load_scene("bkw2d", exponent=e) for e in (0.0, -0.0)],
    ):
        assert len({json.dumps(scene.describe()) for scene in scenes}) == 1
        assert len({str(scene.coordinates()) for scene in scenes}) == 1


@pytest.mark.fault("B1")
def test_numbers_of_numpy_become_numbers_of_python():
    scene = gs.load_scene(
        "maxwellian2d",
        temperature=np.float32(2.0),
        velocity=np.array([0.5, 1.0]),
        e=np.float64(0.5),
        exponent=np.float32(1.0),
        strength=np.int64(1),
        diffusion=np.float32(0.5),
    )
    assert json.loads(json.dumps(scene.describe()))["initial"] == (
        "Maxwellian(dim=2, temperature=2.0, velocity=(0.5, 1.0))"
    )
    assert {type(value) for value in scene.coordinates().values()} == {float, str}
    assert repr(gs.Viscoelastic(np.float64(0.1))) == "Viscoelastic(A=0.1)"
    assert gs.Scene(np.int64(2), "bkw2d", gs.VHS(np.int64(0), np.float64(0.1))).dim == 2


def test_a_scene_says_the_same_in_another_process():
    cell = in_notebook(FILE + "\nbright = lambda v: 1 - 0.1 * v\n")
    scene = gs.Scene(2, cell["anisotropic"], gs.maxwell(2), cell["bright"])
    sent = cloudpickle.loads(cloudpickle.dumps(scene))
    assert sent.initial is not scene.initial
    assert sent.describe() == scene.describe()
    assert sent.source == scene.source and "def anisotropic" in sent.source
    assert sent.coordinates() == scene.coordinates()
