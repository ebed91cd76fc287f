"""One device for all shader tests: programs are compiled once."""

import pytest

from addon.engine.devices.headless import HeadlessDevice


@pytest.fixture(scope="session")
def device():
    return HeadlessDevice()
