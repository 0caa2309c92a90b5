// SPDX-License-Identifier: Apache-2.0
// `SceneTables`: what an integrator derives from a scene once, such as projected splats. Integrators own no scene state:
// the scene keeps it, as long as it exists.
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
  /// `make()`, which returns a std::shared_ptr<const T>. Threads that need a table wait while one makes it, once.
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
