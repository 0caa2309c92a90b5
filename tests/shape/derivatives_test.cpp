// SPDX-License-Identifier: Apache-2.0
// dp/du and dp/dv of every shape against differences of its own surface points.
#include "harness/properties_builder.h"
#include "shape_test_support.h"

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
  // Meshes and instances compute the tangent only for a BSDF that looks at it.
  const ObjectPtr rough = testing::build_object(R"(<bsdf type="roughconductor"/>)");
  const ShapePtr group =
      ShapeBuilder("shapegroup").set("", ObjectPtr(ShapeBuilder("sphere").set("", rough).build())).build();
  const std::vector<ShapePtr> shapes = {
      ShapeBuilder("sphere").to_world(turned).build(),
      ShapeBuilder("disk").to_world(t).build(),
      ShapeBuilder("cylinder").to_world(t).build(),
      ShapeBuilder("rectangle").set("", rough).to_world(t).build(),
      ShapeBuilder("linearcurve").set("filename", file).to_world(turned).build(),
      ShapeBuilder("bsplinecurve").set("filename", file).to_world(turned).build(),
      ShapeBuilder("instance").set("", ObjectPtr(group)).to_world(t).build()};
  for (const ShapePtr& shape : shapes) {
    const std::string type = shape->properties().type();
    const OneShapeScene scene(*shape);
    Random random(1);
    int compared = 0;
    for (int i = 0; i < 3000; ++i) {
      const Vec3 o = random.direction() * 5, target = random.direction() * 0.8f, d = normalize(target - o);
      const auto hit = scene.intersect({o, d});
      if (!hit || std::abs(dot(hit->point.ng, d)) < 0.3f) continue;
      const SurfacePoint& p = hit->point;
      // Next to seams and poles uv jump, and on the round ends of a straight curve they stand still.
      if (p.uv.x < 0.2f || p.uv.x > 0.9f || p.uv.y < 0.1f || p.uv.y > 0.9f) continue;
      if (type == "linearcurve" && (p.barycentric.x < 0.02f || p.barycentric.x > 0.98f)) continue;
      const SurfaceDerivatives at = p.shape->derivatives(p);
      const auto near = scene.intersect({o + random.direction() * 2e-3f, d});
      if (!near || near->point.primitive != p.primitive) continue;
      const Vec2 step = near->point.uv - p.uv;
      const Vec3 expected = near->point.p - p.p, found = at.dp_du * step.x + at.dp_dv * step.y;
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
