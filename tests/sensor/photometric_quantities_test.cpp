// SPDX-License-Identifier: Apache-2.0
// Emitters of a stated amount and sensors of a stated quantity, in scenes whose answers are known in closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "aureole/emitter/amount/emission_amount.h"
#include "aureole/render/job.h"
#include "aureole/render/output.h"
#include "harness/paths.h"
#include "loading/load_text.h"

namespace aureole::test {
namespace {

/// A mean over replicates with its standard error.
struct Reading {
  double mean = 0, error = 0;
};

std::string square_film(const std::string& quantity, const std::string& more = "", int side = 1) {
  return "<film type='hdrfilm'><integer name='width' value='" + std::to_string(side) +
         "'/><integer name='height' value='" + std::to_string(side) + "'/><string name='quantity' value='" +
         quantity + "'/>" + more + "<rfilter type='box'/></film>";
}
LoadedScene scene(const std::string& content, const std::string& integrator = "path") {
  return load_scene_from_string(
      "<scene version='3.0.0'><integrator type='" + integrator + "'/>" + content + "</scene>", "light.xml",
      {});
}
/// The mean of the picture over replicates.
Reading read(const std::string& content, std::int64_t samples, int replicates = 16,
             const std::string& integrator = "path") {
  Reading r;
  double sum = 0, squares = 0;
  for (int k = 0; k < replicates; ++k) {
    RenderOptions options;
    options.end = samples, options.seed = std::uint64_t(1000 + k);
    RenderJob job(scene(content, integrator), options);
    job.run(std::atomic<bool>(false));
    EXPECT_EQ(job.state().invalid_samples, 0u);
    const Image picture = job.state().picture();
    double mean = 0;
    for (const float v : picture.pixels) mean += double(v) / double(picture.pixels.size());
    sum += mean, squares += mean * mean;
  }
  r.mean = sum / replicates;
  r.error = std::sqrt(std::max(0.0, squares / replicates - r.mean * r.mean) / (replicates - 1));
  return r;
}
/// Within three standard errors, which are less than 0.3 % (or rounding errors).
void expect_reading(const Reading& r, double expected, const std::string& what = "") {
  EXPECT_LT(r.error, 0.003 * expected) << what;
  EXPECT_NEAR(r.mean, expected, 3 * r.error + 2e-4 * expected) << what;
}
std::string error(const std::string& content) {
  try {
    scene(content);
    return "";
  } catch (const Error& e) {
    return e.what();
  }
}

/// A small horizontal receiver at the origin that faces +z.
std::string receiver(const std::string& quantity, const std::string& measure = "irradiance",
                     const std::string& more = "") {
  return "<sensor type='powermap'><transform name='to_world'><scale value='0.001'/></transform><string name='measure' value='" +
         measure + "'/>" + more + square_film(quantity) + "</sensor>";
}
const std::string kFar = "<shape type='sphere'><point name='center' x='0' y='0' z='-50'/></shape>";

std::string point_light(const std::string& amount, double z = 2) {
  return "<emitter type='point'><point name='position' x='0' y='0' z='" + std::to_string(z) + "'/>" + amount +
         "</emitter>";
}
std::string amount(const std::string& text, const std::string& more = "") {
  return "<string name='amount' value='" + text + "'/>" + more;
}

TEST(PhotometricQuantities, PointsOfAllAmounts) {
  const double lm800 = 800 / (4 * M_PI) / 4;  // lx at 2 m
  expect_reading(read(receiver("illuminance") + kFar + point_light(amount("800 lm")), 256), lm800);
  // The colour does not change a photometric amount.
  for (const char* colour :
       {"<float name='color_temperature' value='2700'/>", "<rgb name='intensity' value='0.1, 3, 0.5'/>",
        "<spectrum name='intensity' value='500:0, 520:1, 600:0.2, 700:0'/>"})
    expect_reading(read(receiver("illuminance") + kFar + point_light(amount("800 lm", colour)), 256), lm800,
                   colour);
  expect_reading(read(receiver("illuminance") + kFar + point_light(amount("800 cd")), 256), 200);
  expect_reading(read(receiver("illuminance") + kFar +
                          point_light(amount("10 W", "<float name='efficacy' value='80'/>")),
                      256),
                 lm800);
  expect_reading(read(receiver("irradiance") + kFar + point_light(amount("100 W")), 256),
                 100 / (4 * M_PI) / 4);
  expect_reading(read(receiver("irradiance") + kFar + point_light(amount("100 W/sr")), 256), 25);
  // 100 W/sr of 550 nm: 4.5977 umol of photons a joule, and 683.002 V(550) lm/W.
  const std::string green = "<spectrum name='intensity' value='549:0, 550:1, 551:0'/>";
  expect_reading(read(receiver("photon_irradiance") + kFar + point_light(amount("100 W/sr", green)), 256),
                 25 * 4.59773);
  // A scene in millimetres has the same illuminance.
  expect_reading(read("<string name='length_unit' value='mm'/>" + receiver("illuminance") + kFar +
                          point_light(amount("800 lm"), 2000),
                      256),
                 lm800);
}

TEST(PhotometricQuantities, OtherEmitters) {
  const auto lux = [](const std::string& emitters) { return read(receiver("illuminance") + emitters, 1024); };
  expect_reading(lux(kFar + "<emitter type='directional'><vector name='direction' x='0' y='0' z='-1'/>" +
                     amount("100 klx") + "</emitter>"),
                 1e5);
  expect_reading(lux("<emitter type='constant'>" + amount("10 klx") + "</emitter>"), 1e4);
  expect_reading(lux("<emitter type='constant'>" + amount("1000 cd/m^2") + "</emitter>"), 1000 * M_PI);
  expect_reading(lux("<emitter type='ciesky'>" + amount("10 klx") + "</emitter>"), 1e4);
  expect_reading(lux("<emitter type='ciesky'>" + amount("900 cd/m^2") + "</emitter>"), 700 * M_PI);
  const std::string down =
      "<transform name='to_world'><rotate x='1' angle='180'/><translate z='2'/></transform>";
  expect_reading(lux(kFar + "<emitter type='spot'>" + down + amount("400 cd") + "</emitter>"), 100);
  // A uniform beam of half-angle 60 degrees has pi sr.
  expect_reading(lux(kFar + "<emitter type='spot'>" + down +
                     "<float name='cutoff_angle' value='60'/><float name='beam_width' value='60'/>" +
                     amount("100 lm") + "</emitter>"),
                 100 / M_PI / 4);
  // A projector of 1000 lm onto a plane of 4 m x 4 m at 2 m.
  expect_reading(lux(kFar + "<emitter type='projector'>" + down + "<float name='fov' value='90'/>" +
                     amount("1000 lm") + "</emitter>"),
                 62.5);
}

TEST(PhotometricQuantities, ADiscOfItsLuminanceExitanceAndFlux) {
  const auto disc = [](const std::string& light) {
    return read(
        receiver("illuminance") +
            "<shape type='disk'><transform name='to_world'><rotate x='1' angle='180'/><translate z='2'/></transform>"
            "<emitter type='area'>" +
            light + "</emitter></shape>",
        1024);
  };
  // Radius 1 at distance 2: pi L/5.
  expect_reading(disc(amount("1000 cd/m^2")), 628.3185);
  expect_reading(disc(amount("1000 nit", "<float name='color_temperature' value='3000'/>")), 628.3185);
  expect_reading(disc(amount("1000 lx")), 200);
  expect_reading(disc(amount("1000 lm")), 200 / M_PI);  // over pi m^2
  expect_reading(disc(amount("20 W", "<float name='efficacy' value='50'/>")), 200 / M_PI);
}

TEST(PhotometricQuantities, AnIntegratingCube) {
  // 10 klm in the middle of a cube of 4 m: 104.1667 lx of direct light in the mean over the walls, and rho/(1 - rho) times
  // that of indirect light.
  for (const double rho : {0.3, 0.8}) {
    const std::string walls =
        "<shape type='cube'><boolean name='flip_normals' value='true'/><transform name='to_world'><scale value='2'/></transform>"
        "<bsdf type='diffuse'><float name='reflectance' value='" +
        std::to_string(rho) + "'/></bsdf>";
    const std::string meter =
        "<sensor type='irradiancemeter'>" + square_film("illuminance") + "</sensor></shape>";
    const std::string light = "<emitter type='point'>" + amount("10 klm") + "</emitter>";
    const Reading all = read(walls + meter + light, 4096);
    const double direct = 1e4 / 96, indirect = direct * rho / (1 - rho);
    EXPECT_LT(all.error, 0.003 * indirect);
    EXPECT_NEAR(all.mean - direct, indirect, 3 * all.error + 1e-4 * indirect);
    EXPECT_NEAR(indirect, 104.1667 * rho / (1 - rho), 1e-4 * indirect);
  }
}

TEST(PhotometricQuantities, DaylightThroughAHoleInTheRoof) {
  // A hole of 4 x 4 m, 3 m above the point, in black surroundings.
  std::string roof;
  for (const char* side : {"<scale x='2000' y='999' z='1'/><rotate x='1' angle='180'/><translate y='1001'/>",
                           "<scale x='2000' y='999' z='1'/><rotate x='1' angle='180'/><translate y='-1001'/>",
                           "<scale x='999' y='2' z='1'/><rotate x='1' angle='180'/><translate x='1001'/>",
                           "<scale x='999' y='2' z='1'/><rotate x='1' angle='180'/><translate x='-1001'/>"})
    roof +=
        "<shape type='rectangle'><transform name='to_world'>" + std::string(side) +
        "<translate z='3'/></transform><bsdf type='diffuse'><float name='reflectance' value='0'/></bsdf></shape>";
  for (const auto& [sky, factor] : {std::pair("uniform", 0.357685), {"overcast", 0.42996}})
    expect_reading(read(receiver("illuminance") + roof + "<emitter type='ciesky'><string name='sky' value='" +
                            sky + "'/>" + amount("10 klx") + "</emitter>",
                        16384),
                   1e4 * factor, sky);
}

TEST(PhotometricQuantities, CylindricalAndSemicylindricalIlluminance) {
  // 900 cd from (1, 2, 2), at a distance of 3 m: sin(e) = sqrt(5)/3 from the vertical; the azimuth from x has the cosine
  // 1/sqrt(5).
  const std::string lamp = kFar + "<emitter type='point'><point name='position' x='1' y='2' z='2'/>" +
                           amount("900 cd") + "</emitter>";
  const double sine = std::sqrt(5.0) / 3, cosine = 1 / std::sqrt(5.0);
  const std::string facing = "<vector name='facing' x='1' y='0' z='0'/>";
  for (const char* integrator : {"path", "ptracer"}) {
    const bool is_path = std::string(integrator) == "path";
    const std::int64_t samples = is_path ? 256 : 4096;
    expect_reading(read(receiver("illuminance", "cylindrical") + lamp, samples, 16, integrator),
                   100 * sine / M_PI, integrator);
    expect_reading(read(receiver("illuminance", "semicylindrical", facing) + lamp, samples, 16, integrator),
                   100 * sine * (1 + cosine) / M_PI, integrator);
    // Behind: 1 - cos.
    expect_reading(
        read(receiver("illuminance", "semicylindrical", "<vector name='facing' x='-1' y='0' z='3'/>") + lamp,
             samples, 16, integrator),
        100 * sine * (1 - cosine) / M_PI, integrator);
  }
  // A uniform surround of 1000 cd/m^2: pi L for all of them, by rays.
  const std::string around = "<emitter type='constant'>" + amount("1000 cd/m^2") + "</emitter>";
  for (const char* measure : {"irradiance", "cylindrical", "semicylindrical"})
    expect_reading(read(receiver("illuminance", measure) + around, 256), 1000 * M_PI, measure);
  // Half a surround, as the sky: sin(e)/pi over a hemisphere is pi/2, so half of the cylinder's reading.
  const std::string sky =
      "<emitter type='ciesky'><string name='sky' value='uniform'/>" + amount("1000 cd/m^2") + "</emitter>";
  expect_reading(read(receiver("illuminance", "cylindrical") + sky, 4096), 500 * M_PI);
  // The sky of an axis that lies: the upper half of a horizontal cylinder, and a semicylinder that faces it.
  expect_reading(
      read(receiver("illuminance", "semicylindrical",
                    "<vector name='axis' x='1' y='0' z='0'/><vector name='facing' x='0' y='0' z='1'/>") +
               sky,
           4096),
      500 * M_PI * (1 + 2 / M_PI));
}

TEST(PhotometricQuantities, LuminairesAsRadianceComputesThem) {
  // Written by tests/parameter/luminaire/make_radiance_illuminances.py.
  std::ifstream in(source_dir() / "tests/parameter/luminaire/data/radiance_illuminances.csv");
  std::string line;
  std::getline(in, line);
  int count = 0;
  for (; std::getline(in, line); ++count) {
    std::istringstream cells(line);
    std::string file, x, y, z, lux;
    for (std::string* cell : {&file, &x, &y, &z, &lux}) std::getline(cells, *cell, ',');
    const std::string sensor =
        "<sensor type='powermap'><transform name='to_world'><scale value='0.0001'/><translate x='" + x +
        "' y='" + y + "' z='" + z + "'/></transform><string name='measure' value='irradiance'/>" +
        square_film("illuminance") + "</sensor>";
    const std::string lamp =
        "<emitter type='photometric'><string name='filename' value='" + example_file(file).string() +
        "'/><string name='opening' value='point'/><transform name='to_world'><rotate x='1' "
        "angle='180'/></transform></emitter>";
    const double expected = std::stod(lux);
    // Radiance draws no random numbers here. Its tables have single precision.
    EXPECT_NEAR(read(sensor + kFar + lamp, 256, 4).mean, expected, 1e-3 * expected + 1e-3) << line;
  }
  EXPECT_EQ(count, 24);
}

TEST(PhotometricQuantities, ScotopicToPhotopicRatios) {
  // CIE 018: illuminants A and D65, by 1 nm from 360 to 830 nm.
  const auto camera = [](const std::string& quantity) {
    return "<sensor type='radiancemeter'><point name='origin' x='0' y='0' z='0'/><vector name='direction' x='0' y='0' z='1'/>" +
           square_film(quantity) + "</sensor>";
  };
  for (const auto& [name, ratio] : {std::pair("A", 1.4123), {"D65", 2.4646}}) {
    const std::string light = "<emitter type='constant'>" + amount("100 cd/m^2") +
                              "<spectrum name='radiance' type='illuminant'><string name='name' value='" +
                              std::string(name) + "'/></spectrum></emitter>";
    expect_reading(read(camera("luminance") + light, 1024), 100, name);
    const Reading scotopic = read(camera("scotopic_luminance") + light, 1024);
    EXPECT_NEAR(scotopic.mean / 100, ratio, 3 * scotopic.error / 100 + 2e-4) << name;
    EXPECT_LT(scotopic.error, 0.3);
  }
}

TEST(PhotometricQuantities, PicturesSayTheirUnits) {
  const auto meaning = [](const std::string& sensor) {
    const LoadedScene loaded = scene(sensor + kFar + point_light(""));
    return loaded.scene->film().channel_meanings().at(0);
  };
  EXPECT_EQ(meaning(receiver("illuminance")), "illuminance, lx");
  EXPECT_EQ(meaning(receiver("illuminance", "cylindrical")), "cylindrical illuminance, lx");
  EXPECT_EQ(meaning("<sensor type='perspective'>" +
                    square_film("luminance", "<string name='unit' value='nit'/>", 4) + "</sensor>"),
            "luminance, nit");
  EXPECT_EQ(meaning("<sensor type='perspective'>" +
                    square_film("luminance", "<string name='pixel_format' value='xyz'/>", 4) + "</sensor>"),
            "CIE 1931 XYZ; Y is luminance, cd/m^2");
  EXPECT_NE(
      meaning(
          "<sensor type='powermap'><film type='specfilm'><integer name='bins' value='4'/><boolean name='preview' value='false'/></film></sensor>")
          .find("spherical spectral irradiance from 360 to"),
      std::string::npos);
  // Units in other sizes.
  expect_reading(
      read(
          "<sensor type='powermap'><transform name='to_world'><scale value='0.001'/></transform><string name='measure' value='irradiance'/>" +
              square_film("illuminance", "<string name='unit' value='fc'/>") + "</sensor>" + kFar +
              point_light(amount("800 cd")),
          256),
      200 / 10.7639104);
}

TEST(PhotometricQuantities, ErrorsAreLocated) {
  const auto fails = [](const std::string& content, const std::string& what) {
    const std::string message = error(content);
    EXPECT_NE(message.find("light.xml:"), std::string::npos) << message;
    EXPECT_NE(message.find(what), std::string::npos) << message;
  };
  fails(receiver("luminance") + kFar + point_light(""), "not \"luminance\"");
  fails("<sensor type='perspective'>" + square_film("illuminance") + "</sensor>" + kFar,
        "radiance, photon_radiance, luminance");
  fails(receiver("illuminence") + kFar, "illuminance");
  fails(receiver("illuminance") + kFar + point_light(amount("800 lux")), "unknown unit \"lux\"");
  fails(receiver("illuminance") + kFar + point_light(amount("800")), "a unit is missing");
  fails(receiver("illuminance") + kFar + point_light(amount("-800 lm")), "must be positive");
  fails(receiver("illuminance") + kFar + point_light(amount("800 lx")), "\"point\" has no illuminance");
  fails(receiver("illuminance") + kFar + point_light(amount("800 lm", "<float name='efficacy' value='80'/>")),
        "electrical power");
  fails(receiver("illuminance") + kFar + point_light(amount("8 W", "<float name='efficacy' value='-80'/>")),
        "efficacy");
  fails(receiver("illuminance") + kFar + point_light(amount("8 W", "<float name='efficacy' value='700'/>")),
        "683.002");
  // A mistake is told once.
  const std::string cold = error(receiver("illuminance") + kFar +
                                 point_light(amount("8 lm", "<float name='color_temperature' value='-5'/>")));
  EXPECT_NE(cold.find("color_temperature"), std::string::npos) << cold;
  EXPECT_EQ(cold.find("blackbody"), std::string::npos) << cold;
  fails(receiver("illuminance") + kFar + point_light("<float name='color_temperature' value='3000'/>"),
        "needs an \"amount\"");
  fails(receiver("illuminance") + kFar +
            point_light(amount(
                "8 lm", "<float name='color_temperature' value='3000'/><rgb name='intensity' value='1'/>")),
        "either");
  fails(
      receiver("illuminance") + kFar + point_light(amount("8 lm", "<spectrum name='intensity' value='0'/>")),
      "no light that the eye sees");
  EXPECT_EQ(parse_emission_amount(" 2.5e3 kcd/m^2 ").value, 2.5e6);
}

TEST(PhotometricQuantities, PowerAndEnergy) {
  // A small receiver of 2 mm x 2 mm at 200 lx: lm; the side of a sphere of radius 0.5 with a lamp of 1000 lm in its middle.
  const std::string lamp = kFar + point_light(amount("800 cd"));
  expect_reading(read(receiver("luminous_flux") + lamp, 256), 200 * 4e-6);
  expect_reading(
      read(receiver("luminous_flux", "irradiance", "<float name='shutter_close' value='0.5'/>") + lamp, 256),
      200 * 4e-6);
  const auto around = [](const std::string& quantity, const std::string& more = "") {
    return "<shape type='sphere'><float name='radius' value='0.5'/><boolean name='flip_normals' value='true'/>"
           "<bsdf type='diffuse'><rgb name='reflectance' value='0'/></bsdf><sensor type='irradiancemeter'>" +
           more + square_film(quantity) + "</sensor></shape>" + point_light(amount("1000 lm"), 0.2);
  };
  expect_reading(read(around("luminous_flux"), 1024), 1000);
  expect_reading(read(around("luminous_energy", "<float name='shutter_close' value='3'/>"), 1024), 3000);
  // One watt of photons of 550 nm within a narrow film: 1 W is lambda/(h c N_A) mol/s.
  const std::string film =
      "<film type='hdrfilm'><integer name='width' value='1'/><integer name='height' value='1'/><string name='quantity' value='photon_flux'/>"
      "<float name='wavelength_min' value='549'/><float name='wavelength_max' value='551'/><rfilter type='box'/></film>";
  expect_reading(
      read(
          "<shape type='sphere'><boolean name='flip_normals' value='true'/><bsdf type='diffuse'><rgb name='reflectance' "
          "value='0'/></bsdf><sensor type='irradiancemeter'>" +
              film + "</sensor></shape>" + point_light(amount("1 W"), 0),
          1024),
      550e-9 / (6.62607015e-34 * 299792458 * 6.02214076e23) * 1e6);
  const auto fails = [](const std::string& content, const std::string& what) {
    const std::string message = error(content);
    EXPECT_NE(message.find(what), std::string::npos) << message;
  };
  fails(receiver("luminous_flux", "fluence") + kFar, "must be \"irradiance\"");
  // On a shape, the power through each cell: here all of the light of a lamp in a ball, whose cells differ in their areas.
  const Reading cells = read(
      "<shape type='sphere'><float name='radius' value='0.5'/><boolean name='flip_normals' value='true'/><bsdf type='diffuse'>"
      "<rgb name='reflectance' value='0'/></bsdf><sensor type='powermap'><string name='measure' value='irradiance'/>" +
          square_film("luminous_flux", "", 6) + "</sensor></shape>" + point_light(amount("1000 lm"), 0.2),
      256);
  expect_reading({36 * cells.mean, 36 * cells.error}, 1000);
  fails("<sensor type='perspective'><string name='measure' value='irradiance'/>" +
            square_film("radiant_energy") + "</sensor>" + kFar,
        "quantity");
}

TEST(PhotometricQuantities, EyesAtDusk) {
  // A source of 1 cd in light of a black body of 2856 K (illuminant A), whose S/P ratio is 1.4123.
  const std::string lamp =
      kFar + point_light(amount("100 cd", "<float name='color_temperature' value='2855.5'/>"), 1);
  const Reading photopic = read(receiver("illuminance") + lamp, 1024),
                scotopic = read(receiver("scotopic_illuminance") + lamp, 1024);
  expect_reading(photopic, 100);
  EXPECT_NEAR(scotopic.mean / photopic.mean, 1.4123, 0.004);
  // The mesopic one lies on the line between both, by the m of the adaptation (CIE 191, table for 0.3 cd/m^2).
  const std::string adapted =
      "<sensor type='powermap'><transform name='to_world'><scale value='0.001'/></transform><string name='measure' value='irradiance'/>" +
      square_film(
          "mesopic_illuminance",
          "<float name='adaptation_luminance' value='0.3'/><float name='scotopic_to_photopic' value='1.4123'/>") +
      "</sensor>";
  const double v = 683.0 / 1699;
  double m = 0.5;  // the fixed point of CIE 191, equation 4, found by itself
  for (int i = 0; i < 100; ++i) {
    const double mesopic = (m * 0.3 + (1 - m) * 0.3 * 1.4123 * v) / (m + (1 - m) * v);
    m = std::clamp(0.767 + 0.3334 * std::log10(mesopic), 0.0, 1.0);
  }
  expect_reading(read(adapted + lamp, 1024),
                 (m * photopic.mean + (1 - m) * v * scotopic.mean) / (m + (1 - m) * v));
  // V_M exceeds V at short wavelengths: at 440 nm 0.0379 against 0.023, at 555 nm they agree.
  const auto at = [](double nm, const std::string& quantity) {
    const std::string line =
        std::to_string(nm - 0.5) + ":0, " + std::to_string(nm) + ":1, " + std::to_string(nm + 0.5) + ":0";
    return read(
               receiver(quantity) + kFar +
                   "<emitter type='point'><point name='position' x='0' y='0' z='1'/><spectrum name='intensity' value='" +
                   line + "'/></emitter>",
               4096)
        .mean;
  };
  EXPECT_NEAR(at(440, "judd_vos_illuminance") / at(440, "illuminance"), 0.037900 / 0.023, 0.02);
  EXPECT_NEAR(at(555, "judd_vos_illuminance") / at(555, "illuminance"), 1, 0.005);
  EXPECT_NE(error(receiver("mesopic_illuminance") + lamp).find("adaptation_luminance"), std::string::npos);
}

}  // namespace
}  // namespace aureole::test
