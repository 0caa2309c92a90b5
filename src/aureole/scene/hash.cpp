// SPDX-License-Identifier: Apache-2.0
// Hashes: of a scene's content, by which a checkpoint recognises the scene it belongs to, and of single
// elements, by which objects are found again after a change.
#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "aureole/sampler/sampler_docs.h"
#include "aureole/scene/object_pool.h"
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
  void number(std::uint64_t w) { word(w); }

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
    if (node.tag == "sampler" && is_sampler_parameter(child.get("name"))) continue;
    add_node(child, hash);
  }
  hash.text("/");
}

/// Of an element with all it refers to.
class KeyMaker {
public:
  explicit KeyMaker(const References& references) : references_(references) {}

  std::uint64_t key(const Node& node, bool without_children_of_shape = false) {
    const auto target = references_.targets.find(&node);
    if (target != references_.targets.end()) return key(*target->second);
    if (const auto known = known_.find(&node); known != known_.end() && !without_children_of_shape)
      return known->second;
    Hash hash;
    hash.text(node.tag);
    for (const Attribute& a : node.attributes) {
      hash.text(a.name);
      hash.text(a.value);
      if (names_file(node, a)) add_file(a.value, hash);
    }
    for (const Node& child : node.children) {
      if (without_children_of_shape) {
        const auto referred = references_.targets.find(&child);
        const std::string family =
            object_family(referred == references_.targets.end() ? child : *referred->second);
        if (family == "bsdf" || family == "emitter" || family == "sensor") continue;
      }
      hash.text(child.get("name"));  // of a reference: what it refers to does not say it
      hash.number(key(child));
    }
    if (!without_children_of_shape) known_[&node] = hash.value();
    return hash.value();
  }

private:
  static void add_file(const std::string& path, Hash& hash) {
    std::error_code ignored;
    hash.number(std::uint64_t(std::filesystem::file_size(path, ignored)));
    hash.number(std::uint64_t(std::filesystem::last_write_time(path, ignored).time_since_epoch().count()));
  }

  const References& references_;
  std::unordered_map<const Node*, std::uint64_t> known_;
};

}  // namespace

struct PoolKeys::Maker : KeyMaker {
  using KeyMaker::KeyMaker;
};
PoolKeys::PoolKeys(const References& references) : maker_(std::make_unique<Maker>(references)) {}
PoolKeys::~PoolKeys() = default;
ObjectPool::Key PoolKeys::of(const Node& node) {
  return {maker_->key(node), object_family(node) == "shape" ? maker_->key(node, true) : 0};
}

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
