// SPDX-License-Identifier: Apache-2.0
// `TableCache`: a folder of tables that take long to compute (Mie scattering, stacks of layers, energy losses of rough
// surfaces), so that the next start of a program reads them. An entry is a file, named by a hash of all that the table
// depends on: its inputs, the kind and version of the table, and the build of the program.
//
// Any number of processes may use one folder at once. Entries are written to temporary files and renamed, so that
// reading needs no lock. Each has a checksum; a damaged one is computed again. The total size has an upper bound: the
// entries that were used longest ago are removed first. A folder that cannot be written costs one note.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "aureole/core/word_hash.h"

namespace aureole {

/// The inputs of a table, and what it is.
struct TableKey {
  std::string table;       ///< kind of the table, such as "phase function"
  int version = 0;         ///< version of that kind
  WideHashValue inputs{};  ///< hash of all inputs
  std::string made_for;    ///< the plug-in, such as "phase mie", for lists of entries
};

/// A table as it is kept: its bytes, and what else its computation did: parameters that it read, notes to the user.
struct KeptTable {
  std::vector<char> bytes;
  std::vector<std::uint32_t> reads;  ///< numbers of the object's parameters that the computation read
  std::vector<std::pair<std::string, std::string>> notes;  ///< name of a parameter, and message
};

/// An entry of a folder.
struct TableEntry {
  std::filesystem::path file;
  std::uint64_t bytes = 0;      ///< size of the file
  std::int64_t used_s = 0;      ///< time of the last use, in seconds since 1970
  std::string table, made_for;  ///< as in `TableKey`; empty for a file that is damaged
  std::string build;            ///< `table_build()` of the program that has made it
  double seconds = 0;           ///< time that its computation took
};

class TableCache {
public:
  /// Where the user states no limit, in bytes.
  static constexpr std::uint64_t kUsualLimit = std::uint64_t(1) << 30;
  /// Tables that take less time to make [s] are not worth a file.
  static constexpr double kLeastSeconds = 0.02;

  /// Uses a folder, which need not exist: the first entry makes it. Never throws. `least_seconds` replaces `kLeastSeconds`.
  explicit TableCache(std::filesystem::path folder, double least_seconds = kLeastSeconds);

  /// Returns the cache that a user's choice names: "off" is none (null), a path is that folder, and an empty text is the
  /// environment variable AUREOLE_CACHE, which has the same meaning, or else `usual_folder()`.
  static std::shared_ptr<TableCache> chosen(const std::string& choice);
  /// Returns $XDG_CACHE_HOME/aureole or, without that variable, $HOME/.cache/aureole; empty where there is neither.
  static std::filesystem::path usual_folder();

  const std::filesystem::path& folder() const { return folder_; }

  /// Returns a table, and marks it as used; nothing if there is none or it is damaged.
  std::optional<KeptTable> find(const TableKey& key);
  /// Says that the bytes which `find` has returned are no table of that kind. They are computed again.
  void refuse(const TableKey& key);
  /// Keeps a table that took `seconds` to make. Failures become notes.
  void keep(const TableKey& key, const KeptTable& table, double seconds);
  /// Returns the messages for the user since the last call, each of which is given once.
  std::vector<std::string> take_notes();

  /// Numbers of tables that were read, and written, by this object.
  std::uint64_t tables_read() const { return read_; }
  std::uint64_t tables_kept() const { return kept_; }

  /// Lists the entries, the last used first. An absent folder has none.
  std::vector<TableEntry> entries() const;
  /// Removes all entries, and unfinished files of programs that were killed. Other files stay. Throws Error if an entry
  /// cannot be removed. Returns the number of entries.
  std::size_t clear();
  /// Returns the upper bound of the size in bytes: that of `set_limit`, or else kUsualLimit.
  std::uint64_t limit() const;
  /// Sets the bound for all programs that use the folder, and removes the entries beyond it. Throws Error if the folder
  /// cannot be written.
  void set_limit(std::uint64_t bytes);

  /// Returns the file of a table, whether it exists or not.
  std::filesystem::path file_of(const TableKey& key) const;

private:
  /// Reads a table. Throws Error that says what is wrong with the file.
  KeptTable read(const TableKey& key, const std::filesystem::path& file) const;
  void make_folder() const;
  void tell(const std::string& message);
  void remove_beyond(std::uint64_t limit);

  std::filesystem::path folder_;
  double least_seconds_;
  std::uint64_t read_ = 0, kept_ = 0;
  std::mutex mutex_;
  std::vector<std::string> notes_, told_;
};

/// Returns a number of bytes such as "500MB", "2 GB", "1.5GiB" or "1000000". Throws Error that names the form.
std::uint64_t parse_bytes(const std::string& text);

/// Returns what the bits of a table depend on besides its inputs: the version of the program and a hash of its source,
/// compiler and options, the processor's widest vectors and the mathematical library.
std::string table_build();

}  // namespace aureole
