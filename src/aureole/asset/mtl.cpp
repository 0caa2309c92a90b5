// SPDX-License-Identifier: Apache-2.0
#include "aureole/asset/mtl.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "aureole/core/letter_case.h"
#include "aureole/plugin/registry.h"

namespace aureole {

namespace {

/// Returns the rest of a line as a path; some programs write backslashes in it.
std::string path_of(Scanner& s) {
  std::string name(s.rest());
  std::replace(name.begin(), name.end(), '\\', '/');
  return name;
}

void ignore(MtlMaterial& m, const std::string& what) { m.ignored += (m.ignored.empty() ? "" : ", ") + what; }

/// Reads the options and the file name of a map statement ("-s 2 2 1 -bm 0.1 name.png"). The name may contain
/// blanks.
MtlMap read_map(Scanner& s, const std::filesystem::path& folder, const std::string& keyword, MtlMaterial& m) {
  // The maximum number of arguments of each option, all numbers except for -imfchan, -clamp, ...
  static const std::map<std::string, int, std::less<>> kOptions = {
      {"-blendu", 1}, {"-blendv", 1},  {"-boost", 1},  {"-mm", 2},        {"-o", 3},
      {"-s", 3},      {"-t", 3},       {"-texres", 1}, {"-clamp", 1},     {"-bm", 1},
      {"-type", 1},   {"-imfchan", 1}, {"-cc", 1},     {"-colorspace", 1}};
  MtlMap map;
  s.skip_blanks();
  while (s.at < s.end && *s.at == '-') {
    const Scanner before = s;
    const std::string option(s.word());
    const auto found = kOptions.find(option);
    if (found == kOptions.end()) {
      s = before;
      break;
    }
    std::array<double, 3> v{};
    int count = 0;
    std::string word;
    if (found->second > 1 || option == "-bm" || option == "-boost") {
      while (count < found->second && s.number(v[std::size_t(count)])) ++count;
    } else {
      word = s.word();
    }
    const bool finite = std::isfinite(v[0]) && std::isfinite(v[1]);
    if (option == "-s" && count > 0 && finite)
      map.scale = {v[0], count > 1 ? v[1] : 1};
    else if (option == "-o" && count > 0 && finite)
      map.offset = {v[0], v[1]};
    else if (option == "-clamp")
      map.clamp = word == "on";
    else if (!option.starts_with("-blend") && option != "-texres" &&
             // these option values are defaults and change no picture
             !(option == "-colorspace" && word == "sRGB"))
      ignore(m, keyword + " " + option);
    s.skip_blanks();
  }
  const std::string name = path_of(s);
  if (!name.empty()) map.file = folder / name;
  return map;
}

/// Reads one or three numbers in [0, 1]; returns false if there are none. Other numbers are clamped to the
/// interval, with a note.
bool color(Scanner& s, std::array<double, 3>& c, const std::string& keyword, MtlMaterial& m) {
  double v[3];
  if (!s.number(v[0])) return false;
  if (!s.number(v[1]) || !s.number(v[2])) v[1] = v[2] = v[0];
  bool moved = false;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!std::isfinite(v[i])) return false;
    c[i] = std::clamp(v[i], 0.0, 1.0);
    moved |= std::abs(c[i] - v[i]) > 1e-6;
  }
  if (moved) m.notes.push_back(keyword + " is cut to [0, 1]");
  return true;
}

/// Reads a number in [0, 1]; another number is clamped, with a note.
bool unit(Scanner& s, double& value, const std::string& keyword, MtlMaterial& m) {
  double v;
  if (!s.number(v) || !std::isfinite(v)) return false;
  value = std::clamp(v, 0.0, 1.0);
  if (std::abs(value - v) > 1e-6) m.notes.push_back(keyword + " is cut to [0, 1]");
  return true;
}

SpectrumLiteral rgb(const std::array<double, 3>& c) {
  SpectrumLiteral s;
  s.kind = SpectrumLiteral::Kind::rgb;
  std::copy(c.begin(), c.end(), s.rgb);
  return s;
}

/// Returns the picture as a texture, or null, with a note, if it cannot be read.
ObjectPtr picture(const Properties& owner, const std::string& material, const MtlMap& map, bool raw) {
  try {
    std::vector<std::pair<std::string, Properties::Value>> parameters = {{"filename", map.file.string()},
                                                                         {"raw", raw}};
    if (map.clamp) parameters.emplace_back("wrap_mode", "clamp");
    if (map.scale != std::array{1.0, 1.0} || map.offset != std::array{0.0, 0.0}) {
      // In the file v points upwards, and a picture's first row is at v = 0: the mesh has already flipped v.
      const bool flipped = owner.get_bool("flip_tex_coords", true);
      const double v = flipped ? 1 - map.scale[1] - map.offset[1] : map.offset[1];
      parameters.emplace_back("to_uv", Transform::translate(map.offset[0], v, 0) *
                                           Transform::scale(map.scale[0], map.scale[1], 1));
    }
    ObjectPtr texture = make_object(owner, "texture", "bitmap", std::move(parameters));
    if (owner.context().scene) owner.context().scene->add_file(map.file);
    return texture;
  } catch (const Error& problem) {
    owner.note("filename", "material \"" + material + "\": " + problem.message());
    return nullptr;
  }
}

/// Reads one statement of a material; returns false if its value is not valid.
bool read_statement(const std::string& keyword, Scanner& s, const std::filesystem::path& folder,
                    MtlMaterial& m) {
  const std::string name = lower_case(keyword);
  double v = 0;
  if (name == "kd") return color(s, m.diffuse, keyword, m);
  if (name == "ks") return m.has_specular = color(s, m.specular, keyword, m);
  if (name == "ns") return s.number(m.exponent) && m.exponent >= 0 && std::isfinite(m.exponent);
  if (name == "ni") return s.number(m.index) && m.index >= 0 && std::isfinite(m.index);
  if (name == "d" || name == "tr") {
    if (Scanner after = s; after.word() == "-halo") s = after, ignore(m, "-halo of d");
    // Some programs write one number for both d and Tr, though Tr = 1 - d. If both are given, d is used.
    if (!s.number(v) || !(v >= -1e-6 && v <= 1 + 1e-6)) return false;
    v = std::clamp(v, 0.0, 1.0);
    if (name == "d" || !m.has_d) m.opacity = name == "d" ? v : 1 - v;
    m.has_d |= name == "d";
    return true;
  }
  if (name == "illum") {
    if (!s.number(v)) return false;
    m.illumination = int(std::clamp(v, 0.0, 100.0));
    return true;
  }
  if (name == "ke") {
    std::array<double, 3> emission{};
    MtlMaterial unused;
    if (color(s, emission, keyword, unused) && emission != std::array<double, 3>{})
      ignore(m, keyword + " (give the shape an emitter)");
    return true;
  }
  if (name == "tf") {
    std::array<double, 3> c{};
    if (!color(s, c, keyword, m)) return false;
    m.transmission = (c[0] + c[1] + c[2]) / 3;
    return true;
  }
  const struct {
    const char* name;
    double& value;
  } physical[] = {{"pr", m.roughness},
                  {"pm", m.metallic},
                  {"ps", m.sheen},
                  {"pc", m.clearcoat},
                  {"pcr", m.clearcoat_roughness},
                  {"aniso", m.anisotropy}};
  for (const auto& p : physical)
    if (name == p.name) return m.is_physical = unit(s, p.value, keyword, m);
  const struct {
    const char* name;
    MtlMap& map;
    bool is_physical;
  } maps[] = {{"map_kd", m.diffuse_map, false},  {"map_d", m.opacity_map, false},
              {"map_pr", m.roughness_map, true}, {"map_pm", m.metallic_map, true},
              {"map_ps", m.sheen_map, true},     {"map_pc", m.clearcoat_map, true}};
  for (const auto& p : maps)
    if (name == p.name) {
      p.map = read_map(s, folder, keyword, m);
      m.is_physical |= p.is_physical;
      return true;
    }
  if (name == "anisor" && s.number(v) && v == 0) return true;
  // The ambient colour and the sharpness of reflections are not noted, since no physical model has them.
  if (name != "ka" && name != "sharpness") ignore(m, keyword);
  return true;
}

}  // namespace

std::map<std::string, MtlMaterial> read_mtl(const MeshFile& file) {
  std::map<std::string, MtlMaterial> all;
  MtlMaterial* m = nullptr;
  const std::filesystem::path folder = file.path().parent_path();
  for (const char* at = file.begin(); at < file.end();) {
    const char* newline = static_cast<const char*>(std::memchr(at, '\n', std::size_t(file.end() - at)));
    Scanner s{at, newline ? newline : file.end()};
    const std::string keyword(s.word().substr(0, 32));
    if (keyword == "newmtl") {
      m = &all[std::string(s.rest())];
    } else if (!keyword.empty() && keyword[0] != '#') {
      if (!m) throw file.error_at(at, "expected newmtl");
      if (!read_statement(keyword, s, folder, *m))
        throw file.error_at(at, "the value of " + keyword + " is not valid");
    }
    at = newline ? newline + 1 : file.end();
  }
  return all;
}

namespace {

/// Returns a material of the extension for physically based shading as `principled`; null, with a note, if
/// that is impossible.
ObjectPtr principled_of(const std::string& name, const MtlMaterial& m, const Properties& owner,
                        const Properties::Value& base_color) {
  const auto number = [&](const MtlMap& map, double value) -> Properties::Value {
    if (!map.file.empty())
      if (ObjectPtr texture = picture(owner, name, map, true)) return texture;
    return value;
  };
  std::vector<std::pair<std::string, Properties::Value>> parameters = {
      {"base_color", base_color},
      {"roughness", number(m.roughness_map, m.roughness)},
      {"metallic", number(m.metallic_map, m.metallic)},
      {"sheen", number(m.sheen_map, m.sheen)},
      {"clearcoat", number(m.clearcoat_map, m.clearcoat)},
      {"clearcoat_gloss", 1 - m.clearcoat_roughness},
      {"anisotropic", m.anisotropy}};
  if (m.transmission > 0) parameters.emplace_back("spec_trans", m.transmission);
  if (m.index > 1)
    parameters.emplace_back("eta", m.index);
  else if (m.has_specular)
    parameters.emplace_back("specular", *std::max_element(m.specular.begin(), m.specular.end()));
  try {
    return make_object(owner, "bsdf", "principled", std::move(parameters));
  } catch (const Error& problem) {
    owner.note("filename",
               "material \"" + name + "\": Pr, Pm, Ps, Pc and aniso are left out: " + problem.message());
    return nullptr;
  }
}

}  // namespace

BsdfPtr bsdf_of_mtl(const std::string& name, const MtlMaterial& m, const Properties& owner) {
  const auto note = [&](const std::string& text) {
    owner.note("filename", "material \"" + name + "\": " + text);
  };
  if (!m.ignored.empty()) note(m.ignored + " ignored");
  for (const std::string& text : m.notes) note(text);
  if (!m.is_physical &&
      (m.illumination == 4 || m.illumination == 6 || m.illumination == 7 || m.illumination == 9))
    note("the glass of illum " + std::to_string(m.illumination) +
         " is left out: a BSDF of the scene with the material's name as id replaces it");
  Properties::Value diffuse = rgb(m.diffuse);
  if (!m.diffuse_map.file.empty())
    if (ObjectPtr texture = picture(owner, name, m.diffuse_map, false)) diffuse = std::move(texture);

  const bool shines =
      m.illumination >= 2 && m.exponent > 0 && *std::max_element(m.specular.begin(), m.specular.end()) > 0;
  ObjectPtr bsdf = m.is_physical ? principled_of(name, m, owner, diffuse) : nullptr;
  const bool transmits = bsdf && m.transmission > 0;
  try {
    if (shines && !bsdf) {
      bsdf = make_object(owner, "bsdf", "phong",
                         {{"diffuse_reflectance", diffuse},
                          {"specular_reflectance", rgb(m.specular)},
                          {"exponent", m.exponent}});
      // With this roughness, Beckmann's distribution approximates cos^n best.
      if (!bsdf)
        bsdf = make_object(
            owner, "bsdf", "roughplastic",
            {{"diffuse_reflectance", diffuse}, {"alpha", std::min(1.0, std::sqrt(2 / (m.exponent + 2)))}});
      if (!bsdf) note("the highlights (Ks, Ns) are left out");
    }
  } catch (const Error& problem) {
    note("the highlights (Ks, Ns) are left out: " + problem.message());
  }
  try {
    if (!bsdf) bsdf = make_object(owner, "bsdf", "diffuse", {{"reflectance", diffuse}});
  } catch (const Error& problem) {
    note(problem.message() + "; Kd is used instead of the picture");
    bsdf = make_object(owner, "bsdf", "diffuse", {{"reflectance", rgb(m.diffuse)}});
  }
  // The file format does not define the front side.
  if (!transmits) bsdf = make_object(owner, "bsdf", "twosided", {{"", bsdf}});

  ObjectPtr opacity;
  if (!m.opacity_map.file.empty()) opacity = picture(owner, name, m.opacity_map, true);
  if (opacity || m.opacity < 1) {
    ObjectPtr masked = make_object(
        owner, "bsdf", "mask",
        {{"opacity", opacity ? Properties::Value(opacity) : Properties::Value(m.opacity)}, {"", bsdf}});
    if (masked)
      bsdf = std::move(masked);
    else
      note("the opacity (d, Tr) is left out");
  }
  return std::dynamic_pointer_cast<const Bsdf>(bsdf);
}

}  // namespace aureole
