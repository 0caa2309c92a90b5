// SPDX-License-Identifier: Apache-2.0
#include "aureole/render/state.h"

#include <gtest/gtest.h>

#include <fstream>
#include <random>

#include "loading/load_text.h"
#include "render/small_scene.h"

namespace aureole::test {
namespace {

TEST(FilmBuffer, AdditionIsExactAndNeedsNoOrder) {
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  std::vector<std::vector<float>> blocks(200, std::vector<float>(5 * 4 * 5));
  for (auto& b : blocks)
    for (size_t i = 0; i < b.size(); ++i)
      b[i] = i % 5 == 4 ? 1.f : normal(random) * std::pow(10.f, float(random() % 12) - 6);
  FilmBuffer forward(8, 8, 3), backward(8, 8, 3);
  for (size_t i = 0; i < blocks.size(); ++i)
    forward.add(int(i % 7) - 2, int(i % 5) - 2, 5, 4, blocks[i].data());
  for (size_t i = blocks.size(); i-- > 0;)
    backward.add(int(i % 7) - 2, int(i % 5) - 2, 5, 4, blocks[i].data());
  EXPECT_EQ(forward.data(), backward.data());
}

TEST(FilmBuffer, KeepsFloatsAndWeights) {
  FilmBuffer f(1, 1, 1);
  const float sums[3] = {3e-5f * 4, 4, 4};
  f.add(0, 0, 1, 1, sums);
  double measured, alpha;
  f.mean(0, 0, &measured, &alpha);
  EXPECT_NEAR(measured, 3e-5, 1e-11);
  EXPECT_EQ(alpha, 1);
}

TEST(RenderState, SurvivesAFileAndRefusesABrokenOne) {
  const TemporaryFolder folder;
  const std::atomic<bool> go{false};
  RenderOptions options;
  options.end = 16, options.replicates = 2;
  RenderJob job(small_scene(9, 7), options);
  job.run(go);
  const auto file = folder.path / "a.state";
  job.state().save(file);
  const RenderState loaded = RenderState::load(file);
  EXPECT_TRUE(same_bits(job.state(), loaded));
  EXPECT_EQ(loaded.done, job.state().done);
  EXPECT_EQ(loaded.identity.difference(job.state().identity), "");

  std::ifstream in(file, std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(in)), {});
  for (size_t n : {size_t(0), size_t(10), size_t(30), bytes.size() / 2, bytes.size() - 1}) {
    std::ofstream(folder.path / "cut.state", std::ios::binary) << bytes.substr(0, n);
    EXPECT_THROW(RenderState::load(folder.path / "cut.state"), Error) << n;
  }
  for (size_t i : {size_t(3), size_t(20), size_t(200), bytes.size() / 2, bytes.size() - 4}) {
    std::string changed = bytes;
    changed[i] = char(changed[i] ^ 0x40);
    std::ofstream(folder.path / "bad.state", std::ios::binary) << changed;
    EXPECT_THROW(RenderState::load(folder.path / "bad.state"), Error) << i;
  }
  EXPECT_THROW(RenderState::load(folder.path / "none.state"), Error);
}

TEST(RenderState, OfAnotherAssignmentOfRandomNumbersIsNotTakenUp) {
  RenderOptions options;
  options.end = 16;
  RenderJob job(small_scene(9, 7), options);
  TemporaryFolder folder;
  job.state().save(folder.path / "one.state");
  RenderState state = RenderState::load(folder.path / "one.state");
  EXPECT_EQ(state.identity.random_version, job.state().identity.random_version);
  EXPECT_GT(state.identity.random_version, 1) << "files without the number are of version 1";
  state.identity.random_version = 1;
  try {
    job.resume(std::move(state));
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("random numbers"), std::string::npos) << e.what();
  }
}

TEST(RenderState, VarianceIsThatOfTheMeanOverReplicates) {
  const std::atomic<bool> go{false};
  RenderOptions options;
  options.end = 16, options.replicates = 5;
  RenderJob job(small_scene(9, 7), options);
  job.run(go);
  const Image all = job.state().picture();
  std::vector<double> values;
  for (int r = 0; r < 5; ++r) {
    RenderState one = job.state();
    one.identity.replicates = 1;
    one.films = {job.state().films[size_t(r)]};
    const Image p = one.picture();
    values.push_back(p.at(4, 3, size_t(p.channel("G"))));
  }
  double mean = 0, squares = 0;
  for (double v : values) mean += v / 5;
  for (double v : values) squares += (v - mean) * (v - mean);
  EXPECT_NEAR(all.at(4, 3, size_t(all.channel("G"))), mean, 1e-6 * mean);
  EXPECT_NEAR(all.at(4, 3, size_t(all.channel("variance.G"))), squares / 4 / 5, 1e-5 * squares);
}

TEST(RenderState, HugeFilmsAreRefusedPolitely) {
  try {
    RenderJob(small_scene(900000, 900000), {});
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("GiB"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace aureole::test
