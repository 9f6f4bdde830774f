"""When a corrected program is looked at more closely than its set-up asks."""

from types import SimpleNamespace

import numpy as np
import pytest

from robomill.improve import finer


@pytest.mark.parametrize(
    ("step", "length", "looked"),
    [(1e-3, 0.1, True), (0.25e-3, 0.1, False), (0.1e-3, 0.1, False), (1e-3, 1.9, True), (1e-3, 2.1, False)],
)
def test_only_where_the_step_is_coarser_and_the_cuts_are_at_most_two_metres(
    monkeypatch: pytest.MonkeyPatch, step: float, length: float, looked: bool
) -> None:
    """8000 samples of 0.25 mm are 2 m of cutting; rapids count for nothing."""

    class Looked(Exception):
        pass

    def run(setup: object) -> None:
        assert setup == finer.CLOSE
        raise Looked

    monkeypatch.setattr(finer, "ran", run)
    path = SimpleNamespace(
        step_length=np.array([0.5 * length, 0.5 * length, 9.0]), cutting=np.array([True, True, False])
    )
    led = SimpleNamespace(setup=SimpleNamespace(step=step, toolpath=path, replace=lambda step: step))
    if looked:
        with pytest.raises(Looked):
            finer.closer(led, None)  # type: ignore[arg-type]
    else:
        assert finer.closer(led, None) == ()  # type: ignore[arg-type]
