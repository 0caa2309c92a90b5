// SPDX-License-Identifier: Apache-2.0
#include "aureole/medium/classified/classification.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

#include "aureole/core/parallel.h"
#include "aureole/plugin/properties.h"
#include "aureole/plugin/registry.h"

namespace aureole {

namespace {

/// Parameters that may differ among the classes of a mask. Those of one group replace each other: a class that has one of
/// them takes none of the group from the text without labels.
struct LabelledParameter {
  const char* name;
  int group;
};
constexpr int kOpacities = 0, kColors = 1, kGradients = 2;
constexpr LabelledParameter kLabelled[] = {
    {"opacity", kOpacities}, {"extinction", kOpacities}, {"preset", kOpacities},
    {"boxes", kOpacities},   {"triangles", kOpacities},  {"colors", kColors},
    {"color_map", kColors},  {"range", kColors},         {"gradient_opacity", kGradients}};
constexpr std::size_t kLabelledCount = std::size(kLabelled);
/// Parameters that hold for all classes. `table` is the function of classes without one of their own.
constexpr const char* kCommon[] = {"opacity_unit_length", "color_encoding", "table", "table_values",
                                   "table_gradients"};

std::string_view without_blanks(std::string_view text) {
  constexpr const char* kBlanks = " \t\r\n";
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

/// A part of a parameter's text: "1, 4-6: TEXT", or TEXT alone for labels that no other part names.
struct LabelledText {
  std::vector<std::array<int, 2>> labels;  ///< first and last label of each interval
  std::string text;

  bool names(int label) const {
    return std::any_of(labels.begin(), labels.end(),
                       [&](const auto& l) { return label >= l[0] && label <= l[1]; });
  }
};

std::array<int, 2> parse_labels(const Properties& p, const char* name, std::string_view text) {
  const auto number = [&](std::string_view digits) {
    digits = without_blanks(digits);
    int label = -1;
    const auto [end, problem] = std::from_chars(digits.data(), digits.data() + digits.size(), label);
    if (problem != std::errc() || end != digits.data() + digits.size() || label < 0 ||
        label > LabelField::kMaxLabel)
      throw p.error(
          name,
          fmt::format("\"{}\" is no label; before a colon stand whole numbers from 0 to {} or intervals, "
                      "such as \"1, 4-6: 0 0, 100 0.3\"",
                      digits, LabelField::kMaxLabel));
    return label;
  };
  const std::size_t dash = text.find('-');
  if (dash == text.npos) return {number(text), number(text)};
  const std::array<int, 2> labels{number(text.substr(0, dash)), number(text.substr(dash + 1))};
  if (labels[0] > labels[1])
    throw p.error(name, fmt::format("the labels {}-{} do not ascend", labels[0], labels[1]));
  return labels;
}

/// Splits "LABELS: TEXT; LABELS: TEXT; TEXT". Throws located Errors.
std::vector<LabelledText> parse_parts(const Properties& p, const char* name) {
  std::vector<LabelledText> parts;
  const std::string all = p.get_string(name);
  for (std::string_view left = all; !left.empty();) {
    const std::size_t end = std::min(left.find(';'), left.size());
    std::string_view part = left.substr(0, end);
    left.remove_prefix(std::min(end + 1, left.size()));
    if (without_blanks(part).empty()) continue;
    LabelledText& labelled = parts.emplace_back();
    if (const std::size_t colon = part.find(':'); colon != part.npos) {
      for (std::string_view labels = part.substr(0, colon);;) {
        const std::size_t comma = std::min(labels.find(','), labels.size());
        labelled.labels.push_back(parse_labels(p, name, labels.substr(0, comma)));
        if (comma == labels.size()) break;
        labels.remove_prefix(comma + 1);
      }
      part.remove_prefix(colon + 1);
    }
    labelled.text = without_blanks(part);
    for (std::size_t i = 0; i + 1 < parts.size(); ++i) {
      const bool both_hold_for_all = labelled.labels.empty() && parts[i].labels.empty();
      if (both_hold_for_all) throw p.error(name, "two parts have no labels before a colon");
      for (const auto& l : labelled.labels)
        for (const auto& other : parts[i].labels)
          if (l[0] <= other[1] && other[0] <= l[1])
            throw p.error(name, fmt::format("the label {} stands twice", std::max(l[0], other[0])));
    }
  }
  return parts;
}

std::string listed(const std::vector<std::string>& words) {
  constexpr std::size_t kMaxShown = 8;
  std::string text;
  for (std::size_t i = 0; i < std::min(words.size(), kMaxShown); ++i) text += (i ? ", " : "") + words[i];
  if (words.size() > kMaxShown) text += fmt::format(" and {} more", words.size() - kMaxShown);
  return text;
}

/// Reads pairs of gradient and factor as a transfer function whose extinction is the factor.
std::optional<TransferFunction> read_gradient_factor(const Properties& p) {
  if (!p.has("gradient_opacity")) return {};
  const TransferFunction::Curve curve =
      TransferFunction::read_curve(p, "gradient_opacity", 1, 1, "0 0, 50 1");
  if (curve.values.front() < 0)
    throw p.error("gradient_opacity",
                  fmt::format("the gradient {:g} is negative, but a length is not", curve.values.front()));
  return TransferFunction(curve, {{0}, {{0, 0, 0}}});
}

}  // namespace

Classification::Class Classification::read_class(const Properties& p) {
  Class c;
  if (TransferPlane::is_given(p)) {
    c.plane = TransferPlane::read(p);
    return c;
  }
  for (const char* name : {"table_values", "table_gradients"})
    if (p.has(name)) throw p.error(name, "is for a \"table\", which is missing");
  c.function = TransferFunction::read(p);
  c.gradient_factor = read_gradient_factor(p);
  c.gives_extinction = p.has("extinction");
  return c;
}

Classification::Classification(const Properties& p, const ScalarField& field)
    : field_(field), unit_(float(opacity_unit_length(p))) {
  if (p.has("color_encoding") && !p.has("colors") && !TransferPlane::is_given(p))
    throw p.error(
        "color_encoding",
        "has no effect: it is for \"colors\", \"boxes\" and \"triangles\"; colour maps and presets say "
        "how their colours are encoded");
  if (p.has("extinction")) parameter_ = "extinction";
  for (const char* name : {"boxes", "triangles", "table"})
    if (p.has(name)) parameter_ = plane_parameter_ = name;
  if (p.has("mask")) {
    read_classes(p);
    return;
  }
  for (const LabelledParameter& parameter : kLabelled)
    if (const Properties::Entry* e = p.has(parameter.name) ? p.find(parameter.name) : nullptr)
      if (const auto* text = std::get_if<std::string>(&e->value); text && text->find(':') != text->npos)
        throw p.error(parameter.name,
                      "labels before a colon need a <volume name=\"mask\">, which is missing");
  classes_.push_back(read_class(p));
}

void Classification::read_classes(const Properties& p) {
  std::vector<LabelledText> parts[kLabelledCount];
  for (std::size_t k = 0; k < kLabelledCount; ++k)
    if (p.has(kLabelled[k].name)) parts[k] = parse_parts(p, kLabelled[k].name);
  /// For each parameter, the index of the labelled part that holds for a class; -1: none.
  using Choice = std::array<int, kLabelledCount>;
  // Returns the class of a label; -1 stands for labels that no part names.
  const auto chosen = [&](int label) {
    Choice choice;
    bool is_named[3] = {false, false, false};
    for (std::size_t k = 0; k < kLabelledCount; ++k) {
      choice[k] = -1;
      for (std::size_t i = 0; i < parts[k].size(); ++i)
        if (parts[k][i].names(label)) choice[k] = int(i), is_named[kLabelled[k].group] = true;
    }
    const auto plane_is_named = [&] {
      for (std::size_t k = 0; k < kLabelledCount; ++k)
        if (choice[k] >= 0 && (kLabelled[k].name == std::string_view("boxes") ||
                               kLabelled[k].name == std::string_view("triangles")))
          return true;
      return false;
    };
    // A function of value and gradient includes its colours.
    if (plane_is_named()) is_named[kColors] = is_named[kGradients] = true;
    for (std::size_t k = 0; k < kLabelledCount; ++k)
      for (std::size_t i = 0; i < parts[k].size() && !is_named[kLabelled[k].group]; ++i)
        if (parts[k][i].labels.empty()) choice[k] = int(i);
    return choice;
  };
  std::map<Choice, std::uint8_t> class_of_choice;
  const auto class_of = [&](const Choice& choice, const std::string& label) {
    if (const auto known = class_of_choice.find(choice); known != class_of_choice.end()) return known->second;
    bool has_opacities = false, has_own = false;
    for (std::size_t k = 0; k < kLabelledCount; ++k)
      if (choice[k] >= 0 && kLabelled[k].group == kOpacities)
        has_opacities = true, has_own |= !parts[k][std::size_t(choice[k])].labels.empty();
    if (!has_opacities && !p.has("table")) {
      // A class with colours alone has no transfer function.
      class_of_choice[choice] = kTransparent;
      return kTransparent;
    }
    if (classes_.size() >= kTransparent)
      throw p.error("mask",
                    fmt::format("at most {} different transfer functions are possible", int(kTransparent)));
    Properties part(p.type(), p.id(), p.where(), p.shared_context(), p.plugin());
    for (const Properties::Entry& e : p.entries()) {
      for (const char* name : kCommon)
        if (e.name == name && !(has_own && std::string_view(name).starts_with("table")))
          part.add(e.name, e.value, e.where);
      for (std::size_t k = 0; k < kLabelledCount; ++k)
        if (e.name == kLabelled[k].name && choice[k] >= 0)
          part.add(e.name, parts[k][std::size_t(choice[k])].text, e.where);
    }
    try {
      classes_.push_back(read_class(part));
    } catch (const Error& problem) {
      throw Error(problem.where(), problem.message() + " (of " + label + ")");
    }
    p.take_reads(part);
    return class_of_choice[choice] = std::uint8_t(classes_.size() - 1);
  };
  std::vector<bool> is_named(std::size_t(LabelField::kMaxLabel) + 1);
  for (const auto& texts : parts)
    for (const LabelledText& text : texts)
      for (const auto& l : text.labels)
        for (int label = l[0]; label <= l[1]; ++label) is_named[std::size_t(label)] = true;
  const bool names_any = std::find(is_named.begin(), is_named.end(), true) != is_named.end();
  const std::uint8_t other = class_of(chosen(-1), "labels that are not named");
  std::vector<std::uint8_t> class_of_label(is_named.size(), other);
  for (std::size_t label = 0; label < is_named.size(); ++label)
    if (is_named[label]) class_of_label[label] = class_of(chosen(int(label)), fmt::format("label {}", label));
  if (classes_.empty())
    throw p.error("opacity", "is missing: give each label a function, such as \"1: 0 0, 100 0.3; 2: 0 0.5\"");
  labels_.emplace(p, "mask", class_of_label);
  if (!names_any) p.note("mask", "has no effect: no parameter names a label, as \"1: 0 0, 100 0.3\" does");
  std::vector<std::string> transparent, absent;
  for (std::size_t label = 0; label < is_named.size(); ++label) {
    const std::size_t count = labels_->counts()[label];
    if (count > 0 && class_of_label[label] == kTransparent)
      transparent.push_back(fmt::format("{} ({} {})", label, count, count == 1 ? "voxel" : "voxels"));
    if (count == 0 && is_named[label]) absent.push_back(fmt::format("{}", label));
  }
  if (!transparent.empty())
    p.note("mask", "labels without a function are transparent: " + listed(transparent));
  if (!absent.empty()) p.note("mask", "no voxel has the labels of these functions: " + listed(absent));
  for (const char* name : kCommon)
    if (p.has(name)) p.find(name);
}

Classification::Sample Classification::at_plane(const Class& c, const Vec3& p, float value) const {
  if (!(c.plane->max_extinction(value, value) > 0)) return {};
  return c.plane->at(value, length(field_.gradient(p)));
}

void Classification::weigh(const Class& c, const Vec3& p, Sample& s) const {
  const float factor = c.gradient_factor->at(length(field_.gradient(p))).extinction;
  if (factor >= 1) return;
  if (c.gives_extinction)
    s.extinction *= factor;
  else  // Factor of the opacity of a layer of unit thickness.
    s.extinction = std::min(s.extinction, -std::log1p(factor * std::expm1(-s.extinction * unit_)) / unit_);
}

float Classification::max_extinction(float low, float high) const {
  float most = 0;
  for (const Class& c : classes_) most = std::max(most, c.max_extinction(low, high));
  return most;
}

std::vector<float> Classification::bounds(const std::array<int, 3>& cells) const {
  const auto ranges = field_.ranges(cells);
  std::vector<float> bounds(ranges.size());
  const Transform from_box = field_.to_box().inverse();
  const std::size_t row = std::size_t(cells[0]), rows = std::size_t(cells[1]);
  for_ranges(
      rows * std::size_t(cells[2]),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t r = begin; r < end; ++r)
          for (std::size_t x = 0; x < row; ++x) {
            const std::size_t i = r * row + x;
            if (!labels_) {
              bounds[i] = classes_[0].max_extinction(ranges[i][0], ranges[i][1]);
              continue;
            }
            const auto corner = [&](int far) {
              return Vec3{float(int(x) + far) / float(cells[0]), float(int(r % rows) + far) / float(cells[1]),
                          float(int(r / rows) + far) / float(cells[2])};
            };
            const LabelField::Classes found = labels_->classes_in(from_box, corner(0), corner(1));
            for (std::size_t c = 0; c < classes_.size(); ++c)
              if (found[c])
                bounds[i] = std::max(bounds[i], classes_[c].max_extinction(ranges[i][0], ranges[i][1]));
          }
      },
      16);
  return bounds;
}

std::vector<ParameterDoc> Classification::rows() {
  std::vector<ParameterDoc> all = TransferFunction::rows();
  const std::vector<ParameterDoc> plane = TransferPlane::rows();
  all.insert(all.end(), plane.begin(), plane.end());
  const std::vector<ParameterDoc> rest = {
      {"gradient_opacity", "string", "1/length", "none",
       "a factor of the opacity, or of the given extinction: lengths of the gradient of the numbers and the factor at each"},
      {"mask", "volume", "", "none",
       "labels, whole numbers from 0 to 65535, on a grid of their own, without interpolation; outside of it the label is 0. With a "
       "mask, opacity, extinction, preset, boxes, triangles, colors, color_map, range and gradient_opacity may have several parts, "
       "\"1: TEXT; 2, 5-7: TEXT; TEXT\", for the labels before the colon, and without one for all others. Labels without a "
       "function are transparent, which a note counts"}};
  all.insert(all.end(), rest.begin(), rest.end());
  return all;
}

}  // namespace aureole
