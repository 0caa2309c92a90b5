// SPDX-License-Identifier: Apache-2.0
// The shape family: surfaces that rays meet and that area emitters shine from.
#pragma once

#include <embree3/rtcore.h>

#include <optional>
#include <string>
#include <vector>

#include "aureole/bsdf/bsdf.h"
#include "aureole/plugin/object.h"
#include "aureole/shape/surface_point.h"

namespace aureole {

class AttributeTexture;
class Emitter;
class Sensor;
class Texture;

/// A point of a shape chosen by `sample_direct` or `sample_area`.
struct ShapeSample {
  Vec3 p, p_error, ng;
  Vec2 uv;
  float pdf;  ///< of sample_direct: solid-angle density seen from the reference point [1/sr]
  std::uint32_t primitive = 0;
  Vec2 barycentric{};
};

/// What of it a light of one colour needs.
struct PositionSample {
  Vec3 p, p_error, ng;
  float pdf = 0;  ///< 0: there is no such point
};

class Shape : public Object {
public:
  static constexpr const char* kFamily = "a shape";
  /// Whether a shape has attributes for textures to show.
  enum class Attributes { none, some };
  /// Reads the children every shape may have: bsdf (default: diffuse .5, black on emitters) emitter and
  /// sensor.
  explicit Shape(const Properties& properties, Attributes attributes = Attributes::none);
  ~Shape() override;

  /// Null where the shape only stands for others.
  const BsdfPtr& bsdf() const { return bsdf_; }
  /// The shading frame's s must lie along dp/du; else any frame around the normal does.
  bool needs_tangent() const { return needs_tangent_; }
  // Answers of the BSDF that every vertex asks for.
  Lobe lobes() const { return lobes_; }
  bool needs_choice() const { return needs_choice_; }
  /// Some light may pass straight through it.
  virtual bool is_passable() const { return bsdf_->is_passable(); }
  const Emitter* emitter() const { return emitter_.get(); }
  const std::shared_ptr<Emitter>& shared_emitter() const { return emitter_; }
  /// The sensor that sits on it, or null.
  const std::shared_ptr<Sensor>& sensor() const { return sensor_; }

  /// An Embree geometry for this shape, committed, owned by the caller. Buffers are shared with the shape,
  /// which outlives it.
  virtual RTCGeometry make_geometry(RTCDevice device) const = 0;
  /// The surface point of an Embree hit by `ray`. Fills everything; `shape` is the shape that was met (one of
  /// the group's for an instance).
  virtual SurfacePoint surface_point(const ShapeHit& hit, const Ray& ray) const = 0;
  /// Derivatives of the position at one of its surface points, in the world, for bump and normal maps.
  SurfaceDerivatives derivatives(const SurfacePoint& point) const {
    const SurfaceDerivatives own = own_derivatives(point);
    return point.instance ? point.instance->instance_to_world(own) : own;
  }
  /// The value of the mesh attribute that `texture` shows at one of its surface points.
  virtual Spectrum attribute(const Texture& texture, const SurfacePoint& point, const Wavelengths& w) const;

  /// The shapes that a scene renders in its place; null: itself.
  virtual const std::vector<std::shared_ptr<Shape>>* parts() const { return nullptr; }

  virtual Bounds3 bounds() const = 0;
  virtual std::size_t primitive_count() const = 0;  ///< triangles, or 1
  virtual std::size_t memory_bytes() const { return 0; }

  // What an area emitter needs. A shape is divided into patches that are sampled one by one: a triangle, a
  // parallelogram of two triangles, a sphere, a disc.
  virtual std::size_t patch_count() const = 0;
  virtual std::size_t patch_of_primitive(std::uint32_t primitive) const = 0;
  virtual float patch_area(std::size_t patch) const = 0;
  virtual Bounds3 patch_bounds(std::size_t patch) const = 0;
  /// Mean normal and the cosine of the half-angle of the cone that holds all normals of the patch.
  virtual std::pair<Vec3, float> patch_normals(std::size_t patch) const = 0;
  /// A point of the patch as seen from `reference`, by solid angle where that pays; nothing where the patch
  /// can't be seen or has no area.
  virtual std::optional<ShapeSample> sample_direct(const Vec3& reference, std::size_t patch,
                                                   Vec2 u) const = 0;
  /// The same point and density.
  virtual PositionSample sample_direct_position(const Vec3& reference, std::size_t patch, Vec2 u) const {
    const auto s = sample_direct(reference, patch, u);
    return s ? PositionSample{s->p, s->p_error, s->ng, s->pdf} : PositionSample{};
  }
  /// A point of the patch, uniform or nearly so; `pdf` is per area [1/m^2]. Nothing where it has no area.
  virtual std::optional<ShapeSample> sample_area(std::size_t patch, Vec2 u) const = 0;
  /// Solid-angle density with which sample_direct chooses the point `point` of the patch from `reference`.
  virtual float pdf_direct(const Vec3& reference, std::size_t patch, const SurfacePoint& point) const = 0;

  /// What other objects a shape holds.
  struct Children {
    BsdfPtr bsdf;
    std::shared_ptr<Emitter> emitter;
    std::shared_ptr<Sensor> sensor;
    bool default_bsdf = false;
  };
  /// Reads them; throws located Errors.
  static Children read_children(const Properties& properties);
  /// Whether the geometry stays as it is with other children.
  bool can_adopt(const Properties& properties, const Children& children) const;
  /// Exchanges its children, and the properties they came with, for others. Not while anybody traces rays.
  void exchange_children(std::shared_ptr<const Properties>& properties, Children& children);

  /// What the reader dropped or repaired ("3 degenerate triangles dropped"), for `aureole info` and a note.
  const std::vector<std::string>& remarks() const { return remarks_; }

protected:
  /// A shape of the given BSDF, null where it stands for others, that reads no children.
  Shape(const Properties& properties, BsdfPtr bsdf);
  /// No child gave a BSDF; another one may take the default's place.
  bool has_default_bsdf() const { return has_default_bsdf_; }
  void set_bsdf(BsdfPtr bsdf) {
    bsdf_ = std::move(bsdf);
    ask_bsdf();
  }
  /// The textures below the object that show attributes.
  static std::vector<const AttributeTexture*> attribute_textures(const Properties& properties);

  /// `derivatives` in the coordinates of the shape's group, which `p` and the normals of a point that was met
  /// through an instance are not in: only uv, primitive and barycentric may be used.
  virtual SurfaceDerivatives own_derivatives(const SurfacePoint& point) const = 0;
  virtual SurfaceDerivatives instance_to_world(const SurfaceDerivatives& d) const { return d; }

  std::vector<std::string> remarks_;

private:
  void ask_bsdf();
  void take(Children children);

  BsdfPtr bsdf_;
  std::shared_ptr<Emitter> emitter_;
  Lobe lobes_ = Lobe::none;
  bool needs_tangent_ = true, needs_choice_ = true;
  std::shared_ptr<Sensor> sensor_;
  bool has_default_bsdf_ = false;
};
using ShapePtr = std::shared_ptr<Shape>;

}  // namespace aureole
