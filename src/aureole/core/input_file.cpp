// SPDX-License-Identifier: Apache-2.0
#include "aureole/core/input_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "aureole/core/error.h"
#include "aureole/core/mapped_file.h"
#include "aureole/core/memory.h"

namespace aureole {

namespace {

std::string kind_of(mode_t mode) {
  if (S_ISREG(mode)) return "";
  if (S_ISDIR(mode)) return "a folder";
  if (S_ISFIFO(mode)) return "a pipe";
  if (S_ISSOCK(mode)) return "a socket";
  return "a device";
}

std::string opening_fault(int error) {
  if (error == ENOENT || error == ENOTDIR) return "no such file";
  return std::string("cannot be opened: ") + std::strerror(error);
}

/// Opens a regular file. Returns its descriptor, or -1 and the reason.
std::pair<int, std::string> open_regular(const std::filesystem::path& file, std::uint64_t& size) {
  const auto irregular = [](const struct stat& s) { return "not a regular file but " + kind_of(s.st_mode); };
  struct stat status;
  // The status is checked before the file is opened as well, since opening alone can make a device act.
  if (::stat(file.c_str(), &status) != 0) return {-1, opening_fault(errno)};
  if (!S_ISREG(status.st_mode)) return {-1, irregular(status)};
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (descriptor < 0) return {-1, opening_fault(errno)};
  std::string fault;
  if (::fstat(descriptor, &status) != 0)
    fault = opening_fault(errno);
  else if (!S_ISREG(status.st_mode))
    fault = irregular(status);
  if (!fault.empty()) {
    ::close(descriptor);
    return {-1, fault};
  }
  size = std::uint64_t(std::max<off_t>(status.st_size, 0));
  return {descriptor, ""};
}

}  // namespace

std::string fault_of_input(const std::filesystem::path& file) {
  std::uint64_t size = 0;
  const auto [descriptor, fault] = open_regular(file, size);
  if (descriptor >= 0) ::close(descriptor);
  return fault;
}

std::string irregular_kind(const std::filesystem::path& file) {
  struct stat status;
  return ::stat(file.c_str(), &status) == 0 ? kind_of(status.st_mode) : "";
}

InputFile::InputFile(std::filesystem::path file) : file_(std::move(file)) {
  const auto [descriptor, fault] = open_regular(file_, size_);
  if (descriptor < 0) throw Error({file_.string(), 0, 0}, fault);
  descriptor_ = descriptor;
}

InputFile::~InputFile() { ::close(descriptor_); }

void InputFile::require_left(std::uint64_t bytes) const {
  if (bytes > left())
    throw Error({file_.string(), 0, 0},
                "is truncated: " + std::to_string(bytes - left()) + " bytes are missing");
}

void InputFile::read(void* to, std::uint64_t bytes) {
  require_left(bytes);
  for (auto* at = static_cast<char*>(to); bytes > 0;) {
    const ssize_t n = ::read(descriptor_, at, std::min<std::uint64_t>(bytes, std::uint64_t(1) << 30));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0)
      throw Error({file_.string(), 0, 0}, std::string("cannot be read to its end: ") +
                                              (n < 0 ? std::strerror(errno) : "it has become shorter"));
    at += n, position_ += std::uint64_t(n), bytes -= std::uint64_t(n);
  }
}

void InputFile::skip(std::uint64_t bytes) {
  require_left(bytes);
  position_ += bytes;
  if (::lseek(descriptor_, off_t(position_), SEEK_SET) < 0)
    throw Error({file_.string(), 0, 0}, std::string("cannot be read: ") + std::strerror(errno));
}

void InputFile::require_at_most(std::uint64_t max_bytes) const {
  const std::string has = "has " + std::to_string(size_) + " bytes, more than the ";
  if (size_ > max_bytes)
    throw Error({file_.string(), 0, 0}, has + "limit of " + std::to_string(max_bytes) + " for such a file");
  if (double(size_) > available_memory_bytes())
    throw Error({file_.string(), 0, 0}, has + "memory that is available");
}

MappedFile::MappedFile(const std::filesystem::path& file) {
  std::uint64_t size = 0;
  const auto [descriptor, fault] = open_regular(file, size);
  if (descriptor < 0) throw Error({file.string(), 0, 0}, fault);
  void* const data = size > 0 ? ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0) : nullptr;
  const int error = errno;
  ::close(descriptor);
  if (data == MAP_FAILED)
    throw Error({file.string(), 0, 0}, std::string("cannot be mapped into memory: ") + std::strerror(error));
  data_ = static_cast<const std::byte*>(data);
  size_ = std::size_t(size);
}

MappedFile::~MappedFile() {
  if (data_) ::munmap(const_cast<std::byte*>(data_), size_);
}

SharedBytes map_file(const std::filesystem::path& file) {
  auto mapped = std::make_shared<const MappedFile>(file);
  const std::span<const std::byte> bytes = mapped->bytes();
  return {bytes, std::move(mapped)};
}

std::string read_text_file(const std::filesystem::path& file, std::uint64_t max_bytes) {
  InputFile input(file);
  input.require_at_most(max_bytes);
  std::string text(input.size(), '\0');
  input.read(text.data(), text.size());
  return text;
}

std::istringstream read_table_file(const std::filesystem::path& file) {
  return std::istringstream(read_text_file(file, kMaxTableBytes));
}

}  // namespace aureole
