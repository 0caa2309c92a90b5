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
#include <cstdlib>
#include <cstring>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

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

/// Follows symbolic links to the file that is to be written, which need not exist. Throws Error if the target
/// is no file.
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

constexpr const char* kPart = ".part-";

std::size_t name_limit_of(const fs::path& folder) {
  const long limit = ::pathconf(folder.c_str(), _PC_NAME_MAX);
  return limit > 0 ? std::size_t(limit) : NAME_MAX;
}

/// Returns the beginning of the names of temporary files: the target's name, cut where a process id and a number
/// would make it too long.
std::string part_beginning(const fs::path& folder, const std::string& name) {
  constexpr std::size_t kEndingBytes = 32;
  return name.substr(0, std::max(name_limit_of(folder), kEndingBytes + 1) - kEndingBytes);
}

/// Returns a new name beside a target: the target's name, ".part-", process id, number.
fs::path part_path(const fs::path& folder, const std::string& name) {
  static std::atomic<unsigned> counter{0};
  return folder / (part_beginning(folder, name) + kPart + std::to_string(::getpid()) + "-" +
                   std::to_string(counter.fetch_add(1)));
}

bool is_part(const std::string& candidate, const std::string& beginning) {
  if (!candidate.starts_with(beginning + kPart)) return false;
  const std::string numbers = candidate.substr(beginning.size() + std::strlen(kPart));
  return numbers.find_first_not_of("0123456789-") == std::string::npos &&
         numbers.find('-') != std::string::npos;
}

/// Opens and locks a file or folder if nobody else has locked it; returns -1 otherwise.
int lock_of(const fs::path& path) {
  // Flags without write access, as for folders, which cannot be opened for writing; NFS locks only files that
  // are open for writing.
  constexpr int kFlags = O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW;
  int d = ::open(path.c_str(), O_RDWR | kFlags);
  if (d < 0) d = ::open(path.c_str(), O_RDONLY | kFlags);
  if (d < 0 || ::flock(d, LOCK_EX | LOCK_NB) == 0) return d;
  ::close(d);
  return -1;
}

/// Removes the temporary files or folders whose names `is_part_of_ours` accepts. Those of running programs are locked and
/// stay.
template <class IsPart>
void remove_unlocked(const fs::path& folder, const IsPart& is_part_of_ours) {
  std::vector<fs::path> parts;
  std::error_code code;
  for (fs::directory_iterator i(folder, code), end; !code && i != end; i.increment(code))
    if (is_part_of_ours(i->path().filename().string()) && (i->is_regular_file(code) || i->is_directory(code)))
      parts.push_back(i->path());
  for (const fs::path& part : parts) {
    const int d = lock_of(part);
    if (d < 0) continue;
    fs::remove_all(part, code);
    ::close(d);
  }
}

/// Removes the temporary files or folders of programs that were killed while they wrote the same target.
void remove_leftovers(const fs::path& folder, const std::string& name) {
  const std::string beginning = part_beginning(folder, name);
  remove_unlocked(folder, [&](const std::string& candidate) { return is_part(candidate, beginning); });
}

/// Whether an open file or folder still has its name: another program may have taken it for a leftover before it
/// was locked.
bool has_name(int descriptor, const fs::path& path) {
  struct stat own, named;
  return ::fstat(descriptor, &own) == 0 && ::lstat(path.c_str(), &named) == 0 && own.st_dev == named.st_dev &&
         own.st_ino == named.st_ino;
}

/// A temporary file beside a target. It is locked as long as it is open, so that one without a lock is the leftover
/// of a program that was killed.
class PartFile {
public:
  /// Creates the file. Throws Error located at `shown`. With `clean`, first removes leftovers for the same target.
  PartFile(const fs::path& target, const fs::path& shown, bool clean) : target_(target), shown_(shown) {
    const fs::path folder = folder_of(target);
    std::error_code code;
    if (!fs::is_directory(folder, code))
      fail(shown, "cannot be written: there is no folder " + folder.string());
    const std::string name = target.filename().string();
    if (const std::size_t longest = name_limit_of(folder); name.size() > longest)
      fail(shown, "cannot be written: the name " + name + " has " + std::to_string(name.size()) +
                      " bytes, and the file system's limit is " + std::to_string(longest));
    if (clean) remove_leftovers(folder, name);
    // A killed job with the same process id, which is common in containers, may have left its temporary file.
    int error = EEXIST;
    for (int attempt = 0; attempt < 1000 && descriptor_ < 0 && error == EEXIST; ++attempt) {
      path_ = part_path(folder, name);
      descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      error = errno;
      if (descriptor_ < 0) continue;
      ::flock(descriptor_, LOCK_EX);
      if (!has_name(descriptor_, path_)) ::close(std::exchange(descriptor_, -1)), error = EEXIST;
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
  fs::path target_, shown_, path_;
  int descriptor_ = -1;
};

/// Alternative paths for a result that cannot be written to its own path, in the order in which they are
/// tried.
std::vector<fs::path> refuges_of(const fs::path& file) {
  std::vector<fs::path> folders{"."};
  std::error_code code;
  folders.push_back(fs::temp_directory_path(code));
  if (const char* home = std::getenv("HOME")) folders.emplace_back(home);
  std::vector<fs::path> all;
  for (const fs::path& folder : folders) {
    const fs::path whole = fs::absolute(folder, code);
    if (code || folder.empty() || !fs::is_directory(whole, code)) continue;
    // The name is shortened, since its length may be the reason why the file cannot be written.
    const std::string stem = file.stem().string().substr(0, 100);
    for (int i = 0; i < 100; ++i) {
      fs::path name =
          whole / ("rescued-" + std::to_string(::getpid()) + "-" + std::to_string(i) + "-" + stem);
      name += file.extension();
      if (fs::exists(fs::symlink_status(name, code))) continue;
      all.push_back(name.lexically_normal());
      break;
    }
  }
  return all;
}

}  // namespace

void write_file_atomically(const fs::path& file, std::span<const char> bytes) {
  if (!is_character_device(file)) return PartFile(target_of(file), file, false).replace_target_by(bytes);
  const int d = ::open(file.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY);
  if (d < 0) fail_by_system(file, "cannot be opened for writing", errno);
  const bool good = write_all(d, bytes);
  const int error = errno;
  if (::close(d) != 0 || !good) fail_by_system(file, "cannot be written", good ? errno : error);
}

void remove_unfinished_files(const fs::path& folder,
                             const std::function<bool(const std::string& target)>& is_ours) {
  remove_unlocked(folder, [&](const std::string& candidate) {
    const std::size_t at = candidate.rfind(kPart);
    return at != std::string::npos && is_ours(candidate.substr(0, at)) &&
           is_part(candidate, candidate.substr(0, at));
  });
}

void require_writable(const fs::path& file) {
  if (!is_character_device(file)) PartFile(target_of(file), file, true);
}

void open_standard_streams() {
  for (const auto& [descriptor, mode] : {std::pair(0, O_RDONLY), {1, O_RDONLY}, {2, O_WRONLY}})
    if (::fcntl(descriptor, F_GETFD) < 0 && errno == EBADF) {
      // /dev/null gets the lowest free number, which is the number of the closed stream.
      [[maybe_unused]] const int opened = ::open("/dev/null", mode);
    }
}

OutputLock::OutputLock(const fs::path& file) {
  if (is_character_device(file)) return;
  const fs::path target = target_of(file), folder = folder_of(target);
  constexpr std::size_t kEndingBytes = 20;
  const std::string stem = target.stem().string();
  path_ = folder / ("." + stem.substr(0, name_limit_of(folder) - kEndingBytes) + ".aureole-lock");
  for (int attempt = 0; attempt < 1000; ++attempt) {
    // The file is opened for writing, since NFS locks only such files.
    descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW, 0666);
    if (descriptor_ < 0) return;  // no lock; `require_writable` reports what is wrong with the folder
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
      const bool is_held = errno == EWOULDBLOCK;
      ::close(std::exchange(descriptor_, -1));
      if (is_held) fail(file, "is being written by another program, which holds " + path_.string());
      return;  // no lock, since the file system has none
    }
    if (has_name(descriptor_, path_)) return;
    // the previous holder of the lock has removed the file meanwhile
    ::close(std::exchange(descriptor_, -1));
  }
}

OutputLock::~OutputLock() {
  if (descriptor_ < 0) return;
  ::unlink(path_.c_str());
  ::close(descriptor_);
}

WrittenFile write_somewhere(const fs::path& file, const std::function<void(const fs::path&)>& write) {
  try {
    write(file);
    return {file, ""};
  } catch (const Error& problem) {
    for (const fs::path& refuge : refuges_of(file)) {
      try {
        write(refuge);
        return {refuge, problem.what()};
      } catch (const Error&) {
      }
    }
    throw;
  }
}

PartFolder::PartFolder(fs::path target) {
  const fs::path folder = folder_of(target);
  const std::string name = target.filename().string();
  if (const std::size_t longest = name_limit_of(folder); name.size() > longest)
    fail(target, "cannot be made: its name has " + std::to_string(name.size()) +
                     " bytes, and the file system's limit is " + std::to_string(longest));
  remove_leftovers(folder, name);
  std::error_code code;
  for (int attempt = 0; attempt < 1000; ++attempt) {
    path_ = part_path(folder, name);
    if (!fs::create_directory(path_, code)) {
      if (code) break;
      continue;
    }
    descriptor_ = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC | O_DIRECTORY);
    if (descriptor_ < 0 && errno != ENOENT) {
      code.assign(errno, std::generic_category());
      std::error_code ignored;
      fs::remove(path_, ignored);
      break;
    }
    if (descriptor_ >= 0) ::flock(descriptor_, LOCK_EX);
    if (descriptor_ >= 0 && has_name(descriptor_, path_)) return;
    if (descriptor_ >= 0) ::close(std::exchange(descriptor_, -1));
  }
  path_.clear();
  fail(target, "cannot be made: " + code.message());
}

PartFolder::~PartFolder() {
  std::error_code code;
  if (!path_.empty()) fs::remove_all(path_, code);
  if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace aureole
