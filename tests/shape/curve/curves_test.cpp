// SPDX-License-Identifier: Apache-2.0
// Curves: against Mitsuba's values, against the distance to the curve, leaving rays, files.
#include "aureole/shape/curve/curves.h"

#include "shape/shape_test_support.h"

namespace aureole {
namespace {

using test::OneShapeScene;
using test::Random;
using test::ShapeBuilder;

using Points = std::vector<std::array<double, 4>>;

std::string text_of(const Points& points) {
  std::string text;
  char line[200];
  for (const auto& p : points) {
    std::snprintf(line, sizeof line, "%.9g %.9g %.9g %.9g\n", p[0], p[1], p[2], p[3]);
    text += line;
  }
  return text;
}

class CurvesTest : public test::FileTest {
protected:
  ShapePtr curve(const char* type, const std::string& text) const {
    return ShapeBuilder(type).set("filename", write("curves.txt", text)).build();
  }
  std::string error(const char* type, const std::string& text) const {
    return test::build_error(ShapeBuilder(type).set("filename", write("curves.txt", text)));
  }
};

constexpr const char* kTwo =
    "-2 0 0.1 0.5\n-0.8 0.3 0 0.4\n0.9 -0.2 0.3 0.5\n2 0.1 -0.2 0.3\n3 0.4 0.2 0.2\n\n"
    "0 3 0 0.3\n0.1 3.2 1 0.3\n0.3 3 2 0.2\n0 3.1 3 0.4\n";

struct Expected {
  Vec3 o, d;
  float t;
  Vec3 n;
  float u, v;
};

void expect_as_mitsuba(const Shape& shape, const std::vector<Expected>& all) {
  const OneShapeScene scene(shape);
  for (const Expected& e : all) {
    const auto hit = scene.intersect({e.o, e.d});
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->t, e.t, 2e-5f);
    EXPECT_LT(length(hit->point.ng - e.n), 1e-3f);
    EXPECT_LT(length(hit->point.shading.n - e.n), 1e-3f);
    EXPECT_NEAR(hit->point.uv.x, e.u, 3e-4f);
    EXPECT_NEAR(hit->point.uv.y, e.v, 3e-4f);
  }
}

TEST_F(CurvesTest, ValuesAsMitsuba) {
  // Mitsuba 3.9.1, llvm_ad_rgb.
  expect_as_mitsuba(
      *curve("linearcurve", kTwo),
      {{{0.2f, 0.1f, 5}, {0, 0, -1}, 4.36816f, {-0.154422f, 0.248683f, 0.956196f}, 0.218715f, 0.232899f},
       {{1.4f, -0.2f, 5}, {0, 0, -1}, 4.43971f, {0.583421f, -0.13886f, 0.800211f}, 0.297037f, 0.315975f},
       {{0.25f, 5, 1.3f}, {0, -1, 0}, 1.59864f, {0.367947f, 0.906357f, 0.207682f}, 0.0698343f, 0.748962f},
       {{5, 3.05f, 1.7f}, {-1, 0, 0}, 4.52893f, {0.994356f, -0.0232257f, -0.103516f}, 0.871172f, 0.817652f}});
  const ShapePtr spline = curve("bsplinecurve", kTwo);
  expect_as_mitsuba(
      *spline,
      {{{0.2f, 0.1f, 5}, {0, 0, -1}, 4.39973f, {-0.0593234f, 0.186098f, 0.980739f}, 0.222485f, 0.203299f},
       {{1.4f, -0.2f, 5}, {0, 0, -1}, 4.54244f, {0.345975f, -0.340717f, 0.874193f}, 0.312363f, 0.460629f},
       {{0.25f, 5, 1.3f}, {0, -1, 0}, 1.62968f, {0.338143f, 0.936941f, 0.0883246f}, 0.0288071f, 0.763891f},
       {{5, 3.05f, 1.7f}, {-1, 0, 0}, 4.54233f, {0.99355f, -0.096472f, -0.0595971f}, 0.89515f, 0.906279f}});
  const auto hit = OneShapeScene(*spline).intersect({{0.2f, 0.1f, 5}, {0, 0, -1}});
  EXPECT_LT(length(spline->derivatives(hit->point).dp_du - Vec3{-0.551174f, -2.74072f, 0.486719f}), 2e-3f);
  EXPECT_GT(dot(hit->point.shading.s, normalize(Vec3{-0.551174f, -2.74072f, 0.486719f})), 0.9999f);
}

TEST_F(CurvesTest, RadiiDoNotScale) {
  const auto shape = ShapeBuilder("linearcurve")
                         .set("filename", write("curves.txt", "-1 0 0 .1\n1 0 0 .1\n"))
                         .to_world(Transform::scale(10, 10, 10))
                         .build();
  EXPECT_NEAR(shape->bounds().upper.x, 10.1f, 1e-5f);
  const auto hit = OneShapeScene(*shape).intersect({{3, 0, 5}, {0, 0, -1}});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->point.p.z, 0.1f, 1e-6f);
}

/// Distance from q to the surface of a chain of cones between spheres, negative inside.
double chain_distance(const Points& p, const Double3& q) {
  double least = 1e300;
  for (std::size_t i = 0; i + 1 < p.size(); ++i)
    // The sphere around c(v) that is nearest, by golden-section search: the distance is a convex function of
    // v.
    for (double a = 0, b = 1, step = 0; step < 80; ++step) {
      const auto at = [&](double v) {
        Double3 c;
        c.x = p[i][0] + v * (p[i + 1][0] - p[i][0]), c.y = p[i][1] + v * (p[i + 1][1] - p[i][1]);
        c.z = p[i][2] + v * (p[i + 1][2] - p[i][2]);
        return length(q - c) - (p[i][3] + v * (p[i + 1][3] - p[i][3]));
      };
      const double x = a + 0.381966 * (b - a), y = b - 0.381966 * (b - a);
      const double fx = at(x), fy = at(y);
      fx < fy ? b = y : a = x;
      least = std::min({least, fx, fy});
    }
  return least;
}

/// The first point along a ray where the distance becomes zero, by steps of that distance; negative: none.
template <class Distance>
double march(const Distance& distance, const Double3& o, const Double3& d, double far, double size) {
  double t = 0;
  for (int i = 0; i < 3000 && t < far; ++i) {
    const double step = distance(o + d * t);
    if (step < 1e-7 * size) return t;
    t += step;
  }
  return -1;
}

TEST_F(CurvesTest, LinearOnesMeetTheChainOfConesAtAnyScale) {
  Random random(1);
  int hits = 0, differ = 0;
  for (int n = 0; n < 60; ++n) {
    const double size = std::pow(10.0, random.uniform(-6, 4)),
                 thick = std::pow(10.0, random.uniform(-2, -0.3f));
    Points p;
    for (int i = 0; i < 4; ++i)
      p.push_back({size * (i + double(random.uniform(-0.4f, 0.4f))),
                   size * double(random.uniform(-0.5f, 0.5f)), size * double(random.uniform(-0.5f, 0.5f)),
                   float(size * thick * double(random.uniform(0.3f, 1.5f)))});
    for (auto& c : p)
      for (double& x : c) x = double(float(x));
    const ShapePtr shape = curve("linearcurve", text_of(p));
    const OneShapeScene scene(*shape);
    for (int i = 0; i < 100; ++i) {
      const Vec3 target{float(size) * random.uniform(-0.5f, 3.5f), float(size) * random.uniform(-0.4f, 0.4f),
                        float(size) * random.uniform(-0.4f, 0.4f)};
      // A fifth of them nearly along the axis.
      const Vec3 from = i % 5 ? random.direction() : Vec3{1, 1e-4f * random.uniform(-1, 1), 0};
      const Vec3 o = target + from * (float(size) * 8), d = normalize(target - o);
      const double t = march([&](const Double3& q) { return chain_distance(p, q); }, Double3(o), Double3(d),
                             20 * size, size);
      const auto hit = scene.intersect({o, d});
      EXPECT_EQ(hit.has_value(), scene.occluded({o, d}));
      hits += t >= 0;
      // Grazing rays may go either way.
      differ += (t >= 0) != hit.has_value();
      if (t < 0 || !hit || std::abs(dot(hit->point.ng, d)) < 0.02f) continue;
      EXPECT_NEAR(hit->t / size, t / size, 3e-5) << n;
      EXPECT_LT(std::abs(chain_distance(p, Double3(hit->point.p))), 1e-6 * size + length(hit->point.p_error));
    }
  }
  EXPECT_GT(hits, 800);
  EXPECT_LE(differ, 3) << "of " << hits;
}

TEST_F(CurvesTest, SplinesAreAtTheirRadius) {
  Random random(2);
  int hits = 0;
  for (int n = 0; n < 60; ++n) {
    const double size = std::pow(10.0, random.uniform(-4, 3)),
                 radius = size * std::pow(10.0, random.uniform(-2, -0.7f));
    Points p;
    for (int i = 0; i < 7; ++i)
      p.push_back({size * i, size * double(random.uniform(-0.7f, 0.7f)),
                   size * double(random.uniform(-0.7f, 0.7f)), radius});
    for (auto& c : p)
      for (double& x : c) x = double(float(x));
    const ShapePtr shape = curve("bsplinecurve", text_of(p));
    const OneShapeScene scene(*shape);
    const auto center = [&](double s) {
      const int i = std::min(int(s), 3);
      const double v = s - i, w = 1 - v;
      const double b[4] = {w * w * w / 6, (3 * v * v * v - 6 * v * v + 4) / 6,
                           (3 * w * w * w - 6 * w * w + 4) / 6, v * v * v / 6};
      Double3 c;
      for (std::size_t k = 0; k < 4; ++k)
        c = c + Double3(p[std::size_t(i) + k][0], p[std::size_t(i) + k][1], p[std::size_t(i) + k][2]) * b[k];
      return c;
    };
    for (int i = 0; i < 200; ++i) {
      const double s = random.uniform(0.3f, 3.7f);
      const Vec3 target = center(s).to_float() + random.direction() * float(radius * 0.8);
      const Vec3 o = target + random.direction() * float(5 * size);
      const auto hit = scene.intersect({o, normalize(target - o)});
      if (!hit) continue;
      ++hits;
      // The place along the curve gives the centre; the point lies across it, and no centre is nearer.
      const double v = 4 * double(hit->point.uv.y);
      const Double3 w = Double3(hit->point.p) - center(v);
      EXPECT_NEAR(length(w) / radius, 1, 2e-5 + 3 * length(hit->point.p_error) / radius);
      EXPECT_GT(dot(normalize(w), Double3(hit->point.ng)), 0.9999);
      for (double near = std::max(v - 0.3, 0.0); near < std::min(v + 0.3, 4.0); near += 0.01)
        EXPECT_GT(length(Double3(hit->point.p) - center(near)), radius * (1 - 1e-4));
    }
  }
  EXPECT_GT(hits, 8000);
}

TEST_F(CurvesTest, RaysLeaveWithoutMeetingTheCurveAgain) {
  for (const char* type : {"linearcurve", "bsplinecurve"}) {
    Random random(3);
    int hits = 0, self = 0;
    for (int n = 0; n < 300; ++n) {
      const double size = std::pow(10.0, random.uniform(-4, 3)),
                   thick = std::pow(10.0, random.uniform(-2.5f, -0.5f));
      const double taper = random.uniform(-0.15f, 0.25f);
      const Vec3 c = random.direction() * float(size * std::pow(10.0, random.uniform(-2, 3)));
      const Vec3 axis = random.direction() * float(size);
      Points p;  // straight: convex, so that every hit of a leaving ray is the curve itself
      for (int i = 0; i < 6; ++i) {
        const Vec3 at = c + axis * float(i);
        p.push_back({at.x, at.y, at.z, thick * size * (1 + taper * i)});
      }
      const ShapePtr shape = curve(type, text_of(p));
      const OneShapeScene scene(*shape);
      for (int i = 0; i < 300; ++i) {
        const Vec3 target = c + axis * random.uniform(1, 4) +
                            random.direction() * float(thick * size * double(random.uniform()));
        const Vec3 o = target + random.direction() * float(size * std::pow(10.0, random.uniform(0, 2)));
        const auto hit = scene.intersect({o, normalize(target - o)});
        if (!hit) continue;
        EXPECT_LT(dot(hit->point.ng, target - o), 0) << "the inside is not seen";
        ++hits;
        Vec3 d = random.direction();
        if (dot(d, hit->point.ng) < 0) d = -d;
        if (i % 2)
          d = normalize(d - hit->point.ng *
                                (dot(d, hit->point.ng) * (1 - std::pow(10.f, random.uniform(-5, 0)))));
        if (!(dot(d, hit->point.ng) > 1e-6f)) continue;
        // Outwards, and inwards through the far side.
        self += scene.intersect({offset_origin(hit->point, d), d}).has_value();
        self += scene.intersect({offset_origin(hit->point, -d), -d}).has_value();
        EXPECT_FALSE(scene.occluded({offset_origin(hit->point, d), d}));
      }
    }
    EXPECT_GT(hits, 40000) << type;
    EXPECT_EQ(self, 0) << type << " of " << hits;
  }
}

TEST_F(CurvesTest, Files) {
  const auto count = [&](const char* type, const std::string& text) {
    return curve(type, text)->primitive_count();
  };
  EXPECT_EQ(count("linearcurve", kTwo), 7u);
  EXPECT_EQ(count("bsplinecurve", kTwo), 3u);
  EXPECT_EQ(count("linearcurve", "\n\n0 0 0 1\r\n 1\t0 0 1 \r\n\r\n\n2 0 0 1\n3 0 0 1"), 2u);
  // One sphere holds the other; coinciding points; radius zero.
  EXPECT_TRUE(
      OneShapeScene(*curve("linearcurve", "0 0 0 1\n.2 0 0 .1\n")).intersect({{0, 0, 5}, {0, 0, -1}}));
  EXPECT_TRUE(
      OneShapeScene(*curve("linearcurve", "0 0 0 .1\n0 0 0 1\n")).intersect({{0.5f, 0, 5}, {0, 0, -1}}));
  EXPECT_TRUE(OneShapeScene(*curve("linearcurve", "0 0 0 1\n3 0 0 0\n")).intersect({{2, 0, 5}, {0, 0, -1}}));
  curve("bsplinecurve", "0 0 0 1\n0 0 0 1\n0 0 0 1\n0 0 0 1\n");

  const auto expect = [&](const char* type, const std::string& text, const std::string& part) {
    const std::string e = error(type, text);
    EXPECT_NE(e.find("scene.xml:8:5"), std::string::npos) << e;
    EXPECT_NE(e.find("curves.txt"), std::string::npos) << e;
    EXPECT_NE(e.find(part), std::string::npos) << e;
  };
  expect("bsplinecurve", "0 0 0 1\n1 0 0 1\n2 0 0 1\n\n", "line 4: a curve needs at least 4");
  expect("linearcurve", "0 0 0 1\n\n1 0 0 1\n2 0 0 1\n", "line 2: a curve needs at least 2");
  expect("linearcurve", "0 0 0 1\n1 0 x 1\n", "line 2: expected four numbers");
  expect("linearcurve", "0 0 0\n1 0 0\n", "line 1: expected four numbers");
  expect("linearcurve", "0 0 0 1 5\n1 0 0 1\n", "line 1: there is more");
  expect("linearcurve", "0 0 0 -1\n1 0 0 1\n", "line 1: the radius");
  expect("linearcurve", "0 0 nan 1\n1 0 0 1\n", "line 1: not a finite");
  expect("linearcurve", "\n \n", "no control points");
  const std::string text = kTwo;
  for (std::size_t n = 0; n < text.size(); ++n) error("bsplinecurve", text.substr(0, n));
}

TEST_F(CurvesTest, CannotShine) {
  const std::string e =
      test::build_error(ShapeBuilder("linearcurve").set("filename", write("curves.txt", kTwo)).emitting());
  EXPECT_NE(e.find("cannot be an emitter"), std::string::npos) << e;
}

}  // namespace
}  // namespace aureole
