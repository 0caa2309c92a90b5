// SPDX-License-Identifier: Apache-2.0
// Pictures with media are the same bit for bit, as others are: for any number of threads, across interruptions, for
// parts merged, with adaptive samples.
#include <gtest/gtest.h>

#include "medium/scene_text.h"
#include "render/small_scene.h"
#include "volume/volume_test_support.h"

namespace aureole::testing {
namespace {

using aureole::test::same_bits;

/// Fog around everything, a grid that glows, a liquid whose surface a wall of glass hides, and a body with a BSSRDF.
class MediaAreDeterministic : public ::testing::TestWithParam<const char*> {
protected:
  LoadedScene scene() const {
    const std::string coloured =
        "<medium type=\"homogeneous\" name=\"interior\"><rgb name=\"sigma_t\" value=\"1, 4, 9\"/><rgb "
        "name=\"albedo\" value=\"0.9, 0.99, 0.6\"/></medium>";
    const std::string glass = "<bsdf type=\"dielectric\"/>";
    const bool two_way = std::string(GetParam()) == "bdpt";
    const std::string grid =
        "<shape type=\"cube\"><transform name=\"to_world\"><translate x=\"-2\"/></transform>" + kNull +
        "<medium type=\"heterogeneous\" name=\"interior\"><volume name=\"sigma_t\" type=\"gridvolume\"><string "
        "name=\"filename\" value=\"" +
        file_.string() +
        "\"/><transform name=\"to_world\"><scale value=\"2\"/><translate x=\"-3\" y=\"-1\" z=\"-1\"/></transform>"
        "</volume>" +
        (two_way ? "" : parameter("emission", 0.1)) + "</medium></shape>";
    const std::string body = two_way ? ""
                                     : "<shape type=\"sphere\"><point name=\"center\" x=\"0\" y=\"-2\" "
                                       "z=\"0\"/>" +
                                           parameter("radius", 0.5) +
                                           "<bssrdf type=\"dipole\"><medium type=\"homogeneous\">" +
                                           parameter("sigma_t", 20) + "</medium></bssrdf></shape>";
    return load_scene_from_string(
        "<scene version=\"3.0.0\"><integrator type=\"" + std::string(GetParam()) + "\"/>" +
            camera("origin=\"0, -8, 2\" target=\"0, 0, 0\" up=\"0, 0, 1\"", 40, 12, 32) + grid + body +
            "<shape type=\"sphere\"><float name=\"radius\" value=\"9\"/>" + kNull + medium(0.01, 0.03, 0.5) +
            "</shape><shape type=\"sphere\"><integer name=\"priority\" value=\"1\"/>" + glass + coloured +
            "<transform name=\"to_world\"><translate x=\"1.5\"/></transform></shape>" +
            "<shape type=\"cube\"><integer name=\"priority\" value=\"2\"/>" + glass +
            "<transform name=\"to_world\"><translate x=\"3\"/></transform></shape>"
            "<emitter type=\"point\"><point name=\"position\" x=\"2\" y=\"-3\" z=\"4\"/></emitter></scene>",
        "media.xml");
  }
  RenderState rendered(const RenderOptions& options) const {
    const std::atomic<bool> go{false};
    RenderJob job(scene(), options);
    EXPECT_EQ(job.run(go), RenderJob::Outcome::finished);
    return job.state();
  }

  const aureole::test::VolumeFolder folder_;
  const std::filesystem::path file_ = aureole::test::write_bytes(
      folder_.path() / "smoke.vol",
      aureole::test::make_vol({2, 2, 2}, 1, {0.2f, 0.f, 3.f, 1.f, 0.f, 0.f, 2.f, 0.7f}).bytes());
};

TEST_P(MediaAreDeterministic, ThreadsPartsAndInterruptions) {
  for (const bool adaptive : {false, true}) {
    if (adaptive && std::string(GetParam()) != "path") continue;
    RenderOptions options;
    options.threads = 1;
    if (adaptive) options.adaptive = AdaptiveTarget::display;
    const RenderState whole = rendered(options);
    EXPECT_EQ(whole.invalid_samples, 0u);
    options.threads = 3;
    EXPECT_TRUE(same_bits(whole, rendered(options)));

    RenderOptions part = options;
    part.begin = 16, part.end = 32;
    RenderState sum = rendered(part);
    EXPECT_FALSE(same_bits(whole, sum));
    part.begin = 0, part.end = 16;
    sum.merge(rendered(part));
    EXPECT_TRUE(same_bits(whole, sum));

    options.state_file = folder_.path() / "job.state";
    options.threads = 1;
    aureole::test::render_interrupted(scene(), options, [&](const RenderJob& job) {
      EXPECT_TRUE(same_bits(whole, job.state()));
      job.remove_state();
    });
  }
}

INSTANTIATE_TEST_SUITE_P(Media, MediaAreDeterministic, ::testing::Values("path", "ptracer", "bdpt"));

}  // namespace
}  // namespace aureole::testing
