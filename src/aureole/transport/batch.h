// SPDX-License-Identifier: Apache-2.0
// Paths that are followed together, and their rays.
#pragma once

#include <array>
#include <new>
#include <type_traits>
#include <utility>

#include "aureole/scene/scene.h"

namespace aureole {

/// Upper bound of the number of paths of a batch.
inline constexpr int kBatch = RayPacket::kSize;

/// Storage for one T per path of a batch. Records are made in place when they are needed, since they are
/// large: clearing or copying them costs measurable time.
template <class T>
class PerPath {
public:
  static_assert(std::is_trivially_destructible_v<T>);
  /// Constructs the record of a path in place from the result of `make`.
  template <class Make>
  T& make(int path, Make&& make) {
    return *new (room_[size_t(path)].bytes) T(make());
  }
  T& operator[](int path) { return *std::launder(reinterpret_cast<T*>(room_[size_t(path)].bytes)); }

private:
  struct Room {
    alignas(T) std::byte bytes[sizeof(T)];
  };
  std::array<Room, kBatch> room_;
};

/// Some paths of a batch, at most all of them.
struct PathList {
  int count = 0;
  int path[kBatch];

  void add(int p) { path[count++] = p; }
  const int* begin() const { return path; }
  const int* end() const { return path + count; }
};

/// The rays of some paths of a batch.
class BatchRays {
public:
  void add(int path, const Ray& ray) {
    rays_.set(paths_.count, ray);
    paths_.add(path);
  }
  bool empty() const { return paths_.count == 0; }

  /// Traces all rays and calls `use(path, hit)` for each in order. `use` may add rays, which the next call
  /// traces.
  template <class Use>
  void intersect(const RayTracer& tracer, RayTracer::Rays kind, Use&& use) {
    tracer.intersect(rays_, paths_.count, kind, hits_);
    const int n = std::exchange(paths_.count, 0);
    // `use` adds at most one ray for each hit, so that it overwrites only entries that have been read.
    for (int i = 0; i < n; ++i) use(paths_.path[i], hits_[i]);
  }
  /// Tests all rays as segments and calls `use(path, open)` for each in order.
  template <class Use>
  void test_visibility(const RayTracer& tracer, Use&& use) {
    bool blocked[kBatch];
    tracer.occluded(rays_, paths_.count, blocked);
    for (int i = 0; i < paths_.count; ++i) use(paths_.path[i], !blocked[i]);
    paths_.count = 0;
  }

private:
  PathList paths_;
  RayPacket rays_;
  RayTracer::Hit hits_[kBatch];
};

}  // namespace aureole
