// SPDX-License-Identifier: Apache-2.0
// `SceneTables`: data that an integrator derives from a scene once, such as projected splats. Integrators own
// no scene state, so that the scene keeps the data, as long as it exists.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <typeindex>
#include <utility>

namespace aureole {

class SceneTables {
public:
  /// Returns the table of type T with the key `content`, a hash of all that it depends on besides the scene, or makes it by
  /// `make()`, which returns a std::shared_ptr<const T>. The table is made once; other threads that need it
  /// wait meanwhile.
  template <class T, class Make>
  std::shared_ptr<const T> get(std::uint64_t content, const Make& make) {
    const std::lock_guard lock(mutex_);
    std::shared_ptr<const void>& table = tables_[{content, std::type_index(typeid(T))}];
    if (!table) table = std::shared_ptr<const T>(make());
    return std::static_pointer_cast<const T>(table);
  }

private:
  std::mutex mutex_;
  std::map<std::pair<std::uint64_t, std::type_index>, std::shared_ptr<const void>> tables_;
};

}  // namespace aureole
