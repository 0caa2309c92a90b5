// SPDX-License-Identifier: Apache-2.0
// A scene that stays open: its parameters can be read and changed by path, and what a change does not touch
// (meshes, their acceleration structure, textures, tabulated BSDFs) is kept.
//
// A path is a chain of names joined by points: "glass.bsdf.area_fraction". The first name is the id of an
// object anywhere in the scene, or the name or family of a child of <scene>; each further one is the name of
// a child, or its family where it has no name ("bsdf", then "bsdf_2", ...). A reference is followed: what it
// refers to changes for all who refer to it.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "aureole/scene/build.h"
#include "aureole/scene/object_pool.h"
#include "aureole/scene/opened_scene.h"
#include "aureole/scene/scene.h"

namespace aureole {

class SceneDocument {
public:
  /// As `load_scene` and `load_scene_from_string`; throw as these do.
  explicit SceneDocument(const std::filesystem::path& file, const LoadOptions& options = {});
  SceneDocument(const std::string& text, const std::filesystem::path& pretended_file,
                const LoadOptions& options = {});
  ~SceneDocument();

  /// Replaced by every change. A change may alter shapes of earlier scenes, which are not to be used any
  /// more.
  const std::shared_ptr<const Scene>& scene() const { return scene_; }

  /// Paths of all parameters and objects that are written in the scene, in its order; what references lead to
  /// only under its own path.
  std::vector<std::string> paths() const;
  /// The element at a path, references followed. Null for a parameter that the object's plug-in documents but
  /// that is not written; throws Error where there is no such path.
  const Node* find(const std::string& path) const;
  /// The object that `path` is, or that holds the parameter.
  const Node& owner(const std::string& path) const;

  /// The object that the element at a path became, or null.
  ObjectPtr object(const std::string& path) const;

  /// A new element for each path, as XML without a name ("<float value='.4'/>"); empty text removes what is
  /// there. All or nothing: throws ErrorList and leaves everything as it was. `given` adds to
  /// LoadOptions::given, from which goes what nothing refers to any more.
  void set(const std::vector<std::pair<std::string, std::string>>& changes,
           const std::map<std::string, ObjectPtr>& given = {});

  /// The scene as it is now, as the text of a scene file: upgraded, without <include>, <default> and $names.
  /// Throws Error where objects that a program gave are in it.
  std::string xml() const;

  /// `run` calls a function while nobody reads properties of shapes: called with the moment in which shapes
  /// get other children.
  void set_exclusive(std::function<void(const std::function<void()>&)> run) { exclusive_ = std::move(run); }

private:
  struct Place;
  Place place(const std::string& path) const;
  void build();

  LoadOptions options_;
  std::unique_ptr<ParsedScene> parsed_;
  ObjectPool pool_;
  std::unordered_map<const Node*, ObjectPtr> objects_;
  std::shared_ptr<const Scene> scene_;
  std::vector<std::string> notes_;  ///< of all builds: a kept object says its own once
  std::function<void(const std::function<void()>&)> exclusive_ = [](const auto& f) { f(); };
};

}  // namespace aureole
