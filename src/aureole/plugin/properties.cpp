// SPDX-License-Identifier: Apache-2.0
#include "aureole/plugin/properties.h"

#include <algorithm>

#include "aureole/core/input_file.h"
#include "aureole/core/units.h"
#include "aureole/plugin/late_notes.h"
#include "aureole/plugin/registry.h"
#include "aureole/spectrum/value_limit.h"

namespace aureole {

namespace {

std::string describe(const Properties::Value& v) {
  switch (v.index()) {
    case 0:
      return "a boolean";
    case 1:
      return "an integer";
    case 2:
      return "a float";
    case 3:
      return "a string";
    case 4:
      return "a vector";
    case 5:
      return "a transform";
    case 6:
      return "a spectrum";
    case 7:
      return "an object";
    default:
      return "an animation";
  }
}

template <class T, class U>
void add_once(std::vector<T>& values, const U& value) {
  if (std::find(values.begin(), values.end(), value) != values.end()) return;
  if (values.empty()) values.reserve(8);
  values.emplace_back(value);
}

}  // namespace

Object::Object(const Properties& properties) : properties_(properties.weak_from_this().lock()) {
  if (!properties_) properties_ = std::make_shared<Properties>(properties);
}
Object::~Object() = default;
const std::string& Object::id() const { return properties_->id(); }

Properties::Properties(std::string type, std::string id, SourceLocation where,
                       std::shared_ptr<const BuildContext> context, const PluginInfo* plugin)
    : type_(std::move(type)),
      id_(std::move(id)),
      where_(std::move(where)),
      context_(context ? std::move(context) : std::make_shared<const BuildContext>()),
      plugin_(plugin),
      most_expected_(std::make_shared<std::vector<std::pair<std::string, double>>>()) {}

void Properties::add(std::string name, Value value, SourceLocation where) {
  if (!name.empty() && has(name)) throw Error(where, "parameter \"" + name + "\" is given twice");
  entries_.push_back({std::move(name), std::move(value), std::move(where)});
}

bool Properties::has(std::string_view name) const {
  return std::any_of(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.name == name; });
}

void Properties::require_documented(std::string_view name) const {
  if (!plugin_) return add_once(queried_without_plugin_, name);
  const ParameterDoc* row = plugin_->parameter(name);
  if (!row)
    throw std::logic_error("plug-in \"" + plugin_->name + "\" reads the undocumented parameter \"" +
                           std::string(name) + "\"");
  add_once(queried_, row);
}

std::vector<std::string> Properties::queried() const {
  std::vector<std::string> names = queried_without_plugin_;
  for (const ParameterDoc* row : queried_) names.push_back(row->name);
  return names;
}

const Properties::Entry* Properties::find(std::string_view name) const {
  require_documented(name);
  for (const Entry& e : entries_)
    if (e.name == name) return e.used = true, &e;
  return nullptr;
}

Error Properties::error(std::string_view name, const std::string& message) const {
  for (const Entry& e : entries_)
    if (e.name == name)
      return Error(e.where, "parameter \"" + std::string(name) + "\" of \"" + type_ + "\": " + message);
  if (message.starts_with("is missing"))  // a parameter that stands nowhere is named
    return Error(where_, "parameter \"" + std::string(name) + "\" of \"" + type_ + "\": " + message);
  return Error(where_, "\"" + type_ + "\": " + message);
}

Error Properties::wrong_type(const Entry& e, std::string_view expected) const {
  return error(e.name, "expected " + std::string(expected) + ", got " + describe(e.value));
}

double Properties::checked(const Entry& e, double v, Range r) const {
  const bool low = r.open_min ? !(v > r.min) : !(v >= r.min);
  if (!std::isfinite(v)) throw error(e.name, "must be a finite number");
  if (NoiseClamp clamp(r.open_min ? -std::numeric_limits<double>::infinity() : r.min, r.max);
      low || v > r.max)
    if (const double moved = clamp(v); clamp.any()) {
      note(e.name, "parameter \"" + e.name + "\": " + clamp.note());
      return moved;
    }
  if (low || v > r.max) {
    std::string bound = std::isfinite(r.max) ? "in " + std::string(r.open_min ? "(" : "[") +
                                                   shown_number(r.min) + ", " + shown_number(r.max) + "]"
                                             : (r.open_min ? "> " : ">= ") + shown_number(r.min);
    if (!std::isfinite(r.min)) bound = "<= " + shown_number(r.max);
    throw error(e.name, "must be " + bound + ", got " + shown_number(v));
  }
  return v;
}

bool Properties::get_bool(std::string_view name, bool fallback) const {
  const Entry* e = find(name);
  if (!e) return fallback;
  return tolerate(fallback, [&] {
    if (const bool* b = std::get_if<bool>(&e->value)) return *b;
    throw wrong_type(*e, "a boolean");
  });
}

std::int64_t Properties::get_int(std::string_view name, std::int64_t fallback, Range range) const {
  const Entry* e = find(name);
  if (!e) return fallback;
  return tolerate(fallback, [&] {
    if (const auto* i = std::get_if<std::int64_t>(&e->value)) return checked(*e, double(*i), range), *i;
    if (const auto* d = std::get_if<double>(&e->value); d && *d == std::floor(*d) && std::abs(*d) < 9e15)
      return checked(*e, *d, range), std::int64_t(*d);
    throw wrong_type(*e, "an integer");
  });
}

double Properties::get_float(std::string_view name, double fallback, Range range) const {
  if (!has(name)) return require_documented(name), fallback;
  return tolerate(fallback, [&] { return get_float(name, range); });
}

double Properties::get_float(std::string_view name, Range range) const {
  const Entry* e = find(name);
  if (!e) throw Error(where_, "\"" + type_ + "\" needs the parameter \"" + std::string(name) + "\"");
  if (const auto* d = std::get_if<double>(&e->value)) return checked(*e, *d, range);
  if (const auto* i = std::get_if<std::int64_t>(&e->value)) return checked(*e, double(*i), range);
  throw wrong_type(*e, "a float");
}

std::string Properties::get_string(std::string_view name, const std::string& fallback) const {
  const Entry* e = find(name);
  if (!e) return fallback;
  return tolerate(fallback, [&] {
    if (const auto* s = std::get_if<std::string>(&e->value)) return *s;
    throw wrong_type(*e, "a string");
  });
}

std::string Properties::get_string(std::string_view name) const {
  if (!has(name)) {
    require_documented(name);
    throw Error(where_, "\"" + type_ + "\" needs the parameter \"" + std::string(name) + "\"");
  }
  return get_string(name, "");
}

std::string Properties::get_choice(std::string_view name, const std::string& fallback,
                                   const std::vector<std::string>& allowed) const {
  const std::string s = get_string(name, fallback);
  if (std::find(allowed.begin(), allowed.end(), s) != allowed.end()) return s;
  std::string list;
  for (const auto& a : allowed) list += (list.empty() ? "" : ", ") + a;
  return tolerate(fallback, [&]() -> std::string {
    throw error(name, "\"" + s + "\" is not one of " + list + did_you_mean(s, allowed));
  });
}

Vec3 Properties::get_vec3(std::string_view name, const Vec3& fallback) const {
  const Entry* e = find(name);
  if (!e) return fallback;
  return tolerate(fallback, [&] {
    const Vec3* v = std::get_if<Vec3>(&e->value);
    if (!v) throw wrong_type(*e, "a point or vector");
    if (!is_finite(*v)) throw error(name, "must be finite");
    return *v;
  });
}

Transform Properties::get_transform(std::string_view name) const {
  const Entry* e = find(name);
  if (!e) return {};
  return tolerate(Transform(), [&] {
    const Transform* t = transform_of(e->value);
    if (!t && motion_of(e->value))
      throw error(name, "\"" + type_ + "\" cannot move: give a <transform> instead of an <animation>");
    if (!t) throw wrong_type(*e, "a transform");
    if (t->is_singular()) throw error(name, "the transform is singular (it cannot be inverted)");
    if (!t->stays_near()) throw error(name, "leads beyond the coordinate 9e17, where rays end");
    return *t;
  });
}

Motion Properties::get_motion(std::string_view name) const {
  const Entry* e = find(name);
  const Motion* motion = e ? motion_of(e->value) : nullptr;
  if (!motion) return Motion(get_transform(name));
  return tolerate(Motion(), [&] {
    for (const KeyFrame& frame : motion->frames())
      if (!frame.transform.stays_near())
        throw error(name, "leads beyond the coordinate 9e17, where rays end");
    return *motion;
  });
}

double Properties::get_length_m(std::string_view name, double fallback_m, Range range) const {
  const Entry* e = find(name);
  if (!e) return fallback_m;
  return tolerate(fallback_m, [&] {
    if (std::holds_alternative<double>(e->value) || std::holds_alternative<std::int64_t>(e->value))
      throw error(name, "a physical length needs a unit: write <string name=\"" + std::string(name) +
                            "\" value=\"5um\"/>");
    const auto* s = std::get_if<std::string>(&e->value);
    if (!s) throw wrong_type(*e, "a length such as \"5um\"");
    double v = 0;
    try {
      v = parse_length_m(*s);
    } catch (const Error& problem) {
      throw error(name, problem.message());
    }
    return checked(*e, v, range);
  });
}

std::filesystem::path Properties::get_file(std::string_view name) const {
  if (plugin_ && !plugin_->names_file(name))
    throw std::logic_error("plug-in \"" + plugin_->name + "\" reads the file \"" + std::string(name) +
                           "\", which is no file in its table");
  const std::filesystem::path path = get_string(name);
  if (const std::string fault = fault_of_input(path); !fault.empty())
    throw error(name, fault + ": " + path.string());
  return path;
}

void Properties::note(std::string_view name, const std::string& message) const {
  if (making_.notes) making_.notes->emplace_back(name, message);
  if (!context_->diagnostics) return;
  if (context_->diagnostics == closed_diagnostics())
    throw std::logic_error(
        "a note after loading would be lost; notes on a scene belong to Integrator::scene_notes: " + message);
  SourceLocation at = where_;
  for (const Entry& e : entries_)
    if (e.name == name) at = e.where;
  context_->diagnostics->note(at, message);
}

std::string note_text(const Properties& properties, std::string_view name, const std::string& message) {
  return properties.error(name, message).what();
}

Diagnostics* closed_diagnostics() {
  static Diagnostics closed;
  return &closed;
}

void Properties::expect_at_most(std::string_view name, double maximum) const {
  most_expected_->emplace_back(name, maximum);
}

double Properties::most_expected(std::string_view name) const {
  double most = std::numeric_limits<double>::infinity();
  for (const auto& [read, maximum] : *most_expected_)
    if (read == name) most = std::min(most, maximum);
  return most;
}

ObjectPtr Properties::make(const std::function<ObjectPtr(const Properties&)>& create) const {
  making_.now = true;
  making_.problems.clear();
  ObjectPtr object;
  try {
    object = create(*this);
  } catch (const Error& e) {
    // An error at a parameter that already has an error is a consequence of the first one.
    const auto says_same = [&](const Error& known) {
      return known.where().line > 0 && known.where().str() == e.where().str();
    };
    if (making_.problems.empty()) {
      making_.now = false;
      throw;
    }
    if (std::none_of(making_.problems.begin(), making_.problems.end(), says_same))
      making_.problems.push_back(e);
  } catch (const std::exception&) {
    // A constructor that continued with a fallback value may fail because of that value.
    if (making_.problems.empty()) {
      making_.now = false;
      throw;
    }
  }
  making_.now = false;
  if (making_.problems.empty()) return object;
  const Error first = making_.problems.front();
  making_.problems.erase(making_.problems.begin());
  throw first;
}

void Properties::take_reads(const Properties& part) const {
  making_.problems.insert(making_.problems.end(), part.making_.problems.begin(), part.making_.problems.end());
  const auto same = [](const Entry& a, const Entry& b) {
    if (a.name != b.name) return false;
    const auto *x = std::get_if<ObjectPtr>(&a.value), *y = std::get_if<ObjectPtr>(&b.value);
    return !a.name.empty() || (x && y && *x == *y);
  };
  for (const Entry& read : part.entries_)
    for (const Entry& e : entries_)
      if (read.used && same(read, e)) e.used = true;
  // The properties `part` were made for the same plug-in, or both belong to none.
  for (const ParameterDoc* row : part.queried_) add_once(queried_, row);
  for (const std::string& name : part.queried_without_plugin_) add_once(queried_without_plugin_, name);
}

void Properties::mark_all_read() const {
  for (const Entry& e : entries_) e.used = true;
}

void Properties::mark_documented_read() const {
  for (const Entry& e : entries_)
    if (e.name.empty() || (plugin_ && plugin_->documents(e.name))) e.used = true;
}

void Properties::report_unused(Diagnostics& diagnostics) const {
  for (const Entry& e : entries_) {
    if (e.used) continue;
    if (e.name.empty()) {
      diagnostics.error(e.where, "\"" + type_ + "\" has no use for this child object");
      continue;
    }
    std::vector<std::string> names = plugin_ ? plugin_->parameter_names() : queried_without_plugin_;
    std::string suggestion = did_you_mean(e.name, names);
    if (plugin_ && plugin_->documents(e.name)) {
      diagnostics.error(e.where, "parameter \"" + e.name +
                                     "\" has no effect here with the other parameters of \"" + type_ + "\"");
      continue;
    }
    diagnostics.error(e.where, "unknown parameter \"" + e.name + "\" of \"" + type_ + "\"" + suggestion);
  }
}

}  // namespace aureole
