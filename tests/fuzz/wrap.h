// SPDX-License-Identifier: Apache-2.0
// Scenes around single plug-ins: the examples of their documentation, and images.
#pragma once

#include <pugixml.hpp>
#include <string>
#include <vector>

#include "aureole/plugin/registry.h"
#include "fuzz/corpus.h"

namespace aureole::fuzz {

/// The example with every file name replaced by one of `data` with the same ending, which goes to `used`.
std::string with_data_files(const std::string& example,
                            const std::vector<std::pair<std::string, Bytes>>& data, Files& used);

/// Complete scenes that use the example: two for a texture, which may be a reflectance or an emission.
std::vector<std::string> wrap_example(const PluginInfo& plugin, const std::string& example);

/// The plug-in of an object element, or null.
const PluginInfo* plugin_of(pugi::xml_node node);

/// A scene with the picture as a texture and as an environment.
std::string wrap_image(const std::string& file);

/// A scene with the volume as the extinction of a medium.
std::string wrap_volume(const std::string& file);

/// Scenes with the file of splats or points, or with the radiance grid (.npz): projected or composited, and as a medium.
std::vector<std::string> wrap_splats(const std::string& file);

}  // namespace aureole::fuzz
