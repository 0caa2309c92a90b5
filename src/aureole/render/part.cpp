// SPDX-License-Identifier: Apache-2.0
#include "aureole/render/part.h"

#include <zstd.h>

#include <algorithm>
#include <string>
#include <utility>

#include "aureole/core/error.h"

namespace aureole {

namespace {

constexpr int kFastLevel = 1;  ///< of Zstandard's levels of compression
/// Bytes that a state may be larger than a plan's: its list of units and longer numbers in its header.
constexpr std::size_t kSlack = std::size_t(1) << 20;

std::string units_text(const std::vector<UnitRanges::Range>& ranges) {
  if (ranges.empty()) return "none";
  std::string text;
  constexpr std::size_t kShown = 4;
  for (std::size_t i = 0; i < std::min(ranges.size(), kShown); ++i)
    text += (i ? ", " : "") + std::to_string(ranges[i].begin) + " to " + std::to_string(ranges[i].end - 1);
  return text + (ranges.size() > kShown ? ", ..." : "");
}

bool same_films(const std::vector<FilmBuffer>& a, const std::vector<FilmBuffer>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const FilmBuffer& p, const FilmBuffer& q) { return p.data() == q.data(); });
}

}  // namespace

std::vector<char> packed_part(const RenderState& state) {
  const std::vector<char> bytes = state.to_bytes();
  std::vector<char> packed(ZSTD_compressBound(bytes.size()));
  const std::size_t size =
      ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), kFastLevel);
  if (ZSTD_isError(size))
    throw Error(std::string("a part of the picture could not be compressed: ") + ZSTD_getErrorName(size));
  packed.resize(size);
  return packed;
}

PartSum::PartSum(RenderState state) : state_(std::move(state)) {
  largest_ = state_.to_bytes().size() + state_.sampled_pixels() + kSlack;
}

void PartSum::resume(std::span<const char> state_file, const SourceLocation& where) {
  RenderState found = RenderState::from_bytes(state_file, where);
  if (const std::string d = state_.identity.difference(found.identity); !d.empty())
    throw Error(where, "the saved state belongs to another picture: they differ in their " + d);
  try {
    found.set_range(state_.begin, state_.end);
  } catch (const Error& e) {
    throw Error(where, e.message());
  }
  state_ = std::move(found);
}

RenderState PartSum::unpacked(std::span<const char> packed) const {
  const unsigned long long stated = ZSTD_getFrameContentSize(packed.data(), packed.size());
  if (stated == ZSTD_CONTENTSIZE_ERROR || stated == ZSTD_CONTENTSIZE_UNKNOWN)
    throw Error("the part is damaged: it is not compressed by zstd");
  if (stated > largest_)
    throw Error("the part is damaged: it has " + std::to_string(stated) +
                " bytes, a state of this picture at most " + std::to_string(largest_));
  std::vector<char> bytes(stated);
  const std::size_t size = ZSTD_decompress(bytes.data(), bytes.size(), packed.data(), packed.size());
  if (ZSTD_isError(size) || size != bytes.size())
    throw Error(std::string("the part is damaged: ") +
                (ZSTD_isError(size) ? ZSTD_getErrorName(size) : "it is not complete"));
  RenderState part = RenderState::from_bytes(bytes, {"part", 0, 0});
  if (const std::string d = state_.identity.difference(part.identity); !d.empty())
    throw Error("the part belongs to another picture: they differ in their " + d);
  if (part.begin != state_.begin || part.end != state_.end)
    throw Error("the part has the samples " + std::to_string(part.begin) + ":" + std::to_string(part.end) +
                ", the picture " + std::to_string(state_.begin) + ":" + std::to_string(state_.end));
  return part;
}

RenderState PartSum::checked(std::span<const char> packed, const UnitRanges::Range& units) const {
  RenderState part = unpacked(packed);
  if (part.done.ranges() != std::vector{units})
    throw Error("the part has the units " + units_text(part.done.ranges()) + ", expected " +
                units_text({units}));
  return part;
}

void PartSum::add(std::span<const char> packed, const UnitRanges::Range& units) {
  state_.merge(checked(packed, units));
}

RenderState PartSum::start() const {
  RenderState empty(state_.identity, state_.development, state_.begin, state_.end);
  empty.density = state_.density;
  return empty;
}

bool same_samples(const RenderState& a, const RenderState& b) {
  return a.identity.difference(b.identity).empty() && a.begin == b.begin && a.end == b.end &&
         a.done == b.done && a.density == b.density && a.invalid_samples == b.invalid_samples &&
         same_films(a.films, b.films) && same_films(a.splats, b.splats);
}

}  // namespace aureole
