"""The code of docs/extending.md runs, and what it adds does what the page says."""

import re
import subprocess
import sys
from pathlib import Path

PAGE = Path(__file__).parents[1] / "docs" / "extending.md"

CHECKS = """
from granstudy.analysis.tables.table import write_table
from granstudy.theory import maxwell_a2

# a method: of a relaxation model a2 goes as e^{-t}
a2 = ds["a2"].values
np.testing.assert_allclose(a2[-1] / a2[0], np.exp(-2.0), rtol=1e-3)
try:
    gs.simulate(gs.load_scene("bkw2d", restitution=0.5), solver, t_final=1.0, dt=0.1)
    OPERATORS["relaxation"].check(gs.load_scene("bkw2d", restitution=0.5), solver.sized())
except ValueError as error:
    assert "restitution=0.5: method 'relaxation' takes 1.0 only" in str(error)
else:
    raise AssertionError("a gas that the method cannot do was not refused")

# a scene: the grid has the moments that it states, and the run is trusted
grid = gs.VelocityGrid(3, 48, 10.0)
m = gs.moments(ring.density(grid), grid)
assert abs(float(m.density) - 1.0) < 1e-8
assert abs(float(m.temperature) / ring.moments.temperature - 1.0) < 1e-7
assert abs(float(m.a2) - ring.moments.a2) < 1e-6
assert cooling.attrs["choice"].startswith("radial") and int(cooling["trust"]) == 2
try:
    gs.load_scene("ring3d", width=-1.0)
except ValueError as error:
    assert "width=-1.0: must be a positive number" in str(error)
else:
    raise AssertionError("a negative width was not refused")

# a moment: the same by the grid and by particles, within four standard errors
off = float(by_grid["anisotropy"][-1] - by_particles["anisotropy"][-1])
assert abs(off) < 4.0 * float(by_particles["anisotropy_standard_error"][-1])

# the study: tables and figure
assert list(relaxation["method"].values) == ["fast", "relaxation"]
assert ((relaxation["anisotropy"] > 0.0) & (relaxation["anisotropy"] < 0.3)).all()
write_table(relaxation, "relaxation.nc", "relaxation.csv", "relaxation.md")
assert "anisotropy |P − (tr P/d) I|" in Path("relaxation.md").read_text(encoding="utf-8")
assert Path("relaxation.png").stat().st_size > 10_000
assert list(rings["e"].values) == [0.5, 0.9]
"""


def test_the_page_runs_and_keeps_its_word(tmp_path):
    blocks = re.findall(r"^```python\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.M | re.S)
    assert len(blocks) == 5
    script = tmp_path / "page.py"
    script.write_text("\n\n".join([*blocks, CHECKS]), encoding="utf-8")
    done = subprocess.run(
        [sys.executable, script.name], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr[-3000:]
