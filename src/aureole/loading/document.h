// SPDX-License-Identifier: Apache-2.0
// A scene that stays open for editing. Its parameters can be read and changed by path. Everything that a
// change does not affect (meshes, their acceleration structure, textures, tabulated BSDFs) is kept.
//
// A path is a chain of names joined by dots: "glass.bsdf.area_fraction". The first name is the id of an
// object anywhere in the scene, or the name or family of a child of <scene>. Each further name is the name of
// a child, or its family if it has no name ("bsdf", then "bsdf_2", ...). References are followed: a change of
// an object applies to every reference to it.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "aureole/loading/load.h"
#include "aureole/loading/object_pool.h"
#include "aureole/loading/parse.h"

namespace aureole {

class SceneDocument {
public:
  /// Opens a scene like `load_scene` and `load_scene_from_string`, and throws the same errors.
  explicit SceneDocument(const std::filesystem::path& file, const LoadOptions& options = {});
  SceneDocument(const std::string& text, const std::filesystem::path& pretended_file,
                const LoadOptions& options = {});
  ~SceneDocument();

  /// The current scene. Scenes from before an edit do not change and can be rendered concurrently.
  const LoadedScene& loaded() const { return loaded_; }
  const std::shared_ptr<const Scene>& scene() const { return loaded_.scene; }

  /// Paths of all parameters and objects written in the scene, in order. Targets of references appear only
  /// under their own path.
  std::vector<std::string> paths() const;
  /// Returns the element at a path, following references. Null for a parameter that the object's plug-in
  /// documents but that is not written. Throws Error if the path does not exist.
  const Node* find(const std::string& path) const;
  /// Returns the object at `path`, or the object whose parameter is at `path`.
  const Node& owner(const std::string& path) const;

  /// Returns the object built from the element at a path, or null.
  ObjectPtr object(const std::string& path) const;

  /// Replaces elements. `changes` are pairs of a path and a new element as XML without a name ("<float
  /// value='0.4'/>"); empty text removes the element. Makes a new scene, which shares everything unchanged
  /// with the previous one. On errors throws ErrorList and changes nothing. `given` is added to
  /// LoadOptions::given; objects without references are then removed from it.
  const LoadedScene& edit(const std::vector<std::pair<std::string, std::string>>& changes,
                          const std::map<std::string, ObjectPtr>& given = {});

  /// Returns the current scene as `load_scene` would load it for denoising; the document does not change.
  LoadedScene for_denoising();

  /// The current scene as the text of a scene file: upgraded, without <include>, <default> and $names. Throws
  /// Error if it contains objects that a program passed in memory.
  std::string xml() const;

private:
  struct Place;
  Place place(const std::string& path) const;
  void build();

  LoadOptions options_;
  std::unique_ptr<ParsedScene> parsed_;
  ObjectPool pool_;
  NodeTable<ObjectPtr> objects_;
  LoadedScene loaded_;
  /// notes of the file and of all builds; objects that are kept between builds are noted once
  std::vector<std::string> notes_;
};

}  // namespace aureole
