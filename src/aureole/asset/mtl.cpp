// SPDX-License-Identifier: Apache-2.0
#include "aureole/asset/mtl.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "aureole/plugin/registry.h"

namespace aureole {

namespace {

/// Returns the file name after the options of a map statement ("-s 2 2 1 -bm 0.1 name.png"). The name may
/// contain blanks.
std::filesystem::path map_file(Scanner& s, const std::filesystem::path& folder) {
  // The maximum number of arguments of each option, all numbers except for -imfchan, -clamp, ...
  static const std::map<std::string, int, std::less<>> kOptions = {
      {"-blendu", 1}, {"-blendv", 1}, {"-boost", 1}, {"-mm", 2},   {"-o", 3},       {"-s", 3}, {"-t", 3},
      {"-texres", 1}, {"-clamp", 1},  {"-bm", 1},    {"-type", 1}, {"-imfchan", 1}, {"-cc", 1}};
  s.skip_blanks();
  while (s.at < s.end && *s.at == '-') {
    const Scanner before = s;
    const auto option = kOptions.find(s.word());
    if (option == kOptions.end()) {
      s = before;
      break;
    }
    const bool numeric = option->second > 1 || option->first == "-bm" || option->first == "-boost";
    double number;
    for (int i = 0; i < option->second; ++i)
      if (!numeric)
        s.word();
      else if (!s.number(number))
        break;
    s.skip_blanks();
  }
  std::string name(s.at, s.end);
  while (!name.empty() && std::strchr(" \t\r\n", name.back())) name.pop_back();
  std::replace(name.begin(), name.end(), '\\', '/');
  return name.empty() ? std::filesystem::path() : folder / name;
}

/// Reads one or three numbers in [0, 1]; returns false if there are none.
bool color(Scanner& s, std::array<double, 3>& c) {
  double v[3];
  if (!s.number(v[0])) return false;
  if (!s.number(v[1]) || !s.number(v[2])) v[1] = v[2] = v[0];
  for (std::size_t i = 0; i < 3; ++i) {
    if (!std::isfinite(v[i])) return false;
    c[i] = std::clamp(v[i], 0.0, 1.0);
  }
  return true;
}

SpectrumLiteral rgb(const std::array<double, 3>& c) {
  SpectrumLiteral s;
  s.kind = SpectrumLiteral::Kind::rgb;
  std::copy(c.begin(), c.end(), s.rgb);
  return s;
}

/// Returns the picture as a texture, or null, with a note, if it cannot be read.
ObjectPtr picture(const Properties& owner, const std::string& material, const std::filesystem::path& file,
                  bool raw) {
  try {
    ObjectPtr texture = make_object(owner, "texture", "bitmap", {{"filename", file.string()}, {"raw", raw}});
    if (owner.context().scene) owner.context().scene->add_file(file);
    return texture;
  } catch (const Error& problem) {
    owner.note("filename", "material \"" + material + "\": " + problem.message());
    return nullptr;
  }
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
      m = &all[std::string(s.word())];
    } else if (!keyword.empty() && keyword[0] != '#') {
      if (!m) throw file.error_at(at, "expected newmtl");
      bool good = true;
      double v = 0;
      if (keyword == "Kd")
        good = color(s, m->diffuse);
      else if (keyword == "Ks")
        good = color(s, m->specular);
      else if (keyword == "Ns")
        good = s.number(m->exponent) && m->exponent >= 0 && std::isfinite(m->exponent);
      else if (keyword == "d" || keyword == "Tr") {
        // Some programs write one number for both d and Tr, though Tr = 1 - d. If both are given, d is used.
        good = s.number(v) && v >= 0 && v <= 1;
        if (good && (keyword == "d" || !m->has_d)) m->opacity = keyword == "d" ? v : 1 - v;
        m->has_d |= keyword == "d";
      } else if (keyword == "illum") {
        good = s.number(v);
        if (good) m->illumination = int(std::clamp(v, 0.0, 100.0));
      } else if (keyword == "map_Kd")
        m->diffuse_map = map_file(s, folder);
      else if (keyword == "map_d")
        m->opacity_map = map_file(s, folder);
      else if (keyword == "Ke") {
        std::array<double, 3> emission{};
        if (color(s, emission) && emission != std::array<double, 3>{})
          m->ignored += m->ignored.empty() ? "Ke" : ", Ke";
      } else if (keyword.starts_with("map_") || keyword == "bump" || keyword == "disp" || keyword == "norm" ||
                 keyword == "refl")
        m->ignored += (m->ignored.empty() ? "" : ", ") + keyword;
      // Ka, Ni, Tf, sharpness and similar statements have no counterpart.
      if (!good) throw file.error_at(at, "the value of " + keyword + " is not valid");
    }
    at = newline ? newline + 1 : file.end();
  }
  return all;
}

BsdfPtr bsdf_of_mtl(const std::string& name, const MtlMaterial& m, const Properties& owner) {
  const auto note = [&](const std::string& text) {
    owner.note("filename", "material \"" + name + "\": " + text);
  };
  if (!m.ignored.empty()) note(m.ignored + " ignored");
  Properties::Value diffuse = rgb(m.diffuse);
  if (!m.diffuse_map.empty())
    if (ObjectPtr texture = picture(owner, name, m.diffuse_map, false)) diffuse = std::move(texture);

  const bool shines =
      m.illumination >= 2 && m.exponent > 0 && *std::max_element(m.specular.begin(), m.specular.end()) > 0;
  ObjectPtr bsdf;
  try {
    if (shines) {
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
  bsdf = make_object(owner, "bsdf", "twosided", {{"", bsdf}});

  ObjectPtr opacity;
  if (!m.opacity_map.empty()) opacity = picture(owner, name, m.opacity_map, true);
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
