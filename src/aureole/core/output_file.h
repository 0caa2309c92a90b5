// SPDX-License-Identifier: Apache-2.0
// Writes files of the user. A file is replaced as a whole or left as it was.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>

namespace aureole {

/// Replaces `file` by `bytes` atomically: writes a temporary file beside it, flushes and renames it. A symbolic
/// link is followed, also where its target does not exist yet, so that it stays a link. A character device
/// such as /dev/null is written directly. Throws Error located at `file`, also for a pipe or socket.
void write_file_atomically(const std::filesystem::path& file, std::span<const char> bytes);

/// Removes temporary files that programs which were killed have left in a folder: those of targets for whose names `is_ours`
/// returns true. Temporary files of running programs stay.
void remove_unfinished_files(const std::filesystem::path& folder,
                             const std::function<bool(const std::string& target)>& is_ours);

/// Throws Error if a file of this name cannot be written: tries to create the temporary file that
/// `write_file_atomically` creates. Call it before spending hours on the file's content.
void require_writable(const std::filesystem::path& file);

/// Opens /dev/null in place of standard streams that are closed, so that no file of the user gets their numbers and
/// messages are not written into it. What is printed to a closed standard output stays an error.
void open_standard_streams();

/// An exclusive lock on a picture and the files of its name beside it (.png, .state), released by the destructor or
/// when the process ends.
class OutputLock {
public:
  /// Throws Error if another program holds the lock.
  explicit OutputLock(const std::filesystem::path& file);
  ~OutputLock();
  OutputLock(const OutputLock&) = delete;
  OutputLock& operator=(const OutputLock&) = delete;

private:
  std::filesystem::path path_;
  int descriptor_ = -1;
};

/// The path to which the result of a long computation was written.
struct WrittenFile {
  std::filesystem::path file;
  std::string problem;  ///< the reason why it is not the requested file, or empty
};

/// Calls `write(file)`. If that throws Error, as where a folder has vanished or a disc is full, calls `write` with
/// names in the working folder, the folder for temporary files and the home folder instead, so that hours of work
/// are not lost. Throws the first Error if none can be written.
WrittenFile write_somewhere(const std::filesystem::path& file,
                            const std::function<void(const std::filesystem::path&)>& write);

/// A folder that is written beside its final place, under a name like that of temporary files. Folders that killed
/// programs left there for the same place are removed first.
class PartFolder {
public:
  /// Throws Error located at `target`.
  explicit PartFolder(std::filesystem::path target);
  /// Removes the folder unless it was released.
  ~PartFolder();
  PartFolder(const PartFolder&) = delete;
  PartFolder& operator=(const PartFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// The folder was renamed to its final place, and the destructor keeps it.
  void release() { path_.clear(); }

private:
  std::filesystem::path path_;
  int descriptor_ = -1;
};

}  // namespace aureole
