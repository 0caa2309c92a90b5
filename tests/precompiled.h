// SPDX-License-Identifier: Apache-2.0
// As src/aureole/precompiled.h, for the tests.
#pragma once

#include <gtest/gtest.h>

#include <random>
#include <sstream>

#include "aureole/precompiled.h"
