"""``python -m robomill`` is the command line."""

from robomill.cli import main

raise SystemExit(main())
