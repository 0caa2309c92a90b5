// SPDX-License-Identifier: Apache-2.0
#include "aureole/plugin/registry.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace aureole {
namespace {

ParameterDoc row(const std::string& name, const std::string& meaning = "") {
  return {name, "float", "", "1", meaning};
}
FamilyInfo lamps() {
  return {.name = "lamp",
          .second_element = "light",
          .fallback = "bulb",
          .parameters = {row("weight", "shared"), row("power")}};
}
PluginInfo bulb() { return {"lamp", "bulb", {.parameters = {row("colour"), row("weight", "own")}}, {}}; }

TEST(Registry, PluginsShareTheRowsOfTheirFamilyWhicheverComesFirst) {
  for (const bool family_first : {true, false}) {
    Registry registry;
    if (family_first) registry.add(lamps());
    registry.add(bulb());
    registry.add(PluginInfo{"lamp", "bare", {.takes_shared_parameters = false}, {}});
    registry.add(PluginInfo{"chair", "stool", {}, {}});
    if (!family_first) registry.add(lamps());
    const PluginInfo* plugin = registry.find("lamp", "bulb");
    EXPECT_EQ(plugin->parameter_names(), (std::vector<std::string>{"colour", "weight", "power"}));
    EXPECT_EQ(plugin->parameter("weight")->meaning, "own");
    EXPECT_TRUE(registry.find("lamp", "bare")->parameter_names().empty());
    EXPECT_TRUE(registry.find("chair", "stool")->parameter_names().empty());
    EXPECT_TRUE(registry.family("lamp")->shares("power"));
    EXPECT_FALSE(registry.family("lamp")->shares("colour"));
  }
}

TEST(Registry, KnowsWhichElementsAreObjects) {
  Registry registry;
  registry.add(lamps());
  EXPECT_EQ(registry.family_of_element("lamp", false), registry.family("lamp"));
  EXPECT_EQ(registry.family_of_element("light", true), registry.family("lamp"));
  EXPECT_EQ(registry.family_of_element("light", false), nullptr);
  EXPECT_EQ(registry.family_of_element("chair", true), nullptr);
}

TEST(Registry, RefusesNamesThatAreTaken) {
  Registry registry;
  registry.add(lamps());
  registry.add(bulb());
  EXPECT_THROW(registry.add(lamps()), std::logic_error);
  EXPECT_THROW(registry.add(bulb()), std::logic_error);
}

TEST(Registry, EveryPluginHasAFamilyAndEveryDefaultExists) {
  const Registry& registry = Registry::instance();
  for (const PluginInfo& plugin : registry.all())
    EXPECT_TRUE(registry.family(plugin.family)) << plugin.family << " " << plugin.name;
  for (const std::string& name : registry.families()) {
    EXPECT_FALSE(registry.names(name).empty()) << name;
    const std::string& fallback = registry.family(name)->fallback;
    EXPECT_TRUE(fallback.empty() || registry.find(name, fallback)) << name << " " << fallback;
  }
}

}  // namespace
}  // namespace aureole
