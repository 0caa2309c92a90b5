// SPDX-License-Identifier: Apache-2.0
// Last stage of loading: nodes -> objects. Each object is built once, when it is first needed, and shared by
// every reference to it, so that a reference may come before what it refers to.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "aureole/plugin/properties.h"
#include "aureole/scene/adoption.h"
#include "aureole/scene/object_pool.h"
#include "aureole/scene/resolve.h"
#include "aureole/shape/shape.h"

namespace aureole {

struct PluginAlias;

class Builder : public SceneLookup {
public:
  /// `given` are the objects that <given key="..."/> stands for; `pool`, which may be null, holds those of an
  /// earlier build.
  Builder(const References& references, std::shared_ptr<const BuildContext> context, Diagnostics& diagnostics,
          const std::map<std::string, ObjectPtr>& given, ObjectPool* pool = nullptr)
      : references_(references),
        context_(std::move(context)),
        diagnostics_(diagnostics),
        given_(given),
        pool_(pool),
        keys_(references) {}

  /// Shapes that were kept and are to get other children, once nothing can fail any more.
  std::vector<Adoption> take_adoptions() { return std::move(adoptions_); }

  /// The object of an element or of a <ref> to it. Null where it could not be built; the reasons have been
  /// reported, and only once for all references to it.
  ObjectPtr object(const Node& node);

  ObjectPtr find(std::string_view family, const std::string& id) override;
  void add_file(const std::filesystem::path& file) override {
    files_.push_back(file);
    ++looks_around_;
  }
  const std::vector<std::filesystem::path>& files() const { return files_; }

  /// What every element became so far.
  const std::unordered_map<const Node*, ObjectPtr>& built() const { return built_; }

  /// The element itself, or what a <ref> points to, or null.
  const Node* target(const Node& node) const;

private:
  ObjectPtr construct(const Node& node);
  ObjectPtr given(const Node& node);
  const PluginInfo* plugin_of(const Node& node, const PluginAlias** alias);
  /// Adds the parameter or child object; false if it has a problem.
  bool add_child(const Node& child, Properties& properties);
  /// A shape of the pool of the same geometry, to be adopted, or null.
  ObjectPtr kept_shape(const Node& node, const Properties& properties);
  ObjectPtr create(const Node& node, const PluginInfo& plugin, const Properties& properties);
  void report_unknown_parameters(const Node& node, const PluginInfo& plugin);

  const References& references_;
  std::shared_ptr<const BuildContext> context_;
  Diagnostics& diagnostics_;
  const std::map<std::string, ObjectPtr>& given_;
  ObjectPool* pool_;
  PoolKeys keys_;
  std::vector<Adoption> adoptions_;
  int depth_ = 0;
  std::size_t looks_around_ = 0;             ///< how often an object asked for more than its own parameters
  std::unordered_set<const Node*> lookers_;  ///< elements whose objects did
  std::unordered_map<const Node*, ObjectPtr> built_;  ///< null for failed ones
  std::vector<std::filesystem::path> files_;
};

/// `unknown element <bdsf>; did you mean "bsdf"?`
Error unknown_element(const Node& node);

}  // namespace aureole
