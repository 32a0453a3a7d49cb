"""What to cite, as BibTeX: the method's paper, and this software."""

from importlib.metadata import version

PAPER = """@article{HuMa2019,
  author  = {Hu, Jingwei and Ma, Zheng},
  title   = {A fast spectral method for the inelastic {Boltzmann} collision operator and application to
             heated granular gases},
  journal = {Journal of Computational Physics},
  volume  = {385},
  pages   = {119--134},
  year    = {2019},
  doi     = {10.1016/j.jcp.2019.01.049}
}"""

SOFTWARE = """@software{{granstudy,
  author  = {{{{the granstudy developers}}}},
  title   = {{granstudy: parameter studies of granular gases by the fast {{Fourier}} spectral method}},
  version = {{{version}}},
  license = {{MIT}}
}}"""


def citations() -> list[str]:
    """The entries: the method's paper, then the software in the version that is installed."""
    return [PAPER, SOFTWARE.format(version=version("granstudy"))]
