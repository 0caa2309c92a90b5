// SPDX-License-Identifier: Apache-2.0
// Changes to a scene as a tree: what somebody who edits scenes gets wrong, and what nobody would write.
#pragma once

#include <pugixml.hpp>
#include <string>
#include <vector>

#include "fuzz/corpus.h"

namespace aureole::fuzz {

/// The data that a mutation works on. `files` are the other files of the case; a change may add some.
struct SceneEdit {
  const Corpus& corpus;
  Random& random;
  pugi::xml_document& document;
  Files& files;

  std::vector<pugi::xml_node> elements() const;  ///< all but the root
  /// Any element; null in an empty scene.
  pugi::xml_node any_element() const;
  /// An element that is an object (has a type), or null.
  pugi::xml_node any_object() const;
  pugi::xml_attribute any_attribute() const;
  /// Parses `xml` and puts its elements below `parent` at a random place.
  void insert(pugi::xml_node parent, const std::string& xml) const;
};

/// A kind of change: its name for reports, how often it is chosen, and the change; false where it does not
/// apply.
struct SceneMutation {
  const char* name;
  int weight;
  bool (*apply)(SceneEdit&);
  bool gentle = false;  ///< often leaves the scene a valid one
};

const std::vector<SceneMutation>& value_mutations();      ///< numbers, text, names, types, parameters
const std::vector<SceneMutation>& structure_mutations();  ///< elements, references, includes, parameters

}  // namespace aureole::fuzz
