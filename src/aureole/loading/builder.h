// SPDX-License-Identifier: Apache-2.0
// Last stage of loading: nodes -> objects. Each object is built once, on first use, and shared by every
// reference to it, so that a reference may precede its target.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "aureole/loading/object_pool.h"
#include "aureole/loading/references.h"
#include "aureole/plugin/properties.h"
#include "aureole/plugin/table_progress.h"

namespace aureole {

struct PluginAlias;

class Builder : public SceneLookup, public TableListener {
public:
  /// `given` are the objects for <given key="..."/>. `progress` is called while slow tables are computed.
  /// `pool`, which may be null, holds the objects of an earlier build.
  Builder(const References& references, std::shared_ptr<const BuildContext> context, Diagnostics& diagnostics,
          const std::map<std::string, ObjectPtr>& given, TableProgress progress = {},
          ObjectPool* pool = nullptr)
      : references_(references),
        context_(std::move(context)),
        diagnostics_(diagnostics),
        given_(given),
        progress_(std::move(progress)),
        pool_(pool),
        keys_(references, given),
        built_(references.node_count()),
        is_built_(references.node_count()) {}

  /// Returns the object of an element or of the target of a <ref>. Null if it could not be built; the reasons
  /// are reported once for all references to it.
  ObjectPtr object(const Node& node);

  ObjectPtr find(std::string_view family, const std::string& id) override;
  void add_file(const std::filesystem::path& file) override { files_.push_back(file); }
  const std::vector<std::filesystem::path>& files() const { return files_; }
  std::optional<WideHashValue> inputs_of_object() override {
    return making_ ? keys_.inputs_of(*making_, *context_) : std::nullopt;
  }
  const TableProgress& table_progress() const override { return progress_; }

  /// The objects built so far, by element; null if there is none.
  const NodeTable<ObjectPtr>& built() const { return built_; }
  NodeTable<ObjectPtr> take_built() { return std::move(built_); }

  /// Returns the element itself; for a <ref>, the element it refers to, or null if there is none.
  const Node* target(const Node& node) const { return references_.follow(node); }

private:
  ObjectPtr construct(const Node& node);
  ObjectPtr given(const Node& node);
  const PluginInfo* plugin_of(const Node& node, const PluginAlias** alias);
  /// Adds the parameter or child object; returns false if it has a problem.
  bool add_child(const Node& child, Properties& properties);
  ObjectPtr create(const Node& node, const PluginInfo& plugin, const Properties& properties);
  void report_unknown_parameters(const Node& node, const PluginInfo& plugin);

  const References& references_;
  std::shared_ptr<const BuildContext> context_;
  Diagnostics& diagnostics_;
  const std::map<std::string, ObjectPtr>& given_;
  TableProgress progress_;
  ObjectPool* pool_;
  PoolKeys keys_;
  const Node* making_ = nullptr;  ///< the element whose object is being constructed
  NodeTable<ObjectPtr> built_;    ///< object of each element; null if building failed
  NodeTable<char> is_built_;      ///< whether building of an element was begun
  std::vector<std::filesystem::path> files_;
};

/// Returns an error such as: unknown element <bdsf>; did you mean "bsdf"?
Error unknown_element(const Node& node);

}  // namespace aureole
