// SPDX-License-Identifier: Apache-2.0
#include "aureole/render/part.h"

#include <gtest/gtest.h>
#include <zstd.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <random>
#include <string>

#include "loading/load_text.h"
#include "render/small_scene.h"

namespace aureole::test {
namespace {

void expect_error(const std::function<void()>& action, const std::string& text) {
  try {
    action();
    ADD_FAILURE() << "no error; expected: " << text;
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find(text), std::string::npos) << e.what();
  }
}

/// Renders the units of one part, as a worker does.
RenderState rendered_part(const LoadedScene& scene, RenderOptions options, UnitRanges::Range units,
                          const RenderState* start = nullptr) {
  options.units = units;
  RenderJob job(scene, options);
  if (start) job.resume(*start);
  EXPECT_EQ(job.run(std::atomic<bool>{false}), RenderJob::Outcome::finished);
  return job.state();
}

LoadedScene two_way_scene() {
  std::string text = small_scene_text(40, 28);
  const std::string path = "<integrator type=\"path\">";
  text.replace(text.find(path), path.size(), "<integrator type=\"bdpt\">");
  return load_scene_from_string(text, "small.xml");
}

RenderOptions replicated(int replicates) {
  RenderOptions options;
  options.end = 40, options.replicates = replicates;
  return options;
}

RenderOptions adaptive_options() {
  RenderOptions options;
  options.end = 48, options.adaptive = AdaptiveTarget::display;
  return options;
}

TEST(PartSum, HasTheBitsOfOneMachineInAnyOrder) {
  std::mt19937 random(7);
  const std::pair<LoadedScene, RenderOptions> pictures[] = {{small_scene(), replicated(1)},
                                                            {small_scene(33, 20), replicated(2)},
                                                            {small_scene(), adaptive_options()},
                                                            {two_way_scene(), replicated(1)}};
  for (const auto& [scene, options] : pictures) {
    RenderJob whole(scene, options);
    whole.run(std::atomic<bool>{false});
    PartSum sum(planned_state(scene, options));
    const std::int64_t units = sum.state().units();
    // The first unit is rendered first, since its state has the densities of adaptive samples.
    const RenderState first = rendered_part(scene, options, {0, 1});
    sum.add(packed_part(first), {0, 1});
    const RenderState start = sum.start();
    EXPECT_EQ(start.units_done(), 0);
    std::vector<UnitRanges::Range> parts;
    for (std::int64_t begin = 1; begin < units;) {
      const std::int64_t end = std::min<std::int64_t>(units, begin + 1 + std::int64_t(random() % 7));
      parts.push_back({begin, end});
      begin = end;
    }
    std::shuffle(parts.begin(), parts.end(), random);
    for (const UnitRanges::Range& part : parts)
      sum.add(packed_part(rendered_part(scene, options, part, &start)), part);
    EXPECT_EQ(sum.state().units_done(), units);
    EXPECT_TRUE(same_bits(whole.state(), sum.state())) << scene.integrator->properties().type();
    EXPECT_TRUE(same_samples(whole.state(), sum.state()));
    EXPECT_EQ(whole.state().invalid_samples, sum.state().invalid_samples);
  }
}

TEST(PartSum, RefusesWhatWasNotAskedFor) {
  const LoadedScene scene = small_scene();
  const RenderOptions options = replicated(1);
  PartSum sum(planned_state(scene, options));
  const RenderState part = rendered_part(scene, options, {2, 5});
  const std::vector<char> packed = packed_part(part);
  const auto refuses = [&](const std::vector<char>& bytes, UnitRanges::Range units, const char* why) {
    expect_error([&] { sum.add(bytes, units); }, why);
    EXPECT_EQ(sum.state().units_done(), 0);
  };
  refuses(packed, {2, 6}, "the part has the units 2 to 4, expected 2 to 5");
  refuses({packed.begin(), packed.end() - 9}, {2, 5}, "damaged");
  refuses({}, {2, 5}, "not compressed");
  std::vector<char> flipped = packed;
  flipped[flipped.size() / 2] = char(flipped[flipped.size() / 2] ^ 4);
  EXPECT_THROW(sum.add(flipped, {2, 5}), Error);
  RenderOptions other = options;
  other.seed = 9;
  refuses(packed_part(rendered_part(scene, other, {2, 5})), {2, 5}, "they differ in their seed");
  other = options, other.end = 24;
  refuses(packed_part(rendered_part(scene, other, {2, 5})), {2, 5}, "has the samples 0:24, the picture 0:40");
  refuses(packed_part(rendered_part(small_scene(41, 28), options, {2, 5})), {2, 5}, "differ in their");
  // A frame of 1 GB of zeros is refused by the size that it states.
  std::vector<char> zeros(std::size_t(1) << 24);
  std::vector<char> bomb(ZSTD_compressBound(zeros.size()));
  bomb.resize(ZSTD_compress(bomb.data(), bomb.size(), zeros.data(), zeros.size(), 1));
  refuses(bomb, {2, 5}, "a state of this picture at most");

  sum.add(packed, {2, 5});
  expect_error([&] { sum.add(packed, {2, 5}); }, "overlap");
  EXPECT_EQ(sum.state().units_done(), 3);
  EXPECT_TRUE(same_samples(sum.state(), sum.unpacked(packed)));
  RenderState changed = part;
  changed.films[0].data()[17] += 1;
  EXPECT_FALSE(same_samples(part, changed));
  changed = part, changed.seconds += 5;
  EXPECT_TRUE(same_samples(part, changed));
}

TEST(PartSum, GoesOnFromAStateFile) {
  const LoadedScene scene = small_scene();
  const RenderOptions options = replicated(1);
  RenderOptions shorter = options;
  shorter.end = 32;
  const std::vector<char> state = rendered_part(scene, shorter, {3, 9}).to_bytes();
  PartSum sum(planned_state(scene, options));
  sum.resume(state, {"a.state", 0, 0});
  EXPECT_EQ(sum.state().done.ranges(), (std::vector<UnitRanges::Range>{{3, 9}}));
  EXPECT_EQ(sum.state().end, 40);
  RenderOptions other = options;
  other.seed = 3;
  PartSum wrong(planned_state(scene, other));
  expect_error(
      [&] {
        wrong.resume(state, {"a.state", 0, 0});
      },
      "a.state: the saved state belongs to another picture");
  expect_error(
      [&] {
        wrong.resume(std::vector<char>(100), {"a.state", 0, 0});
      },
      "is not a complete state file");
}

TEST(PartSum, UnitsOutsideOfThePictureAreAnError) {
  RenderOptions options = replicated(1);
  options.units = UnitRanges::Range{5, 1 << 20};
  expect_error([&] { RenderJob job(small_scene(), options); }, "are not a part of the 18 of this picture");
}

}  // namespace
}  // namespace aureole::test
