// SPDX-License-Identifier: Apache-2.0
// Parts of scene files for the tests of media.
#pragma once

#include <fmt/format.h>

#include <string>

namespace aureole::testing {

/// Exact, unlike std::to_string, which keeps six digits after the point.
inline std::string number(double v) { return fmt::format("{:.9g}", v); }
inline std::string parameter(const std::string& name, double v) {
  return "<float name=\"" + name + "\" value=\"" + number(v) + "\"/>";
}
inline std::string path(int max_scattering = -1) {
  return "<integrator type=\"path\"><integer name=\"max_scattering\" value=\"" +
         std::to_string(max_scattering) + "\"/></integrator>";
}
inline std::string film(int size, int samples) {
  return "<sampler type=\"sobol\"><integer name=\"sample_count\" value=\"" + std::to_string(samples) +
         "\"/></sampler><film type=\"hdrfilm\"><integer name=\"width\" value=\"" + std::to_string(size) +
         "\"/><integer name=\"height\" value=\"" + std::to_string(size) +
         "\"/><rfilter type=\"box\"/></film>";
}
inline std::string camera(const std::string& lookat, double fov, int size, int samples) {
  return "<sensor type=\"perspective\">" + parameter("fov", fov) + "<transform name=\"to_world\"><lookat " +
         lookat + "/></transform>" + film(size, samples) + "</sensor>";
}
/// Parallel rays through the square [-1, 1]^2 across z.
inline std::string parallel(int size, int samples) {
  return "<sensor type=\"orthographic\"><transform name=\"to_world\"><lookat origin=\"0, 0, 5\" target=\"0, "
         "0, 0\" up=\"0, 1, 0\"/></transform>" +
         film(size, samples) + "</sensor>";
}
inline std::string medium(double sigma_a, double sigma_s, double g = 0, double emission = 0) {
  return "<medium type=\"homogeneous\" name=\"interior\">" + parameter("sigma_a", sigma_a) +
         parameter("sigma_s", sigma_s) + (emission > 0 ? parameter("emission", emission) : "") +
         "<phase type=\"hg\">" + parameter("g", g) + "</phase></medium>";
}
inline std::string ball(const std::string& bsdf, const std::string& content) {
  return "<shape type=\"sphere\">" + bsdf + content + "</shape>";
}
inline const std::string kNull = "<bsdf type=\"null\"/>";
inline const std::string kSky = "<emitter type=\"constant\"/>";

}  // namespace aureole::testing
