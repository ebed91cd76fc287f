"""After any edits the picture is that of a fresh session."""

import gc

import numpy as np
import pytest

from addon.engine import (
    LoadedScene,
    packing,
    tree_packing,
)

from .edited_stage import Stage, picture, update


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("quick", [False, True])
def test_after_any_edits_the_picture_is_that_of_a_fresh_session(device, monkeypatch, seed, quick):
    for module in (packing, tree_packing):
        monkeypatch.setattr(module, "QUICK_FROM", 10)
    stage, loaded, log = Stage(seed), LoadedScene(device), []
    for step in range(12):
        log.append("+".join(stage.edit() for _ in range(stage.rng.integers(1, 4))) if step else "")
        made = update(loaded, stage.scene(), stage.settings, seconds=0.0 if seed % 2 else None, quick=quick)
        if step % 3 == 2 and loaded.can_improve:
            log.append("better trees")
            loaded.apply(loaded.prepare_better())
        expected = picture(device, None, stage.scene(), stage.settings)
        found = picture(device, loaded)
        different = np.abs(found - expected).max(axis=-1) > 1e-5
        assert not different.any(), (log, made.change, int(different.sum()))
        gc.collect()
    loaded.free()
