// SPDX-License-Identifier: Apache-2.0
// The hash of a scene's content, by which a checkpoint recognises the scene it belongs to.
#include <algorithm>
#include <cstring>
#include <fstream>

#include "aureole/scene/resolve.h"
#include "aureole/scene/values.h"

namespace aureole {

namespace {

/// FNV-1a over 64-bit words instead of bytes, for files of many megabytes, with a final mix because
/// multiplication alone carries nothing from high to low bits.
class Hash {
public:
  void bytes(const char* data, std::size_t size) {
    word(size);
    for (; size >= 8; data += 8, size -= 8) {
      std::uint64_t w;
      std::memcpy(&w, data, 8);
      word(w);
    }
    std::uint64_t rest = 0;
    std::memcpy(&rest, data, size);
    word(rest);
  }
  void text(std::string_view s) { bytes(s.data(), s.size()); }

  std::uint64_t value() const {
    std::uint64_t h = state_;
    h = (h ^ (h >> 32)) * 0xd6e8feb86659fd93u;
    return h ^ (h >> 32);
  }

private:
  void word(std::uint64_t w) { state_ = ((state_ ^ w) * 0x100000001b3u) ^ (state_ >> 29); }
  std::uint64_t state_ = 0xcbf29ce484222325u;
};

bool names_file(const Node& node, const Attribute& a) {
  const std::string name = node.get("name");
  return (node.tag == "string" && (name == "filename" || name == "size_histogram") && a.name == "value") ||
         (node.tag == "spectrum" && a.name == "filename");
}

void add_node(const Node& node, Hash& hash) {
  hash.text(node.tag);
  std::vector<const Attribute*> sorted;
  for (const Attribute& a : node.attributes) sorted.push_back(&a);
  std::sort(sorted.begin(), sorted.end(),
            [](const Attribute* a, const Attribute* b) { return a->name < b->name; });
  for (const Attribute* a : sorted) {
    if (a->name == "version" || names_file(node, *a))
      continue;  // a file counts by its content, wherever it lies
    hash.text(a->name);
    if (node.tag == "string")
      hash.text(a->value);
    else
      for (std::string_view word : split_list(a->value)) hash.text(word);
  }
  for (const Node& child : node.children) {
    const std::string name = child.get("name");
    if (node.tag == "sampler" && (name == "sample_count" || name == "seed")) continue;
    add_node(child, hash);
  }
  hash.text("/");
}

}  // namespace

std::uint64_t content_hash(const Node& root, const References& references) {
  Hash hash;
  add_node(root, hash);
  for (const auto& file : references.files) {
    std::ifstream stream(file, std::ios::binary);
    std::vector<char> block(1 << 20);
    do {
      stream.read(block.data(), std::streamsize(block.size()));
      hash.bytes(block.data(), std::size_t(stream.gcount()));
    } while (stream);
  }
  return hash.value();
}

}  // namespace aureole
