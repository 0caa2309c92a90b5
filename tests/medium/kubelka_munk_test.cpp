// SPDX-License-Identifier: Apache-2.0
// The medium `kubelka_munk`: coefficients by hand, and wrong parameters.
#include <gtest/gtest.h>

#include "aureole/medium/medium.h"
#include "harness/paths.h"
#include "harness/properties_builder.h"
#include "medium/scene_text.h"

namespace aureole::testing {
namespace {

std::shared_ptr<const Medium> paint_medium(const std::string& content, double unit_m = 1) {
  auto context = std::make_shared<BuildContext>(*make_context());
  context->length_unit_m = unit_m;
  return build<Medium>("<medium type=\"kubelka_munk\">" + content + "</medium>", context, test::example_file);
}

MediumCoefficients at(const Medium& medium, float nm) {
  MediumCoefficients c;
  medium.eval({}, {0, 0, 1}, Wavelengths::at(make_context()->grid, Spectrum(nm)), c);
  return c;
}

TEST(KubelkaMunkMedium, CoefficientsByConvention) {
  const std::string content =
      parameter("k", 6) + parameter("s", 3) + "<phase type=\"hg\">" + parameter("g", 0.5) + "</phase>";
  const std::pair<const char*, double> scattering[] = {
      {"three_quarters", 8}, {"diffusion", 10}, {"double_gauss", 4.8}};
  for (const auto& [convention, sigma_s] : scattering) {
    const auto medium = paint_medium(content + "<string name=\"convention\" value=\"" + convention + "\"/>");
    const MediumCoefficients c = at(*medium, 550);
    EXPECT_NEAR(double(c.sigma_s[0]), sigma_s, 2e-3) << convention;  // g by quadrature
    EXPECT_NEAR(double(c.sigma_t[0] - c.sigma_s[0]), 3, 1e-5) << convention;
  }
}

TEST(KubelkaMunkMedium, RecipesAreInUnitsOfTheScene) {
  const std::string white =
      "<string name=\"palette\" value=\"two_paints.csv\"/><string name=\"recipe\" value=\"white\"/>";
  const MediumCoefficients in_metres = at(*paint_medium(white), 500),
                           in_mm = at(*paint_medium(white, 1e-3), 500);
  EXPECT_GT(in_metres.sigma_s[0], 1e3f);
  EXPECT_NEAR(double(in_mm.sigma_s[0] / in_metres.sigma_s[0]), 1e-3, 1e-8);
}

TEST(KubelkaMunkMedium, WrongParametersAreLocated) {
  const auto says = [](const std::string& content, const std::string& part) {
    try {
      paint_medium(content);
      ADD_FAILURE() << "no error: " << content;
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
    }
  };
  const std::string red = "<string name=\"recipe\" value=\"red\"/>";
  says(parameter("k", 1), "give \"k\" and \"s\"");
  says(red, "required for this palette");
  says(red + parameter("scale", 10) + parameter("k", 1), "a recipe has its own K and S");
  says("<string name=\"recipe\" value=\"rad\"/>" + parameter("scale", 10), "did you mean \"red\"?");
  says("<boolean name=\"by_volume\" value=\"true\"/>", "belongs to a \"recipe\"");
  says(parameter("k", 1) + parameter("s", -1), "parameter \"s\"");
  says(parameter("k", 1) + parameter("s", 1e30),
       "parameter \"s\" of \"kubelka_munk\": the extinction becomes");
  says(parameter("k", 1) + parameter("s", 1) + "<string name=\"convention\" value=\"klein\"/>", "convention");
}

}  // namespace
}  // namespace aureole::testing
