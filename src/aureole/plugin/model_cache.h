// SPDX-License-Identifier: Apache-2.0
// `ModelCache`: tables that take seconds to compute, found by what they are made of, so that equal objects share
// them, those of one scene and those of its next versions.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <typeindex>
#include <utility>

namespace aureole {

class ModelCache {
public:
  /// The model of type T made from `content`, a hash of everything that it depends on, or else the one that
  /// `make` returns. It lives for as long as somebody uses it.
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
