// SPDX-License-Identifier: Apache-2.0
#include "aureole/render/state.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstring>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
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

RenderJob small_job() {
  RenderOptions options;
  options.end = 16, options.replicates = 2;
  return RenderJob(small_scene(9, 7), options);
}

/// Runs a job to its end, saves its state and returns the bytes of the file.
std::string finished(RenderJob& job, const std::filesystem::path& file) {
  job.run(std::atomic<bool>{false});
  job.state().save(file);
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(RenderState, SurvivesAFileAndRefusesABrokenOne) {
  const TemporaryFolder folder;
  RenderJob job = small_job();
  const auto file = folder.path / "a.state";
  const std::string bytes = finished(job, file);
  const RenderState loaded = RenderState::load(file);
  EXPECT_TRUE(same_bits(job.state(), loaded));
  EXPECT_EQ(loaded.done, job.state().done);
  EXPECT_EQ(loaded.identity.difference(job.state().identity), "");

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

/// A state file whose header was changed, with the checksum that belongs to it.
std::string forged(const std::string& bytes, const std::function<void(nlohmann::json&)>& change) {
  constexpr std::size_t kMagic = 16;
  std::uint64_t size;
  std::memcpy(&size, bytes.data() + kMagic, 8);
  nlohmann::json header = nlohmann::json::parse(bytes.substr(kMagic + 8, size));
  change(header);
  const std::string text = header.dump() + "\n";
  size = text.size();
  std::string made = bytes.substr(0, kMagic) + std::string(reinterpret_cast<const char*>(&size), 8) + text;
  std::memcpy(&size, bytes.data() + kMagic, 8);
  made += bytes.substr(kMagic + 8 + size, bytes.size() - 8 - (kMagic + 8 + size));
  std::uint64_t h = 0xcbf29ce484222325u;
  std::size_t at = 0;
  for (; at + 8 <= made.size(); at += 8) {
    std::uint64_t word;
    std::memcpy(&word, made.data() + at, 8);
    h = (h ^ word) * 0x100000001b3u;
    h ^= h >> 29;
  }
  for (; at < made.size(); ++at) h = (h ^ std::uint8_t(made[at])) * 0x100000001b3u;
  return made + std::string(reinterpret_cast<const char*>(&h), 8);
}

TEST(RenderState, ForgedSizesAreRefused) {
  const TemporaryFolder folder;
  RenderJob job = small_job();
  const auto other = folder.path / "forged.state";
  const std::string bytes = finished(job, folder.path / "a.state");
  const auto load = [&](const std::function<void(nlohmann::json&)>& change) {
    std::ofstream(other, std::ios::binary) << forged(bytes, change);
    return RenderState::load(other);
  };
  EXPECT_TRUE(same_bits(load([](nlohmann::json&) {}), job.state()));  // the checksum is right
  using Rows = std::vector<std::vector<float>>;
  const std::pair<const char*, nlohmann::json> cases[] = {{"rgb_rows", Rows()},
                                                          {"rgb_rows", Rows(2, std::vector<float>(3, 1.f))},
                                                          {"rgb_rows", Rows(3)},
                                                          {"rows", Rows()},
                                                          {"rows", Rows(3, std::vector<float>(20000, 1.f))},
                                                          {"rows", Rows(100, std::vector<float>(3, 1.f))},
                                                          {"names", std::vector<std::string>()},
                                                          {"names", std::vector<std::string>(50, "R")},
                                                          {"measured_channels", 1},
                                                          {"measured_channels", 4},
                                                          {"splat_channels", 3},
                                                          {"replicates", 1},
                                                          {"replicates", 1 << 30},
                                                          {"width", 8},
                                                          {"width", 0},
                                                          {"width", 1 << 20},
                                                          {"height", -7},
                                                          {"border", 64},
                                                          {"begin", 3},
                                                          {"begin", -16},
                                                          {"end", 17},
                                                          {"end", std::int64_t(1) << 33},
                                                          {"density_size", 63},
                                                          {"density_size", std::int64_t(1) << 40},
                                                          {"adaptive", "nothing"}};
  for (const auto& [key, value] : cases)
    EXPECT_THROW(load([&](nlohmann::json& header) { header[key] = value; }), Error) << key << value;

  // Any other change gives an error, or a state that can be used.
  std::mt19937 random(7);
  const nlohmann::json values[] = {nullptr,
                                   -1,
                                   0,
                                   1,
                                   2,
                                   3,
                                   15,
                                   64,
                                   1e9,
                                   1e300,
                                   true,
                                   "text",
                                   Rows(3, {1.f, 2.f}),
                                   std::vector<std::string>(3, ""),
                                   nlohmann::json::object()};
  int loaded = 0;
  for (int i = 0; i < 2000; ++i) {
    try {
      RenderState state = load([&](nlohmann::json& header) {
        for (std::size_t n = 1 + random() % 2; n > 0; --n) {
          auto entry = header.begin();
          std::advance(entry, std::ptrdiff_t(random() % header.size()));
          *entry = values[random() % std::size(values)];
        }
      });
      ++loaded;
      state.picture(), state.rgb_picture();
      state.merge(job.state());
    } catch (const Error&) {
    }
  }
  EXPECT_GT(loaded, 100);
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
