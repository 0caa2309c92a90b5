// SPDX-License-Identifier: Apache-2.0
// The registry of plug-ins. A plug-in is one .cpp file that ends with AUREOLE_PLUGIN(...); the reference page
// of the docs and every check of parameter names come from what is registered there.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "aureole/plugin/object.h"
#include "aureole/plugin/properties.h"

namespace aureole {

/// One row of a plug-in's parameter table.
struct ParameterDoc {
  std::string name;
  std::string type;  ///< float, integer, boolean, string, length, vector, transform, spectrum, texture, file,
                     ///< or a family
  std::string unit;  ///< empty where there is none
  std::string fallback;  ///< the default as a user would write it; "required" or "none"
  std::string meaning;
};

/// What a plug-in says about itself.
struct PluginDoc {
  std::string summary;  ///< one or more sentences
  std::string source;   ///< work and equation the model comes from; empty for plain infrastructure
  std::vector<ParameterDoc> parameters;
  /// XML of instances that together read every parameter; shown in the docs and built by the tests.
  std::vector<std::string> examples;
};

struct PluginInfo {
  std::string
      family;  ///< the XML tag: bsdf, shape, texture, emitter, sensor, film, rfilter, sampler, integrator
  std::string name;
  PluginDoc doc;
  std::function<ObjectPtr(const Properties&)> create;

  bool documents(std::string_view parameter) const;
  std::vector<std::string> parameter_names() const;
};

class Registry {
public:
  static Registry& instance();
  void add(PluginInfo info);  ///< throws std::logic_error where the name is taken
  const PluginInfo* find(std::string_view family, std::string_view name) const;
  std::vector<std::string> families() const;                      ///< sorted
  std::vector<std::string> names(std::string_view family) const;  ///< sorted
  const std::vector<PluginInfo>& all() const { return plugins_; }

private:
  std::vector<PluginInfo> plugins_;
};

struct PluginRegistration {
  explicit PluginRegistration(PluginInfo info) { Registry::instance().add(std::move(info)); }
};

/// AUREOLE_PLUGIN(Diffuse, "bsdf", "diffuse", PluginDoc{...}): `Class` needs a constructor from const
/// Properties&.
#define AUREOLE_PLUGIN(Class, family, name, ...)                                  \
  static const ::aureole::PluginRegistration aureole_plugin_registration_##Class( \
      {family, name, __VA_ARGS__, [](const ::aureole::Properties& properties) {   \
         return ::aureole::ObjectPtr(std::make_shared<Class>(properties));        \
       }})

}  // namespace aureole
