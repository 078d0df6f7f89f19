"""The pytest fixture `gonio`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from types import ModuleType


@pytest.fixture(scope="session")
def gonio() -> ModuleType:
    """``gonio.assert_valid(bsdf)``: has gonio measure a BSDF of the test's process."""
    from gonio import testing

    return testing
