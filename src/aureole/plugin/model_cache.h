// SPDX-License-Identifier: Apache-2.0
// `ModelCache`: a cache of tables that take seconds to compute, keyed by a hash of their inputs. Equal
// objects share tables, both within a scene and with later versions of the scene.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <typeindex>
#include <utility>

namespace aureole {

class ModelCache {
public:
  /// Returns the cached model of type T with the key `content`, a hash of everything it depends on, or else
  /// the result of `make`. A model is released with its last user.
  template <class T, class Make>
  std::shared_ptr<const T> get(std::uint64_t content, Make&& make) {
    std::erase_if(models_, [](const auto& entry) { return entry.second.expired(); });
    const std::pair key{content, std::type_index(typeid(T))};
    if (const auto known = models_.find(key); known != models_.end())
      return std::static_pointer_cast<const T>(known->second.lock());
    std::shared_ptr<const T> made = make();
    models_[key] = made;
    return made;
  }

private:
  std::map<std::pair<std::uint64_t, std::type_index>, std::weak_ptr<const void>> models_;
};

}  // namespace aureole
