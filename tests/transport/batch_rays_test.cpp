// SPDX-License-Identifier: Apache-2.0
// Rays of batches that are larger than a packet, traced while others are added.
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "aureole/loading/load.h"
#include "aureole/transport/batch.h"

namespace aureole::testing {
namespace {

std::shared_ptr<const Scene> discs() {
  return load_scene_from_string(R"(<scene version="3.0.0"><sensor type="perspective"/>
      <shape type="disk"/><shape type="disk"><transform name="to_world"><translate z="-1"/></transform></shape></scene>)",
                                "discs.xml")
      .scene;
}
/// Ray i of some that meet the first disc, the second one behind it, or none.
Ray ray(int i) { return {{0.05f * float(i), 0, i % 3 == 1 ? -0.5f : 2}, {0, 0, -1}, kInfinity}; }

TEST(BatchRays, AreTracedInOrderWhileOthersAreAdded) {
  const auto scene = discs();
  for (int n : {0, 1, 15, 16, 17, 40})
    for (int again : {0, 1, 2, 5}) {  // every n-th path goes on behind its hit, 0: none
      const Arena::Frame frame;
      BatchRays rays(frame.arena(), std::size_t(n));
      for (int i = 0; i < n; ++i) rays.add(i, ray(i));
      std::vector<int> order, further;
      rays.intersect(scene->tracer(), RayTracer::Rays::incoherent, [&](int i, const RayTracer::Hit& hit) {
        const RayTracer::Hit alone = scene->tracer().intersect(ray(i));
        EXPECT_EQ(bool(hit), bool(alone)) << n << ", " << i;
        if (hit) EXPECT_EQ(hit.t, alone.t) << n << ", " << i;
        order.push_back(i);
        if (again > 0 && i % again == 0) rays.add(i, ray(i + 1)), further.push_back(i);
      });
      ASSERT_EQ(int(order.size()), n);
      for (int i = 0; i < n; ++i) ASSERT_EQ(order[std::size_t(i)], i);
      ASSERT_EQ(rays.empty(), further.empty());
      std::size_t k = 0;
      rays.test_visibility(scene->tracer(), [&](int i, bool open) {
        ASSERT_LT(k, further.size());
        EXPECT_EQ(i, further[k++]);
        EXPECT_EQ(open, !scene->tracer().occluded(ray(i + 1))) << n << ", " << i;
      });
      EXPECT_EQ(k, further.size());
      EXPECT_TRUE(rays.empty());
    }
}

}  // namespace
}  // namespace aureole::testing
