// SPDX-License-Identifier: Apache-2.0
// Amplitudes of specular reflections: the powers that BSDFs sample, and which BSDFs have them.
#include "aureole/bsdf/mirror_reflection.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bsdf/bsdf_test_support.h"
#include "harness/properties_builder.h"

namespace aureole::testing {
namespace {

TEST(MirrorReflections, AmplitudesAreThoseOfTheSampledPowers) {
  for (
      const char* xml :
      {R"(<bsdf type="conductor"><string name="material" value="none"/></bsdf>)",
       R"(<bsdf type="conductor"><string name="material" value="Cu"/><float name="specular_reflectance" value="0.7"/></bsdf>)",
       R"(<bsdf type="dielectric"><float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/></bsdf>)",
       R"(<bsdf type="slab"><string name="int_ior" value="Au"/><float name="ext_ior" value="1"/><string name="thickness" value="20nm"/></bsdf>)",
       R"(<bsdf type="plastic"><float name="int_ior" value="1.4"/><float name="diffuse_reflectance" value="0"/></bsdf>)",
       R"(<bsdf type="twosided"><bsdf type="conductor"><string name="material" value="Al"/></bsdf></bsdf>)",
       R"(<bsdf type="freespacediffraction"><bsdf type="conductor"><string name="material" value="Al"/></bsdf></bsdf>)"}) {
    const auto bsdf = build<Bsdf>(xml);
    const MirrorReflection* mirror = mirror_reflection_of(*bsdf);
    ASSERT_TRUE(mirror) << xml;
    const Setting s;
    for (const double degrees : {0.0, 30.0, 60.0, 85.0}) {
      const Vec3 wi = direction(degrees * kDegree, 0.4);
      // The first random number chooses the reflection in all of them.
      const auto sample = bsdf->sample(wi, 0, {0.5f, 0.5f}, s.context());
      ASSERT_TRUE(sample && sample->is_delta()) << xml;
      const auto a = mirror->reflection_amplitudes(wi.z, s.context());
      for (int i = 0; i < kWavelengths; ++i) {
        const double power = 0.5 * (std::norm(a.s[std::size_t(i)]) + std::norm(a.p[std::size_t(i)]));
        EXPECT_NEAR(power, double(sample->value[i]), 2e-5) << xml << " at " << degrees << " degrees";
      }
    }
  }
}

// A mirror below a coat reflects no wave by itself, and a sheet with two different sides has no one reflection.
TEST(MirrorReflections, CoatsHaveNone) {
  for (
      const char* xml :
      {R"(<bsdf type="paint"><string name="recipe" value="magenta"/><float name="thickness" value="0.7"/><bsdf type="conductor"/></bsdf>)",
       R"(<bsdf type="mask"><float name="opacity" value="0.5"/><bsdf type="conductor"/></bsdf>)",
       R"(<bsdf type="twosided"><bsdf type="conductor"/><bsdf type="diffuse"/></bsdf>)",
       R"(<bsdf type="roughconductor"/>)", R"(<bsdf type="diffuse"/>)"})
    EXPECT_FALSE(mirror_reflection_of(*build<Bsdf>(xml))) << xml;
}

}  // namespace
}  // namespace aureole::testing
