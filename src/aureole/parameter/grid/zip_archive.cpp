// SPDX-License-Identifier: Apache-2.0
#include "aureole/parameter/grid/zip_archive.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <new>

#include "aureole/parameter/grid/grid_reader.h"

namespace aureole {

namespace {

/// A number of little-endian bytes from byte `at` of the archive. Throws Error where the archive ends before.
template <class T>
T zip_number(const SharedBytes& bytes, std::uint64_t at) {
  static_assert(std::endian::native == std::endian::little);
  if (at > bytes.size() || bytes.size() - at < sizeof(T))
    throw Error("is no complete zip archive: it ends within a header");
  T value;
  std::memcpy(&value, bytes.bytes.data() + at, sizeof value);
  return value;
}

constexpr std::uint32_t kLocalHeader = 0x04034b50, kDirectoryEntry = 0x02014b50, kDirectoryEnd = 0x06054b50,
                        kDirectoryEnd64 = 0x06064b50, kDirectoryLocator64 = 0x07064b50;
constexpr std::uint64_t kIn64 = 0xffffffff;  ///< stands for a number in an extra field

/// Returns the place of the record that ends the directory; a comment of at most 65535 bytes may follow it.
std::uint64_t find_directory_end(const SharedBytes& bytes) {
  constexpr std::uint64_t kRecord = 22, kLongestComment = 65535;
  if (bytes.size() < kRecord) throw Error("is too short for a zip archive");
  const std::uint64_t last = bytes.size() - kRecord, first = last - std::min(last, kLongestComment);
  for (std::uint64_t at = last + 1; at-- > first;)
    if (zip_number<std::uint32_t>(bytes, at) == kDirectoryEnd) return at;
  throw Error("is no complete zip archive: its directory is missing");
}

}  // namespace

ZipArchive::ZipArchive(const SharedBytes& bytes) : bytes_(bytes) {
  const std::uint64_t end = find_directory_end(bytes);
  std::uint64_t count = zip_number<std::uint16_t>(bytes, end + 10),
                at = zip_number<std::uint32_t>(bytes, end + 16);
  if (end >= 20 && zip_number<std::uint32_t>(bytes, end - 20) == kDirectoryLocator64) {
    const auto record = zip_number<std::uint64_t>(bytes, end - 12);
    if (record > bytes.size() || zip_number<std::uint32_t>(bytes, record) != kDirectoryEnd64)
      throw Error("is damaged: its zip directory is not where it should be");
    count = zip_number<std::uint64_t>(bytes, record + 32), at = zip_number<std::uint64_t>(bytes, record + 48);
  }
  constexpr std::uint64_t kShortestEntry = 46;
  if (count > bytes.size() / kShortestEntry)
    throw Error(fmt::format("is damaged: its zip directory claims {} members", count));
  for (std::uint64_t i = 0; i < count; ++i) {
    if (zip_number<std::uint32_t>(bytes, at) != kDirectoryEntry)
      throw Error(fmt::format("is damaged: entry {} of its zip directory is none", i));
    Member m;
    const auto flags = zip_number<std::uint16_t>(bytes, at + 8);
    m.method = zip_number<std::uint16_t>(bytes, at + 10);
    m.packed_bytes = zip_number<std::uint32_t>(bytes, at + 20);
    m.bytes = zip_number<std::uint32_t>(bytes, at + 24);
    m.offset = zip_number<std::uint32_t>(bytes, at + 42);
    const std::uint64_t name = zip_number<std::uint16_t>(bytes, at + 28),
                        extra = zip_number<std::uint16_t>(bytes, at + 30),
                        comment = zip_number<std::uint16_t>(bytes, at + 32);
    if (at + kShortestEntry + name + extra > bytes.size())
      throw Error("is no complete zip archive: it ends within its directory");
    m.name.assign(reinterpret_cast<const char*>(bytes.bytes.data() + at + kShortestEntry), std::size_t(name));
    if (flags & 1) throw Error("has the encrypted member \"" + m.name.substr(0, 60) + "\"");
    // Sizes of 64 bits stand in an extra field of the kind 1, in this order, those alone that do not fit.
    std::uint64_t field = at + kShortestEntry + name;
    const std::uint64_t extra_end = field + extra;
    while (field + 4 <= extra_end) {
      const auto kind = zip_number<std::uint16_t>(bytes, field);
      const std::uint64_t length = zip_number<std::uint16_t>(bytes, field + 2);
      if (kind == 1) {
        std::uint64_t value = field + 4;
        for (std::uint64_t* number : {&m.bytes, &m.packed_bytes, &m.offset})
          if (*number == kIn64) {
            if (value + 8 > field + 4 + length)
              throw Error("is damaged: sizes of its zip directory are missing");
            *number = zip_number<std::uint64_t>(bytes, value), value += 8;
          }
      }
      field += 4 + length;
    }
    at += kShortestEntry + name + extra + comment;
    members_.push_back(std::move(m));
  }
}

const ZipArchive::Member* ZipArchive::find(std::string_view name) const {
  const auto found =
      std::find_if(members_.begin(), members_.end(), [&](const Member& m) { return m.name == name; });
  return found == members_.end() ? nullptr : &*found;
}

SharedBytes ZipArchive::read(const Member& m) const {
  const std::string shown = "\"" + m.name.substr(0, 60) + "\"";
  if (m.offset > bytes_.size() || zip_number<std::uint32_t>(bytes_, m.offset) != kLocalHeader)
    throw Error("is damaged: its member " + shown + " is not where the directory says");
  const std::uint64_t start = m.offset + 30 + zip_number<std::uint16_t>(bytes_, m.offset + 26) +
                              zip_number<std::uint16_t>(bytes_, m.offset + 28);
  if (start > bytes_.size() || m.packed_bytes > bytes_.size() - start)
    throw Error(fmt::format("is truncated: its member {} needs {} bytes from byte {}, but it has {}", shown,
                            m.packed_bytes, start, bytes_.size()));
  const SharedBytes packed{bytes_.bytes.subspan(std::size_t(start), std::size_t(m.packed_bytes)),
                           bytes_.owner};
  constexpr unsigned kStored = 0, kDeflated = 8;
  if (m.method == kStored) {
    if (m.bytes != m.packed_bytes) throw Error("is damaged: its member " + shown + " has two sizes");
    return packed;
  }
  if (m.method != kDeflated)
    throw Error(fmt::format("has the member {} compressed by method {}; 0 (stored) and 8 (deflated) are read",
                            shown, m.method));
  return grid_reader::inflate_raw(packed, m.bytes);
}

std::string make_zip(std::span<const std::pair<std::string, std::string>> members) {
  std::string out, directory;
  const auto add = [](std::string& to, auto value) {
    to.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  const auto limited = [](std::uint64_t value) {
    if (value >= kIn64) throw Error("needs more than 4 GiB, the end of a zip archive without further fields");
    return std::uint32_t(value);
  };
  for (const auto& [name, bytes] : members) {
    // The library's own sum of lengths and its stream have one header, so that a raw stream is asked for.
    z_stream stream{};
    if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, -15, 9, Z_DEFAULT_STRATEGY) != Z_OK)
      throw std::bad_alloc();
    limited(bytes.size());
    std::string packed(deflateBound(&stream, uLong(bytes.size())), '\0');
    limited(packed.size());
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = unsigned(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(packed.data()), stream.avail_out = unsigned(packed.size());
    deflate(&stream, Z_FINISH);
    packed.resize(packed.size() - stream.avail_out);
    deflateEnd(&stream);
    const auto crc =
        std::uint32_t(crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), unsigned(bytes.size())));
    const std::uint32_t offset = limited(out.size());
    // From the version that is needed up to the length of the extra field; the time is 1980-01-01.
    const auto add_common = [&](std::string& to) {
      for (const unsigned v : {20u, 0u, 8u, 0u, 0x21u}) add(to, std::uint16_t(v));
      add(to, crc), add(to, std::uint32_t(packed.size())), add(to, std::uint32_t(bytes.size()));
      add(to, std::uint16_t(name.size())), add(to, std::uint16_t(0));
    };
    add(out, kLocalHeader), add_common(out);
    out += name + packed;
    add(directory, kDirectoryEntry), add(directory, std::uint16_t(20)), add_common(directory);
    for (int k = 0; k < 3; ++k) add(directory, std::uint16_t(0));
    add(directory, std::uint32_t(0)), add(directory, offset);
    directory += name;
  }
  const std::uint32_t offset = limited(out.size());
  out += directory;
  add(out, kDirectoryEnd), add(out, std::uint32_t(0));
  for (int k = 0; k < 2; ++k) add(out, std::uint16_t(members.size()));
  add(out, std::uint32_t(directory.size())), add(out, offset), add(out, std::uint16_t(0));
  return out;
}

}  // namespace aureole
