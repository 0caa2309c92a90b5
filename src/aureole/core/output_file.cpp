// SPDX-License-Identifier: Apache-2.0
#include "aureole/core/output_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstring>
#include <string>
#include <utility>

#include "aureole/core/error.h"
#include "aureole/core/input_file.h"

namespace aureole {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail(const fs::path& file, const std::string& message) {
  throw Error({file.string(), 0, 0}, message);
}
[[noreturn]] void fail_by_system(const fs::path& file, const std::string& what, int error) {
  fail(file, what + ": " + std::strerror(error));
}

/// Writes all of `bytes` and flushes them to the disc.
bool write_all(int descriptor, std::span<const char> bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(descriptor, bytes.data(), std::min(bytes.size(), std::size_t(1) << 30));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    bytes = bytes.subspan(std::size_t(n));
  }
  return ::fsync(descriptor) == 0 || errno == EINVAL;  // devices cannot be flushed
}

fs::path folder_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

bool is_character_device(const fs::path& file) {
  struct stat status;
  return ::stat(file.c_str(), &status) == 0 && S_ISCHR(status.st_mode);
}

/// Follows symbolic links to the file that is to be written, which need not exist. Throws Error for what is no
/// file.
fs::path target_of(const fs::path& file) {
  constexpr int kMaxLinks = 40;
  if (const std::string kind = irregular_kind(file); !kind.empty() && !is_character_device(file))
    fail(file, "cannot be written: it is " + kind);
  fs::path target = file;
  std::error_code code;
  for (int links = 0; fs::is_symlink(target, code); ++links) {
    if (links == kMaxLinks) fail_by_system(file, "cannot be written", ELOOP);
    const fs::path next = fs::read_symlink(target, code);
    if (code) fail(file, "cannot be written: " + code.message());
    target = next.is_absolute() ? next : folder_of(target) / next;
  }
  return target;
}

/// A temporary file beside a target. Its name is that of the target and ".part-", process id, number. It is
/// locked as long as it is open, so that one without a lock is the leftover of a program that was killed.
class PartFile {
public:
  /// Creates the file. Throws Error located at `shown`. With `remove_leftovers`, first removes the temporary files
  /// of programs that were killed while they wrote the same target.
  PartFile(const fs::path& target, const fs::path& shown, bool remove_leftovers)
      : target_(target), shown_(shown) {
    static std::atomic<unsigned> counter{0};
    const fs::path folder = folder_of(target);
    std::error_code code;
    if (!fs::is_directory(folder, code))
      fail(shown, "cannot be written: there is no folder " + folder.string());
    const std::string name = target.filename().string();
    const long name_limit = ::pathconf(folder.c_str(), _PC_NAME_MAX);
    const std::size_t longest = name_limit > 0 ? std::size_t(name_limit) : NAME_MAX;
    if (name.size() > longest)
      fail(shown, "cannot be written: the name " + name + " has " + std::to_string(name.size()) +
                      " bytes, and the file system's limit is " + std::to_string(longest));
    if (remove_leftovers) remove_leftovers_of(folder, name, longest);
    // A killed job with the same process id, which is common in containers, may have left its temporary file.
    int error = EEXIST;
    for (int attempt = 0; attempt < 1000 && descriptor_ < 0 && error == EEXIST; ++attempt) {
      const std::string ending =
          kPart + std::to_string(::getpid()) + "-" + std::to_string(counter.fetch_add(1));
      path_ = folder / (beginning(name, longest) + ending);
      descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      error = errno;
      if (descriptor_ < 0) continue;
      // Another program may have taken the new file for a leftover before it was locked.
      struct stat status;
      ::flock(descriptor_, LOCK_EX);
      if (::fstat(descriptor_, &status) == 0 && status.st_nlink == 0)
        ::close(std::exchange(descriptor_, -1)), error = EEXIST;
    }
    if (descriptor_ < 0)
      fail_by_system(shown, "cannot be written: the folder " + folder.string() + " is not writable", error);
  }
  ~PartFile() {
    if (descriptor_ < 0) return;
    ::unlink(path_.c_str());
    ::close(descriptor_);
  }
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  void replace_target_by(std::span<const char> bytes) {
    if (!write_all(descriptor_, bytes) || std::rename(path_.c_str(), target_.c_str()) != 0)
      fail_by_system(shown_, "cannot be written", errno);
    if (::close(std::exchange(descriptor_, -1)) != 0) fail_by_system(shown_, "cannot be written", errno);
  }

private:
  static constexpr const char* kPart = ".part-";
  /// Bytes left for what follows the target's name: process id and number.
  static constexpr std::size_t kEndingBytes = 28;

  static std::string beginning(const std::string& name, std::size_t longest) {
    return name.substr(0, std::max(longest, kEndingBytes + 1) - kEndingBytes);
  }

  static bool is_part(const std::string& candidate, const std::string& start) {
    if (!candidate.starts_with(start + kPart)) return false;
    const std::string numbers = candidate.substr(start.size() + std::strlen(kPart));
    return numbers.find_first_not_of("0123456789-") == std::string::npos &&
           numbers.find('-') != std::string::npos;
  }

  static void remove_leftovers_of(const fs::path& folder, const std::string& name, std::size_t longest) {
    std::error_code code;
    for (fs::directory_iterator i(folder, code), end; !code && i != end; i.increment(code)) {
      if (!is_part(i->path().filename().string(), beginning(name, longest))) continue;
      const int d = ::open(i->path().c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW);
      if (d < 0) continue;
      struct stat status;
      if (::fstat(d, &status) == 0 && S_ISREG(status.st_mode) && ::flock(d, LOCK_EX | LOCK_NB) == 0)
        ::unlink(i->path().c_str());
      ::close(d);
    }
  }

  fs::path target_, shown_, path_;
  int descriptor_ = -1;
};

}  // namespace

void write_file_atomically(const fs::path& file, std::span<const char> bytes) {
  if (!is_character_device(file)) return PartFile(target_of(file), file, false).replace_target_by(bytes);
  const int d = ::open(file.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY);
  if (d < 0) fail_by_system(file, "cannot be opened for writing", errno);
  const bool good = write_all(d, bytes);
  const int error = errno;
  if (::close(d) != 0 || !good) fail_by_system(file, "cannot be written", good ? errno : error);
}

void require_writable(const fs::path& file) {
  if (!is_character_device(file)) PartFile(target_of(file), file, true);
}

}  // namespace aureole
