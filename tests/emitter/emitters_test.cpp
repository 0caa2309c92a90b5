// SPDX-License-Identifier: Apache-2.0
// Wrong parameters of emitters, and what single emitters promise beyond the harness.
#include <gtest/gtest.h>

#include <cmath>

#include "aureole/loading/stages.h"

namespace aureole::testing {
namespace {

std::string scene_with(const std::string& xml, const std::string& version = "3.0.0") {
  return "<scene version=\"" + version +
         "\"><integrator type=\"path\"/><sensor type=\"perspective\"><film type=\"hdrfilm\"/></sensor>\n" +
         xml + "</scene>";
}

/// The only error of a scene with this on line 2.
std::string error_of(const std::string& xml) {
  try {
    load_scene_from_string(scene_with(xml), "test.xml");
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

std::string emitter(const std::string& type, const std::string& parameters) {
  return "<emitter type=\"" + type + "\">" + parameters + "</emitter>";
}
std::string number(const std::string& name, const std::string& value) {
  return "<float name=\"" + name + "\" value=\"" + value + "\"/>";
}
const std::string kStretch = "<transform name=\"to_world\"><scale x=\"2\" y=\"1\" z=\"1\"/></transform>";
const std::string kLarger = "<transform name=\"to_world\"><scale value=\"2\"/></transform>";
const std::string kPattern = "<texture name=\"texture\" type=\"checkerboard\"/>";

TEST(EmitterParameters, WrongParametersAreLocatedErrors) {
  const struct {
    std::string xml, message;
  } cases[] = {
      {emitter("spot", number("cutoff_angle", "0")), "cutoff_angle"},
      {emitter("spot", number("cutoff_angle", "181")), "cutoff_angle"},
      {emitter("spot", number("cutoff_angle", "1e-7")), "too narrow"},
      {emitter("spot", number("cutoff_angle", "10") + number("beam_width", "11")),
       "must not exceed cutoff_angle"},
      {emitter("spot", number("cutoff_angle", "95") + kPattern), "below 90 degrees"},
      {emitter("spot", "<rgb name=\"texture\" value=\"1, 0, 0\"/>"), "a colour belongs to \"intensity\""},
      {emitter("spot", "<texture name=\"intensity\" type=\"checkerboard\"/>"), "belongs to \"texture\""},
      {emitter("spot", kStretch), "stretched"},
      {emitter("projector", kStretch), "stretched"},
      {emitter("projector", kLarger), "must not scale"},
      {emitter("projector", number("fov", "180")), "fov"},
      {emitter("projector", number("fov", "40") + "<string name=\"focal_length\" value=\"50mm\"/>"),
       "give either"},
      {emitter("projector", "<string name=\"focal_length\" value=\"-3\"/>"), "expected a length"},
      {emitter("projector", number("scale", "-1")), "scale"},
      {emitter("directional", "<vector name=\"direction\" value=\"0, 0, 0\"/>"), "must not be zero"},
      {emitter("directional", "<vector name=\"direction\" value=\"0, 0, 1\"/>" + kLarger), "give either"},
      {emitter("directional", "<texture name=\"irradiance\" type=\"checkerboard\"/>"), "not a texture"},
      {emitter("sunsky", number("turbidity", "0.9")), "turbidity"},
      {emitter("sunsky", number("sun_aperture", "0")), "sun_aperture"},
      {emitter("sunsky", "<integer name=\"month\" value=\"2\"/><integer name=\"day\" value=\"30\"/>"),
       "fewer days"},
      {emitter("sunsky", "<vector name=\"sun_direction\" value=\"0, 0, 1\"/>" + number("hour", "9")),
       "give either"},
      {emitter("sunsky", "<vector name=\"sun_direction\" value=\"0, 0, 0\"/>"), "must not be zero"},
      {emitter("sunsky", "<texture name=\"albedo\" type=\"checkerboard\"/>"), "not a texture"},
      {emitter("sunsky", number("albedo", "1.2")), "[0, 1]"},
      {emitter("point", number("sampling_weight", "-1")), "sampling_weight"},
      {"<shape type=\"sphere\">" + emitter("spot", "") + "</shape>", "cannot sit on a shape"},
  };
  for (const auto& c : cases) {
    const std::string error = error_of(c.xml);
    EXPECT_TRUE(error.starts_with("test.xml:2:")) << c.xml << "\n" << error;
    EXPECT_NE(error.find(c.message), std::string::npos) << c.xml << "\n" << error;
  }
}

TEST(EmitterParameters, UnusualParametersWork) {
  for (const std::string& xml :
       {emitter("spot", number("cutoff_angle", "180") + number("beam_width", "0")),
        emitter("spot", number("cutoff_angle", "0.001") + kLarger),
        emitter("spot", "<transform name=\"to_world\"><scale x=\"-1\"/></transform>"),
        emitter("projector", number("fov", "179.9")), emitter("projector", number("fov", "0.001")),
        emitter("directional", kStretch),
        emitter("sunsky", number("turbidity", "10") + number("albedo", "1")),
        emitter("sunsky", number("sun_aperture", "60") + number("hour", "18.9") +
                              "<boolean name=\"complex_sun\" value=\"true\"/>")}) {
    const auto loaded = load_scene_from_string(scene_with(xml + "<shape type=\"sphere\"/>"), "test.xml");
    const Scene& scene = *loaded.scene;
    const Light& e = scene.emitters()[0];
    const Wavelengths w = Wavelengths::at(scene.wavelengths().grid(), 550.f);
    EXPECT_TRUE(is_valid_radiance(e.power_spectrum().eval(w))) << xml;
    EXPECT_FALSE(is_black(e.power_spectrum().eval(w))) << xml;
    int found = 0;
    for (int k = 0; k < 1000; ++k) {
      const Vec2 u{(float(k % 32) + 0.5f) / 32, (float(k / 32) + 0.5f) / 32};
      if (const auto r = e.sample_ray(0, u, u, w)) {
        ++found;
        EXPECT_TRUE(is_valid_radiance(r->value) && std::isfinite(r->pdf_direction)) << xml;
      }
      if (const auto s = e.sample_direct({3 * u.x, 3 * u.y, -2}, 0, u, w)) {
        EXPECT_TRUE(is_valid_radiance(s->radiance)) << xml;
      }
    }
    EXPECT_GT(found, 100) << xml;
  }
}

TEST(EmitterParameters, NotesOfWhatHasNoEffect) {
  const auto notes = [](const std::string& xml) { return load_parts("test.xml", scene_with(xml), {}).notes; };
  const auto night = notes(emitter("sunsky", number("hour", "23")));
  ASSERT_EQ(night.size(), 1u);
  EXPECT_NE(night[0].find("below the horizon"), std::string::npos);
  const auto beam = notes("<shape type=\"sphere\">" + emitter("directionalarea", "") + "</shape>");
  ASSERT_EQ(beam.size(), 1u);
  EXPECT_NE(beam[0].find("ptracer"), std::string::npos);
}

/// A sky's radiance at one wavelength along world directions.
class Sky {
public:
  explicit Sky(const std::string& xml, const std::string& version = "3.0.0")
      : scene_(load_scene_from_string(scene_with(xml, version), "test.xml").scene),
        w_(Wavelengths::at(scene_->wavelengths().grid(), 560.f)) {}
  double operator()(const Vec3& d) const {
    return double(scene_->emitters()[0].eval_escaped(normalize(d), w_)[0]);
  }
  /// Irradiance of a plane across `axis` from a cone around it.
  double cone(const Vec3& axis, double half_angle) const {
    const Frame frame = Frame::from_normal(normalize(axis));
    constexpr int kRings = 400, kSpokes = 64;
    double sum = 0;
    for (int i = 0; i < kRings; ++i)
      for (int j = 0; j < kSpokes; ++j) {
        const double cosine = 1 - (1 - std::cos(half_angle)) * (i + 0.5) / kRings,
                     sine = std::sqrt(1 - cosine * cosine), phi = 2 * M_PI * (j + 0.5) / kSpokes;
        sum += (*this)(
            frame.to_world({float(sine * std::cos(phi)), float(sine * std::sin(phi)), float(cosine)}));
      }
    return sum / (kRings * kSpokes) * 2 * M_PI * (1 - std::cos(half_angle));
  }
  /// The direction on a fine grid where it is brightest.
  Vec3 brightest() const {
    Vec3 best;
    double most = -1;
    constexpr int kN = 400000;
    for (int k = 0; k < kN; ++k) {
      const double z = 1 - (2 * k + 1.0) / kN, phi = 2 * M_PI * k * 0.61803398874989485,
                   r = std::sqrt(1 - z * z);
      const Vec3 d{float(r * std::cos(phi)), float(r * std::sin(phi)), float(z)};
      if (const double l = (*this)(d); l > most) most = l, best = d;
    }
    return best;
  }

private:
  std::shared_ptr<const Scene> scene_;
  Wavelengths w_;
};

TEST(Sunsky, TheSunsPowerIsKept) {
  const std::string sun = "<vector name=\"sun_direction\" value=\"1, 2, 2\"/>" + number("sky_scale", "0");
  const std::string complex_sun = "<boolean name=\"complex_sun\" value=\"true\"/>";
  const Vec3 at{1, 2, 2};
  const Sky even(emitter("sunsky", sun)), shaded(emitter("sunsky", sun + complex_sun)),
      large(emitter("sunsky", sun + number("sun_aperture", "6"))),
      twice(emitter("sunsky", sun + number("sun_scale", "2")));
  constexpr double kDegree = M_PI / 180;
  // Cones a little wider than the disc, whose edge the rings resolve to a part in a thousand.
  const double power = even.cone(at, 0.268 * kDegree);
  EXPECT_NEAR(power / 1.1307, 1, 2e-3);  // W/(m^2 nm), by quadrature elsewhere; Mitsuba's table has 1.1268
  EXPECT_NEAR(shaded.cone(at, 0.268 * kDegree) / power, 1, 2e-3);
  EXPECT_NEAR(large.cone(at, 3.001 * kDegree) / power, 1, 4e-3);
  EXPECT_NEAR(twice.cone(at, 0.268 * kDegree) / power, 2, 1e-5);
  // Even, and dark beyond.
  EXPECT_EQ(even(at), even(at + Vec3{0.008f, 0, 0}));
  EXPECT_GT(shaded(at), 1.2 * shaded(at + Vec3{0.012f, 0, 0}));
  EXPECT_GT(shaded(at + Vec3{0.012f, 0, 0}), 0);
  EXPECT_EQ(even(at + Vec3{0.02f, 0, 0}), 0);
  EXPECT_EQ(
      Sky(emitter("sunsky", "<vector name=\"sun_direction\" value=\"1, 2, 2\"/>"))({0.3f, 0.1f, -0.001f}), 0);
}

TEST(Sunsky, DateTimeAndPlace) {
  const std::string vienna = number("hour", "16.5") + number("latitude", "48.2") +
                             number("longitude", "16.4") + number("timezone", "2") +
                             "<integer name=\"year\" value=\"2024\"/><integer name=\"month\" value=\"6\"/>"
                             "<integer name=\"day\" value=\"21\"/>" +
                             number("sun_aperture", "1");
  // Azimuth 259.05 degrees from north, 48.63 from the zenith (Meeus): north is -x, east -y.
  const Vec3 expected{0.14257f, 0.73673f, 0.66098f};
  EXPECT_LT(length(Sky(emitter("sunsky", vienna)).brightest() - expected), 0.01f);
  // The default: Tokyo, 10 July 2010, 15:00.
  EXPECT_LT(length(Sky(emitter("sunsky", number("sun_aperture", "1"))).brightest() -
                   Vec3{0.05141f, 0.69169f, 0.72036f}),
            0.01f);
  // Turned so that y is up.
  const Vec3 turned{expected.x, expected.z, -expected.y};
  EXPECT_LT(
      length(Sky(emitter("sunsky",
                         vienna + "<transform name=\"to_world\"><rotate x=\"1\" angle=\"-90\"/></transform>"))
                 .brightest() -
             turned),
      0.01f);
  // A scene of version 0.6: y up, north -z, east +x.
  const Vec3 old{-expected.y, expected.z, expected.x};
  EXPECT_LT(length(Sky(emitter("sunsky", vienna), "0.6.0").brightest() - old), 0.01f);
  // In the world, whatever the axes.
  for (const std::string version : {"0.6.0", "3.0.0"}) {
    const std::string name = version == "0.6.0" ? "sunDirection" : "sun_direction";
    const Sky sky(emitter("sunsky", "<vector name=\"" + name + "\" value=\"1, 2, 2\"/>"), version);
    EXPECT_GT(sky({1, 2, 2}), 1000);
  }
}

}  // namespace
}  // namespace aureole::testing
