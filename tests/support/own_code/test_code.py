"""A function is known by its content, wherever it is defined."""

import functools
import io
import math

import numpy as np
import pytest
from own_functions import imported, in_file, in_notebook

import granstudy as gs
from granstudy.support.own_code.code import code_of
from granstudy.support.own_code.load import load_function

GAS = '''
import numpy as np
from scipy.special import gamma

WIDTH = 2.0


def unused(x):
    return x


def squared(v, T):
    """|v|²/T."""
    return v**2 / T  # along one axis


def anisotropic(vx, vy, Tx=1.0, Ty=1.0):
    """Two temperatures."""
    parts = [squared(v, WIDTH * T) for v, T in ((vx, Tx), (vy, Ty))]
    return np.exp(-sum(parts)) / gamma(1.5)
'''


def digest(source, name="anisotropic"):
    return code_of(in_notebook(source)[name]).digest


def test_the_same_in_a_notebook_a_module_and_a_file(tmp_path, monkeypatch):
    path = in_file(tmp_path, GAS)
    loaded = load_function("my_gas.py:anisotropic", tmp_path)
    module = imported(path, monkeypatch)
    cells = in_notebook("import numpy as np\nfrom scipy.special import gamma\nWIDTH = 2.0")
    for part in GAS.split("\n\n\n")[1:]:
        in_notebook(part, cells)
    found = {code_of(f).digest for f in (loaded, module.anisotropic, cells["anisotropic"])}
    assert found == {digest(GAS)}
    assert code_of(loaded).name == "my_gas.py:anisotropic"
    assert code_of(module.anisotropic).name == "anisotropic"


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("# along one axis", "# along x"),
        ('"""Two temperatures."""', '"""Another text,\n\n    in lines."""'),
        ("return x\n", "return x + 1\n"),
        ("import numpy as np\n", "import numpy as np\nimport math\nOTHER = 3\n"),
        ("WIDTH = 2.0", "WIDTH = 2"),
        ("WIDTH = 2.0", "WIDTH = np.float64(2.0)"),
        ("WIDTH * T)", "(WIDTH*T))"),
    ],
)
def test_what_does_not_count(old, new):
    assert old in GAS
    assert digest(GAS.replace(old, new)) == digest(GAS)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("WIDTH = 2.0", "WIDTH = 2.5"),
        ("WIDTH = 2.0", "WIDTH = np.array(2.0)"),
        ("v**2 / T", "v**2 / T / 2"),
        ("Tx=1.0", "Tx=1.5"),
        ("import gamma", "import gammaln as gamma"),
        ("np.exp(-sum", "np.exp(+sum"),
        ("def anisotropic", "@lambda f: f\ndef anisotropic"),
    ],
)
def test_what_counts(old, new):
    assert old in GAS
    assert digest(GAS.replace(old, new)) != digest(GAS)


def test_the_source_says_all_that_is_reached_and_runs():
    code = code_of(in_notebook(GAS)["anisotropic"])
    assert "def squared" in code.source and "WIDTH = 2.0" in code.source
    assert "unused" not in code.source
    again = in_notebook(code.source)
    assert code_of(again["anisotropic"]).digest == code.digest
    assert again["anisotropic"](0.5, 0.2, Tx=2.0) > 0.0


def test_a_helper_in_a_file_beside_counts(tmp_path):
    in_file(tmp_path, "import widths\n\ndef f(vx, vy):\n    return widths.of(vx) + vy\n")
    found = []
    for body in ("x", "x  # same", "2 * x", "2 * x"):
        more = "\n\ndef other(x):\n    return 0\n" if len(found) == 3 else ""
        in_file(tmp_path, f"def of(x):\n    return {body}\n{more}", "widths.py")
        function = load_function("my_gas.py:f", tmp_path)
        assert function(1.0, 0.0) == (2.0 if "2" in body else 1.0)
        found.append(function.digest)
    assert found[0] == found[1] != found[2] == found[3]
    text = code_of(function).source
    assert "def of(x)" in text and "other" not in text
    assert in_notebook(text)["f"](1.0, 0.0) == 2.0


def test_two_lambdas_on_one_line():
    cell = in_notebook("a, b, c = lambda v: 1 - v, lambda v: 1 - 2 * v, lambda w: lambda v: w + v")
    codes = [code_of(cell[name]) for name in "abc"] + [code_of(cell["c"](1)), code_of(cell["c"](2))]
    assert len({code.digest for code in codes}) == 5
    assert codes[0].source == "function = lambda v: 1 - v\n"
    assert codes[0].name == "lambda"
    assert in_notebook(codes[4].source)["function"](3.0) == 5.0


def test_closures_and_defaults_count_by_value():
    cell = in_notebook(
        """
        import numpy as np
        def make(a, table):
            def law(v, b=a):
                return a * v + table[0] + b
            return law
        """
    )
    make = cell["make"]
    same = [code_of(make(0.5, np.arange(3.0))).digest for _ in range(2)]
    assert same[0] == same[1]
    assert code_of(make(0.5, np.arange(4.0))).digest != same[0]
    assert code_of(make(0.6, np.arange(3.0))).digest != same[0]
    assert code_of(make(0.5, [1, 2])).digest == code_of(make(0.5, (1.0, 2.0))).digest


def test_a_global_that_changes_makes_another_function():
    cell = in_notebook("A = 0.1\nlaw = lambda v: 1 - A * v**0.2")
    before = code_of(cell["law"]).digest
    cell["A"] = 0.3
    assert code_of(cell["law"]).digest != before
    cell["A"] = 0.1
    assert code_of(cell["law"]).digest == before


OBJECTS = """
from dataclasses import dataclass
SCALE = 1.0

@dataclass
class Law:
    A: float
    def __call__(self, v):
        return 1 - self.A * SCALE * v

class Plain:
    "A class."
    def __init__(self, A):
        self.A = A
    def at(self, v):
        return 1 - self.A * v
    __call__ = at
"""


def test_objects_count_by_class_and_state():
    cell = in_notebook(OBJECTS)
    law = code_of(cell["Law"](0.1))
    assert (law.name, law.arguments) == ("Law", (("A", 0.1),))
    assert "class Law" in law.source and "SCALE = 1.0" in law.source
    assert code_of(in_notebook(law.source)["Law"](0.1)).digest == law.digest
    other = in_notebook(OBJECTS.replace('"A class."', '"The class."'))
    assert code_of(other["Plain"](0.1)).digest == code_of(cell["Plain"](0.1)).digest
    assert code_of(cell["Plain"](0.1)).digest != code_of(cell["Plain"](0.2)).digest
    assert code_of(cell["Plain"](0.1).at).digest != code_of(cell["Plain"](0.2).at).digest
    edited = in_notebook(OBJECTS.replace("1 - self.A", "2 - self.A"))
    for name in ("Law", "Plain"):
        assert code_of(edited[name](0.1)).digest != code_of(cell[name](0.1)).digest


def test_partials_bind_arguments():
    f = in_notebook(GAS)["anisotropic"]
    codes = [code_of(functools.partial(f, Tx=T)) for T in (2.0, np.float64(2.0), 2, 3.0)]
    assert codes[0].arguments == (("Tx", 2.0),) and codes[0].name == "anisotropic"
    assert codes[0].digest == codes[1].digest == codes[2].digest != codes[3].digest
    signs = [code_of(functools.partial(f, Tx=zero)) for zero in (0.0, -0.0)]
    assert signs[0] == signs[1] and math.copysign(1.0, signs[1].arguments[0][1]) == 1.0


def test_methods_caches_and_densities_of_granstudy():
    cell = in_notebook(
        "import functools\nimport granstudy as gs\n"
        "gas = gs.load_scene('maxwellian2d').initial\n"
        "@functools.lru_cache\ndef width(x):\n    return 2 * x\n"
        "def f(vx, vy):\n    return width(1.0) * gas(vx, vy)\n"
    )
    before = code_of(cell["f"])
    assert "def width" in before.source
    cell["gas"] = gs.load_scene("maxwellian2d", temperature=2.0).initial
    assert code_of(cell["f"]).digest != before.digest


def test_code_without_a_source(tmp_path):
    space = {"__name__": "__main__"}
    exec("def law(v, a=1):\n    return 1 - a * v\nother = lambda v: 1 - 2 * v", space)
    code = code_of(space["law"])
    assert code.source.startswith("# law: source not known")
    assert code.digest != code_of(space["other"]).digest
    again = {"__name__": "__main__"}
    exec("\n\ndef law(v, a=1):\n    return 1 - a * v", again)
    assert code_of(again["law"]).digest == code.digest


def test_a_file_edited_since_is_not_taken_for_the_function(tmp_path, monkeypatch):
    path = in_file(tmp_path, "def law(v):\n    return 1 - 0.1 * v\n", "edited_law.py")
    law = imported(path, monkeypatch).law
    before = code_of(law)
    in_file(tmp_path, "# moved\n\ndef law(v):\n    return 1 - 0.1 * v\n", "edited_law.py")
    assert code_of(law).digest == before.digest
    in_file(tmp_path, "def law(v):\n    return 1 - 0.25 * v\n", "edited_law.py")
    after = code_of(law)
    assert after.digest != digest("def law(v):\n    return 1 - 0.25 * v\n", "law")
    assert after.source.startswith("# law: source not known")


@pytest.mark.parametrize(
    ("value", "kind"),
    [
        (np.random.default_rng(1), "numpy.random._generator.Generator"),
        (io.StringIO("1"), "_io.StringIO"),
        (np.array([object()]), "numpy.ndarray"),
        (object(), "builtins.object"),
        ((n for n in range(2)), "builtins.generator"),
    ],
)
def test_values_without_content(value, kind):
    cell = in_notebook(
        "def law(v):\n    return inner(v)\ndef inner(v):\n    return v if THING else 0"
    )
    cell["THING"] = value
    with pytest.raises(
        ValueError, match="law: 'THING', used by 'inner',.*pass it as an argument"
    ) as error:
        code_of(cell["law"])
    assert kind in str(error.value)


def test_methods_of_a_generator_have_no_content():
    cell = in_notebook(
        "import numpy as np\nnoise = np.random.default_rng(1).normal\nf = lambda v: noise()"
    )
    with pytest.raises(ValueError, match="lambda: 'noise'.*Generator"):
        code_of(cell["f"])


def test_a_module_of_the_user_is_imported_at_the_top():
    cell = in_notebook(
        "def f(v):\n    import no_such_widths\n    import scipy.special\n    return v"
    )
    with pytest.raises(
        ValueError, match="f: 'f' imports 'no_such_widths' when it is called; import it at"
    ):
        code_of(cell["f"])


def test_functions_that_call_each_other():
    source = """
    def even(n):
        return n == 0 or odd(n - 1)
    def odd(n):
        return n != 0 and even(n - 1)
    """
    assert digest(source, "even") != digest(source, "odd")
    assert digest(source, "even") == digest(source + "\n", "even")
