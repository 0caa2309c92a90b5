// SPDX-License-Identifier: Apache-2.0
// dp/du and dp/dv of every shape against differences of its own surface points.
#include "aureole/scene/ray_tracer.h"
#include "harness/properties_builder.h"
#include "shape/shape_test_support.h"

namespace aureole {
namespace {

using test::OneShapeScene;
using test::Random;
using test::ShapeBuilder;

class Derivatives : public test::FileTest {};

TEST_F(Derivatives, AgreeWithDifferences) {
  const std::string file =
      write("curves.txt", "-2 0 0.1 0.5\n-0.8 0.3 0 0.4\n0.9 -0.2 0.3 0.5\n2 0.1 -0.2 0.3\n");
  const Transform t = Transform::rotate(1, 2, 3, 50) * Transform::scale(1, 0.6, 1.3);
  const Transform turned = Transform::rotate(3, 1, 2, 70) * Transform::scale(0.8, 0.8, 0.8);
  const ObjectPtr group =
      ShapeBuilder("shapegroup").set("", ObjectPtr(ShapeBuilder("sphere").build_asset())).build_asset();
  const std::vector<std::shared_ptr<Asset>> assets = {
      ShapeBuilder("sphere").to_world(turned).build_asset(),
      ShapeBuilder("disk").to_world(t).build_asset(),
      ShapeBuilder("cylinder").to_world(t).build_asset(),
      ShapeBuilder("rectangle").to_world(t).build_asset(),
      ShapeBuilder("linearcurve").set("filename", file).to_world(turned).build_asset(),
      ShapeBuilder("bsplinecurve").set("filename", file).to_world(turned).build_asset(),
      ShapeBuilder("instance").set("", group).to_world(t).build_asset()};
  for (const std::shared_ptr<Asset>& asset : assets) {
    const std::string type = asset->properties().type();
    const RayTracer tracer(asset->primitives());
    const Primitive& part = asset->primitives()[0];
    const auto intersect = [&](const Ray& ray) -> std::optional<SurfacePoint> {
      const RayTracer::Hit hit = tracer.intersect(ray);
      if (!hit) return {};
      // Meshes and instances compute the tangent only where it is asked for.
      return part.instance
                 ? part.instance->surface_point(*part.instance->list().shapes[hit.geometry], hit, ray, true)
                 : part.shape->surface_point(hit, ray, true);
    };
    Random random(1);
    int compared = 0;
    for (int i = 0; i < 3000; ++i) {
      const Vec3 o = random.direction() * 5, target = random.direction() * 0.8f, d = normalize(target - o);
      const auto hit = intersect({o, d});
      if (!hit || std::abs(dot(hit->ng, d)) < 0.3f) continue;
      const SurfacePoint& p = *hit;
      // Next to seams and poles uv jump, and on the round ends of a straight curve they stand still.
      if (p.uv.x < 0.2f || p.uv.x > 0.9f || p.uv.y < 0.1f || p.uv.y > 0.9f) continue;
      if (type == "linearcurve" && (p.barycentric.x < 0.02f || p.barycentric.x > 0.98f)) continue;
      const SurfaceDerivatives at = p.shape->derivatives(p);
      const auto near = intersect({o + random.direction() * 2e-3f, d});
      if (!near || near->primitive != p.primitive) continue;
      const Vec2 step = near->uv - p.uv;
      const Vec3 expected = near->p - p.p, found = at.dp_du * step.x + at.dp_dv * step.y;
      if (length(expected) < 5e-4f || length(expected) > 0.02f) continue;  // or another side
      ++compared;
      EXPECT_LT(length(found - expected), 0.02f * length(expected) + 2e-5f) << type;
      // The frame follows dp/du.
      const Vec3 along = at.dp_du - p.shading.n * dot(p.shading.n, at.dp_du);
      EXPECT_GT(dot(normalize(along), p.shading.s), 0.999f) << type;
    }
    EXPECT_GT(compared, 100) << type;
  }
}

}  // namespace
}  // namespace aureole
