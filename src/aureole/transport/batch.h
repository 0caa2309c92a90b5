// SPDX-License-Identifier: Apache-2.0
// Paths that are followed together, and their rays. The records of a batch lie in the arena of the thread
// (transport/arena.h); how many there are is known when the batch begins.
#pragma once

#include <new>
#include <utility>

#include "aureole/scene/scene.h"
#include "aureole/transport/arena.h"

namespace aureole {

/// Most paths that a job hands to an integrator at once, the size of a packet of rays.
inline constexpr int kBatch = RayPacket::kSize;

/// Storage for one T per path of a batch. Records are made in place when they are needed, since they are
/// large: clearing or copying them costs measurable time.
template <class T>
class PerPath {
public:
  PerPath(Arena& arena, std::size_t paths) : records_(arena.allocate<T>(paths)) {}
  /// Constructs the record of a path in place from the result of `make`.
  template <class Make>
  T& make(int path, Make&& make) {
    return *new (records_ + path) T(make());
  }
  T& operator[](int path) { return *std::launder(records_ + path); }
  const T& operator[](int path) const { return *std::launder(records_ + path); }

private:
  T* records_;
};

/// Some paths of a batch, each at most once.
class PathList {
public:
  PathList(Arena& arena, std::size_t paths) : paths_(arena.allocate<int>(paths)) {}
  void add(int path) { paths_[count_++] = path; }
  void clear() { count_ = 0; }
  bool empty() const { return count_ == 0; }
  const int* begin() const { return paths_; }
  const int* end() const { return paths_ + count_; }
  /// Keeps the paths for which `is_kept` is true.
  template <class IsKept>
  void keep(const IsKept& is_kept) {
    int kept = 0;
    for (int i = 0; i < count_; ++i)
      if (is_kept(paths_[i])) paths_[kept++] = paths_[i];
    count_ = kept;
  }

private:
  int* paths_;
  int count_ = 0;
};

/// The rays of some paths of a batch, in packets for the ray tracer.
class BatchRays {
public:
  BatchRays(Arena& arena, std::size_t paths)
      : paths_(arena.allocate<int>(paths)),
        packets_(arena.make<RayPacket>((paths + RayPacket::kSize - 1) / RayPacket::kSize).data()) {}
  void add(int path, const Ray& ray) {
    packets_[unsigned(count_) / RayPacket::kSize].set(count_ % RayPacket::kSize, ray);
    paths_[count_++] = path;
  }
  bool empty() const { return count_ == 0; }

  /// Traces all rays and calls `use(path, hit)` for each in order. `use` may add a ray of the path, which the next
  /// call traces.
  template <class Use>
  void intersect(const RayTracer& tracer, RayTracer::Rays kind, Use&& use) {
    RayTracer::Hit hits[RayPacket::kSize];
    for_packets([&](const RayPacket& rays, int n) { tracer.intersect(rays, n, kind, hits); },
                [&](int path, int lane) { use(path, hits[lane]); });
  }
  /// Tests all rays as segments and calls `use(path, open)` for each in order.
  template <class Use>
  void test_visibility(const RayTracer& tracer, Use&& use) {
    bool blocked[RayPacket::kSize];
    for_packets([&](const RayPacket& rays, int n) { tracer.occluded(rays, n, blocked); },
                [&](int path, int lane) { use(path, !blocked[lane]); });
  }

private:
  /// Takes all rays: trace(packet, count), then use(path, lane) for each ray of the packet. `use` adds at most one
  /// ray for each that it gets, so that it overwrites only rays that were traced.
  template <class Trace, class Use>
  [[gnu::always_inline]] inline void for_packets(const Trace& trace, const Use& use) {
    const int all = std::exchange(count_, 0);
    for (int first = 0; first < all; first += RayPacket::kSize) {
      const int n = std::min(all - first, RayPacket::kSize);
      trace(packets_[first / RayPacket::kSize], n);
      for (int i = 0; i < n; ++i) use(paths_[first + i], i);
    }
  }

  int* paths_;
  RayPacket* packets_;
  int count_ = 0;
};

}  // namespace aureole
