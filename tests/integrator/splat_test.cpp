// SPDX-License-Identifier: Apache-2.0
// Splatting against the published formulas, written out plainly here in double precision, and against closed forms.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "aureole/core/image.h"
#include "aureole/integrator/splat/depth_sort.h"
#include "aureole/integrator/splat/splat_blend.h"
#include "aureole/loading/load.h"
#include "aureole/plugin/late_notes.h"
#include "aureole/render/job.h"
#include "medium/splat_test_support.h"

namespace aureole::test {
namespace {

using Row = std::array<double, 3>;

std::string splat_medium(const std::filesystem::path& file, const std::string& parameters = "") {
  return R"(<shape type="cube"><transform name="to_world"><scale value="50"/></transform><bsdf type="null"/>
    <medium type="splats" name="interior"><string name="filename" value=")" +
         file.string() + R"("/><string name="file_axes" value="RUB"/>)" + parameters + "</medium></shape>";
}

/// A camera at the origin that looks along +z, with x to the left of the picture and y up, and a focal length in pixels.
std::string camera(int width, int height, double focal, const std::string& more = "",
                   const std::string& target = "0, 0, 1") {
  const double fov = 2 * std::atan(0.5 * width / focal) * 180 / M_PI;
  return fmt::format(
      R"(<sensor type="perspective"><float name="fov" value="{:.17g}"/><string name="fov_axis" value="x"/>
    <transform name="to_world"><lookat origin="0, 0, 0" target="{}" up="0, 1, 0"/></transform>
    <film type="hdrfilm"><integer name="width" value="{}"/><integer name="height" value="{}"/><rfilter type="box"/></film>
    <sampler type="sobol"><integer name="sample_count" value="1"/></sampler>{}</sensor>)",
      fov, target, width, height, more);
}

LoadedScene scene_of(const std::string& integrator, const std::string& content) {
  return load_scene_from_string(R"(<scene version="3.0.0"><integrator type="splat">)" + integrator +
                                    "</integrator>" + content + "</scene>",
                                "splat.xml");
}

/// Colour and transmittance of the blended splats at the centres of pixels, as the integrator's channels give them.
struct Blended {
  int width, height;
  std::vector<SplatSample> pixels;
  const SplatSample& at(int x, int y) const { return pixels[std::size_t(y * width + x)]; }
};

/// Traces one path through the centre of each pixel.
Blended look(const LoadedScene& loaded) {
  const Scene& scene = *loaded.scene;
  loaded.integrator->require_scene(scene);
  Blended b{scene.film().width(), scene.film().height(), {}};
  for (int y = 0; y < b.height; ++y)
    for (int x = 0; x < b.width; ++x) {
      Path path;
      float aovs[5] = {};
      path.samples = SampleStream(scene.sensor().sampler(), 7, 0);
      path.wavelengths = scene.wavelengths().sample(0.5f);
      path.samples.set_first(SampleStream::camera_dimensions(false));
      path.film = {float(x) + 0.5f, float(y) + 0.5f};
      path.ray = scene.sensor().sample_ray(path.film, {}).ray;
      path.aovs = aovs;
      std::vector<Splat> splats;
      loaded.integrator->trace(scene, std::span(&path, 1), splats, {});
      SplatSample& s = b.pixels.emplace_back();
      std::copy_n(aovs, 3, s.color);
      s.transmittance = aovs[3], s.distance = aovs[4];
    }
  return b;
}
const char* const kMeasures = R"(<boolean name="measures" value="true"/>)";

std::vector<PlainSplat> random_splats(int count, unsigned seed, double near, double far, double width) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> normal;
  std::vector<PlainSplat> splats;
  for (int i = 0; i < count; ++i) {
    PlainSplat s;
    const double z = near + (far - near) * unit(random);
    s.position = {(unit(random) - 0.5) * width * z, (unit(random) - 0.5) * width * z, z};
    for (double& x : s.scale) x = 0.02 * z * std::exp(0.8 * normal(random));
    for (double& x : s.rotation) x = normal(random);
    s.opacity = 0.02 + 0.97 * unit(random);
    for (double& x : s.color) x = unit(random);
    for (int k = 0; k < 15; ++k)
      s.rest.push_back({0.1 * normal(random), 0.1 * normal(random), 0.1 * normal(random)});
    splats.push_back(s);
  }
  return splats;
}

/// The formulas of 3D Gaussian splatting (Kerbl and others 2023, appendix A; Zwicker and others 2001, EWA splatting), in the
/// axes of computer vision. The camera looks along z; x of the picture is -x of the world, y is -y.
struct Published {
  double focal, width, height, dilation = 0.3, near = 0.2, cap = 0.99, limit = 1. / 255, end = 1e-4,
                               cutoff = 10. / 3;
  bool by_distance = false;

  struct Projected {
    double x, y, xx, xy, yy, depth, opacity;
    Row color;
  };
  static Row times(const std::array<Row, 3>& m, const Row& v) {
    Row r{};
    for (std::size_t i = 0; i < 3; ++i) r[i] = m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];
    return r;
  }
  Projected project(const PlainSplat& s) const {
    std::array<double, 4> q = s.rotation;
    const double l = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (double& v : q) v /= l;
    const auto [w, x, y, z] = q;
    const std::array<Row, 3> r = {{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                                   {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                                   {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}};
    double sigma[3][3] = {};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        for (std::size_t k = 0; k < 3; ++k) sigma[i][j] += r[i][k] * s.scale[k] * s.scale[k] * r[j][k];
    const double px = -s.position[0], py = -s.position[1], pz = s.position[2];
    const double limit_x = 1.3 * 0.5 * width / focal, limit_y = 1.3 * 0.5 * height / focal;
    const double tx = std::clamp(px / pz, -limit_x, limit_x), ty = std::clamp(py / pz, -limit_y, limit_y);
    // J W, with W = diag(-1, -1, 1).
    const double jw[2][3] = {{-focal / pz, 0, -focal * tx / pz}, {0, -focal / pz, -focal * ty / pz}};
    double c[2][2] = {};
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j)
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < 3; ++b) c[i][j] += jw[i][a] * sigma[a][b] * jw[j][b];
    Projected p{0.5 * width + focal * px / pz,
                0.5 * height + focal * py / pz,
                c[0][0] + dilation,
                c[0][1],
                c[1][1] + dilation,
                by_distance ? std::hypot(px, py, pz) : pz,
                s.opacity,
                s.color};
    if (!s.rest.empty()) {
      // The functions of l = 1 to 3 by the associated Legendre functions with the Condon-Shortley phase, whose sign the
      // constants of the format have once more.
      const double n = std::hypot(px, py, pz), dx = s.position[0] / n, dy = s.position[1] / n,
                   dz = s.position[2] / n;
      const double theta = std::acos(dz), phi = std::atan2(dy, dx);
      std::size_t k = 0;
      for (int deg = 1; deg <= 3; ++deg)
        for (int m = -deg; m <= deg; ++m, ++k) {
          // std::sph_legendre includes the phase (-1)^m.
          double value = std::sph_legendre(unsigned(deg), unsigned(std::abs(m)), theta);
          if (m != 0) value *= std::sqrt(2.) * (m > 0 ? std::cos(m * phi) : std::sin(-m * phi));
          for (std::size_t i = 0; i < 3; ++i) p.color[i] += value * s.rest[k][i];
        }
    }
    for (double& v : p.color) v = std::max(v, 0.);
    return p;
  }
  double alpha(const Projected& p, double x, double y) const {
    const double det = p.xx * p.yy - p.xy * p.xy, dx = x - p.x, dy = y - p.y;
    const double power = -0.5 * (p.yy * dx * dx + p.xx * dy * dy) / det + p.xy * dx * dy / det;
    if (power < -0.5 * cutoff * cutoff) return 0;
    const double a = std::min(cap, p.opacity * std::exp(power));
    return a < limit ? 0 : a;
  }
  void picture(const std::vector<PlainSplat>& splats, std::vector<Row>& colors,
               std::vector<double>& left) const {
    std::vector<Projected> all;
    for (const PlainSplat& s : splats)
      if (s.position[2] > near) all.push_back(project(s));
    std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.depth < b.depth; });
    for (int y = 0; y < int(height); ++y)
      for (int x = 0; x < int(width); ++x) {
        Row sum{};
        double t = 1;
        for (const Projected& p : all) {
          const double a = alpha(p, x + 0.5, y + 0.5);
          if (a == 0) continue;
          if (t * (1 - a) < end) break;
          for (std::size_t k = 0; k < 3; ++k) sum[k] += p.color[k] * a * t;
          t *= 1 - a;
        }
        colors.push_back(sum), left.push_back(t);
      }
  }
};

/// The variances of a footprint, from its quadratic form.
Row covariance_of(const SplatFootprint& f) {
  const double a0 = double(f.a0), a1 = double(f.a1), b0 = double(f.b0), b1 = double(f.b1);
  const double xx = a0 * a0 + b0 * b0, xy = a0 * a1 + b0 * b1, yy = a1 * a1 + b1 * b1,
               det = xx * yy - xy * xy;
  return {yy / det, -xy / det, xx / det};
}

ProjectedSplats project(const LoadedScene& loaded, const std::string& settings = "") {
  const Scene& scene = *loaded.scene;
  std::vector<const SplatMedium*> media;
  for (const Medium* m : scene.media())
    if (const auto* s = dynamic_cast<const SplatMedium*>(m)) media.push_back(s);
  const auto made = scene_of(settings, camera(8, 8, 8));
  const SplatSettings s = SplatSettings::read(made.integrator->properties());
  return {media,
          s,
          SplatConventions::of(media, s, made.integrator->properties()),
          *scene.sensor().pinhole(),
          scene.sensor().part,
          0,
          0};
}

TEST(Splat, VariancesOfOneGaussian) {
  const SplatFolder folder;
  PlainSplat s;
  s.position = {0, 0, 2}, s.scale = {0.02, 0.02, 0.02};
  const auto first = [&](const std::string& settings = "") {
    const auto scene =
        scene_of("", camera(1000, 600, 500) + splat_medium(folder.write("one.ply", make_ply({s}))));
    const ProjectedSplats p = project(scene, settings);
    EXPECT_EQ(p.footprints().size(), 1u);
    return p.footprints()[0];
  };
  Row c = covariance_of(first());
  EXPECT_NEAR(c[0], 25.3, 1e-4);
  EXPECT_NEAR(c[1], 0, 1e-4);
  EXPECT_NEAR(c[2], 25.3, 1e-4);
  EXPECT_NEAR(first().x, 500, 1e-3);
  EXPECT_NEAR(first().y, 300, 1e-3);
  s.position = {1, 0, 2};  // x / z of 0.5, left of the centre
  c = covariance_of(first(R"(<float name="dilation" value="0"/>)"));
  EXPECT_NEAR(c[0], 31.25, 1e-4);
  EXPECT_NEAR(c[2], 25, 1e-4);
  EXPECT_NEAR(first().x, 250, 1e-3);
}

TEST(Splat, RedOverGreenOverWhite) {
  const SplatFolder folder;
  PlainSplat red, green;
  red.position = {0, 0, 2}, green.position = {0, 0, 3};
  red.scale = green.scale = {50, 50, 50};
  red.opacity = 0.6, green.opacity = 0.5, red.color = {1, 0, 0}, green.color = {0, 1, 0};
  for (const bool reversed : {false, true}) {
    const auto file = folder.write("two.ply", reversed ? make_ply({green, red}) : make_ply({red, green}));
    const auto scene = scene_of(std::string(kMeasures) + R"(<string name="background" value="1, 1, 1"/>)",
                                camera(3, 3, 1000) + splat_medium(file));
    const SplatSample s = look(scene).at(1, 1);
    EXPECT_NEAR(s.color[0] + s.transmittance, 0.8, 2e-6);
    EXPECT_NEAR(s.color[1] + s.transmittance, 0.4, 2e-6);
    EXPECT_NEAR(s.color[2] + s.transmittance, 0.2, 2e-6);
    EXPECT_NEAR(s.distance, 2, 1e-5);
  }
}

TEST(Splat, EachSplatAsPublished) {
  const SplatFolder folder;
  const Published published{.focal = 60, .width = 64, .height = 48};
  const auto splats = random_splats(60, 3, 0.5, 4, 1.6);
  double worst = 0;
  int visible = 0;
  for (const PlainSplat& s : splats) {
    const auto scene =
        scene_of(kMeasures, camera(64, 48, 60) + splat_medium(folder.write("one.ply", make_ply({s}))));
    const Blended seen = look(scene);
    const auto p = published.project(s);
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 64; ++x) {
        const double a = published.alpha(p, x + 0.5, y + 0.5);
        // At the threshold of 1/255 a rounding error decides whether a splat is seen.
        if (a > 0 && a < 1.001 / 255) continue;
        const SplatSample& pixel = seen.at(x, y);
        if (a == 0 && pixel.transmittance > 1 - 1.001 / 255) continue;
        ++visible;
        worst = std::max(worst, std::abs(double(1 - pixel.transmittance) - a));
        for (std::size_t k = 0; k < 3; ++k)
          worst = std::max(worst, std::abs(double(pixel.color[k]) - a * p.color[k]));
      }
  }
  EXPECT_GT(visible, 1000);
  EXPECT_LT(worst, 1e-5);
}

TEST(Splat, PicturesAsPublished) {
  const SplatFolder folder;
  const auto splats = random_splats(600, 8, 0.3, 5, 1.8);
  const auto file = folder.write("many.ply", make_ply(splats));
  for (const bool by_distance : {false, true}) {
    const Published published{.focal = 60, .width = 64, .height = 48, .by_distance = by_distance};
    std::vector<Row> colors;
    std::vector<double> left;
    published.picture(splats, colors, left);
    const auto scene = scene_of(
        std::string(kMeasures) + (by_distance ? R"(<string name="sorting" value="camera_distance"/>)" : ""),
        camera(64, 48, 60) + splat_medium(file));
    const Blended seen = look(scene);
    double worst = 0, mean = 0, other = 0;
    for (std::size_t i = 0; i < left.size(); ++i) {
      double difference = std::abs(double(seen.pixels[i].transmittance) - left[i]);
      for (std::size_t k = 0; k < 3; ++k)
        difference = std::max(difference, std::abs(double(seen.pixels[i].color[k]) - colors[i][k]));
      worst = std::max(worst, difference), mean += difference / double(left.size()), other += 1 - left[i];
    }
    EXPECT_LT(worst, 4.5e-3);  // of one splat at the threshold of 1/255
    EXPECT_LT(mean, 1e-4);
    EXPECT_GT(other / double(left.size()), 0.4);
  }
}

TEST(Splat, OrdersOfSortingDiffer) {
  // Off the axis one splat is nearer in depth, the other one in distance.
  const SplatFolder folder;
  PlainSplat a, b;
  a.position = {2, 0, 2}, b.position = {1.05, 0, 2.1};
  a.scale = b.scale = {10, 10, 10}, a.opacity = b.opacity = 0.9;
  a.color = {1, 0, 0}, b.color = {0, 0, 1};
  const std::string content = camera(3, 3, 1000) + splat_medium(folder.write("ab.ply", make_ply({a, b})));
  const auto red = [&](const char* sorting) {
    return look(scene_of(std::string(kMeasures) + R"(<string name="sorting" value=")" + sorting + R"("/>)",
                         content))
        .at(1, 1)
        .color[0];
  };
  EXPECT_GT(red("z_depth"), 0.8f);
  EXPECT_LT(red("camera_distance"), 0.1f);
  EXPECT_EQ(red("file"), red("z_depth"));
}

TEST(Splat, TangentialDoesNotDependOnTheCamerasAxis) {
  const SplatFolder folder;
  PlainSplat s;
  s.position = {0.8, 0, 2}, s.scale = {0.3, 0.05, 0.2}, s.rotation = {0.9, 0.2, 0.3, -0.1}, s.opacity = 0.9;
  const std::string medium = splat_medium(folder.write("one.ply", make_ply({s})));
  // The opacity along fixed rays, by a camera that looks along z and by one that looks at the splat.
  const auto along = [&](const char* projection, const char* target) {
    const auto scene = scene_of(std::string(kMeasures) +
                                    R"(<float name="dilation" value="0"/><string name="projection" value=")" +
                                    projection + R"("/>)",
                                camera(400, 400, 200, "", target) + medium);
    std::vector<double> opacities;
    for (const Vec3 d :
         {Vec3{0.8f, 0, 2}, Vec3{0.7f, 0.05f, 2}, Vec3{0.95f, -0.03f, 2}, Vec3{1.2f, 0.02f, 2.2f}}) {
      const Vec3 q = scene.scene->sensor().pinhole()->to_camera.point(d);
      const PinholeView view = *scene.scene->sensor().pinhole();
      SplatSample sample;
      sample.film = {view.center.x + view.focal * q.x / q.z, view.center.y + view.focal * q.y / q.z};
      const ProjectedSplats splats =
          project(scene, R"(<float name="dilation" value="0"/><string name="projection" value=")" +
                             std::string(projection) + R"("/>)");
      const auto made = scene_of(R"(<string name="projection" value=")" + std::string(projection) + R"("/>)",
                                 camera(8, 8, 8));
      blend_splats(splats, SplatSettings::read(made.integrator->properties()), {&sample, 1});
      opacities.push_back(1 - double(sample.transmittance));
    }
    return opacities;
  };
  const auto straight = along("tangential", "0, 0, 1"), turned = along("tangential", "0.8, 0, 2");
  double most = 0;
  for (std::size_t i = 0; i < straight.size(); ++i) EXPECT_NEAR(straight[i], turned[i], 2e-5) << i;
  const auto flat = along("perspective", "0, 0, 1"), flat_turned = along("perspective", "0.8, 0, 2");
  for (std::size_t i = 0; i < flat.size(); ++i) most = std::max(most, std::abs(flat[i] - flat_turned[i]));
  EXPECT_GT(most, 0.01);  // linearised about the centre, the picture depends on the axis
  EXPECT_NEAR(flat[0], straight[0], 1e-5);
}

/// A square lattice of points in the plane z = 2, `pixels` apart.
std::string lattice(int n, double pixels, double focal, double radius_pixels, bool alternates) {
  std::string s = fmt::format(
      "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\n"
      "property float ny\nproperty float nz\nproperty float radius\nproperty float red\nproperty float green\nproperty float "
      "blue\nend_header\n",
      n * n);
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const double color = alternates ? (x * 7 + y * 3) % 5 * 0.2 : 0.4;
      s += fmt::format("{:.9g} {:.9g} 2 0 0 -1 {:.9g} {} {} 0.5\n", -(x - n / 2) * pixels * 2 / focal,
                       -(y - n / 2) * pixels * 2 / focal, radius_pixels * 2 / focal, color, 0.25);
    }
  return s;
}

TEST(Splat, HolesOfPointsAreFilledAndAConstantStays) {
  const SplatFolder folder;
  const std::string content =
      camera(32, 32, 100) + splat_medium(folder.write("grid.ply", lattice(30, 3, 100, 2.5, false)));
  for (const char* footprint : {"point", "disc", "gaussian", "ewa"}) {
    const Blended seen = look(scene_of(
        std::string(kMeasures) + R"(<string name="footprint" value=")" + footprint + R"("/>)", content));
    int holes = 0;
    for (const SplatSample& s : seen.pixels) {
      if (s.transmittance > 0) {
        ++holes;
        continue;
      }
      EXPECT_NEAR(s.color[0], 0.4, 1e-6) << footprint;
      EXPECT_NEAR(s.color[1], 0.25, 1e-6) << footprint;
    }
    if (std::string(footprint) == "point")
      EXPECT_NEAR(holes, 32 * 32 * 8 / 9, 40);
    else
      EXPECT_EQ(holes, 0) << footprint;
  }
}

TEST(Splat, IdenticalFootprintsAreOneConvolution) {
  const SplatFolder folder;
  const int n = 20;
  const std::string content =
      camera(32, 32, 100) + splat_medium(folder.write("grid.ply", lattice(n, 2, 100, 1.5, true)));
  const std::string integrator =
      std::string(kMeasures) +
      R"(<string name="footprint" value="gaussian"/><float name="cutoff" value="6"/>
      <string name="normalization" value="none"/>)";
  const Blended seen = look(scene_of(integrator, content));
  // An image of impulses, at the pixels' corners, convolved with the sampled kernel.
  std::vector<double> impulses(33 * 33, 0);
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const int px = 16 + (x - n / 2) * 2, py = 16 + (y - n / 2) * 2;
      if (px >= 0 && px < 33 && py >= 0 && py < 33)
        impulses[std::size_t(py * 33 + px)] += (x * 7 + y * 3) % 5 * 0.2;
    }
  for (int y = 9; y < 23; ++y)
    for (int x = 9; x < 23; ++x) {
      double sum = 0;
      for (int j = 0; j < 33; ++j)
        for (int i = 0; i < 33; ++i) {
          const double dx = x + 0.5 - i, dy = y + 0.5 - j, d2 = (dx * dx + dy * dy) / (1.5 * 1.5);
          if (d2 <= 36) sum += impulses[std::size_t(j * 33 + i)] * std::exp(-0.5 * d2);
        }
      EXPECT_NEAR(seen.at(x, y).color[0], sum, 2e-5 * (1 + sum)) << x << " " << y;
    }
}

TEST(Splat, EwaIsTheGaussianOfTheTiltedDisc) {
  // Zwicker and others 2001, equation 10: J V J^T + I, with a disc that is tilted by 60 degrees about x.
  const SplatFolder folder;
  const double c = std::cos(M_PI / 3), s = std::sin(M_PI / 3);
  const std::string ply = fmt::format(
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\n"
      "property float ny\nproperty float nz\nproperty float radius\nend_header\n0 0 2 0 {} {} 0.1\n",
      s, -c);
  const auto scene = scene_of("", camera(64, 64, 200) + splat_medium(folder.write("disc.ply", ply)));
  const ProjectedSplats p = project(scene, R"(<string name="footprint" value="ewa"/>)");
  ASSERT_EQ(p.footprints().size(), 1u);
  const Row v = covariance_of(p.footprints()[0]);
  EXPECT_NEAR(v[0], 101, 1e-3);
  EXPECT_NEAR(v[2], 100 * c * c + 1, 1e-3);
  EXPECT_NEAR(p.footprints()[0].weight, std::sqrt(100 * 25. / (101 * 26)), 1e-5);
}

TEST(Splat, SurfacesHideSplatsAndAreHidden) {
  const SplatFolder folder;
  PlainSplat s;
  s.position = {0, 0, 4}, s.scale = {20, 20, 0.01}, s.opacity = 0.75, s.color = {1, 1, 1};
  const std::string medium = splat_medium(folder.write("one.ply", make_ply({s})));
  const auto light = [&](double z) {
    const std::string wall = fmt::format(
        R"(<shape type="rectangle"><transform name="to_world"><rotate y="1" angle="180"/><scale value="5"/><translate z="{}"/></transform>
      <bsdf type="diffuse"><float name="reflectance" value="0"/></bsdf><emitter type="area"><float name="radiance" value="0"/></emitter></shape>)",
        z);
    return look(scene_of(std::string(kMeasures) + R"(<integrator type="direct"/>)",
                         camera(3, 3, 100) + wall + medium))
        .at(1, 1);
  };
  EXPECT_NEAR(light(5).transmittance, 0.25, 1e-5);
  EXPECT_EQ(light(3).transmittance, 1);
  EXPECT_EQ(light(3).color[0], 0);
}

TEST(Splat, PicturesDoNotDependOnThreads) {
  const SplatFolder folder;
  const auto file = folder.write("many.ply", make_ply(random_splats(3000, 21, 0.5, 5, 1.5)));
  std::vector<std::vector<double>> pictures;
  for (const int threads : {1, 2, 5}) {
    RenderOptions options;
    options.threads = threads;
    options.end = 2;
    RenderJob job(scene_of("", camera(70, 50, 60) + splat_medium(file)), options);
    ASSERT_EQ(job.run(std::atomic<bool>(false)), RenderJob::Outcome::finished);
    std::vector<double>& all = pictures.emplace_back();
    for (int y = 0; y < 50; ++y)
      for (int x = 0; x < 70; ++x) {
        double channels[3], alpha;
        job.state().films[0].mean(x, y, channels, &alpha);
        all.insert(all.end(), {channels[0], channels[1], channels[2], alpha});
      }
  }
  EXPECT_GT(*std::max_element(pictures[0].begin(), pictures[0].end()), 0.5);
  EXPECT_EQ(pictures[0], pictures[1]);
  EXPECT_EQ(pictures[0], pictures[2]);
}

/// The notes of a scene that contain `part`.
std::size_t count_notes(const LoadedScene& scene, const std::string& part) {
  return std::size_t(std::count_if(scene.notes.begin(), scene.notes.end(), [&](const std::string& note) {
    return note.find(part) != note.npos && note.find("splat.xml:") != note.npos;
  }));
}

TEST(Splat, NotesOnSplatsThatAreNotSeen) {
  const SplatFolder folder;
  // A disc that is seen along its plane has no area without dilation.
  const auto flat =
      folder.write("flat.ply", make_ply({PlainSplat{.position = {0, 0, 2}, .scale = {0, 0.2, 0.2}},
                                         PlainSplat{.position = {0.1, 0, 2}}}));
  const std::string view = camera(8, 8, 8), no_dilation = R"(<float name="dilation" value="0"/>)";
  const auto seen = scene_of(no_dilation, splat_medium(flat) + view);
  EXPECT_EQ(count_notes(seen, "1 splats have a projection without area"), 1u) << seen.notes.size();
  EXPECT_EQ(count_notes(scene_of("", splat_medium(flat) + view), "without area"), 0u);
  const auto behind = folder.write("behind.ply", make_ply({PlainSplat{.position = {0, 0, -2}}}));
  EXPECT_EQ(count_notes(scene_of("", splat_medium(behind) + view), "none of the splats is seen"), 1u);
  EXPECT_EQ(count_notes(scene_of("", splat_medium(flat) + view), "none of the splats is seen"), 0u);
  const std::string orthographic = R"(<sensor type="orthographic"><film type="hdrfilm"/></sensor>)";
  const auto rays =
      scene_of(R"(<string name="sorting" value="z_depth"/>)", splat_medium(flat) + orthographic);
  EXPECT_EQ(count_notes(rays, "this sensor follows splats by rays"), 1u);
}

TEST(Splat, NotesOnTheMediumAreThoseOfIntegratorsThatFollowIt) {
  const SplatFolder folder;
  const auto file =
      folder.write("thin.ply", make_ply({PlainSplat{.position = {0, 0, 2}, .scale = {0.2, 0.2, 1e-4}}}));
  const std::string content = splat_medium(file) + camera(8, 8, 8);
  const auto notes = [&](const std::string& integrator, const std::string& more = "") {
    return count_notes(load_scene_from_string(R"(<scene version="3.0.0"><integrator type=")" + integrator +
                                                  "</integrator>" + content + more + "</scene>",
                                              "splat.xml"),
                       "1 of 1 splats are thinner than 1/100");
  };
  EXPECT_EQ(notes(R"(path">)"), 1u);
  EXPECT_EQ(notes(R"(moment"><integrator type="direct"/>)"), 1u);
  EXPECT_EQ(notes(R"(depth">)"), 0u);
  EXPECT_EQ(notes(R"(splat">)"), 0u);
  // A surface behind is lit through the medium.
  EXPECT_EQ(notes(R"(splat">)", R"(<shape type="rectangle"/>)"), 1u);
  EXPECT_EQ(notes(R"(splat"><string name="background" value="1, 1, 1"/>)", R"(<shape type="rectangle"/>)"),
            0u);
}

TEST(Splat, NoNoteIsLostAfterLoading) {
  const SplatFolder folder;
  const auto file = folder.write("one.ply", make_ply({PlainSplat{.position = {0, 0, 2}}}));
  const auto scene = scene_of("", splat_medium(file) + camera(8, 8, 8));
  EXPECT_THROW(scene.integrator->properties().note("", "too late"), std::logic_error);
  EXPECT_THROW(scene.scene->media().front()->properties().note("filename", "too late"), std::logic_error);
  const std::string text = note_text(scene.integrator->properties(), "", "in time");
  EXPECT_NE(text.find("splat.xml:"), std::string::npos) << text;
  EXPECT_NE(text.find("in time"), std::string::npos) << text;
}

TEST(Splat, SortsByDepth) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> depth(1e-3f, 1e4f);
  for (const std::size_t n : {0u, 1u, 2u, 1000u, 200000u}) {
    std::vector<float> depths(n);
    for (float& d : depths) d = n > 1000 ? std::floor(depth(random)) + 1 : depth(random);  // many are equal
    const auto order = sort_by_depth(depths);
    std::vector<std::uint32_t> expected(n);
    for (std::size_t i = 0; i < n; ++i) expected[i] = std::uint32_t(i);
    std::stable_sort(expected.begin(), expected.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return depths[a] < depths[b]; });
    EXPECT_TRUE(std::equal(order.begin(), order.end(), expected.begin(), expected.end())) << n;
  }
}

std::string splat_error(const std::string& integrator, const std::string& content) {
  try {
    const auto scene = scene_of(integrator, content);
    scene.integrator->require_scene(*scene.scene);
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

TEST(Splat, ScenesThatItCannotShow) {
  const SplatFolder folder;
  const auto file = folder.write("one.ply", make_ply({PlainSplat{.position = {0, 0, 2}}}));
  const std::string medium = splat_medium(file), view = camera(8, 8, 8);
  const auto expect = [](const std::string& error, const char* part) {
    EXPECT_NE(error.find(part), std::string::npos) << error;
    EXPECT_NE(error.find("splat.xml:"), std::string::npos) << error;
  };
  expect(splat_error("", view), "and the scene has none");
  expect(splat_error(R"(<string name="method" value="projection"/>)",
                     medium + R"(<sensor type="orthographic"><film type="hdrfilm"/></sensor>)"),
         "use the sensor \"perspective\"");
  expect(
      splat_error(
          "",
          view + medium +
              R"(<shape type="sphere"><bsdf type="null"/><medium type="homogeneous" name="interior"/></shape>)"),
      "this one would not be seen");
  expect(splat_error(R"(<float name="depth_range" value="1"/>)", view + medium),
         "has no effect on this footprint");
  expect(splat_error(R"(<string name="footprint" value="ewa"/><float name="opacity_cap" value="1"/>)",
                     view + medium),
         "has no effect on this footprint");
  const auto points =
      folder.write("points.ply",
                   "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                   "property float z\nend_header\n0 0 2\n");
  expect(splat_error(R"(<string name="footprint" value="disc"/>)", view + splat_medium(points)),
         "state their radius");
  expect(splat_error("", view + splat_medium(folder.write("bad.ply", "ply\n"))), "its header does not end");
}

/// Sensors without a single centre of projection follow splats by rays.
std::string orthographic(int width, int height) {
  return fmt::format(
      R"(<sensor type="orthographic"><transform name="to_world"><lookat origin="0, 0, 0" target="0, 0, 1" up="0, 1, 0"/></transform>
    <film type="hdrfilm"><integer name="width" value="{}"/><integer name="height" value="{}"/><rfilter type="box"/></film>
    <sampler type="sobol"><integer name="sample_count" value="1"/></sampler></sensor>)",
      width, height);
}

TEST(Splat, RaysSeeTheLargestValueOfAGaussian) {
  // One splat before an orthographic camera, with a turned axis: along z the Gaussian's marginal is its conditional peak.
  const SplatFolder folder;
  PlainSplat s;
  s.position = {0.1, -0.2, 3}, s.scale = {0.3, 0.15, 0.4}, s.opacity = 0.8, s.color = {0.9, 0.4, 0.2};
  s.rotation = {0.8, 0.3, -0.4, 0.2};
  const Blended b =
      look(scene_of(kMeasures, orthographic(24, 24) + splat_medium(folder.write("s.ply", make_ply({s})))));
  // The inverse covariance, and the minimum over z of its quadratic form.
  auto [w, x, y, z] = s.rotation;
  const double l = std::sqrt(w * w + x * x + y * y + z * z);
  w /= l, x /= l, y /= l, z /= l;
  const double r[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                          {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                          {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
  double p[3][3] = {};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (std::size_t k = 0; k < 3; ++k) p[i][j] += r[i][k] * r[j][k] / (s.scale[k] * s.scale[k]);
  double most = 0;
  for (int py = 0; py < 24; ++py)
    for (int px = 0; px < 24; ++px) {
      const double dx = -((px + 0.5) / 12 - 1) - 0.1, dy = -((py + 0.5) / 12 - 1) + 0.2;
      const double dz = -(p[0][2] * dx + p[1][2] * dy) / p[2][2];
      const double form = p[0][0] * dx * dx + p[1][1] * dy * dy + p[2][2] * dz * dz +
                          2 * (p[0][1] * dx * dy + p[0][2] * dx * dz + p[1][2] * dy * dz);
      const double alpha = 0.8 * std::exp(-0.5 * form);
      const SplatSample& found = b.at(px, py);
      if (std::abs(alpha - 1. / 255) < 1e-4) continue;
      const double expected = alpha > 1. / 255 ? alpha : 0;
      EXPECT_NEAR(1 - found.transmittance, expected, 2e-5) << px << " " << py;
      EXPECT_NEAR(found.color[1], 0.4 * expected, 2e-5);
      most = std::max(most, expected);
    }
  EXPECT_GT(most, 0.7);
}

TEST(Splat, RaysAndProjectionAgreeOnSmallSplats) {
  const SplatFolder folder;
  auto splats = random_splats(3000, 17, 2, 8, 0.8);
  for (auto& s : splats) {
    for (double& x : s.scale) x *= 0.15;
    s.rest.clear();
  }
  const std::string medium = splat_medium(folder.write("s.ply", make_ply(splats)));
  const Blended rays = look(scene_of(std::string(kMeasures) + R"(<string name="method" value="rays"/>)",
                                     camera(96, 64, 400) + medium));
  const Blended projected = look(scene_of(
      std::string(kMeasures) +
          R"(<float name="dilation" value="0"/><string name="projection" value="tangential"/><string name="sorting" value="camera_distance"/>)",
      camera(96, 64, 400) + medium));
  double sum = 0, covered = 0;
  for (std::size_t i = 0; i < rays.pixels.size(); ++i) {
    for (int k = 0; k < 3; ++k)
      sum += std::abs(double(rays.pixels[i].color[k]) - double(projected.pixels[i].color[k]));
    covered += 1 - double(projected.pixels[i].transmittance);
  }
  EXPECT_GT(covered / double(rays.pixels.size()), 0.2);
  EXPECT_LT(sum / double(3 * rays.pixels.size()), 2e-3);
}

TEST(Splat, SensorsThatCannotProject) {
  const SplatFolder folder;
  const auto file = folder.write("s.ply", make_ply(random_splats(20, 3, 2, 4, 0.5)));
  const std::string content = orthographic(4, 4) + splat_medium(file);
  const auto fault = [&](const std::string& integrator) -> std::string {
    try {
      look(scene_of(kMeasures + integrator, content));
    } catch (const Error& problem) {
      return problem.what();
    }
    return "";
  };
  EXPECT_EQ(fault(""), "");
  EXPECT_NE(fault(R"(<string name="method" value="projection"/>)").find("or the method \"rays\""),
            std::string::npos);
  EXPECT_NE(fault(R"(<string name="footprint" value="disc"/>)").find("use the sensor \"perspective\""),
            std::string::npos);
  EXPECT_NE(fault(R"(<string name="method" value="rays"/><float name="dilation" value="1"/>)")
                .find("has no effect on rays"),
            std::string::npos);
}

}  // namespace
}  // namespace aureole::test
