"""What the tests of pictures share: one device, so that a program is compiled once, and `--regenerate`."""

import pytest

from addon.engine.devices.headless import HeadlessDevice


def pytest_addoption(parser):
    parser.addoption("--regenerate", action="store_true", help="write the golden pictures anew instead of comparing")


@pytest.fixture(scope="session")
def device():
    """A headless device for all pictures."""
    return HeadlessDevice()


@pytest.fixture(scope="session")
def regenerate(request):
    return request.config.getoption("--regenerate")
