// SPDX-License-Identifier: Apache-2.0
#include "aureole/bsdf/measured/tensor_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <bit>
#include <cmath>
#include <cstring>

#include "aureole/core/parallel.h"

static_assert(std::endian::native == std::endian::little, "tensor files are little-endian");

namespace aureole {
namespace {

constexpr std::string_view kTensorMagic("tensor_file\0", 12);
constexpr std::size_t kMaxTensorFields = 256, kMaxTensorAxes = 8;

std::size_t size_of(TensorType type) {
  constexpr std::size_t kSizes[] = {0, 1, 1, 2, 2, 4, 4, 8, 8, 2, 4, 8};
  return kSizes[std::size_t(type)];
}

/// Reads numbers one after the other from bytes, and fails where the bytes end too early.
class TensorHeader {
public:
  TensorHeader(std::span<const std::byte> bytes, const TensorFile& file) : bytes_(bytes), file_(file) {}

  template <class T>
  T next() {
    T value;
    std::memcpy(&value, take(sizeof value), sizeof value);
    return value;
  }
  std::string text(std::size_t length) { return {reinterpret_cast<const char*>(take(length)), length}; }

private:
  const std::byte* take(std::size_t length) {
    if (bytes_.size() - at_ < length)
      throw file_.error(
          fmt::format("the header ends at byte {}, the end of the file: it is truncated", bytes_.size()));
    const std::byte* found = bytes_.data() + at_;
    at_ += length;
    return found;
  }
  std::span<const std::byte> bytes_;
  const TensorFile& file_;
  std::size_t at_ = 0;
};

}  // namespace

std::size_t TensorField::count() const { return bytes.size() / size_of(type); }

std::string shape_text(std::span<const std::size_t> shape) {
  return fmt::format("{}", fmt::join(shape, " x "));
}

Error TensorFile::error(const std::string& message) const { return Error({file_.string(), 0, 0}, message); }

TensorFile::TensorFile(const std::filesystem::path& file) : file_(file), content_(map_file(file)) {
  const std::span<const std::byte> bytes = content_.bytes;
  if (bytes.size() < kTensorMagic.size() ||
      std::memcmp(bytes.data(), kTensorMagic.data(), kTensorMagic.size()) != 0)
    throw error("not a tensor file (.bsdf of RGL's material database), which begins with \"tensor_file\"");
  TensorHeader header(bytes, *this);
  header.text(kTensorMagic.size());
  const int major = header.next<std::uint8_t>(), minor = header.next<std::uint8_t>();
  if (major != 1)
    throw error(fmt::format("a tensor file of version {}.{}; version 1.0 is known", major, minor));
  const std::uint32_t count = header.next<std::uint32_t>();
  if (count > kMaxTensorFields)
    throw error(fmt::format("states {} fields; at most {} are allowed", count, kMaxTensorFields));
  for (std::uint32_t i = 0; i < count; ++i) {
    TensorField f;
    f.name = header.text(header.next<std::uint16_t>());
    const std::size_t axes = header.next<std::uint16_t>();
    const std::uint8_t type = header.next<std::uint8_t>();
    if (type < 1 || type > std::uint8_t(TensorType::float64))
      throw error(
          fmt::format("field {} has the unknown type {}; 1 (uint8) to 11 (float64) are known", i + 1, type));
    if (axes > kMaxTensorAxes)
      throw error(fmt::format("field {} has {} axes; at most {} are allowed", i + 1, axes, kMaxTensorAxes));
    f.type = TensorType(type);
    const std::uint64_t offset = header.next<std::uint64_t>();
    std::uint64_t size = size_of(f.type);
    for (std::size_t axis = 0; axis < axes; ++axis) {
      const std::uint64_t n = header.next<std::uint64_t>();
      // The product stays below the size of the file and cannot overflow, even where an axis has the length
      // 0.
      if (n > bytes.size() || (n > 0 && size > bytes.size() / n))
        throw error(
            fmt::format("field {} has more numbers than the file has bytes ({})", i + 1, bytes.size()));
      f.shape.push_back(std::size_t(n));
      size *= n;
    }
    if (offset > bytes.size() || size > bytes.size() - offset)
      throw error(fmt::format("field \"{}\" ends at byte {}, but the file has {}: it is truncated",
                              f.name.substr(0, 80), offset > bytes.size() ? offset : offset + size,
                              bytes.size()));
    f.bytes = bytes.subspan(std::size_t(offset), std::size_t(size));
    fields_.push_back(std::move(f));
  }
}

const TensorField* TensorFile::find(std::string_view name) const {
  for (const TensorField& f : fields_)
    if (f.name == name) return &f;
  return nullptr;
}

const TensorField& TensorFile::field(std::string_view name) const {
  if (const TensorField* f = find(name)) return *f;
  std::vector<std::string> names;
  for (const TensorField& f : fields_) names.push_back(f.name.substr(0, 40));
  throw error(fmt::format("there is no field \"{}\"; the file has {}", name,
                          names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "))));
}

std::vector<float> TensorFile::floats(std::string_view name, std::size_t axes) const {
  const TensorField& f = field(name);
  if (f.type != TensorType::float32 && f.type != TensorType::float64)
    throw error(fmt::format("field \"{}\" has numbers of type {}; float32 (10) or float64 (11) is expected",
                            name, int(f.type)));
  if (f.shape.size() != axes)
    throw error(fmt::format("field \"{}\" has {} axes; {} are expected", name, f.shape.size(), axes));
  std::vector<float> numbers(f.count());
  for_ranges(numbers.size(), [&](std::size_t begin, std::size_t end) {
    if (f.type == TensorType::float32)
      std::memcpy(numbers.data() + begin, f.bytes.data() + begin * sizeof(float),
                  (end - begin) * sizeof(float));
    else
      for (std::size_t i = begin; i < end; ++i) {
        double d;
        std::memcpy(&d, f.bytes.data() + i * sizeof d, sizeof d);
        numbers[i] = float(d);
      }
    for (std::size_t i = begin; i < end; ++i)
      if (!std::isfinite(numbers[i]))
        throw error(fmt::format("field \"{}\": number {} of {} is not finite", name, i + 1, numbers.size()));
  });
  return numbers;
}

std::string TensorFile::text(std::string_view name) const {
  const TensorField& f = field(name);
  if (f.type != TensorType::uint8 || f.shape.size() != 1)
    throw error(fmt::format("field \"{}\" is not a row of bytes (uint8)", name));
  return {reinterpret_cast<const char*>(f.bytes.data()), f.bytes.size()};
}

void TensorFileWriter::add(std::string name, std::vector<std::size_t> shape, std::span<const float> numbers) {
  entries_.push_back({std::move(name), TensorType::float32, std::move(shape),
                      std::string(reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes())});
}

void TensorFileWriter::add_bytes(std::string name, std::string_view bytes) {
  entries_.push_back({std::move(name), TensorType::uint8, {bytes.size()}, std::string(bytes)});
}

std::string TensorFileWriter::content() const {
  std::size_t header = kTensorMagic.size() + 2 + 4;
  for (const Entry& e : entries_) header += 2 + e.name.size() + 2 + 1 + 8 + 8 * e.shape.size();
  std::string out(kTensorMagic);
  const auto put = [&](auto value) { out.append(reinterpret_cast<const char*>(&value), sizeof value); };
  put(std::uint8_t(1)), put(std::uint8_t(0)), put(std::uint32_t(entries_.size()));
  const auto aligned = [](std::size_t at) { return (at + 7) / 8 * 8; };
  std::size_t at = header;
  for (const Entry& e : entries_) {
    at = aligned(at);
    put(std::uint16_t(e.name.size()));
    out += e.name;
    put(std::uint16_t(e.shape.size())), put(std::uint8_t(e.type)), put(std::uint64_t(at));
    for (const std::size_t n : e.shape) put(std::uint64_t(n));
    at += e.bytes.size();
  }
  for (const Entry& e : entries_) {
    out.resize(aligned(out.size()));
    out += e.bytes;
  }
  return out;
}

}  // namespace aureole
