// SPDX-License-Identifier: Apache-2.0
#include "fuzz/wrap.h"

#include <algorithm>
#include <filesystem>
#include <sstream>

namespace aureole::fuzz {

namespace {

constexpr const char* kFilm = R"(<film type="hdrfilm"><integer name="width" value="6"/>
<integer name="height" value="5"/><rfilter type="box"/></film>)";
constexpr const char* kOnePixel = R"(<film type="hdrfilm"><integer name="width" value="1"/>
<integer name="height" value="1"/><rfilter type="box"/></film>)";
constexpr const char* kSampler =
    R"(<sampler type="sobol"><integer name="sample_count" value="2"/></sampler>)";
constexpr const char* kView =
    R"(<transform name="to_world"><lookat origin="0, -5, 2" target="0, 0, 0.5" up="0, 0, 1"/></transform>)";
constexpr const char* kIntegrator =
    R"(<integrator type="path"><integer name="max_depth" value="6"/></integrator>)";
constexpr const char* kLight = R"(<emitter type="constant"/>)";
constexpr const char* kFloor =
    R"(<shape type="rectangle"><transform name="to_world"><scale value="4"/></transform></shape>)";

std::string sensor(const std::string& film = kFilm, const std::string& sampler = kSampler) {
  return std::string(R"(<sensor type="perspective"><float name="fov" value="40"/>)") + kView + film +
         sampler + "</sensor>\n";
}
std::string scene(const std::string& content) {
  return "<scene version=\"3.0.0\">\n" + content + "\n</scene>\n";
}
std::string usual(const std::string& content) { return scene(kIntegrator + sensor() + kFloor + content); }
std::string ball(const std::string& children) {
  return R"(<shape type="sphere"><point name="center" x="0" y="0" z="1"/>)" + children + "</shape>\n";
}

std::string plate(const std::string& children) {
  return R"(<shape type="rectangle"><transform name="to_world"><translate z="1"/></transform>)" + children +
         "</shape>\n";
}

/// The element with another name attribute, or with one more child.
std::string changed(const std::string& xml, const char* name, const std::string& child = "") {
  pugi::xml_document document;
  if (!document.load_string(xml.c_str())) return xml;
  pugi::xml_node root = document.document_element();
  if (name) {
    root.remove_attribute("name");
    root.append_attribute("name") = name;
  }
  if (!child.empty()) root.append_buffer(child.data(), child.size());
  std::ostringstream out;
  document.save(out, " ", pugi::format_default | pugi::format_no_declaration);
  return out.str();
}

}  // namespace

std::string with_data_files(const std::string& example,
                            const std::vector<std::pair<std::string, Bytes>>& data, Files& used) {
  pugi::xml_document document;
  if (!document.load_string(example.c_str())) return example;
  for (const pugi::xpath_node found : document.select_nodes("//string/@value | //spectrum/@filename")) {
    const pugi::xml_node parameter = found.parent();
    const PluginInfo* plugin = plugin_of(parameter.parent());
    const bool names_file = std::string_view(found.attribute().name()) == "filename" ||
                            (plugin && plugin->names_file(parameter.attribute("name").value()));
    if (!names_file) continue;
    const std::string wanted = found.attribute().value(),
                      ending = std::filesystem::path(wanted).extension().string();
    auto file = std::find_if(data.begin(), data.end(), [&](const auto& f) { return f.first == wanted; });
    if (file == data.end())
      file = std::find_if(data.begin(), data.end(), [&](const auto& f) { return f.first.ends_with(ending); });
    if (file == data.end()) continue;
    found.attribute().set_value(file->first.c_str());
    used[file->first] = file->second;
  }
  std::ostringstream out;
  document.save(out, " ", pugi::format_default | pugi::format_no_declaration);
  return out.str();
}

const PluginInfo* plugin_of(pugi::xml_node node) {
  const FamilyInfo* family = Registry::instance().family_of_element(node.name(), true);
  return family ? Registry::instance().find(family->name, node.attribute("type").value()) : nullptr;
}

std::vector<std::string> wrap_example(const PluginInfo& plugin, const std::string& example) {
  const std::string& family = plugin.family;
  if (family == "bsdf") return {usual(kLight + ball(example))};
  if (family == "texture")
    return {usual(kLight + ball("<bsdf type=\"diffuse\">" + changed(example, "reflectance") + "</bsdf>")),
            usual(ball("<emitter type=\"area\">" + changed(example, "radiance") + "</emitter>"))};
  if (plugin.name == "lightfielddisplay") return {usual(plate(example))};  // which must be flat
  if (family == "emitter") return {usual(plugin.doc.needs_shape ? ball(example) : ball("") + example)};
  if (family == "modulation")
    return {usual(R"(<emitter type="point"><point name="position" x="0" y="3" z="0"/>)" + example +
                  "</emitter>" + ball(""))};
  if (family == "shape") return {usual(kLight + example)};
  if (family == "integrator") return {scene(example + sensor() + kFloor + ball("") + kLight)};
  if (family == "film") return {scene(kIntegrator + sensor(example) + kFloor + kLight)};
  if (family == "sampler") return {scene(kIntegrator + sensor(kFilm, example) + kFloor + kLight)};
  if (family == "rfilter")
    return {scene(
        kIntegrator +
        sensor(R"(<film type="hdrfilm"><integer name="width" value="6"/><integer name="height" value="5"/>)" +
               example + "</film>") +
        kFloor + kLight)};
  if (family == "sensor") {
    const bool has_film = example.find("<film") != std::string::npos;
    const std::string objects = kFloor + ball("") + kLight;
    if (plugin.doc.needs_shape) return {scene(kIntegrator + std::string(kFloor) + kLight + ball(example))};
    std::vector<std::string> scenes = {
        scene(kIntegrator + changed(example, nullptr, has_film ? "" : kFilm) + objects)};
    if (!has_film) scenes.push_back(scene(kIntegrator + changed(example, nullptr, kOnePixel) + objects));
    return scenes;
  }
  if (family == "aperture" || family == "correlation") {
    // The radius is that of a circle where there is no aperture.
    const char* radius = family == "aperture" ? "" : R"(<string name="radius" value="5um"/>)";
    return {usual(kLight + ball(std::string(R"(<bsdf type="correlated_scatterers">)") + radius +
                                R"(<float name="area_fraction" value="0.4"/>)" + example + "</bsdf>"))};
  }
  if (family == "medium")
    return {usual(kLight + ball("<bsdf type=\"dielectric\"/>" + changed(example, "interior")))};
  if (family == "bssrdf") return {usual(kLight + ball(example))};
  if (family == "ingredient")
    return {usual(kLight + ball("<bsdf type=\"dielectric\"/><medium type=\"suspension\" name=\"interior\">" +
                                example + "</medium>"))};
  if (family == "volume") {
    const auto as = [&](const char* parameter) {
      return usual(kLight + ball(R"(<bsdf type="null"/><medium type="heterogeneous" name="interior">)" +
                                 changed(example, parameter) + "</medium>"));
    };
    return {as("sigma_t"), as("albedo"), as("emission"), as("temperature")};
  }
  return {usual(kLight + example)};
}

std::string wrap_image(const std::string& file) {
  const std::string name = R"(<string name="filename" value=")" + file + "\"/>";
  return usual(R"(<emitter type="envmap">)" + name + "</emitter>\n" +
               ball(R"(<emitter type="area"><texture type="bitmap" name="radiance">)" + name +
                    R"(<boolean name="raw" value="false"/></texture></emitter>)"));
}

std::string wrap_volume(const std::string& file) {
  const std::string parameters = file.starts_with("named")    ? R"(<string name="array" value="two"/>)"
                                 : file.starts_with("series") ? R"(<boolean name="series" value="true"/>)"
                                                              : "";
  return usual(kLight + ball(R"(<bsdf type="null"/><medium type="heterogeneous" name="interior">
<volume type="gridvolume" name="sigma_t"><string name="filename" value=")" +
                             file + "\"/>" + parameters + "</volume></medium>"));
}

std::vector<std::string> wrap_splats(const std::string& file) {
  const bool is_grid = file.ends_with(".npz") || file.ends_with(".vdb");
  const std::string medium =
      ball(R"(<bsdf type="null"/><medium type=")" + std::string(is_grid ? "radiance_grid" : "splats") +
           R"(" name="interior"><string name="filename" value=")" + file + "\"/></medium>");
  return {usual(kLight + medium),
          scene(R"(<integrator type=")" + std::string(is_grid ? "radiance_field" : "splat") + "\"/>" +
                sensor() + kFloor + kLight + medium)};
}

}  // namespace aureole::fuzz
