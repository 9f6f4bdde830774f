"""The name by which the rooms above ask for ``NO_UNITS``, which belongs to ``toolpath.findings``."""

from robomill.toolpath.findings import NO_UNITS as NO_UNITS
