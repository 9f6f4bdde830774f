"""The force models, one a file: a new file in this folder is found by itself."""

import importlib
import pkgutil
from collections.abc import Mapping

from robomill.cutting.force import ForceModel
from robomill.cutting.materials import Material

for _module in pkgutil.iter_modules(__path__):
    importlib.import_module(f"{__name__}.{_module.name}")

#: Every model by its kind, the name it has in files.
FORCES: Mapping[str, type[ForceModel]] = dict(sorted(ForceModel.kinds.items(), key=lambda item: item[1].rank))


def model_of(material: Material) -> type[ForceModel]:
    """The model that takes rows of the kind of ``material``."""
    return next(model for model in FORCES.values() if model.takes is type(material))
