// SPDX-License-Identifier: Apache-2.0
#include "aureole/render/state.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <functional>
#include <limits>
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

TEST(UnitRanges, AreSets) {
  std::mt19937 random(3);
  for (int round = 0; round < 200; ++round) {
    std::vector<bool> flags(60);
    UnitRanges set;
    const int count = int(random() % 40);
    for (int i = 0; i < count; ++i) {
      const std::int64_t begin = random() % 60, end = std::min<std::int64_t>(60, begin + random() % 4);
      set.insert({begin, end});
      for (std::int64_t unit = begin; unit < end; ++unit) flags[std::size_t(unit)] = true;
    }
    EXPECT_EQ(set.count(), std::count(flags.begin(), flags.end(), true));
    for (std::int64_t a = 0; a < 60; ++a) {
      EXPECT_EQ(set.contains(a), flags[std::size_t(a)]);
      std::int64_t end = a;
      while (end < 60 && flags[std::size_t(end)]) ++end;
      EXPECT_EQ(set.end_of(a), end);
      const auto begin = flags.begin() + a;
      for (std::int64_t b = a; b <= 60; b += 7) {
        const auto stop = flags.begin() + b, found = std::find(begin, stop, true);
        EXPECT_EQ(set.count({a, b}), std::count(begin, stop, true));
        EXPECT_EQ(set.contains({a, b}), std::count(begin, stop, true) == b - a);
        EXPECT_EQ(set.first_in({a, b}).value_or(b), found - flags.begin());
      }
    }
    UnitRanges again;
    const auto ranges = set.ranges();
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      again.insert(ranges[i]);
      EXPECT_TRUE(i == 0 || ranges[i].begin > ranges[i - 1].end);
    }
    EXPECT_EQ(again, set);
  }
}

TEST(RenderState, ManySamplesTakeNoMemory) {
  const TemporaryFolder folder;
  RenderOptions options;
  options.end = std::int64_t(1) << 31;
  RenderJob job(small_scene(64, 64), options);
  RenderState state = job.state();
  EXPECT_EQ(state.units(), std::int64_t(1) << 31);
  state.done.insert({0, 16 * 1000 + 3});
  state.done.insert({(std::int64_t(1) << 31) - 16, std::int64_t(1) << 31});
  EXPECT_EQ(state.samples_everywhere(), 16 * 1001);
  const auto file = folder.path / "a.state";
  state.save(file);
  EXPECT_LT(std::filesystem::file_size(file), 1u << 20);
  const RenderState loaded = RenderState::load(file);
  EXPECT_EQ(loaded.done, state.done);
  EXPECT_EQ(loaded.units_done(), 16 * 1001 + 3);
  // A run continues where nothing is done, without a step for each unit that is.
  state.done.insert({0, state.units() - 1});
  job.resume(state);
  EXPECT_EQ(job.run(std::atomic<bool>{false}), RenderJob::Outcome::finished);
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
  RenderJob job = small_job();
  job.run(std::atomic<bool>{false});
  const std::vector<char> saved = job.state().to_bytes();
  const std::string bytes(saved.data(), saved.size());
  const auto load = [&](const std::function<void(nlohmann::json&)>& change) {
    return RenderState::from_bytes(forged(bytes, change), {});
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
                                                          {"border", 65},
                                                          {"begin", 3},
                                                          {"begin", -16},
                                                          {"density_size", 63},
                                                          {"density_size", std::int64_t(1) << 40},
                                                          {"done_ranges", 0},
                                                          {"done_ranges", 2},
                                                          {"done_ranges", std::int64_t(1) << 60},
                                                          {"adaptive", "nothing"}};
  for (const auto& [key, value] : cases)
    EXPECT_THROW(load([&](nlohmann::json& header) { header[key] = value; }), Error) << key << value;
}

/// Changes a value somewhere in a document to another one.
void change_somewhere(nlohmann::json& value, std::mt19937& random) {
  using Rows = std::vector<std::vector<float>>;
  static const nlohmann::json values[] = {nullptr,
                                          -1,
                                          0,
                                          1,
                                          2,
                                          3,
                                          15,
                                          16,
                                          64,
                                          1e9,
                                          1e300,
                                          std::numeric_limits<std::int64_t>::max(),
                                          std::numeric_limits<std::int64_t>::min(),
                                          std::numeric_limits<std::uint64_t>::max(),
                                          true,
                                          "text",
                                          Rows(3, {1.f, 2.f}),
                                          std::vector<std::string>(3, ""),
                                          nlohmann::json::object()};
  if (value.is_structured() && !value.empty() && random() % 4 != 0) {
    auto entry = value.begin();
    std::advance(entry, std::ptrdiff_t(random() % value.size()));
    return change_somewhere(*entry, random);
  }
  if (value.is_number_integer() && random() % 2 == 0)
    value = std::int64_t(std::uint64_t(value.get<std::int64_t>()) + std::uint64_t(random() % 41) - 20);
  else
    value = values[random() % std::size(values)];
}

// State files with damage in any part and the checksum that belongs to it are errors, or states that can be used:
// developed, saved, merged, continued. AUREOLE_STATE_CASES is the number of files, AUREOLE_STATE_SEED chooses them.
TEST(RenderState, ForgedFilesAreErrorsOrStates) {
  const auto option = [](const char* name, int otherwise) {
    const char* text = std::getenv(name);
    return text ? std::atoi(text) : otherwise;
  };
  const int cases = option("AUREOLE_STATE_CASES", 3000);
  std::mt19937 random(unsigned(option("AUREOLE_STATE_SEED", 7)));
  RenderOptions options;
  options.end = 40, options.replicates = 2;
  RenderOptions adaptive = options;
  adaptive.replicates = 1, adaptive.adaptive = AdaptiveTarget::absolute;
  const std::pair<LoadedScene, RenderOptions> pictures[] = {{small_scene(20, 7), options},
                                                            {small_scene(9, 7), adaptive}};
  std::vector<RenderState> whole;
  std::vector<std::string> files;
  for (const auto& [scene, with] : pictures) {
    RenderJob job(scene, with);
    job.run(std::atomic<bool>{false});
    RenderState part = whole.emplace_back(job.state());
    const std::vector<char> complete = part.to_bytes();
    part.done = {};
    part.done.insert({1, 2}), part.done.insert({3, part.units()});
    const std::vector<char> begun = part.to_bytes();
    for (const auto& bytes : {complete, begun}) files.emplace_back(bytes.data(), bytes.size());
  }
  int loaded = 0, used = 0;
  for (int i = 0; i < cases; ++i) {
    std::string bytes = files[random() % files.size()];
    std::uint64_t header;
    std::memcpy(&header, bytes.data() + 16, 8);
    // Bytes behind the header: ranges, densities, films; sometimes in it.
    for (unsigned n = random() % 4; n > 0; --n) {
      const std::size_t first = random() % 16 == 0 ? 24 : 24 + header, length = bytes.size() - 8 - first;
      const std::size_t at =
          first + random() % (random() % 2 == 0 ? std::min<std::size_t>(length, 64) : length);
      bytes[at] = char(random() % 3 == 0 ? 0xff : random());
    }
    if (random() % 16 == 0) bytes.erase(24 + header + random() % 64, random() % 64);
    try {
      const std::string made = forged(bytes, [&](nlohmann::json& document) {
        for (unsigned n = random() % 3; n > 0; --n) change_somewhere(document, random);
      });
      RenderState state = RenderState::from_bytes(made, {"forged", 0, 0});
      ++loaded;
      state.picture(), state.rgb_picture();
      EXPECT_GE(state.samples_everywhere(), 0);
      EXPECT_LE(state.units_done(), state.units());
      const std::vector<char> again = state.to_bytes();
      EXPECT_EQ(RenderState::from_bytes(again, {}).to_bytes(), again) << i;
      for (std::size_t k = 0; k < whole.size(); ++k) {
        RenderState sum = whole[k];
        try {
          sum.merge(state);
          sum.picture();
        } catch (const Error&) {
        }
        try {
          RenderJob job(pictures[k].first, pictures[k].second);
          job.resume(state);
          job.run(std::atomic<bool>{true});
          ++used;
        } catch (const Error&) {
        }
      }
    } catch (const Error&) {
    } catch (const nlohmann::json::exception&) {  // the header itself was damaged
    }
  }
  RecordProperty("loaded", loaded);
  EXPECT_GT(loaded, cases / 10);
  EXPECT_GT(used, cases / 50);
}

TEST(RenderState, RangesOfUnitsAreChecked) {
  const TemporaryFolder folder;
  RenderJob job = small_job();
  const auto other = folder.path / "forged.state";
  const std::string bytes = finished(job, folder.path / "a.state");
  std::uint64_t header;
  std::memcpy(&header, bytes.data() + 16, 8);
  for (const auto& [begin, end] : {std::pair<std::int64_t, std::int64_t>{-1, 2},
                                   {0, 3},
                                   {1, 1},
                                   {2, 1},
                                   {0, std::numeric_limits<std::int64_t>::max()},
                                   {std::numeric_limits<std::int64_t>::min(), 2}}) {
    std::string changed = bytes;
    std::memcpy(changed.data() + 24 + header, &begin, 8);
    std::memcpy(changed.data() + 32 + header, &end, 8);
    std::ofstream(other, std::ios::binary) << forged(changed, [](nlohmann::json&) {});
    EXPECT_THROW(RenderState::load(other), Error) << begin << ":" << end;
  }
  std::string older = bytes;
  older[14] = '2';
  std::ofstream(other, std::ios::binary) << older;
  try {
    RenderState::load(other);
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("another version of the program"), std::string::npos) << e.what();
  }
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
