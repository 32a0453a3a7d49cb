"""granstudy: parameter studies of granular gases by the fast Fourier spectral method.

The public names are listed in the stub file beside this one. Each is imported when it is first used, so that
`import granstudy` and the processes of a workflow load what they need and no more.
"""

import lazy_loader

__version__ = "0.1.0"

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
