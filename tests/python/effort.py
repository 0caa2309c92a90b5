# SPDX-License-Identifier: Apache-2.0
"""How much a test computes, as tests/harness/effort.h has it: AUREOLE_THOROUGH=1 takes the larger number."""
import os
from typing import TypeVar

T = TypeVar("T")


def effort(usual: T, thorough: T) -> T:
    return thorough if "AUREOLE_THOROUGH" in os.environ else usual
