// SPDX-License-Identifier: Apache-2.0
#include "aureole/sensor/sensor.h"

#include "aureole/plugin/registry.h"

namespace aureole {

namespace {

/// The only child of family T, or a plug-in with its defaults.
template <class T>
std::shared_ptr<T> child_or(const Properties& p, const char* family, const char* fallback) {
  auto found = p.get_children<T>(family);
  if (found.size() > 1) throw Error(p.where(), std::string("a sensor has one ") + family);
  if (!found.empty()) return found.front();
  const PluginInfo* info = Registry::instance().find(family, fallback);
  return std::dynamic_pointer_cast<T>(
      info->create(Properties(fallback, "", p.where(), p.shared_context(), info)));
}

}  // namespace

void Sensor::read_common(const Properties& p) {
  film_ = child_or<Film>(p, "film", "hdrfilm");
  sampler_ = child_or<Sampler>(p, "sampler", "sobol");
}

}  // namespace aureole
