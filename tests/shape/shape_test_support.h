// SPDX-License-Identifier: Apache-2.0
// Shared by the shape tests: shapes from parameters, emitters that do nothing, rays, temporary files.
#pragma once

#include <embree3/rtcore.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "aureole/asset/asset.h"
#include "aureole/emitter/emitter.h"
#include "aureole/plugin/registry.h"

namespace aureole::test {

/// An emitter that only sits on its shape.
class DarkEmitter final : public Emitter {
public:
  using Emitter::Emitter;
  std::optional<DirectSample> sample_direct(const Light&, const Vec3&, std::size_t, Vec2,
                                            const Wavelengths&) const override {
    return std::nullopt;
  }
  std::optional<EmittedRay> sample_ray(const Light&, std::size_t, Vec2, Vec2,
                                       const Wavelengths&) const override {
    return std::nullopt;
  }
  RayDensity pdf_ray(const Light&, std::size_t, const SurfacePoint*, const Vec3&) const override {
    return {};
  }
  SampledSpectrum power_spectrum(const Light&) const override { return {}; }
  EmissionBounds emission_bounds(const Light&, std::size_t) const override { return {}; }
};

inline ObjectPtr make_dark_emitter() {
  static const PluginInfo plugin{"emitter",
                                 "dark",
                                 {.parameters = {{"sampling_weight", "", "", "", ""},
                                                 {"medium", "", "", "", ""},
                                                 {"modulation", "", "", "", ""}},
                                  .needs_shape = true},
                                 nullptr};
  return std::make_shared<DarkEmitter>(Properties("dark", "", {}, nullptr, &plugin));
}

/// The area sampler of a shape; it keeps the shape alive.
inline std::shared_ptr<const AreaSampler> sampler_of(const ShapePtr& shape, AreaUse use = AreaUse::emitter) {
  struct Kept {
    ShapePtr shape;
    std::shared_ptr<const AreaSampler> sampler;
  };
  const auto kept = std::make_shared<const Kept>(Kept{shape, shape->make_area_sampler(use)});
  return {kept, kept->sampler.get()};
}

/// Builds a shape: ShapeBuilder("sphere").set("radius", 2.0).build().
class ShapeBuilder {
public:
  explicit ShapeBuilder(const std::string& name)
      : info_(Registry::instance().find("shape", name)),
        properties_(name, "", {"scene.xml", 7, 3}, nullptr, info_) {}
  ShapeBuilder& set(const std::string& name, Properties::Value value) {
    properties_.add(name, std::move(value), {"scene.xml", 8, 5});
    return *this;
  }
  ShapeBuilder& to_world(const Transform& t) { return set("to_world", t); }
  ShapeBuilder& emitting() { return set("", make_dark_emitter()); }
  /// The geometry alone.
  ShapePtr build() const { return std::dynamic_pointer_cast<const Shape>(info_->create(properties_)); }
  /// Its area sampler for an emitter.
  std::shared_ptr<const AreaSampler> build_sampler() const { return sampler_of(build()); }
  /// With its BSDF, emitter, sensor and media.
  std::shared_ptr<Asset> build_asset() const {
    return std::dynamic_pointer_cast<Asset>(make_element(*info_, properties_));
  }

private:
  const PluginInfo* info_;
  Properties properties_;
};

/// A shape as a primitive of a scene, without BSDF, emitter and media.
inline Primitive primitive_of(const ShapePtr& shape) {
  Primitive primitive;
  primitive.shape = shape, primitive.element = shape->shared_properties();
  return primitive;
}

/// An asset of any shape, made without its parameters.
class GivenAsset final : public Asset {
public:
  explicit GivenAsset(const ShapePtr& shape) : Asset(shape->properties()) {
    primitives_ = {primitive_of(shape)};
  }
};

/// An Embree scene of one shape.
class OneShapeScene {
public:
  explicit OneShapeScene(const Shape& shape)
      : device_(rtcNewDevice("threads=1")), scene_(rtcNewScene(device_)), shape_(shape) {
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry g = shape.make_geometry(device_);
    rtcAttachGeometry(scene_, g);
    rtcReleaseGeometry(g);
    rtcCommitScene(scene_);
  }
  ~OneShapeScene() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  OneShapeScene(const OneShapeScene&) = delete;
  OneShapeScene& operator=(const OneShapeScene&) = delete;

  struct Hit {
    float t, u, v;
    std::uint32_t primitive;
    SurfacePoint point;
  };
  std::optional<Hit> intersect(const Ray& ray) const {
    RTCRayHit r = query(ray);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene_, &context, &r);
    if (r.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    return Hit{r.ray.tfar, r.hit.u, r.hit.v, r.hit.primID,
               shape_.surface_point({0, r.hit.primID, r.hit.u, r.hit.v, r.ray.tfar}, ray)};
  }
  bool occluded(const Ray& ray) const {
    RTCRayHit r = query(ray);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene_, &context, &r.ray);
    return r.ray.tfar < 0;
  }
  RTCScene scene() const { return scene_; }

private:
  static RTCRayHit query(const Ray& ray) {
    RTCRayHit r{};
    r.ray.org_x = ray.o.x, r.ray.org_y = ray.o.y, r.ray.org_z = ray.o.z;
    r.ray.dir_x = ray.d.x, r.ray.dir_y = ray.d.y, r.ray.dir_z = ray.d.z;
    r.ray.tfar = ray.t_max, r.ray.mask = ~0u;
    r.hit.geomID = r.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    return r;
  }
  RTCDevice device_;
  RTCScene scene_;
  const Shape& shape_;
};

/// Random numbers of a test, the same on every run.
class Random {
public:
  explicit Random(unsigned seed) : engine_(seed) {}
  float uniform(float a = 0, float b = 1) { return a + (b - a) * float(engine_() >> 8) * 0x1p-24f; }
  Vec2 square() {
    const float x = uniform();
    return {x, uniform()};
  }
  Vec3 direction() {
    const float z = uniform(-1, 1), phi = uniform(0, 2 * kPi), r = std::sqrt(std::max(0.f, 1 - z * z));
    return {r * std::cos(phi), r * std::sin(phi), z};
  }

private:
  std::mt19937 engine_;
};

/// A folder of its own for every test, removed at its end.
class FileTest : public ::testing::Test {
protected:
  FileTest() {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ =
        std::filesystem::temp_directory_path() / ("aureole-" + std::string(info->test_suite_name()) + "-" +
                                                  info->name() + "-" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  ~FileTest() override { std::filesystem::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& bytes) const {
    std::filesystem::remove(folder_ / name);  // overwriting a file flushes it on some file systems: slow
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return (folder_ / name).string();
  }
  std::filesystem::path folder_;
};

/// The error that building gives, or an empty string.
inline std::string build_error(const ShapeBuilder& builder) {
  try {
    builder.build_asset();
    return "";
  } catch (const Error& e) {
    return e.what();
  }
}

}  // namespace aureole::test
