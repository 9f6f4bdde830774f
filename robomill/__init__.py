"""robomill: how far a milling robot is pushed off its path by the cutting force, and which joint is to blame.

SI inside (m, rad, N, s). The public names stand in ``__init__.pyi`` and load on first use, so that ``import robomill``
stays quick.
"""

import lazy_loader

from robomill.version import __version__ as __version__

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
