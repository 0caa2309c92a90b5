// SPDX-License-Identifier: Apache-2.0
// A scene that stays open: its parameters can be read and changed by path, and what a change does not touch
// (meshes, their acceleration structure, textures, tabulated BSDFs) is kept.
//
// A path is a chain of names joined by points: "glass.bsdf.area_fraction". The first name is the id of an
// object anywhere in the scene, or the name or family of a child of <scene>; each further one is the name of
// a child, or its family where it has no name ("bsdf", then "bsdf_2", ...). References are followed: a change
// of an object applies to every reference to it.
#pragma once

#include <memory>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "aureole/loading/load.h"
#include "aureole/loading/object_pool.h"
#include "aureole/loading/parse.h"

namespace aureole {

class SceneDocument {
public:
  /// As `load_scene` and `load_scene_from_string`; throw as these do.
  explicit SceneDocument(const std::filesystem::path& file, const LoadOptions& options = {});
  SceneDocument(const std::string& text, const std::filesystem::path& pretended_file,
                const LoadOptions& options = {});
  ~SceneDocument();

  /// The scene as it is now. Scenes of before an edit stay what they were, and may be rendered meanwhile.
  const LoadedScene& loaded() const { return loaded_; }
  const std::shared_ptr<const Scene>& scene() const { return loaded_.scene; }

  /// Paths of all parameters and objects that are written in the scene, in its order; targets of references
  /// appear only under their own path.
  std::vector<std::string> paths() const;
  /// The element at a path, references followed. Null for a parameter that the object's plug-in documents but
  /// that is not written; throws Error where there is no such path.
  const Node* find(const std::string& path) const;
  /// The object at `path`, or the object whose parameter is at `path`.
  const Node& owner(const std::string& path) const;

  /// The object built from the element at a path, or null.
  ObjectPtr object(const std::string& path) const;

  /// A new element for each path, as XML without a name ("<float value='.4'/>"); empty text removes the
  /// element. Makes a new scene, which shares everything unchanged with the previous one. On errors throws
  /// ErrorList and changes nothing. `given` is added to LoadOptions::given, from which objects without
  /// references are then removed.
  const LoadedScene& edit(const std::vector<std::pair<std::string, std::string>>& changes,
                          const std::map<std::string, ObjectPtr>& given = {});

  /// The scene as it is now, as the text of a scene file: upgraded, without <include>, <default> and $names.
  /// Throws Error where objects that a program gave are in it.
  std::string xml() const;

private:
  struct Place;
  Place place(const std::string& path) const;
  void build();

  LoadOptions options_;
  std::unique_ptr<ParsedScene> parsed_;
  ObjectPool pool_;
  std::unordered_map<const Node*, ObjectPtr> objects_;
  LoadedScene loaded_;
  std::vector<std::string> notes_;  ///< of the file and of all builds; kept objects add none again
};

}  // namespace aureole
