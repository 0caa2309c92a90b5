// SPDX-License-Identifier: Apache-2.0
// Parses the steps of a <transform> element.
#include <algorithm>
#include <cmath>

#include "aureole/core/units.h"
#include "aureole/loading/values.h"

namespace aureole {

namespace {

using Vec3d = std::array<double, 3>;

/// Reads x, y and z, or `value` with one or three numbers.
Vec3d read_axes(const Node& step, double fallback) {
  Vec3d v{fallback, fallback, fallback};
  if (const Attribute* value = step.find("value")) {
    for (const char* axis : {"x", "y", "z"})
      if (step.find(axis)) throw Error(step.find(axis)->where, "give either \"value\" or x, y and z");
    const std::vector<double> numbers = parse_numbers(value->value);
    if (numbers.size() != 1 && numbers.size() != 3)
      throw Error(value->where, "\"" + value->value + "\" must have 1 or 3 numbers");
    for (std::size_t i = 0; i < 3; ++i) v[i] = numbers[numbers.size() == 1 ? 0 : i];
    return v;
  }
  const char* axes[] = {"x", "y", "z"};
  for (std::size_t i = 0; i < 3; ++i)
    if (const Attribute* a = step.find(axes[i])) v[i] = parse_number(a->value);
  return v;
}

Vec3d read_triple(const Node& step, std::string_view name) {
  const Attribute& a = *step.find(name);
  const std::vector<double> v = parse_numbers(a.value);
  if (v.size() != 3) throw Error(a.where, "\"" + a.value + "\" must have 3 numbers");
  return {v[0], v[1], v[2]};
}

/// Mitsuba's choice of an up vector if the file gives none: the first tangent of Duff et al. (2017),
/// "Building an orthonormal basis, revisited". Such cameras then have the same roll angle as in Mitsuba.
Vec3d any_up(const Vec3d& origin, const Vec3d& target) {
  Vec3d n{target[0] - origin[0], target[1] - origin[1], target[2] - origin[2]};
  const double length = std::hypot(n[0], n[1], n[2]);
  for (double& x : n) x /= length;
  const double sign = std::copysign(1.0, n[2]), a = -1 / (sign + n[2]);
  return {1 + sign * n[0] * n[0] * a, sign * n[0] * n[1] * a, -sign * n[0]};
}

Transform look_at(const Node& step) {
  const Vec3d origin = read_triple(step, "origin"), target = read_triple(step, "target");
  if (origin == target) throw Error(step.where, "<lookat>: origin and target are the same point");
  Vec3d up{};
  if (step.find("up") && !step.get("up").empty()) up = read_triple(step, "up");
  if (up == Vec3d{}) up = any_up(origin, target);
  const Transform t = Transform::look_at(origin, target, up);
  if (t.is_singular())
    throw Error(step.where, "<lookat>: up is parallel to the direction from origin to target");
  return t;
}

Transform matrix(const Node& step) {
  const Attribute& value = *step.find("value");
  const std::vector<double> v = parse_numbers(value.value);
  if (v.size() != 9 && v.size() != 16)
    throw Error(value.where, "<matrix> needs 9 or 16 numbers, got " + std::to_string(v.size()));
  Transform::Matrix m = Transform().matrix();
  const std::size_t n = v.size() == 16 ? 4 : 3;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) m[i][j] = v[i * n + j];
  if (m[3] != Transform().matrix()[3]) throw Error(value.where, "<matrix>: the last row must be 0 0 0 1");
  return Transform(m);
}

Transform rotate(const Node& step) {
  const Vec3d axis = read_axes(step, 0);
  if (axis == Vec3d{}) throw Error(step.where, "<rotate>: the axis is zero");
  return Transform::rotate(axis[0], axis[1], axis[2], parse_number(step.get("angle")));
}

/// Reads one step; the identity if attributes are missing (reported).
Transform read_step(const Node& step, Diagnostics& diagnostics) {
  const auto has = [&](std::initializer_list<std::string_view> required,
                       std::initializer_list<std::string_view> optional) {
    return check_attributes(step, required, optional, diagnostics);
  };
  if (step.tag == "translate" && has({}, {"x", "y", "z", "value"})) {
    const Vec3d v = read_axes(step, 0);
    return Transform::translate(v[0], v[1], v[2]);
  }
  if (step.tag == "scale" && has({}, {"x", "y", "z", "value"})) {
    const Vec3d v = read_axes(step, 1);
    return Transform::scale(v[0], v[1], v[2]);
  }
  if (step.tag == "rotate") return has({"angle"}, {"x", "y", "z", "value"}) ? rotate(step) : Transform();
  if (step.tag == "lookat") return has({"origin", "target"}, {"up"}) ? look_at(step) : Transform();
  if (step.tag == "matrix") return has({"value"}, {}) ? matrix(step) : Transform();
  if (step.tag == "translate" || step.tag == "scale") return {};
  throw Error(step.where, "<transform> can't contain <" + step.tag + ">" +
                              did_you_mean(step.tag, {"translate", "rotate", "scale", "lookat", "matrix"}));
}

}  // namespace

Transform parse_transform(const Node& node, Diagnostics& diagnostics) {
  Transform product;
  for (const Node& step : node.children) {
    try {
      const Transform t = read_step(step, diagnostics);
      if (t.is_singular()) throw Error(step.where, "<" + step.tag + "> is singular: it can't be inverted");
      product = t * product;
    } catch (const Error& e) {
      throw e.where().file.empty() ? Error(step.where, "<" + step.tag + ">: " + e.message()) : e;
    }
  }
  return product;
}

Motion parse_animation(const Node& node, Diagnostics& diagnostics) {
  check_attributes(node, {"name"}, {}, diagnostics);
  std::vector<KeyFrame> frames;
  for (const Node& child : node.children) {
    if (child.tag != "transform")
      throw Error(child.where,
                  "<animation> can't contain <" + child.tag + ">: it has <transform time=\"...\">");
    if (!check_attributes(child, {"time"}, {}, diagnostics)) continue;
    const Attribute& time = *child.find("time");
    try {
      frames.push_back({parse_number(time.value), {}});
    } catch (const Error& e) {
      throw Error(time.where, "parameter \"time\": " + e.message());
    }
    if (frames.size() > 1 && !(frames.back().time > frames[frames.size() - 2].time))
      throw Error(time.where, "the times of key frames must increase");
    frames.back().transform = parse_transform(child, diagnostics);
  }
  if (frames.empty()) throw Error(node.where, "<animation> needs at least one <transform time=\"...\">");
  try {
    return Motion(std::move(frames));
  } catch (const Error& e) {
    throw Error(node.where, e.message());
  }
}

}  // namespace aureole
