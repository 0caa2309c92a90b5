// SPDX-License-Identifier: Apache-2.0
#include "aureole/core/table_cache.h"

#include <fcntl.h>
#include <gnu/libc-version.h>
#include <sys/stat.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <system_error>

#include "aureole/core/error.h"
#include "aureole/core/input_file.h"
#include "aureole/core/output_file.h"
#include "aureole/core/source_hash.h"
#include "aureole/core/table_fields.h"
#include "aureole/core/version.h"

namespace aureole {

namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t kTableFileMagic = 0x31304c4254525541u;  ///< "AURTBL01"
constexpr const char *kTableEnding = ".table", *kLimitName = "limit";
constexpr std::size_t kNameDigits = 32;
/// No table may take more than this part of the folder.
constexpr std::uint64_t kLargestPart = 4;
/// An upper bound of the size of a file that is read, whatever it says.
constexpr std::uint64_t kLargestTableFile = std::uint64_t(1) << 33;

/// The first bytes of an entry.
struct Preamble {
  std::uint64_t magic = kTableFileMagic, header_bytes = 0, table_bytes = 0, checksum = 0;
};

/// The part of an entry that says what it is.
struct EntryHeader {
  TableKey key;
  std::string build;
  double seconds = 0;
  std::vector<std::uint32_t> reads;
  std::vector<std::string> note_names, notes;

  template <class Self, class Fields>
  static void fields(Self& self, Fields& all) {
    all(self.key.table, self.key.version, self.key.inputs, self.key.made_for, self.build, self.seconds,
        self.reads, self.note_names, self.notes);
  }
};

std::uint64_t checksum_of(const char* data, std::size_t size) {
  WordHash<> hash;
  hash.bytes(data, size);
  return hash.value();
}

std::string hexadecimal(const WideHashValue& value) {
  char text[2 * 16 + 1];
  std::snprintf(text, sizeof text, "%016llx%016llx", static_cast<unsigned long long>(value[0]),
                static_cast<unsigned long long>(value[1]));
  return text;
}

bool is_entry_name(const std::string& name) {
  return name.size() == kNameDigits + std::char_traits<char>::length(kTableEnding) &&
         name.ends_with(kTableEnding) &&
         std::all_of(name.begin(), name.begin() + kNameDigits,
                     [](unsigned char c) { return std::isxdigit(c) && !std::isupper(c); });
}

/// The file by which programs that make backups know a folder that they leave out (Cache Directory Tagging Specification, B. Ford).
constexpr const char* kTagName = "CACHEDIR.TAG";

/// Whether the cache writes files of that name.
bool is_name_of_cache(const std::string& name) { return is_entry_name(name) || name == kTagName; }

/// Reads the header of an entry, which leaves `input` at the table. Throws Error.
EntryHeader read_header(InputFile& input, Preamble& preamble, std::vector<char>& header_bytes) {
  input.read(&preamble, sizeof preamble);
  if (preamble.magic != kTableFileMagic) throw Error("it is no table of this format");
  if (preamble.header_bytes > input.left() || preamble.table_bytes != input.left() - preamble.header_bytes)
    throw Error("it is not complete");
  header_bytes.resize(preamble.header_bytes);
  input.read(header_bytes.data(), header_bytes.size());
  EntryHeader header;
  TableReader reader(header_bytes);
  EntryHeader::fields(header, reader);
  if (!reader.is_complete() || header.note_names.size() != header.notes.size())
    throw Error("its header is damaged");
  return header;
}

std::string in_megabytes(std::uint64_t bytes) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g MB", double(bytes) * 1e-6);
  return text;
}

}  // namespace

std::string table_build() {
  const bool wide = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                    __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
  return std::string("aureole ") + kVersion + " " + kSourceHash + (wide ? " AVX-512" : " AVX2") + " glibc " +
         gnu_get_libc_version();
}

std::uint64_t parse_bytes(const std::string& text) {
  const std::size_t digits = std::min(text.find_first_not_of("0123456789."), text.size());
  double number = -1;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + digits, number);
  std::string unit = text.substr(digits);
  while (!unit.empty() && unit.front() == ' ') unit.erase(0, 1);
  constexpr std::pair<const char*, double> kUnits[] = {
      {"", 1},      {"B", 1},        {"kB", 1e3},     {"KB", 1e3},     {"MB", 1e6},    {"GB", 1e9},
      {"TB", 1e12}, {"KiB", 0x1p10}, {"MiB", 0x1p20}, {"GiB", 0x1p30}, {"TiB", 0x1p40}};
  for (const auto& [name, factor] : kUnits)
    if (unit == name && problem == std::errc() && end == text.data() + digits && number >= 0 &&
        number * factor < 0x1p62)
      return std::uint64_t(number * factor);
  throw Error("\"" + text + "\" is no number of bytes: write 500MB, 2GB or 1000000");
}

TableCache::TableCache(fs::path folder, double least_seconds)
    : folder_(std::move(folder)), least_seconds_(least_seconds) {
  std::error_code code;
  if (const fs::path whole = fs::absolute(folder_, code); !code) folder_ = whole;
}

fs::path TableCache::usual_folder() {
  // A relative path in this variable is to be ignored (XDG Base Directory Specification, version 0.8).
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && cache[0] == '/')
    return fs::path(cache) / "aureole";
  if (const char* home = std::getenv("HOME"); home && home[0] == '/')
    return fs::path(home) / ".cache" / "aureole";
  return {};
}

std::shared_ptr<TableCache> TableCache::chosen(const std::string& choice) {
  std::string folder = choice;
  if (folder.empty())
    if (const char* stated = std::getenv("AUREOLE_CACHE")) folder = stated;
  if (folder == "off") return nullptr;
  const fs::path path = folder.empty() ? usual_folder() : fs::path(folder);
  return path.empty() ? nullptr : std::make_shared<TableCache>(path);
}

fs::path TableCache::file_of(const TableKey& key) const {
  WideHash hash;
  hash.text(table_build());
  hash.text(key.table);
  hash.number(std::uint64_t(key.version));
  hash.wide(key.inputs);
  return folder_ / (hexadecimal(hash.value()) + kTableEnding);
}

KeptTable TableCache::read(const TableKey& key, const fs::path& file) const {
  InputFile input(file);
  input.require_at_most(kLargestTableFile);
  Preamble preamble;
  std::vector<char> all;
  EntryHeader header = read_header(input, preamble, all);
  if (header.build != table_build() || header.key.table != key.table || header.key.version != key.version ||
      header.key.inputs != key.inputs)
    throw Error("it is of another version");
  KeptTable table;
  table.reads = std::move(header.reads);
  table.bytes.resize(preamble.table_bytes);
  input.read(table.bytes.data(), table.bytes.size());
  if (checksum_of(all.data(), all.size()) + checksum_of(table.bytes.data(), table.bytes.size()) !=
      preamble.checksum)
    throw Error("its checksum is wrong");
  for (std::size_t i = 0; i < header.notes.size(); ++i)
    table.notes.emplace_back(std::move(header.note_names[i]), std::move(header.notes[i]));
  return table;
}

std::optional<KeptTable> TableCache::find(const TableKey& key) {
  const fs::path file = file_of(key);
  std::error_code code;
  // Another program may remove or replace the file meanwhile: what fails is tried once more.
  for (int attempt = 0; fs::exists(fs::symlink_status(file, code)); ++attempt) try {
      KeptTable table = read(key, file);
      // Entries of another user, or on a file system that is not writable, keep their time.
      const timespec now[2] = {{0, UTIME_NOW}, {0, UTIME_NOW}};
      (void)::utimensat(AT_FDCWD, file.c_str(), now, 0);
      const std::lock_guard guard(mutex_);
      ++read_;
      return table;
    } catch (const Error& e) {
      if (attempt == 0) continue;
      tell("the kept table " + file.string() + " cannot be used and is computed again: " + e.message());
      return {};
    }
  return {};
}

void TableCache::refuse(const TableKey& key) {
  tell("the kept table " + file_of(key).string() +
       " cannot be used and is computed again: its content is damaged");
}

void TableCache::keep(const TableKey& key, const KeptTable& table, double seconds) {
  if (seconds < least_seconds_) return;
  const std::uint64_t most = limit();
  EntryHeader header{key, table_build(), seconds, table.reads, {}, {}};
  for (const auto& [name, note] : table.notes)
    header.note_names.push_back(name), header.notes.push_back(note);
  TableWriter head;
  EntryHeader::fields(header, head);
  Preamble preamble;
  preamble.header_bytes = head.bytes().size(), preamble.table_bytes = table.bytes.size();
  preamble.checksum = checksum_of(head.bytes().data(), head.bytes().size()) +
                      checksum_of(table.bytes.data(), table.bytes.size());
  std::vector<char> all(sizeof preamble + head.bytes().size() + table.bytes.size());
  std::memcpy(all.data(), &preamble, sizeof preamble);
  std::copy(head.bytes().begin(), head.bytes().end(), all.begin() + sizeof preamble);
  std::copy(table.bytes.begin(), table.bytes.end(),
            all.begin() + std::ptrdiff_t(sizeof preamble + head.bytes().size()));
  if (all.size() > most / kLargestPart) {
    tell("a table of " + in_megabytes(all.size()) + " (" + key.table +
         ") is not kept: that is more than a quarter of the " + in_megabytes(most) +
         " for all tables (aureole cache limit)");
    return;
  }
  try {
    make_folder();
    remove_unfinished_files(folder_, is_name_of_cache);
    write_file_atomically(file_of(key), all);
    remove_beyond(most);
    const std::lock_guard guard(mutex_);
    ++kept_;
  } catch (const Error& e) {
    tell("tables are not kept for the next start: " + std::string(e.what()));
  }
}

void TableCache::make_folder() const {
  std::error_code code;
  fs::create_directories(folder_, code);
  if (code || !fs::is_directory(folder_, code))
    throw Error({folder_.string(), 0, 0}, "the folder cannot be made" + (code ? ": " + code.message() : ""));
  const fs::path tag = folder_ / kTagName;
  if (fs::exists(fs::symlink_status(tag, code))) return;
  const std::string text =
      "Signature: 8a477f597d28d172789f06886806bc55\n# Tables that aureole computes again where they are missing "
      "(aureole cache).\n";
  write_file_atomically(tag, text);
}

void TableCache::tell(const std::string& message) {
  const std::lock_guard guard(mutex_);
  // A full disc is told once, though the names of the files differ.
  const std::string kind = message.substr(0, message.find(':'));
  if (std::find(told_.begin(), told_.end(), kind) != told_.end()) return;
  told_.push_back(kind);
  notes_.push_back(message);
}

std::vector<std::string> TableCache::take_notes() {
  const std::lock_guard guard(mutex_);
  return std::exchange(notes_, {});
}

std::vector<TableEntry> TableCache::entries() const {
  std::vector<TableEntry> found;
  std::error_code code;
  for (fs::directory_iterator i(folder_, code), end; !code && i != end; i.increment(code)) {
    if (!is_entry_name(i->path().filename().string())) continue;
    struct stat status;
    if (::lstat(i->path().c_str(), &status) != 0 || !S_ISREG(status.st_mode)) continue;
    TableEntry entry;
    entry.file = i->path();
    entry.bytes = std::uint64_t(status.st_size), entry.used_s = std::int64_t(status.st_mtime);
    try {
      InputFile input(entry.file);
      Preamble preamble;
      std::vector<char> bytes;
      const EntryHeader header = read_header(input, preamble, bytes);
      entry.table = header.key.table, entry.made_for = header.key.made_for;
      entry.build = header.build, entry.seconds = header.seconds;
    } catch (const Error&) {
      // A damaged entry is listed without a kind.
    }
    found.push_back(std::move(entry));
  }
  std::sort(found.begin(), found.end(), [](const TableEntry& a, const TableEntry& b) {
    return a.used_s != b.used_s ? a.used_s > b.used_s : a.file < b.file;
  });
  return found;
}

void TableCache::remove_beyond(std::uint64_t limit) {
  struct Found {
    timespec used;
    std::uint64_t bytes;
    fs::path file;
  };
  std::vector<Found> found;
  std::uint64_t sum = 0;
  std::error_code code;
  for (fs::directory_iterator i(folder_, code), end; !code && i != end; i.increment(code)) {
    struct stat status;
    if (!is_entry_name(i->path().filename().string()) || ::lstat(i->path().c_str(), &status) != 0) continue;
    found.push_back({status.st_mtim, std::uint64_t(status.st_size), i->path()});
    sum += found.back().bytes;
  }
  if (sum <= limit) return;
  std::sort(found.begin(), found.end(), [](const Found& a, const Found& b) {
    return a.used.tv_sec != b.used.tv_sec ? a.used.tv_sec < b.used.tv_sec : a.used.tv_nsec < b.used.tv_nsec;
  });
  for (const Found& entry : found) {
    if (sum <= limit) return;
    // An entry that another program has removed meanwhile takes no space either.
    fs::remove(entry.file, code);
    if (!code) sum -= entry.bytes;
  }
}

std::size_t TableCache::clear() {
  std::size_t count = 0;
  for (const TableEntry& entry : entries()) {
    std::error_code code;
    fs::remove(entry.file, code);
    if (code) throw Error({entry.file.string(), 0, 0}, "cannot be removed: " + code.message());
    ++count;
  }
  remove_unfinished_files(folder_, is_name_of_cache);
  return count;
}

std::uint64_t TableCache::limit() const {
  try {
    const fs::path file = folder_ / kLimitName;
    std::error_code code;
    if (!fs::exists(file, code)) return kUsualLimit;
    const std::string text = read_text_file(file, 64);
    std::uint64_t bytes = 0;
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), bytes);
    if (problem == std::errc() && (*end == '\n' || *end == 0)) return bytes;
  } catch (const Error&) {
    // A file that cannot be read sets no limit.
  }
  return kUsualLimit;
}

void TableCache::set_limit(std::uint64_t bytes) {
  make_folder();
  write_file_atomically(folder_ / kLimitName, std::to_string(bytes) + "\n");
  remove_beyond(bytes);
}

}  // namespace aureole
