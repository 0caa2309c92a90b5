// SPDX-License-Identifier: Apache-2.0
#include "aureole/render/state.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string_view>

#include "aureole/core/error.h"
#include "aureole/core/input_file.h"
#include "aureole/core/output_file.h"
#include "aureole/render/sample_density.h"

namespace aureole {

namespace {

constexpr char kMagic[] = "aureole-state-3\n";
/// The part of the magic that all versions of the format share.
constexpr std::string_view kAnyVersion = "aureole-state-";
constexpr std::size_t kMagicSize = sizeof kMagic - 1;

std::uint64_t checksum(const char* p, std::size_t n) {
  std::uint64_t h = 0xcbf29ce484222325u;
  // Hashes eight bytes per step: checkpoints of large films must not wait for a byte-wise hash.
  for (; n >= 8; p += 8, n -= 8) {
    std::uint64_t word;
    std::memcpy(&word, p, 8);
    h = (h ^ word) * 0x100000001b3u;
    h ^= h >> 29;
  }
  for (; n; ++p, --n) h = (h ^ std::uint8_t(*p)) * 0x100000001b3u;
  return h;
}

nlohmann::json header_of(const RenderState& s) {
  const PictureIdentity& i = s.identity;
  return {{"scene", i.scene},
          {"version", i.version},
          {"sampler", i.sampler},
          {"integrator", i.integrator},
          {"adaptive", i.adaptive},
          {"density_size", s.density.size()},
          {"done_ranges", s.done.ranges().size()},
          {"scene_hash", i.scene_hash},
          {"seed", i.seed},
          {"random_version", i.random_version},
          {"wavelengths", i.wavelengths},
          {"width", i.width},
          {"height", i.height},
          {"border", i.border},
          {"measured_channels", i.measured_channels},
          {"splat_channels", i.splat_channels},
          {"replicates", i.replicates},
          {"names", s.development.names},
          {"meanings", s.development.meanings},
          {"rows", s.development.rows},
          {"rgb_rows", s.development.rgb_rows},
          {"half", s.development.half},
          {"begin", s.begin},
          {"end", s.end},
          {"invalid_samples", s.invalid_samples},
          {"seconds", s.seconds},
          {"approximations", s.approximations}};
}

}  // namespace

std::string PictureIdentity::difference(const PictureIdentity& o) const {
  if (version != o.version) return "program version (" + version + " and " + o.version + ")";
  if (random_version != o.random_version) return "assignment of random numbers";
  if (scene_hash != o.scene_hash) return "scene";
  if (width != o.width || height != o.height || border != o.border ||
      measured_channels != o.measured_channels || splat_channels != o.splat_channels)
    return "film";
  if (seed != o.seed) return "seed (" + std::to_string(seed) + " and " + std::to_string(o.seed) + ")";
  if (sampler != o.sampler) return "sampler (" + sampler + " and " + o.sampler + ")";
  if (integrator != o.integrator) return "integrator (" + integrator + " and " + o.integrator + ")";
  if (adaptive != o.adaptive) return "adaptive sampling (" + adaptive + " and " + o.adaptive + ")";
  if (replicates != o.replicates) return "number of replicates";
  if (wavelengths != o.wavelengths) return "number of wavelengths per path";
  return "";
}

RenderState::RenderState(PictureIdentity id, Development d, std::int64_t first, std::int64_t last)
    : identity(std::move(id)), development(std::move(d)), begin(first), end(last) {
  for (int r = 0; r < identity.replicates; ++r)
    films.emplace_back(identity.width, identity.height, identity.measured_channels);
  for (int r = 0; r < identity.replicates && identity.splat_channels > 0; ++r)
    splats.emplace_back(identity.width, identity.height, identity.splat_channels);
}

void RenderState::mean(std::size_t replicate, int x, int y, double* measured, double* alpha) const {
  films[replicate].mean(x, y, measured, alpha);
  if (!splats.empty()) splats[replicate].add_means(x, y, measured);
}

std::int64_t RenderState::units_done() const { return done.count(); }

WorkUnit RenderState::unit(std::int64_t index) const {
  const std::int64_t tile = index % tiles();
  WorkUnit u;
  u.replicate = int(index / tiles() % identity.replicates);
  u.x0 = int(tile % tiles_x()) * kTileSize - identity.border;
  u.y0 = int(tile / tiles_x()) * kTileSize - identity.border;
  u.x1 = std::min(u.x0 + kTileSize, identity.width + identity.border);
  u.y1 = std::min(u.y0 + kTileSize, identity.height + identity.border);
  u.first = begin + index / units_per_block() * kSampleBlock;
  u.last = std::min(u.first + kSampleBlock, end);
  return u;
}

std::int64_t RenderState::samples_everywhere() const {
  const std::int64_t per_block = units_per_block();
  std::int64_t samples = 0;
  for (const UnitRanges::Range& range : done.ranges()) {
    // The blocks that lie in the range as a whole. The last block of the picture may be cut short.
    const std::int64_t first = (range.begin + per_block - 1) / per_block, last = range.end / per_block;
    if (first < last) samples += std::min(last * kSampleBlock, end - begin) - first * kSampleBlock;
  }
  return samples;
}

void RenderState::set_range(std::int64_t new_begin, std::int64_t new_end) {
  if (new_begin == begin && new_end == end) return;
  const std::int64_t per_block = units_per_block();
  // Blocks at the ends of a range of units are checked; the blocks between have the same samples before and
  // after.
  const auto require_block = [&](std::int64_t block) {
    const std::int64_t sample = begin + block * kSampleBlock;
    const std::int64_t old_stop = std::min(sample + kSampleBlock, end),
                       new_stop = std::min(sample + kSampleBlock, new_end);
    if (sample < new_begin || sample >= new_end || old_stop != new_stop)
      throw Error("samples " + std::to_string(sample) + ":" + std::to_string(old_stop) +
                  " are done already and do not fit into the samples " + std::to_string(new_begin) + ":" +
                  std::to_string(new_end) + " asked for (use multiples of " + std::to_string(kSampleBlock) +
                  ")");
  };
  const std::int64_t moved = (begin - new_begin) / kSampleBlock * per_block;
  UnitRanges changed;
  for (const UnitRanges::Range& range : done.ranges()) {
    require_block(range.begin / per_block);
    require_block((range.end - 1) / per_block);
    changed.insert({range.begin + moved, range.end + moved});
  }
  begin = new_begin, end = new_end;
  done = std::move(changed);
}

void RenderState::merge(const RenderState& other) {
  if (const std::string d = identity.difference(other.identity); !d.empty())
    throw Error("these states belong to different pictures: they differ in their " + d);
  if (!density.empty() && !other.density.empty() && density != other.density)
    throw Error(
        "these states spread adaptive samples differently over the pixels: they were rendered by different "
        "machines");
  RenderState b = other;
  const std::int64_t first = std::min(begin, b.begin), last = std::max(end, b.end);
  set_range(first, last);
  b.set_range(first, last);
  for (const UnitRanges::Range& range : b.done.ranges())
    if (const auto unit = done.first_in(range)) {
      const std::int64_t sample = begin + *unit / units_per_block() * kSampleBlock;
      throw Error("the states overlap: both hold samples from " + std::to_string(sample) + " on");
    }
  for (const UnitRanges::Range& range : b.done.ranges()) done.insert(range);
  for (std::size_t r = 0; r < films.size(); ++r) films[r].add(b.films[r]);
  for (std::size_t r = 0; r < splats.size(); ++r) splats[r].add(b.splats[r]);
  invalid_samples += b.invalid_samples;
  seconds += b.seconds;
  for (std::string& text : b.approximations)
    if (std::find(approximations.begin(), approximations.end(), text) == approximations.end())
      approximations.push_back(std::move(text));
  if (density.empty()) density = std::move(b.density);
}

std::vector<char> RenderState::to_bytes() const {
  const std::string header =
      header_of(*this).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  std::vector<char> bytes;
  const std::vector<UnitRanges::Range> ranges = done.ranges();
  const std::size_t ranges_size = ranges.size() * sizeof(UnitRanges::Range);
  std::size_t size = kMagicSize + 8 + header.size() + ranges_size + density.size() + 8;
  for (const auto* buffers : {&films, &splats})
    for (const auto& f : *buffers) size += f.data().size() * sizeof(Fixed);
  bytes.reserve(size);
  const auto append = [&](const void* p, std::size_t n) {
    bytes.insert(bytes.end(), static_cast<const char*>(p), static_cast<const char*>(p) + n);
  };
  append(kMagic, kMagicSize);
  const std::uint64_t header_size = header.size();
  append(&header_size, 8);
  append(header.data(), header.size());
  append(ranges.data(), ranges_size);
  append(density.data(), density.size());
  for (const auto* buffers : {&films, &splats})
    for (const auto& f : *buffers) append(f.data().data(), f.data().size() * sizeof(Fixed));
  const std::uint64_t sum = checksum(bytes.data(), bytes.size());
  append(&sum, 8);
  return bytes;
}

void RenderState::save(const std::filesystem::path& file) const { write_file_atomically(file, to_bytes()); }

namespace {

/// Whether the map to the picture's channels has the sizes that it needs: a factor for each measured channel.
bool fits(const Development& d, const PictureIdentity& id) {
  const auto has_channels = [&](const std::vector<float>& row) {
    return row.size() == std::size_t(id.measured_channels) &&
           std::all_of(row.begin(), row.end(), [](float f) { return std::isfinite(f); });
  };
  // A channel without a row, the last, is alpha.
  const bool names =
      !d.names.empty() && (d.rows.size() == d.names.size() || d.rows.size() + 1 == d.names.size());
  return names && (d.meanings.empty() || d.meanings.size() == d.names.size()) && d.rgb_rows.size() == 3 &&
         std::all_of(d.rows.begin(), d.rows.end(), has_channels) &&
         std::all_of(d.rgb_rows.begin(), d.rgb_rows.end(), has_channels);
}

}  // namespace

RenderState RenderState::load(const std::filesystem::path& file) {
  constexpr std::uint64_t kMaxBytes = std::uint64_t(1) << 42;
  InputFile in(file);
  in.require_at_most(kMaxBytes);
  std::vector<char> bytes(in.size());
  in.read(bytes.data(), bytes.size());
  return from_bytes(bytes, {file.string(), 0, 0});
}

RenderState RenderState::from_bytes(std::span<const char> bytes, const SourceLocation& where) {
  const Error broken(where, "is not a complete state file");
  const std::string_view beginning(bytes.data(), std::min(bytes.size(), kMagicSize));
  if (beginning != std::string_view(kMagic) && beginning.starts_with(kAnyVersion))
    throw Error(where, "is a state file of another version of the program");
  if (bytes.size() < kMagicSize + 16 || beginning != std::string_view(kMagic)) throw broken;
  std::uint64_t header_size, sum;
  std::memcpy(&header_size, bytes.data() + kMagicSize, 8);
  std::memcpy(&sum, bytes.data() + bytes.size() - 8, 8);
  if (sum != checksum(bytes.data(), bytes.size() - 8) || header_size > bytes.size() - kMagicSize - 16)
    throw broken;
  try {
    const char* p = bytes.data() + kMagicSize + 8;
    const auto j = nlohmann::json::parse(p, p + header_size);
    RenderState s;
    PictureIdentity id;
    id.scene = j.at("scene"), id.version = j.at("version"), id.random_version = j.value("random_version", 1),
    id.sampler = j.at("sampler"), id.integrator = j.at("integrator"), id.adaptive = j.at("adaptive");
    id.scene_hash = j.at("scene_hash"), id.seed = j.at("seed"), id.wavelengths = j.at("wavelengths");
    id.width = j.at("width"), id.height = j.at("height"), id.border = j.at("border");
    id.measured_channels = j.at("measured_channels"), id.replicates = j.at("replicates");
    id.splat_channels = j.value("splat_channels", 0);
    Development d;
    d.names = j.at("names").get<std::vector<std::string>>();
    d.meanings = j.value("meanings", std::vector<std::string>());
    d.rows = j.at("rows").get<std::vector<std::vector<float>>>();
    d.rgb_rows = j.at("rgb_rows").get<std::vector<std::vector<float>>>();
    d.half = j.at("half");
    const std::int64_t begin = j.at("begin"), end = j.at("end");
    const std::size_t density_size = j.at("density_size"), range_count = j.at("done_ranges");
    // Sizes are checked before memory is allocated for them.
    const auto within = [](double x, double least, double most) { return x >= least && x <= most; };
    if (!within(id.width, 1, 1 << 20) || !within(id.height, 1, 1 << 20) || !within(id.border, 0, 64) ||
        !within(id.measured_channels, 1, 1 << 20) || !within(id.replicates, 1, 1 << 30) ||
        !within(id.splat_channels, 0, id.measured_channels) || !within(double(begin), 0, double(end)) ||
        !within(double(end), 0, 0x1p33) || begin % kSampleBlock != 0 || !fits(d, id))
      throw broken;
    const double left = double(bytes.data() + bytes.size() - 8 - p) - double(header_size);
    const double tiles = (double(id.width) + 2 * id.border + kTileSize) *
                         (double(id.height) + 2 * id.border + kTileSize) / (kTileSize * kTileSize);
    if (state_bytes(id) + double(range_count) * sizeof(UnitRanges::Range) + double(density_size) > left ||
        tiles * id.replicates * (double(end - begin) / kSampleBlock + 1) > 0x1p60)
      throw broken;
    s = RenderState(id, d, begin, end);
    s.invalid_samples = j.at("invalid_samples"), s.seconds = j.at("seconds");
    if (j.contains("approximations"))
      s.approximations = j.at("approximations").get<std::vector<std::string>>();
    p += header_size;
    if (density_size != 0 && density_size != s.sampled_pixels()) throw broken;
    s.density.resize(density_size);
    std::size_t needed = range_count * sizeof(UnitRanges::Range) + density_size;
    for (auto* buffers : {&s.films, &s.splats})
      for (auto& f : *buffers) needed += f.data().size() * sizeof(Fixed);
    if (needed != std::size_t(bytes.data() + bytes.size() - 8 - p)) throw broken;
    std::int64_t after = -1;  // two ranges that touch would be one
    for (std::size_t i = 0; i < range_count; ++i, p += sizeof(UnitRanges::Range)) {
      UnitRanges::Range range;
      std::memcpy(&range, p, sizeof range);
      if (range.begin <= after || range.end <= range.begin || range.end > s.units()) throw broken;
      after = range.end;
      s.done.insert(range);
    }
    if (density_size > 0) std::memcpy(s.density.data(), p, density_size);
    p += density_size;
    for (const std::int8_t e : s.density)
      if (e < kMinDensityExponent || e > kMaxDensityExponent) throw broken;
    const auto& targets = adaptive_target_names();
    const bool known = std::find(targets.begin(), targets.end(), id.adaptive) != targets.end();
    if (!known || (density_size > 0 && id.adaptive == "none")) throw broken;
    if (density_size == 0 && id.adaptive != "none" && s.units_done() > 0) throw broken;
    for (auto* buffers : {&s.films, &s.splats})
      for (auto& f : *buffers) {
        std::memcpy(f.data().data(), p, f.data().size() * sizeof(Fixed));
        p += f.data().size() * sizeof(Fixed);
      }
    return s;
  } catch (const nlohmann::json::exception&) {
    throw broken;
  }
}

Image RenderState::picture() const {
  Image image;
  image.width = identity.width, image.height = identity.height;
  image.channels = development.names;
  const std::size_t n = development.names.size();
  const bool variances = identity.replicates > 1;
  if (variances)
    for (std::size_t c = 0; c < n; ++c) image.channels.push_back("variance." + development.names[c]);
  image.pixels.resize(std::size_t(image.width) * image.height * image.channels.size());
  std::vector<double> measured(std::size_t(identity.measured_channels)), sum(n);
  // Only the nonzero range of each row is used: a film of a thousand bins has rows with one factor each.
  std::vector<std::pair<std::size_t, std::size_t>> nonzero;
  for (const auto& row : development.rows) {
    std::size_t begin = 0, end = row.size();
    while (begin < end && row[begin] == 0) ++begin;
    while (end > begin && row[end - 1] == 0) --end;
    nonzero.emplace_back(begin, end);
  }
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      std::fill(sum.begin(), sum.end(), 0.0);
      std::vector<std::vector<double>> values(films.size(), std::vector<double>(n));
      for (std::size_t r = 0; r < films.size(); ++r) {
        double alpha;
        mean(r, x, y, measured.data(), &alpha);
        for (std::size_t c = 0; c < n; ++c) {
          double v = 0;
          if (c < development.rows.size())
            for (std::size_t k = nonzero[c].first; k < nonzero[c].second; ++k)
              v += double(development.rows[c][k]) * measured[k];
          else
            v = alpha;
          values[r][c] = v;
          sum[c] += v;
        }
      }
      const double replicates = double(films.size());
      for (std::size_t c = 0; c < n; ++c) {
        const double mean = sum[c] / replicates;
        image.at(x, y, c) = float(mean);
        if (!variances) continue;
        double squares = 0;
        for (std::size_t r = 0; r < films.size(); ++r)
          squares += (values[r][c] - mean) * (values[r][c] - mean);
        image.at(x, y, n + c) = float(squares / (replicates - 1) / replicates);
      }
    }
  return image;
}

Image RenderState::rgb_picture() const {
  Image image;
  image.width = identity.width, image.height = identity.height;
  image.channels = {"R", "G", "B"};
  image.pixels.resize(std::size_t(image.width) * image.height * 3);
  std::vector<double> measured(std::size_t(identity.measured_channels));
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      float rgb[3] = {};
      for (std::size_t r = 0; r < films.size(); ++r) {
        double alpha;
        mean(r, x, y, measured.data(), &alpha);
        for (std::size_t c = 0; c < 3; ++c)
          for (std::size_t k = 0; k < measured.size(); ++k)
            rgb[c] += float(double(development.rgb_rows[c][k]) * measured[k] / double(films.size()));
      }
      for (std::size_t c = 0; c < 3; ++c) image.at(x, y, c) = rgb[c];
    }
  return image;
}

Image display_picture(Image rgb) {
  for (float& value : rgb.pixels) {
    constexpr float knee = 0.8f;
    float v = std::max(0.f, value);
    if (v > knee) v = knee + (1 - knee) * (1 - std::exp(-(v - knee) / (1 - knee)));
    value = srgb_encode(std::min(v, 1.f));
  }
  rgb.srgb_encoded = true;
  return rgb;
}

double state_bytes(int width, int height, int measured_channels, int replicates) {
  return double(width) * height * (measured_channels + 2) * sizeof(Fixed) * replicates;
}
double state_bytes(const PictureIdentity& id) {
  return state_bytes(id.width, id.height, id.measured_channels, id.replicates) +
         (id.splat_channels > 0 ? state_bytes(id.width, id.height, id.splat_channels, id.replicates) : 0);
}

}  // namespace aureole
