// SPDX-License-Identifier: Apache-2.0
// The fuzzer's corpus: every scene of the repository, every example in the documentation of a registered
// plug-in wrapped into a scene, and every file found beside the scenes. New ones are included automatically.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "fuzz/fuzz_random.h"

namespace aureole::fuzz {

using Bytes = std::shared_ptr<const std::string>;
/// Name -> content of the files of a case, which all lie in one folder.
using Files = std::map<std::string, Bytes>;

/// Larger files are left out: slow cases find few errors.
inline constexpr std::size_t kLargestFile = 200 << 10;
inline constexpr char kMainFile[] = "scene.xml";

/// A scene that loads, made so small that it renders in milliseconds: few pixels, few samples, short paths.
struct BaseScene {
  std::string name;
  Files files;  ///< kMainFile and what it refers to
  /// Its objects tabulate physics, or edges of round shapes, which takes a hundred times as long as all else.
  bool has_tables = false;
};

class Corpus {
public:
  /// `source` is the root of the repository.
  explicit Corpus(const std::filesystem::path& source);

  /// A scene; those of the repository, of examples, of images and of volumes are equally likely, and one with
  /// tables comes a tenth as often as another.
  const BaseScene& pick_scene(Random& random) const;
  const std::vector<BaseScene>& scenes() const { return scenes_; }

  /// Meshes, images, spectra: name -> content.
  const std::vector<std::pair<std::string, Bytes>>& data_files() const { return data_; }
  /// One with the ending of `name` if there is one, else any.
  const std::pair<std::string, Bytes>& data_file_like(const std::string& name, Random& random) const;
  /// Examples of plug-ins, by family, their file names replaced by those of data files.
  const std::map<std::string, std::vector<std::string>>& examples() const { return examples_; }
  const std::string& any_example(Random& random) const;

private:
  void add_data_files(const std::filesystem::path& folder);
  void add_scene(const std::filesystem::path& file, const std::filesystem::path& root);
  void add_examples();
  void add_image_scenes();
  void add_volume_scenes(const std::filesystem::path& folder);
  void add_splat_scenes(const std::filesystem::path& folder);
  void find_tables();
  /// The text with numbers made small and file names made names of files in one folder, which are added.
  std::string prepare(const std::string& text, const std::filesystem::path& folder, Files& files) const;

  std::vector<BaseScene> scenes_;
  std::vector<std::size_t> group_begin_;  ///< of repository scenes, examples, images, volumes; then the end
  std::vector<std::pair<std::string, Bytes>> data_;
  std::map<std::string, std::vector<std::string>> examples_;
};

/// The content of a file; empty where it cannot be read.
std::string read_whole(const std::filesystem::path& file);
bool is_image_name(const std::string& name);

}  // namespace aureole::fuzz
