"""The springs that can stand beside the joints, one a file: a new file in this folder is found by itself."""

import importlib
import pkgutil
from collections.abc import Mapping

from robomill.compliance.spring import Spring

for _module in pkgutil.iter_modules(__path__):
    importlib.import_module(f"{__name__}.{_module.name}")

#: Every kind of spring by the name it has in files.
SPRINGS: Mapping[str, type[Spring]] = dict(sorted(Spring.kinds.items(), key=lambda item: item[1].rank))
