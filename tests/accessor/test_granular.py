"""`ds.granular` is there wherever granstudy gives a dataset, and is imported when it is used."""

import subprocess
import sys

RUN = (
    "ds = gs.simulate(gs.load_scene('maxwellian2d'), gs.Solver(N=8, R=7.0, method='radial'), "
    "t_final=0.1, dt=0.1, progress=False); gs.write_dataset(ds, 'run.nc'); print(ds.granular.dim); "
    "ds = gs.open_runs('run.nc')"
)
PLAIN = "ds = xr.Dataset({'a': ('component', [1, 2])})"
SAYS = "; print(ds.granular.dim)"


def said(code, folder):
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=folder, capture_output=True, text=True, check=True
    )
    return done.stdout.split()


def test_runs_of_granstudy_have_it(tmp_path):
    assert said("import granstudy as gs; " + RUN + SAYS, tmp_path) == ["2", "2"]


def test_datasets_of_xarray_have_it_once_granstudy_knows_of_xarray(tmp_path):
    code = "import xarray as xr, granstudy; " + PLAIN + SAYS
    assert said(code, tmp_path) == ["2"]


def test_it_is_imported_when_it_is_used(tmp_path):
    asks = "; print('granstudy.accessor.granular' in sys.modules)"
    code = "import sys, granstudy as gs, xarray as xr; gs.read_dataset; " + PLAIN + asks
    assert said(code + "; ds.granular" + asks, tmp_path) == ["False", "True"]


def test_importing_granstudy_imports_next_to_nothing(tmp_path):
    asks = "print([m for m in ('numpy', 'xarray', 'matplotlib') if m in sys.modules])"
    assert said("import sys, granstudy; " + asks, tmp_path) == ["[]"]
