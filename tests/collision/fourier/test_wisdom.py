"""Plans found once and kept: equal bits in every process, and nothing but them in what a process plans."""

import json
import os
import subprocess
import sys
import threading
import warnings

import numpy as np
import pyfftw
import pytest
import scipy.fft
from click.testing import CliRunner

import granstudy as gs
from granstudy.collision.fourier import fftw, tuning, wisdom
from granstudy.collision.fourier.transforms import RealTransforms, aligned_zeros
from granstudy.commands.main import granstudy

SHAPES = [(18, 1, 18), (12, 12, 12)]
"""Small grids; at 18 points ESTIMATE's plan is not the fastest."""


@pytest.fixture
def cache(tmp_path, monkeypatch):
    """An empty cache folder."""
    monkeypatch.setenv("GRANSTUDY_CACHE", str(tmp_path))
    return tmp_path


def tuned(shapes=SHAPES, precision="double"):
    """Wisdom of some shapes, made and kept."""
    with tuning.tuning() as texts:
        list(tuning.tune(texts, shapes, precision))
    return wisdom.kept()


def half_spectrum(shape):
    return aligned_zeros((*shape[:2], shape[2] // 2 + 1), np.complex128)


RUN = """
import hashlib, sys
import granstudy as gs
from granstudy.datasets.netcdf import write_dataset

scene = gs.load_scene("bkw2d", restitution=0.5, diffusion=0.0)
solver = gs.Solver(N=18, R=7.0, N_rho=5, M_cir=8, method="fast")
ds = gs.simulate(scene, solver, t_final=0.2, dt=0.1, progress=False)
write_dataset(ds, sys.argv[1])
print(ds.attrs.get("fftw_wisdom"))
"""


def run_in_a_new_process(path):
    command = [sys.executable, "-c", RUN, str(path)]
    done = subprocess.run(command, env=os.environ, stdout=subprocess.PIPE, text=True, check=True)
    return done.stdout.strip(), path.read_bytes()


def test_processes_with_one_wisdom_write_the_same_bytes(cache):
    known = tuned()
    first, second = (run_in_a_new_process(cache / f"{i}.nc") for i in range(2))
    assert first == second
    assert first[0] == known.digest != ""


def test_wisdom_gives_its_plans_back_and_the_same_bits(cache):
    known = tuned()
    f = np.random.default_rng(0).standard_normal(SHAPES[0])
    spectra = []
    for _ in range(2):
        with wisdom.planning_with(known), warnings.catch_warnings(action="error"):
            made = RealTransforms(f.shape)
            spectra.append(made.forward(f))
        assert made.wisdom == known.digest
    np.testing.assert_array_equal(*spectra)
    expected = scipy.fft.rfftn(f, axes=(0, 2))
    assert np.max(np.abs(spectra[0] - expected)) < 1e-14 * np.max(np.abs(expected))


def test_other_shapes_are_planned_as_without_wisdom(cache):
    known = tuned([(16, 16, 16), (9, 9, 16)])  # whose parts make a plan of the shape below, too
    f = np.random.default_rng(0).standard_normal((18, 18, 16))
    with wisdom.planning_with(wisdom.Wisdom()):
        expected = RealTransforms(f.shape).forward(f)
    with wisdom.planning_with(known):
        np.testing.assert_array_equal(RealTransforms(f.shape).forward(f), expected)


def test_plans_of_others_play_no_part_and_stay_known():
    array = pyfftw.zeros_aligned((12, 12, 12), dtype="complex128")
    pyfftw.FFTW(array, array, axes=(0, 1, 2), flags=("FFTW_MEASURE",))
    before = pyfftw.export_wisdom()
    with fftw.no_wisdom():
        assert fftw.exported_wisdom(np.dtype(np.float64)).count("\n") <= 2  # nothing but brackets
        assert fftw.make_plans(half_spectrum((14, 14, 14)), 14, fftw.ESTIMATE)
    with fftw.no_wisdom():
        only = fftw.PATIENT | fftw.WISDOM_ONLY
        assert fftw.make_plans(half_spectrum((14, 14, 14)), 14, only) is None
    assert sorted(pyfftw.export_wisdom()[0].splitlines()) == sorted(before[0].splitlines())


def test_damaged_wisdom_is_none_and_says_so(cache):
    tuned(SHAPES[:1])
    path = wisdom.wisdom_path()
    content = path.read_bytes()
    for damaged in (content[:-1], content.replace(b"codelet", b"c0delet"), b""):
        path.write_bytes(damaged)
        with pytest.warns(UserWarning, match="damaged.*tune --anew"):
            assert wisdom.kept() == wisdom.Wisdom()
    path.write_bytes(content)
    assert wisdom.kept().texts


def test_wisdom_of_another_fftw_or_cpu_is_not_taken(cache, monkeypatch):
    tuned(SHAPES[:1])
    path = wisdom.wisdom_path()
    monkeypatch.setattr(wisdom, "machine", lambda: "pyfftw 9.9, fftw-4.0, another CPU")
    assert wisdom.wisdom_path() != path
    assert wisdom.kept() == wisdom.Wisdom()
    path.rename(wisdom.wisdom_path())
    with pytest.warns(UserWarning, match="of another machine"):
        assert wisdom.kept() == wisdom.Wisdom()


def test_wisdom_that_fftw_refuses_is_said_and_does_no_harm():
    f = np.random.default_rng(0).standard_normal((8, 8, 8))
    refused = wisdom.Wisdom({"double 8x8x8": "(fftw-9.9 fftw_wisdom #x1 #x2 #x3 #x4)"})
    with wisdom.planning_with(refused), pytest.warns(UserWarning, match="plans by ESTIMATE"):
        spectrum = RealTransforms(f.shape).forward(f)
    with wisdom.planning_with(wisdom.Wisdom()):
        np.testing.assert_array_equal(RealTransforms(f.shape).forward(f), spectrum)


def test_of_two_that_tune_one_waits_and_finds_the_work_done(cache):
    gained, kept = [], []
    start = threading.Barrier(2)

    def tune():
        start.wait()
        with tuning.tuning() as texts:
            gained.extend(tuning.tune(texts, SHAPES, "double"))
        kept.append(wisdom.kept())

    both = [threading.Thread(target=tune) for _ in range(2)]
    for one in both:
        one.start()
    for one in both:
        one.join()
    assert len(gained) == len(SHAPES)
    assert kept[0] == kept[1] and set(kept[0].texts) == {"double 18x1x18", "double 12x12x12"}


def test_tuning_that_is_stopped_keeps_what_was_there(cache):
    before = tuned(SHAPES[:1])
    with pytest.raises(KeyboardInterrupt), tuning.tuning(anew=True) as texts:
        list(tuning.tune(texts, SHAPES[1:], "double"))
        raise KeyboardInterrupt
    assert wisdom.kept() == before


def test_tuning_makes_its_folder_and_those_above(tmp_path, monkeypatch):
    monkeypatch.setenv("GRANSTUDY_CACHE", str(tmp_path / "not" / "there"))
    with tuning.tuning() as texts:
        assert texts == {}
    assert (tmp_path / "not" / "there").is_dir()


def test_more_sizes_leave_the_plans_of_others_as_they_are(cache):
    before = tuned(SHAPES[:1])
    after = tuned(SHAPES[1:])
    assert after.texts.items() > before.texts.items()
    assert after.digest != before.digest


def test_one_planner_serves_a_process_whatever_is_tuned_meanwhile(cache):
    now = wisdom.planner()
    tuned(SHAPES[:1])
    assert wisdom.planner() is now


def test_datasets_say_which_wisdom(cache):
    scene = gs.load_scene("bkw2d", restitution=0.5, diffusion=0.0)
    elastic = gs.load_scene("bkw2d", restitution=1.0, diffusion=0.0)
    nodes = {"N": 18, "R": 7.0, "N_rho": 5, "M_cir": 8}
    fast, radial = gs.Solver(method="fast", **nodes), gs.Solver(method="radial", N=18, R=7.0)
    tight = gs.Solver(method="fast", N=18, R=7.0, rtol=0.1)
    carleman = gs.Solver(method="carleman", **nodes)

    def said(scene, solver):
        ds = gs.simulate(scene, solver, t_final=0.1, dt=0.1, progress=False)
        return ds.attrs.get("fftw_wisdom")

    with wisdom.planning_with(wisdom.Wisdom()):
        assert said(scene, fast) is None
    known = tuned(SHAPES[:1])
    with wisdom.planning_with(known):
        for solver in (fast, tight):
            assert said(scene, solver) == known.digest
        assert said(elastic, carleman) == known.digest
        assert said(scene, radial) is None
        literal = gs.Solver(method="literal", **nodes)
        assert said(scene, literal) is None


@pytest.mark.parametrize("precision", ["double", "single"])
def test_gains_are_measured(cache, precision):
    with tuning.tuning() as texts:
        (gain,) = tuning.tune(texts, [(30, 1, 30)], precision)
    assert gain.name == f"{precision} 30x1x30" and gain.estimate > 0.0 and gain.patient > 0.0
    assert gain.ratio == gain.estimate / gain.patient


def test_shapes_are_those_that_fftw_has_code_for():
    sizes = {shape[0] for shape in tuning.shapes(64) if shape[1] > 1}
    assert {6, 20, 22, 26, 32, 36, 40, 64} <= sizes and not sizes & {7, 34, 38, 62, 66}
    assert max(shape[0] for shape in tuning.shapes(96) if shape[1] > 1) == 96


def test_the_command_says_what_it_gained_and_does_it_once(cache, monkeypatch):
    monkeypatch.setattr(tuning, "LARGEST", {2: 8, 3: 8})
    first = CliRunner().invoke(granstudy, ["tune", "--largest", "8"])
    assert first.exit_code == 0, first.output
    lines = first.output.splitlines()
    assert len(lines) == 8 + 2 and all("times as fast" in line for line in lines[:8])
    assert wisdom.kept().digest in lines[-1] and str(wisdom.wisdom_path()) in lines[-1]
    again = CliRunner().invoke(granstudy, ["tune", "--largest", "8"])
    assert again.output.splitlines() == ["all sizes were tuned before", lines[-1]]
    texts = json.loads(wisdom._content(wisdom.kept()))
    assert set(texts) == {
        f"{precision} {n}x{m}x{n}"
        for precision in ("double", "single")
        for n in (6, 8)
        for m in (1, n)
    }
