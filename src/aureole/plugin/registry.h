// SPDX-License-Identifier: Apache-2.0
// The registry of families and of their plug-ins. A plug-in is one .cpp file that ends with
// AUREOLE_PLUGIN(...). A family is declared by AUREOLE_FAMILY in its `<family>/<family>.cpp`. The scene
// reader, the hash, the generated reference page and every check of parameter names query the registry and
// keep no lists of their own.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "aureole/plugin/object.h"
#include "aureole/plugin/properties.h"

namespace aureole {

/// One row of a plug-in's parameter table.
struct ParameterDoc {
  std::string name;
  /// float, integer, boolean, string, length, vector, transform, spectrum, texture, file, or a family. For
  /// type `file` only, the loader searches the file next to the scene, hashes its content, and reports an
  /// error if it is missing.
  std::string type;
  std::string unit;      ///< unit of the parameter; empty if there is none
  std::string fallback;  ///< the default as a user would write it; "required" or "none"
  std::string meaning;
};

/// Documentation of a plug-in.
struct PluginDoc {
  std::string summary = "";  ///< one or more sentences
  std::string source = "";   ///< publication and equation of the model; empty for plain infrastructure
  /// Rows shared by the family's plug-ins are appended automatically, except for names already listed here.
  std::vector<ParameterDoc> parameters = {};
  /// XML of instances that together read every parameter; shown in the docs and built by the tests.
  std::vector<std::string> examples = {};
  bool takes_shared_parameters = true;  ///< whether the family's shared parameters apply to the plug-in
  /// whether the plug-in has no effect by itself, since it must be a child of a shape
  bool needs_shape = false;
  std::string advice = "";  ///< a note for scenes that use this plug-in, if another one is the better choice
};

struct PluginInfo {
  std::string family;  ///< family of the plug-in, the name of a FamilyInfo
  std::string name;
  PluginDoc doc;
  std::function<ObjectPtr(const Properties&)> create;
  /// Returns the range of wavelengths over which an object with these parameters responds or has data, if the
  /// parameters state one. Called before any object is built: for nested objects only raw parameters are
  /// known. Null for most plug-ins.
  std::function<std::optional<WavelengthRange>(const Properties&)> wavelength_range = nullptr;

  /// Returns the row of the parameter table, or null.
  const ParameterDoc* parameter(std::string_view name) const;
  bool documents(std::string_view name) const { return parameter(name) != nullptr; }
  bool names_file(std::string_view name) const;
  std::vector<std::string> parameter_names() const;
};

/// Description of a family of plug-ins.
struct FamilyInfo {
  std::string name;                 ///< the XML element of its objects: bsdf, shape, texture, ...
  std::string second_element = "";  ///< a further XML element of its objects, recognised by a `type`
  std::string fallback = "";        ///< the default plug-in if a scene gives none; empty: no default
  std::vector<ParameterDoc> parameters = {};  ///< rows that all plug-ins of the family share
  /// whether the parameters control rendering only, so that they are excluded from the hash
  bool parameters_are_of_render = false;
  /// whether such an object, as a child of a shape, leaves its geometry unchanged
  bool belongs_to_shapes = false;
  /// Whether an object depends only on its parameters, the wavelengths and the unit of length. Such an object
  /// is reused in later versions of the scene while these are unchanged.
  bool is_reusable = false;

  /// Whether a shared row has that name.
  bool shares(std::string_view parameter) const;
};

class Registry {
public:
  static Registry& instance();
  void add(FamilyInfo info);  ///< Adds a family. Throws std::logic_error if the name is taken.
  void add(PluginInfo info);  ///< Adds a plug-in. Throws std::logic_error if the name is taken.
  const FamilyInfo* family(std::string_view name) const;
  /// Returns the family of the object that an element <tag> or <tag type="..."> describes, or null.
  const FamilyInfo* family_of_element(std::string_view tag, bool has_type) const;
  const PluginInfo* find(std::string_view family, std::string_view name) const;
  std::vector<std::string> families() const;  ///< Returns the names of all families, sorted.
  /// Returns the names of a family's plug-ins, sorted.
  std::vector<std::string> names(std::string_view family) const;
  const std::vector<PluginInfo>& all() const { return plugins_; }

private:
  struct TextHash {
    using is_transparent = void;
    std::size_t operator()(std::string_view text) const { return std::hash<std::string_view>()(text); }
  };
  template <class T>
  using ByName = std::unordered_map<std::string, T, TextHash, std::equal_to<>>;

  std::vector<FamilyInfo> families_;
  std::vector<PluginInfo> plugins_;
  ByName<std::size_t> family_index_, second_element_index_;  ///< indices into families_
  ByName<ByName<std::size_t>> plugin_index_;                 ///< indices into plugins_ by family and name
};

using NamedValues = std::vector<std::pair<std::string, Properties::Value>>;

/// Makes an object of the plug-in, with the location and context of `owner`. Null if there is no such
/// plug-in. Throws whatever its constructor throws.
ObjectPtr make_object(const Properties& owner, std::string_view family, std::string_view plugin,
                      const NamedValues& parameters = {});

/// Makes an object of the family's default plug-in, as `make_object`. Throws std::logic_error if there is
/// none.
ObjectPtr make_default_object(const Properties& owner, std::string_view family,
                              const NamedValues& parameters = {});
template <class T>
std::shared_ptr<T> make_default(const Properties& owner, std::string_view family,
                                const NamedValues& parameters = {}) {
  return std::dynamic_pointer_cast<T>(make_default_object(owner, family, parameters));
}

struct PluginRegistration {
  explicit PluginRegistration(PluginInfo info) { Registry::instance().add(std::move(info)); }
};
struct FamilyRegistration {
  explicit FamilyRegistration(FamilyInfo info) { Registry::instance().add(std::move(info)); }
};

/// Returns `Class::wavelength_range` if the plug-in has one, else null; see PluginInfo::wavelength_range.
template <class Class>
std::function<std::optional<WavelengthRange>(const Properties&)> wavelength_range_of() {
  if constexpr (requires(const Properties& p) { Class::wavelength_range(p); })
    return [](const Properties& p) { return Class::wavelength_range(p); };
  else
    return nullptr;
}

/// Registers a plug-in: AUREOLE_PLUGIN(Diffuse, "bsdf", "diffuse", PluginDoc{...}). `Class` needs a
/// constructor from const Properties&.
#define AUREOLE_PLUGIN(Class, family, name, ...)                                  \
  static const ::aureole::PluginRegistration aureole_plugin_registration_##Class( \
      {family, name, __VA_ARGS__,                                                 \
       [](const ::aureole::Properties& properties) {                              \
         return ::aureole::ObjectPtr(std::make_shared<Class>(properties));        \
       },                                                                         \
       ::aureole::wavelength_range_of<Class>()})

/// Registers a family: AUREOLE_FAMILY(FamilyInfo{.name = "bsdf", ...}).
#define AUREOLE_FAMILY(...) \
  static const ::aureole::FamilyRegistration aureole_family_registration(__VA_ARGS__)

}  // namespace aureole
