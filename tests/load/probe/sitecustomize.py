"""In a server under measurement: on SIGUSR1 it collects garbage and writes down what it holds, as JSON.

Python imports this where the folder is on its path; ``waves.py`` starts the server so.
"""

import os
import signal
import sys

COUNTS = os.environ.get("ROBOMILL_COUNTS")
NAMES = ("AppSession", "Store", "Project", "SimulationSetup", "SimulationResult", "Toolpath", "Job")


def _count(*_: object) -> None:
    import ctypes
    import gc
    import json
    from collections import Counter
    from pathlib import Path

    def counts() -> Counter[str]:
        return Counter(type(one).__name__ for one in gc.get_objects() if str(type(one).__module__).startswith(OURS))

    before = counts()
    gc.collect()
    after = counts()
    told = {name: [before[name], after[name]] for name in NAMES}
    if "robomill.ui.work.commons" in sys.modules:
        from robomill.budgets import weight
        from robomill.ui.session import Store
        from robomill.ui.work.commons import Commons

        commons = [dict(one._held) for one in gc.get_objects() if isinstance(one, Commons)]
        stores = [one for one in gc.get_objects() if isinstance(one, Store)]
        shared = weight(commons)
        told["MB in caches"] = [shared // 10**6] * 2
        told["MB in sessions beside"] = [(weight([commons, stores]) - shared) // 10**6] * 2
    ctypes.CDLL(None).malloc_trim(0)
    path = Path(str(COUNTS))
    path.with_suffix(".new").write_text(json.dumps(told))
    path.with_suffix(".new").rename(path)


OURS = ("robomill.", "streamlit.")
if COUNTS:
    signal.signal(signal.SIGUSR1, _count)
