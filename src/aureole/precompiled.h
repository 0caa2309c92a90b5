// SPDX-License-Identifier: Apache-2.0
// Headers that are compiled once for all files of the library (AUREOLE_PRECOMPILED_HEADERS in CMakeLists.txt): the front end is
// most of the time that a plug-in takes to compile. Every file still includes all headers that it uses, and
// compiles without this one. Only headers that rarely change belong here, since each change of one of them
// recompiles everything.
#pragma once

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <variant>
#include <vector>

#include "aureole/bsdf/bsdf.h"
#include "aureole/core/error.h"
#include "aureole/core/image.h"
#include "aureole/core/units.h"
#include "aureole/math/warp.h"
#include "aureole/plugin/registry.h"
#include "aureole/texture/texture.h"
