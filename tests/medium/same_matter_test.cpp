// SPDX-License-Identifier: Apache-2.0
// Random scenes of the same matter, described in different ways: as one block or as several that touch or overlap,
// with priorities or without, as shapes or as instances of a group, as a cube or as a mesh of many triangles, in
// other units of length. Their pictures differ by noise alone. The seed is made from the commit; AUREOLE_SEED
// states another one.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>

#include "aureole/loading/load.h"
#include "aureole/render/job.h"
#include "harness/effort.h"
#include "harness/paths.h"
#include "harness/rendered.h"
#include "medium/scene_text.h"

namespace aureole::testing {
namespace {

std::uint64_t seed_of_commit() {
  if (const char* stated = std::getenv("AUREOLE_SEED")) return std::strtoull(stated, nullptr, 10);
  std::uint64_t seed = 1;
  if (FILE* out = popen((test::source_dir() / "tools/with_fuzz_seed.sh").c_str(), "r")) {
    unsigned long long read;
    if (std::fscanf(out, "%llu", &read) == 1) seed = read;
    pclose(out);
  }
  return seed;
}

struct Box {
  double from[3], to[3];
};

/// One random scene: a box of some matter, maybe with another one within, and what surrounds it.
class RandomScene {
public:
  RandomScene(std::uint64_t seed, std::string folder) : random_(seed), folder_(std::move(folder)) {
    for (int k = 0; k < 3; ++k) box_.from[k] = -uniform(0.4, 1.5), box_.to[k] = uniform(0.4, 1.5);
    index_ = uniform(1.2, 1.7);
    boundary_ = pick({"null", "dielectric", "roughdielectric"});
    alpha_ = uniform(0.1, 0.5);
    sigma_ = std::exp(uniform(-1.5, 1.2)), albedo_ = uniform(0, 0.98), g_ = uniform(-0.5, 0.8);
    has_core_ = chance(0.4);
    core_sigma_ = uniform(0.2, 4), core_albedo_ = uniform(0, 0.95);
    // Next-event estimation cannot pass an index: a point lamp would be black within.
    has_lamp_ = boundary_ == "null" && chance(0.5);
    has_floor_ = chance(0.5);
    is_inside_ = chance(0.3);
    integrator_ = pick({"path", "path", "bdpt"});
    for (double& x : eye_) x = uniform(-1, 1);
    if (has_floor_) eye_[2] = std::abs(eye_[2]);
  }

  /// The scene with its box as one cube.
  std::string plain() { return frame(1) + cube(box_, 1, matter(1)) + rest(1); }

  /// The scene with the box described in another way, which `what` names.
  std::string other(std::string& what) {
    const int kind = int(uniform(0, 7));
    const double unit = chance(0.5) ? 1 : std::exp(uniform(-3, 3));
    std::string shapes;
    if (kind == 0) {
      what = "touching";
      for (const Box& part : split(0)) shapes += cube(part, unit, matter(unit));
    } else if (kind == 1) {
      what = "overlapping";
      for (const Box& part : split(uniform(0.01, 0.2))) shapes += cube(part, unit, matter(unit));
    } else if (kind == 2) {
      what = "overlapping, with priorities";
      int priority = int(uniform(1, 4));
      for (const Box& part : split(uniform(0.01, 0.2)))
        shapes += cube(part, unit,
                       matter(unit) + "<integer name=\"priority\" value=\"" +
                           std::to_string(priority = priority % 5 + 1) + "\"/>");
    } else if (kind == 3) {
      what = "instance";
      shapes = instance(cube(box_, unit, matter(unit)));
    } else if (kind == 4) {
      what = "touching instances";
      const std::vector<Box> parts = split(0);
      for (std::size_t i = 0; i < parts.size(); ++i)
        shapes += instance(cube(parts[i], unit, matter(unit)), "group" + std::to_string(i));
    } else if (kind == 5) {
      what = "mesh";
      shapes = mesh(box_, unit);
    } else {
      what = "touching meshes and cubes";
      bool as_mesh = false;
      for (const Box& part : split(0))
        shapes += (as_mesh = !as_mesh) ? mesh(part, unit) : cube(part, unit, matter(unit));
    }
    what += ", " + boundary_ + ", " + integrator_ + ", unit " + number(unit);
    // Other random numbers than those of the plain scene, since the same ones would follow nearly the same paths.
    std::string begin = frame(unit);
    begin.insert(begin.find("<integer name=\"sample_count\""), "<integer name=\"seed\" value=\"1\"/>");
    return begin + shapes + rest(unit);
  }

private:
  double uniform(double from, double to) {
    return from + (to - from) * (double(random_()) / 18446744073709551616.0);
  }
  bool chance(double p) { return uniform(0, 1) < p; }
  std::string pick(std::initializer_list<const char*> from) {
    return *(from.begin() + std::ptrdiff_t(uniform(0, double(from.size()))));
  }

  std::string frame(double unit) const {
    const double reach = is_inside_ ? 0.3 : 4;
    const auto place = [&](double scale) {
      std::string text;
      for (int k = 0; k < 3; ++k) text += (k ? ", " : "") + number(eye_[k] * scale * unit);
      return text;
    };
    const double size = std::sqrt(eye_[0] * eye_[0] + eye_[1] * eye_[1] + eye_[2] * eye_[2]);
    return "<integrator type=\"" + integrator_ + "\"/><sensor type=\"perspective\">" + parameter("fov", 30) +
           parameter("near_clip", 1e-6 * unit) + "<transform name=\"to_world\"><lookat origin=\"" +
           place(reach / size) + "\" target=\"" + place(is_inside_ ? -1 : 0) +
           "\" up=\"0.1, 1, 0.2\"/></transform>" + film(2, test::effort(48, 1024)) + "</sensor>";
  }
  std::string rest(double unit) const {
    std::string all = "<emitter type=\"constant\"/>";
    if (has_lamp_)
      all += "<emitter type=\"point\"><point name=\"position\" x=\"" + number(2.5 * unit) + "\" y=\"" +
             number(2 * unit) + "\" z=\"" + number(unit) + "\"/>" + parameter("intensity", 4 * unit * unit) +
             "</emitter>";
    if (has_floor_)
      all += "<shape type=\"rectangle\"><transform name=\"to_world\"><scale value=\"" + number(5 * unit) +
             "\"/><translate z=\"" + number(-2 * unit) + "\"/></transform><bsdf type=\"diffuse\"/></shape>";
    if (has_core_) {
      const std::string core = "<shape type=\"cube\"><transform name=\"to_world\"><scale value=\"" +
                               number(0.25 * unit) + "\"/></transform>" + kNull;
      std::string outside = medium_of(sigma_, albedo_, g_, unit);
      outside.replace(outside.find("interior"), 8, "exterior");
      all += core + medium_of(core_sigma_, core_albedo_, 0, unit) + outside + "</shape>";
    }
    return all;
  }
  static std::string medium_of(double sigma, double albedo, double g, double unit) {
    return medium(sigma * (1 - albedo) / unit, sigma * albedo / unit, g);
  }
  std::string matter(double unit) const {
    std::string bsdf = "<bsdf type=\"" + boundary_ + "\">";
    if (boundary_ != "null") bsdf += parameter("int_ior", index_) + parameter("ext_ior", 1);
    if (boundary_ == "roughdielectric") bsdf += parameter("alpha", alpha_);
    return bsdf + "</bsdf>" + medium_of(sigma_, albedo_, g_, unit);
  }
  static std::string cube(const Box& box, double unit, const std::string& content) {
    std::string scale, translate;
    for (int k = 0; k < 3; ++k) {
      const std::string axis(1, "xyz"[k]);
      scale += " " + axis + "=\"" + number(unit * (box.to[k] - box.from[k]) / 2) + "\"";
      translate += " " + axis + "=\"" + number(unit * (box.to[k] + box.from[k]) / 2) + "\"";
    }
    return "<shape type=\"cube\"><transform name=\"to_world\"><scale" + scale + "/><translate" + translate +
           "/></transform>" + content + "</shape>";
  }
  static std::string instance(const std::string& shapes, const std::string& name = "group") {
    return "<shape type=\"shapegroup\" id=\"" + name + "\">" + shapes +
           "</shape><shape type=\"instance\"><ref id=\"" + name + "\"/></shape>";
  }
  /// The box as a mesh, each face of n x n squares.
  std::string mesh(const Box& box, double unit) {
    const int n = int(uniform(1, 6));
    const std::string file = folder_ + "/box" + std::to_string(files_++) + ".obj";
    std::ofstream out(file);
    out.precision(9);
    int vertices = 0;
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        for (int i = 0; i <= n; ++i)
          for (int j = 0; j <= n; ++j) {
            double p[3];
            p[axis] = side ? box.to[axis] : box.from[axis];
            p[u] = i == n ? box.to[u] : box.from[u] + (box.to[u] - box.from[u]) * i / n;
            p[v] = j == n ? box.to[v] : box.from[v] + (box.to[v] - box.from[v]) * j / n;
            out << "v " << unit * p[0] << ' ' << unit * p[1] << ' ' << unit * p[2] << '\n';
          }
        for (int i = 0; i < n; ++i)
          for (int j = 0; j < n; ++j) {
            const int a = vertices + i * (n + 1) + j + 1, b = a + n + 1;
            out << "f " << a << ' ';
            if (side)
              out << b << ' ' << b + 1 << ' ' << a + 1 << '\n';
            else
              out << a + 1 << ' ' << b + 1 << ' ' << b << '\n';
          }
        vertices += (n + 1) * (n + 1);
      }
    return "<shape type=\"obj\"><string name=\"filename\" value=\"" + file +
           "\"/><boolean name=\"face_normals\" value=\"true\"/>" + matter(unit) + "</shape>";
  }
  /// The box in two to four parts along an axis, which overlap by that length. The core lies within one part.
  std::vector<Box> split(double overlap) {
    const int axis = int(uniform(0, 3)), count = int(uniform(2, 5));
    std::vector<double> cuts;
    for (int i = 1; i < count; ++i) {
      const double from = box_.from[axis], to = box_.to[axis];
      // Not through the core.
      const double at = has_core_
                            ? (chance(0.5) || to - 0.02 < 0.28 + overlap ? uniform(from + 0.02, -0.26)
                                                                         : uniform(0.27 + overlap, to - 0.02))
                            : uniform(from + 0.02, to - 0.02);
      cuts.push_back(at);
    }
    std::sort(cuts.begin(), cuts.end());
    std::vector<Box> parts;
    double from = box_.from[axis];
    for (const double cut : cuts) {
      Box part = box_;
      part.from[axis] = from, part.to[axis] = cut;
      parts.push_back(part);
      from = std::max(cut - overlap, box_.from[axis]);
    }
    Box last = box_;
    last.from[axis] = from;
    parts.push_back(last);
    return parts;
  }

  std::mt19937_64 random_;
  std::string folder_;
  int files_ = 0;
  Box box_;
  double index_, alpha_, sigma_, albedo_, g_, core_sigma_, core_albedo_, eye_[3];
  bool has_core_, has_lamp_, has_floor_, is_inside_;
  std::string boundary_, integrator_;
};

TEST(SameMatter, IsTheSamePictureHoweverItIsDescribed) {
  const std::uint64_t seed = seed_of_commit();
  const std::string folder =
      (std::filesystem::temp_directory_path() / ("aureole_same_matter_" + std::to_string(getpid()))).string();
  std::filesystem::create_directories(folder);
  const int scenes = test::kSanitized ? 20 : 200;
  // A difference of two means of 16 pictures each exceeds this many standard errors once in some 1e6 (Student's
  // distribution of 30 degrees of freedom).
  constexpr double kMostErrors = 6;
  double squares = 0;
  for (int i = 0; i < scenes; ++i) {
    RandomScene scene(seed + std::uint64_t(i) * 0x9e3779b97f4a7c15ull, folder);
    std::string what;
    const Picture plain = render(scene.plain());
    const std::string text = scene.other(what);
    const Picture other = render(text);
    const double error = std::hypot(plain.all_error, other.all_error);
    const double z = error > 0 ? (plain.all - other.all) / error : 0;
    squares += z * z / scenes;
    if (test::kSanitized) continue;
    EXPECT_LE(std::abs(plain.all - other.all), kMostErrors * error + 1e-5 * plain.all)
        << "AUREOLE_SEED=" << seed << ", scene " << i << ": " << what << "\n"
        << text << "\nagainst\n"
        << scene.plain();
  }
  // The mean of z^2 is 30/28 with a standard deviation of some 0.12.
  if (!test::kSanitized) {
    EXPECT_LT(squares, 1.6);
  }
  if (!::testing::Test::HasFailure()) std::filesystem::remove_all(folder);
}

// A layer has the coefficients that give it one optical thickness, whatever its own thickness: a film of some
// millionths of its width, or a slab.
TEST(SameMatter, FilmsScatterAsSlabsDo) {
  std::mt19937_64 random(seed_of_commit());
  const auto uniform = [&](double from, double to) {
    return from + (to - from) * (double(random()) / 18446744073709551616.0);
  };
  double squares = 0;
  const int layers = test::kSanitized ? 3 : 20;
  for (int i = 0; i < layers; ++i) {
    const double tau = std::exp(uniform(-2, 1.5)), albedo = uniform(0.3, 1), g = uniform(-0.5, 0.8),
                 index = uniform(1.1, 1.7), tilt = uniform(0, 4);
    const bool is_null = uniform(0, 1) < 0.5;
    const std::string boundary = is_null ? kNull
                                         : "<bsdf type=\"dielectric\">" + parameter("int_ior", index) +
                                               parameter("ext_ior", 1) + "</bsdf>";
    const auto layer = [&](double thickness, int seed) {
      const double width = 500, sigma = tau / thickness;
      std::string view = camera("origin=\"0, " + number(tilt) + ", 5\" target=\"0, 0, 0\" up=\"1, 0, 0\"", 1,
                                2, test::effort(64, 1024));
      view.insert(view.find("<integer name=\"sample_count\""),
                  "<integer name=\"seed\" value=\"" + std::to_string(seed) + "\"/>");
      // Light from above alone, so that what is reflected and what is transmitted differ.
      return render(
          "<integrator type=\"path\"/>" + view +
          "<shape type=\"cube\"><transform name=\"to_world\"><scale x=\"" + number(width) + "\" y=\"" +
          number(width) + "\" z=\"" + number(thickness / 2) + "\"/></transform>" + boundary +
          medium(sigma * (1 - albedo), sigma * albedo, g) +
          "</shape><emitter type=\"directional\"><vector name=\"direction\" x=\"0.3\" y=\"0.2\" z=\"-1\"/>"
          "<spectrum name=\"irradiance\" value=\"1\"/></emitter><emitter type=\"constant\"/>");
    };
    const double thin = std::exp(uniform(std::log(5e-3), std::log(5e-2)));
    const Picture film = layer(thin, 1), slab = layer(uniform(0.1, 1), 2);
    const double error = std::hypot(film.all_error, slab.all_error), z = (film.all - slab.all) / error;
    squares += z * z / layers;
    if (test::kSanitized) continue;
    EXPECT_LT(std::abs(film.all - slab.all), 6 * error + 1e-4 * slab.all)
        << "tau " << tau << ", albedo " << albedo << ", g " << g << ", thickness " << thin << ", tilt "
        << tilt << ", " << boundary;
    EXPECT_LT(error, 0.1 * slab.all);
  }
  if (!test::kSanitized) {
    EXPECT_LT(squares, 2.2);  // 30/28, with a standard deviation of some 0.36
  }
}

}  // namespace
}  // namespace aureole::testing
