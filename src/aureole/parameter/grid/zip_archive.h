// SPDX-License-Identifier: Apache-2.0
// Members of zip archives (PKWARE, APPNOTE.TXT 6.3), stored or deflated, with sizes of 64 bits. Archives of numpy (.npz) are
// such archives.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "aureole/core/mapped_file.h"

namespace aureole {

class ZipArchive {
public:
  struct Member {
    std::string name;
    unsigned method = 0;  ///< 0: stored, 8: deflated
    std::uint64_t packed_bytes = 0, bytes = 0;
    std::uint64_t offset = 0;  ///< of its local header
  };

  /// Reads the directory. Throws Error without a location.
  explicit ZipArchive(const SharedBytes& bytes);

  const std::vector<Member>& members() const { return members_; }
  /// Returns the member of a name, or null.
  const Member* find(std::string_view name) const;
  /// Returns a member's bytes, without a copy where it is stored. Checks its CRC only by its length. Throws Error.
  SharedBytes read(const Member& member) const;

private:
  SharedBytes bytes_;
  std::vector<Member> members_;
};

/// Returns an archive of deflated members. Members and the archive are smaller than 4 GiB; else throws Error.
std::string make_zip(std::span<const std::pair<std::string, std::string>> members);

}  // namespace aureole
