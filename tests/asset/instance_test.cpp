// SPDX-License-Identifier: Apache-2.0
// Instances against the same shapes placed at load, groups within groups, and what scenes make of them.
#include "aureole/asset/shape_group.h"
#include "aureole/loading/load.h"
#include "aureole/scene/ray_tracer.h"
#include "aureole/scene/scene.h"
#include "aureole/shape/geometry/double3.h"
#include "aureole/shape/mesh/mesh.h"
#include "shape/shape_test_support.h"

namespace aureole {
namespace {

using test::Random;
using test::ShapeBuilder;

using AssetPtr = std::shared_ptr<Asset>;

AssetPtr asset_of(const ShapePtr& shape) { return std::make_shared<test::GivenAsset>(shape); }
AssetPtr group_of(const std::vector<AssetPtr>& assets) {
  ShapeBuilder b("shapegroup");
  for (const AssetPtr& m : assets) b.set("", ObjectPtr(m));
  return b.build_asset();
}
AssetPtr instance_of(const AssetPtr& group, const Transform& t) {
  return ShapeBuilder("instance").set("", ObjectPtr(group)).to_world(t).build_asset();
}
/// The point of a hit on one of the parts, with a tangent.
SurfacePoint point_of(const std::vector<Primitive>& parts, const RayTracer::Hit& hit, const Ray& ray) {
  const Primitive& part = parts[hit.shape];
  if (!part.instance) return part.shape->surface_point(hit, ray, true);
  return part.instance->surface_point(*part.instance->list().shapes[hit.geometry], hit, ray, true);
}

Transform random_transform(Random& random, bool mirrored) {
  const Vec3 a = random.direction(), b = random.direction(), c = random.direction() * random.uniform(0, 20);
  return Transform::translate(c.x, c.y, c.z) * Transform::rotate(a.x, a.y, a.z, random.uniform(0, 360)) *
         Transform::scale(mirrored ? -1.3 : 0.7, random.uniform(0.3f, 2), random.uniform(0.3f, 2)) *
         Transform::rotate(b.x, b.y, b.z, random.uniform(0, 360));
}

/// A bumpy mesh with normals and texture coordinates, placed by `t`.
class Bump final : public Mesh {
public:
  explicit Bump(const Properties& p) : Mesh(p) {
    MeshData d;
    constexpr std::uint32_t kN = 41;
    for (std::uint32_t j = 0; j < kN; ++j)
      for (std::uint32_t i = 0; i < kN; ++i) {
        const double x = i / 20.0 - 1, y = j / 20.0 - 1, z = 0.5 * std::exp(-2 * (x * x + y * y));
        d.positions.push_back(place_point(x, y, z));
        d.normals.push_back(place_normal(4 * x * z, 4 * y * z, 1));
        d.uvs.push_back({float(0.5 + 0.4 * x + 0.1 * y), float(0.5 + 0.45 * y)});
        if (i + 1 < kN && j + 1 < kN) {
          const std::uint32_t k = j * kN + i;
          d.triangles.push_back({k, k + 1, k + kN}), d.triangles.push_back({k + 1, k + kN + 1, k + kN});
        }
      }
    build(std::move(d), "bump");
  }
};
ShapePtr bump(const Transform& t) {
  Properties p("bump", "", {"scene.xml", 3, 4}, nullptr);
  p.add("to_world", t, {});
  return std::make_shared<Bump>(p);
}

TEST(Instance, IsTheShapePlacedAtLoad) {
  Random random(1);
  for (const bool mirrored : {false, true})
    for (int n = 0; n < 20; ++n) {
      const Transform t = random_transform(random, mirrored);
      const std::vector<Primitive> placed = {test::primitive_of(bump(t))};
      const std::vector<Primitive> instanced = instance_of(group_of({asset_of(bump({}))}), t)->primitives();
      const RayTracer a(placed), b(instanced);
      for (int i = 0; i < 3; ++i) {
        EXPECT_LE(instanced[0].bounds().lower[i], placed[0].bounds().lower[i] + 1e-5f);
        EXPECT_GE(instanced[0].bounds().upper[i], placed[0].bounds().upper[i] - 1e-5f);
      }
      int hits = 0, differ = 0;
      for (int i = 0; i < 1000; ++i) {
        const Vec3 target = t.point({random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0, 0.5f)});
        const Vec3 o = target + random.direction() * 10;
        const Ray ray{o, normalize(target - o)};
        const auto ha = a.intersect(ray), hb = b.intersect(ray);
        differ += bool(ha) != bool(hb);
        EXPECT_EQ(bool(hb), b.occluded(ray));
        if (!ha || !hb || std::abs(ha.t - hb.t) > 1e-3f) continue;
        const SurfacePoint pa = point_of(placed, ha, ray), pb = point_of(instanced, hb, ray);
        const Vec2 b = pa.barycentric;
        const bool at_edge = std::min({b.x, b.y, 1 - b.x - b.y}) < 0.01f;  // either triangle may be met
        if (at_edge || std::abs(dot(pa.ng, ray.d)) < 0.02f) continue;
        ++hits;
        EXPECT_LT(length(pa.p - pb.p), 2e-4f);
        EXPECT_GT(dot(pa.ng, pb.ng), 0.9999f);
        // Normals are interpolated before they are placed, or after.
        EXPECT_GT(dot(pa.shading.n, pb.shading.n), 0.999f);
        EXPECT_GT(dot(pa.shading.s, pb.shading.s), 0.999f);
        EXPECT_NEAR(pa.uv.x, pb.uv.x, 2e-4f);
        EXPECT_NEAR(pa.uv.y, pb.uv.y, 2e-4f);
        EXPECT_EQ(pb.instance, instanced[0].instance.get());
        ASSERT_NE(pb.shape, nullptr);
        EXPECT_EQ(pb.shape->properties().type(), "bump");
        const SurfaceDerivatives da = pa.shape->derivatives(pa), db = pb.shape->derivatives(pb);
        EXPECT_LT(length(da.dp_du - db.dp_du), 1e-3f * length(da.dp_du));
        EXPECT_LT(length(da.dp_dv - db.dp_dv), 1e-3f * length(da.dp_dv));
      }
      EXPECT_GT(hits, 500);
      EXPECT_LE(differ, 3);  // at the border
    }
}

TEST(Instance, RaysLeaveWithoutMeetingTheInstanceAgain) {
  Random random(2);
  int hits = 0, self = 0;
  for (int n = 0; n < 400; ++n) {
    const float size = std::pow(10.f, random.uniform(-2, 2)),
                away = std::pow(10.f, random.uniform(-2, 4)) * size;
    const Vec3 c = random.direction() * away;
    Transform t = random_transform(random, n % 2);
    t = Transform::translate(c.x, c.y, c.z) * Transform::scale(size, size * random.uniform(0.1f, 1), size) *
        t;
    // Far from the origin of the group, too; a flat mesh, a disc and a cylinder have no way to meet
    // themselves.
    const Vec3 g = random.direction() * (n % 3 == 0 ? 0 : std::pow(10.f, random.uniform(-1, 2)));
    const Transform in_group = Transform::translate(g.x, g.y, g.z) * Transform::rotate(1, 2, 3, 77);
    const ShapePtr shape = n % 4 == 0   ? ShapeBuilder("disk").to_world(in_group).build()
                           : n % 4 == 1 ? ShapeBuilder("sphere").to_world(in_group).build()
                                        : ShapeBuilder("rectangle").to_world(in_group).build();
    const std::vector<Primitive> parts = instance_of(group_of({asset_of(shape)}), t)->primitives();
    const RayTracer tracer(parts);
    const Transform all = t * in_group;
    for (int i = 0; i < 200; ++i) {
      const Vec3 target = all.point({random.uniform(-0.6f, 0.6f), random.uniform(-0.6f, 0.6f), 0});
      const Vec3 o = target + random.direction() * (size * std::pow(10.f, random.uniform(0, 2)));
      const Ray ray{o, normalize(target - o)};
      const auto hit = tracer.intersect(ray);
      if (!hit) continue;
      const SurfacePoint p = point_of(parts, hit, ray);
      ++hits;
      Vec3 d = random.direction();
      if (i % 2) d = normalize(d - p.ng * (dot(d, p.ng) * (1 - std::pow(10.f, random.uniform(-4, 0)))));
      if (n % 4 == 1 && dot(d, p.ng) < 0) d = -d;
      if (!(std::abs(dot(d, p.ng)) > 1e-5f)) continue;
      self += bool(tracer.intersect({offset_origin(p, d), d}));
    }
  }
  EXPECT_GT(hits, 40000);
  EXPECT_EQ(self, 0) << "of " << hits;
}

TEST(Instance, EveryKindOfShape) {
  Random random(3);
  const std::string file =
      (std::filesystem::temp_directory_path() / ("aureole-instance-" + std::to_string(::getpid()) + ".txt"))
          .string();
  std::ofstream(file) << "-1 0 0 .2\n-.4 .1 0 .3\n.3 -.1 .1 .25\n1 0 0 .2\n";
  const std::vector<ShapePtr> kinds = {ShapeBuilder("sphere").build(),
                                       ShapeBuilder("cylinder").build(),
                                       ShapeBuilder("disk").build(),
                                       ShapeBuilder("linearcurve").set("filename", file).build(),
                                       ShapeBuilder("bsplinecurve").set("filename", file).build(),
                                       bump({})};
  std::filesystem::remove(file);
  for (const ShapePtr& shape : kinds) {
    const Transform t = random_transform(random, false), back = t.inverse();
    const std::vector<Primitive> alone = {test::primitive_of(shape)},
                                 instanced = instance_of(group_of({asset_of(shape)}), t)->primitives();
    const RayTracer a(alone), b(instanced);
    int hits = 0, differ = 0;
    for (int i = 0; i < 2000; ++i) {
      const Vec3 o = random.direction() * 4, d = normalize(random.direction() - o);
      const Ray local{o, d}, ray{t.point(o), t.vector(d)};  // of the same distance, not of unit length
      const auto ha = a.intersect(local), hb = b.intersect(ray);
      differ += bool(ha) != bool(hb) || (ha && std::abs(ha.t - hb.t) > 1e-3f);
      if (!ha || !hb || std::abs(ha.t - hb.t) > 1e-3f) continue;
      ++hits;
      const SurfacePoint pa = point_of(alone, ha, local), pb = point_of(instanced, hb, ray);
      if (std::abs(dot(pa.ng, d)) < 0.05f) continue;
      EXPECT_LT(length(back.point(pb.p) - pa.p), 1e-3f) << shape->properties().type();
      EXPECT_GT(dot(pb.ng, normalize(t.normal(pa.ng))), 0.999f) << shape->properties().type();
      EXPECT_EQ(pb.shape, shape.get());
    }
    EXPECT_GT(hits, 90) << shape->properties().type();
    EXPECT_LT(differ, 20) << shape->properties().type();
  }
}

TEST(Instance, FindsTheShapeOfTheGroup) {
  std::vector<ShapePtr> shapes;
  std::vector<AssetPtr> assets;
  for (int i = 0; i < 20; ++i) {
    shapes.push_back(ShapeBuilder("sphere").set("radius", 0.4).set("center", Vec3{float(i), 0, 0}).build());
    assets.push_back(asset_of(shapes.back()));
  }
  const AssetPtr group = group_of(assets);
  const std::vector<Primitive> instances = {
      instance_of(group, {})->primitives().at(0),
      instance_of(group, Transform::translate(0, 5, 0))->primitives().at(0)};
  const RayTracer tracer(instances);
  for (int y = 0; y < 2; ++y)
    for (int i = 0; i < 20; ++i) {
      const Ray ray{{float(i), 5.f * float(y), 5}, {0, 0, -1}};
      const auto hit = tracer.intersect(ray);
      ASSERT_TRUE(hit);
      ASSERT_EQ(hit.shape, unsigned(y));
      const SurfacePoint p = point_of(instances, hit, ray);
      EXPECT_EQ(p.shape, shapes[std::size_t(i)].get());
      EXPECT_EQ(p.instance, instances[std::size_t(y)].instance.get());
    }
  // One copy of the shapes, shared.
  EXPECT_EQ(instances[0].triangle_count(), 20u);
  EXPECT_EQ(&instances[0].instance->list(), &instances[1].instance->list());
  EXPECT_LT(2 * sizeof(Instance), 4000u);
}

TEST(Instance, TwoScenesAtOnceAndLaterOnes) {
  const std::vector<Primitive> shapes =
      instance_of(group_of({ShapeBuilder("sphere").build_asset()}), {})->primitives();
  auto first = std::make_unique<RayTracer>(shapes);
  const RayTracer second(shapes);
  const Ray ray{{0, 0, 5}, {0, 0, -1}};
  EXPECT_TRUE(first->intersect(ray) && second.intersect(ray));
  first.reset();
  EXPECT_TRUE(second.intersect(ray));
  EXPECT_TRUE(RayTracer(shapes).intersect(ray));
}

TEST(Instance, GroupsWithinGroupsAreTakenApart) {
  const AssetPtr leaf = group_of({ShapeBuilder("sphere").build_asset()});
  const AssetPtr pair = group_of({instance_of(leaf, Transform::translate(-2, 0, 0)),
                                  instance_of(leaf, Transform::translate(2, 0, 0)),
                                  group_of({ShapeBuilder("disk").build_asset()})});
  const AssetPtr quad = group_of(
      {instance_of(pair, Transform::translate(0, 10, 0)), instance_of(pair, Transform::rotate(0, 0, 1, 90))});
  const AssetPtr top = instance_of(quad, Transform::scale(2, 2, 2));
  EXPECT_EQ(top->primitives().size(), 6u);
  const RayTracer tracer(top->primitives());
  for (const Vec3& p : {Vec3{-4, 20, 0}, {4, 20, 0}, {0, 20, 0}, {0, -4, 0}, {0, 4, 0}, {0, 0, 0}})
    EXPECT_TRUE(tracer.intersect({{p.x, p.y, 50}, {0, 0, -1}})) << p.x << " " << p.y;
  EXPECT_FALSE(tracer.intersect({{-4, 0, 50}, {0, 0, -1}}));
}

TEST(Instance, ErrorsAreLocated) {
  EXPECT_NE(test::build_error(ShapeBuilder("instance")).find("scene.xml:7:3"), std::string::npos);
  const AssetPtr g = group_of({ShapeBuilder("sphere").build_asset()});
  EXPECT_NE(test::build_error(ShapeBuilder("instance").set("", ObjectPtr(g)).set("", ObjectPtr(g))), "");
  const std::string tiny = test::build_error(
      ShapeBuilder("instance").set("", ObjectPtr(g)).to_world(Transform::scale(1e-30, 1, 1)));
  EXPECT_NE(tiny.find("scene.xml:8:5"), std::string::npos) << tiny;
}

TEST(InstanceScene, IsPassableWhereOneOfItsShapesIs) {
  const auto binary = [](const std::string& shapes) {
    return load_scene_from_string(
               R"(<scene version="3.0.0"><integrator type="path"/><sensor type="perspective"/>
<emitter type="constant"/><shape type="instance"><shape type="shapegroup">)" +
                   shapes + "</shape></shape></scene>",
               "test.xml")
        .scene->has_binary_visibility();
  };
  const std::string closed = R"(<shape type="sphere"/>)",
                    open = R"(<shape type="disk"><bsdf type="null"/></shape>)";
  EXPECT_TRUE(binary(closed));
  EXPECT_FALSE(binary(closed + open));
}

TEST(InstanceScene, GroupsInGroupsAreCountedBeforeTheyArePlaced) {
  // Each group has two instances of the one before.
  const auto load = [](int level) {
    const auto instance = [](int of) {
      return "<shape type=\"instance\"><ref id=\"g" + std::to_string(of) + "\"/></shape>";
    };
    std::string text =
        R"(<scene version="3.0.0"><integrator type="path"/><sensor type="perspective"><film type="hdrfilm"/></sensor>
<emitter type="constant"/><shape type="shapegroup" id="g0"><shape type="sphere"/></shape>)";
    for (int i = 1; i <= level; ++i)
      text += "<shape type=\"shapegroup\" id=\"g" + std::to_string(i) + "\">" + instance(i - 1) +
              instance(i - 1) + "</shape>";
    return load_scene_from_string(text + instance(level) + "</scene>", "test.xml");
  };
  EXPECT_EQ(load(6).scene->parts().surfaces.size(), 64u);
  try {
    load(22);
    ADD_FAILURE();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("2.1e+06 instances"), std::string::npos) << e.what();
  }
}

TEST(InstanceScene, GroupsAreNotRendered) {
  const auto load = [](const std::string& content) {
    return load_scene_from_string(
        R"(<scene version="3.0.0"><integrator type="path"/><sensor type="perspective"><film type="hdrfilm"/></sensor>
<emitter type="constant"/>)" +
            content + "</scene>",
        "test.xml");
  };
  const std::string group =
      R"(<shape type="shapegroup" id="g"><shape type="sphere"><float name="radius" value="2"/></shape><shape type="cube"/></shape>)";
  const LoadedScene unused = load(group);
  EXPECT_EQ(unused.scene->parts().surfaces.size(), 0u);
  EXPECT_EQ(std::count_if(
                unused.notes.begin(), unused.notes.end(),
                [](const std::string& n) { return n.find("shapegroup is rendered") != std::string::npos; }),
            1);
  const LoadedScene two =
      load(group + R"(<shape type="instance"><ref id="g"/></shape><shape type="instance"><ref id="g"/>
<transform name="to_world"><translate x="5"/></transform></shape>)");
  EXPECT_EQ(two.scene->parts().surfaces.size(), 2u);
  for (const std::string& note : two.notes) EXPECT_EQ(note.find("rendered"), std::string::npos) << note;
  const Scene& scene = *two.scene;
  const auto hit = scene.intersect({{5, 0, 9}, {0, 0, -1}});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->p.z, 2, 1e-5f);
  EXPECT_EQ(hit->shape->properties().type(), "sphere");
  EXPECT_FALSE(scene.intersect({{2.5f, 0, 9}, {0, 0, -1}}));
  // An empty group, and one that nobody uses, are no errors.
  EXPECT_EQ(load(R"(<shape type="shapegroup" id="e"/><shape type="instance"><ref id="e"/></shape>)")
                .scene->parts()
                .surfaces.size(),
            0u);
  // Groups may emit, but the instances of those that do may not be scaled.
  const std::string lamp =
      R"(<shape type="shapegroup" id="l"><shape type="sphere"><emitter type="area"/></shape></shape>
<shape type="instance"><ref id="l"/><transform name="to_world">)";
  EXPECT_FALSE(load(lamp + R"(<translate x="1"/></transform></shape>)").scene->lights().empty());
  EXPECT_THROW(load(lamp + R"(<scale value="2"/></transform></shape>)"), Error);
  EXPECT_THROW(load(group + R"(<shape type="instance"><ref id="g"/><bsdf type="diffuse"/></shape>)"), Error);
}

}  // namespace
}  // namespace aureole
