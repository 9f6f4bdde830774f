"""Corrected samples that are looked into."""

import pytest

import robomill as rm
from robomill.improve.compensation import Compensation
from tests.improve.corrected import SLOT


@pytest.fixture(scope="session")
def slot() -> Compensation:
    return rm.compensate(rm.load_setup(SLOT))


@pytest.fixture(scope="session")
def process() -> Compensation:
    return rm.compensate(rm.load_setup(SLOT / "setup_process.toml"))


@pytest.fixture(scope="session")
def pocket() -> Compensation:
    return rm.compensate(rm.load_setup("pocket_arcs"))
