// SPDX-License-Identifier: Apache-2.0
// The registry of families and of their plug-ins. A plug-in is one .cpp file that ends with
// AUREOLE_PLUGIN(...), a family is declared by AUREOLE_FAMILY in its `<family>/<family>.cpp`. The reader of
// scenes, the hash, the reference page of the docs and every check of parameter names ask here and keep no
// lists of their own.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "aureole/plugin/object.h"
#include "aureole/plugin/properties.h"

namespace aureole {

/// One row of a plug-in's parameter table.
struct ParameterDoc {
  std::string name;
  /// float, integer, boolean, string, length, vector, transform, spectrum, texture, file, or a family. Type
  /// `file` alone makes the loader search for it beside the scene, hash its content, and report an error if
  /// it is missing.
  std::string type;
  std::string unit;      ///< empty where there is none
  std::string fallback;  ///< the default as a user would write it; "required" or "none"
  std::string meaning;
};

/// Documentation of a plug-in.
struct PluginDoc {
  std::string summary = "";  ///< one or more sentences
  std::string source = "";   ///< work and equation the model comes from; empty for plain infrastructure
  /// Rows shared by the family's plug-ins are appended automatically, except for names that are listed here.
  std::vector<ParameterDoc> parameters = {};
  /// XML of instances that together read every parameter; shown in the docs and built by the tests.
  std::vector<std::string> examples = {};
  bool takes_shared_parameters = true;  ///< those of its family
  bool needs_shape = false;             ///< has no effect by itself: it must be a child of a shape
  std::string advice = "";  ///< a note for scenes that use it, if another plug-in is the better choice
};

struct PluginInfo {
  std::string family;  ///< the name of a FamilyInfo
  std::string name;
  PluginDoc doc;
  std::function<ObjectPtr(const Properties&)> create;
  /// The range of wavelengths that an object with these parameters responds to or has data for, if they state
  /// one. Called before any object is built: of nested objects only the raw parameters are known. Null for
  /// most plug-ins.
  std::function<std::optional<WavelengthRange>(const Properties&)> wavelength_range = nullptr;

  /// The row of the parameter table, or null.
  const ParameterDoc* parameter(std::string_view name) const;
  bool documents(std::string_view name) const { return parameter(name) != nullptr; }
  bool names_file(std::string_view name) const;
  std::vector<std::string> parameter_names() const;
};

/// Description of a family of plug-ins.
struct FamilyInfo {
  std::string name;                 ///< the element of its objects: bsdf, shape, texture, ...
  std::string second_element = "";  ///< another element, which is one of its objects where it has a `type`
  std::string fallback = "";        ///< the default plug-in where a scene states none; empty: no default
  std::vector<ParameterDoc> parameters = {};  ///< rows that all of its plug-ins share
  bool parameters_are_of_render = false;      ///< these control rendering only: not in the scene's hash
  bool belongs_to_shapes = false;  ///< children of a shape of this family do not change its geometry
  /// An object depends on its parameters, the wavelengths and the unit of length alone: where these stay, it
  /// outlives changes of the scene.
  bool is_reusable = false;

  /// Whether a row that all plug-ins share has that name.
  bool shares(std::string_view parameter) const;
};

class Registry {
public:
  static Registry& instance();
  void add(FamilyInfo info);  ///< throws std::logic_error where the name is taken
  void add(PluginInfo info);  ///< throws std::logic_error where the name is taken
  const FamilyInfo* family(std::string_view name) const;
  /// The family whose object an element <tag> or <tag type="..."> is, or null.
  const FamilyInfo* family_of_element(std::string_view tag, bool has_type) const;
  const PluginInfo* find(std::string_view family, std::string_view name) const;
  std::vector<std::string> families() const;                      ///< sorted
  std::vector<std::string> names(std::string_view family) const;  ///< sorted
  const std::vector<PluginInfo>& all() const { return plugins_; }

private:
  std::vector<FamilyInfo> families_;
  std::vector<PluginInfo> plugins_;
};

using NamedValues = std::vector<std::pair<std::string, Properties::Value>>;

/// An object of the plug-in as if it were written where `owner` is; null where there is no such plug-in.
/// Throws as its constructor does.
ObjectPtr make_object(const Properties& owner, std::string_view family, std::string_view plugin,
                      const NamedValues& parameters = {});

/// The same for the family's default plug-in. Throws std::logic_error where there is none.
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

/// `Class::wavelength_range`, where a plug-in has it: PluginInfo::wavelength_range.
template <class Class>
std::function<std::optional<WavelengthRange>(const Properties&)> wavelength_range_of() {
  if constexpr (requires(const Properties& p) { Class::wavelength_range(p); })
    return [](const Properties& p) { return Class::wavelength_range(p); };
  else
    return nullptr;
}

/// AUREOLE_PLUGIN(Diffuse, "bsdf", "diffuse", PluginDoc{...}): `Class` needs a constructor from const
/// Properties&.
#define AUREOLE_PLUGIN(Class, family, name, ...)                                  \
  static const ::aureole::PluginRegistration aureole_plugin_registration_##Class( \
      {family, name, __VA_ARGS__,                                                 \
       [](const ::aureole::Properties& properties) {                              \
         return ::aureole::ObjectPtr(std::make_shared<Class>(properties));        \
       },                                                                         \
       ::aureole::wavelength_range_of<Class>()})

/// AUREOLE_FAMILY(FamilyInfo{.name = "bsdf", ...})
#define AUREOLE_FAMILY(...) \
  static const ::aureole::FamilyRegistration aureole_family_registration(__VA_ARGS__)

}  // namespace aureole
