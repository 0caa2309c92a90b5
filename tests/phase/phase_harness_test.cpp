// SPDX-License-Identifier: Apache-2.0
// Runs the rules of scattering functions over every registered phase function, and checks that they see the
// errors that a phase function may have.
#include "harness/phase_harness.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "harness/check_report.h"
#include "harness/paths.h"
#include "harness/properties_builder.h"

namespace aureole::testing {
namespace {

std::string hg(const char* g) {
  return std::string("<phase type=\"hg\"><float name=\"g\" value=\"") + g + "\"/></phase>";
}
std::string sggx(const char* s) {
  return std::string("<phase type=\"sggx\"><string name=\"S\" value=\"") + s + "\"/></phase>";
}
std::string table(const char* values) {
  return std::string("<phase type=\"tabphase\"><string name=\"values\" value=\"") + values + "\"/></phase>";
}
PhaseCase peaked(std::string name, std::string xml, double angle) {
  PhaseCase c(std::move(name), std::move(xml));
  has_peaks(c, angle);
  return c;
}

const PhaseCases kHg("hg", {},
                     {{"hg_isotropic", hg("0")},
                      {"hg_backward", hg("-0.7")},
                      peaked("hg_peak", hg("0.995"), 0.002),
                      peaked("hg_backward_peak", hg("-0.99"), 0.003)});

const PhaseCases kRayleigh(
    "rayleigh", {},
    {{"rayleigh_depolarised",
      R"(<phase type="rayleigh"><float name="depolarization" value="0.8"/></phase>)"}});

const PhaseCases kTable("tabphase", {},
                        {{"tabphase_two_values", table("1 3")},
                         {"tabphase_even", table("0, 1, 0.5, 2")},
                         {"tabphase_forward_only", table("0, 0, 0, 0, 1, 0")}});

const PhaseCases kSggx("sggx", {},
                       {{"sggx_sphere", sggx("1, 1, 1, 0, 0, 0")},
                        {"sggx_any", sggx("0.5, 0.9, 0.2, 0.1, -0.15, 0.05")},
                        {"sggx_flakes", sggx("0.01, 0.01, 1, 0, 0, 0")}});

const PhaseCases kBlend(
    "blendphase", {},
    {{"blendphase_areas", "<phase type=\"blendphase\"><float name=\"weight\" value=\"0.4\"/>" +
                              sggx("0.3, 0.9, 0.1, 0.05, 0, 0.1") + hg("0.5") + "</phase>"},
     {"blendphase_second_alone", "<phase type=\"blendphase\"><float name=\"weight\" value=\"1\"/>" +
                                     hg("0.2") + hg("-0.5") + "</phase>"},
     {"blendphase_nested", "<phase type=\"blendphase\"><float name=\"weight\" value=\"0.5\"/>" + hg("0.2") +
                               "<phase type=\"blendphase\"><float name=\"weight\" value=\"0.1\"/>" +
                               hg("-0.2") + hg("0.8") + "</phase></phase>"}});

class PhaseHarness : public ::testing::TestWithParam<std::size_t> {};

TEST_P(PhaseHarness, Passes) {
  const std::vector<PhaseCase> cases = all_phase_cases();
  PhaseCase c = cases[GetParam()];
  c.family_size = cases.size();
  const auto phase = build<PhaseFunction>(c.xml, make_context(c.min_nm, c.max_nm), test::example_file);
  const CheckResult result = check_phase(*phase, c);
  for (const std::string& failure : report(c.name, result, ::testing::TempDir())) ADD_FAILURE() << failure;
  EXPECT_GT(result.statistical_tests, 12u);
}

INSTANTIATE_TEST_SUITE_P(Phase, PhaseHarness, ::testing::Range(std::size_t(0), all_phase_cases().size()),
                         [](const auto& info) { return all_phase_cases()[info.param].name; });

// A check that never fails would pass every test above: each of these breaks one rule.
enum class Fault { none, absorbs, area, shape };

/// Flakes with one fault.
class Faulty final : public PhaseFunction {
public:
  Faulty(const Properties& p, Fault fault)
      : PhaseFunction(p),
        fault_(fault),
        right_(build<PhaseFunction>(fault == Fault::shape ? hg("0.6") : sggx("0.1, 0.4, 1, 0, 0, 0"),
                                    p.shared_context())),
        sampled_(fault == Fault::shape ? build<PhaseFunction>(hg("0.63"), p.shared_context()) : right_) {}

  PhaseEval eval_pdf(const Vec3& wi, const Vec3& wo, const PhaseContext& ctx) const override {
    PhaseEval e = right_->eval_pdf(wi, wo, ctx);
    if (fault_ == Fault::absorbs) e.value *= 0.98f;
    return e;
  }
  std::optional<PhaseSample> sample(const Vec3& wi, float u1, Vec2 u2,
                                    const PhaseContext& ctx) const override {
    auto s = sampled_->sample(wi, u1, u2, ctx);
    if (s && fault_ == Fault::shape) {
      const PhaseEval e = right_->eval_pdf(wi, s->wo, ctx);
      s->value = e.value, s->pdf = e.pdf;
    }
    if (s && fault_ == Fault::absorbs) s->value *= 0.98f;
    return s;
  }
  float projected_area(const Vec3& d, const Vec3& p) const override {
    return fault_ == Fault::area ? 1 : right_->projected_area(d, p);
  }
  bool is_isotropic_medium() const override { return fault_ == Fault::shape; }

private:
  Fault fault_;
  PhaseFunctionPtr right_, sampled_;
};

CheckResult check(Fault fault) {
  const auto context = make_context();
  CheckOptions options;
  options.samples = 40000;  // as PhaseCase
  return check_phase(Faulty(Properties("faulty", "", {}, context), fault), options);
}
bool fails(const CheckResult& r, CheckRule rule) {
  return std::any_of(r.findings.begin(), r.findings.end(),
                     [&](const CheckFinding& f) { return f.rule == rule && !f.passed; });
}

TEST(PhaseHarnessItself, AcceptsWhatIsRight) {
  EXPECT_EQ(check(Fault::none).problems(), std::vector<std::string>{});
}
TEST(PhaseHarnessItself, SeesLostEnergy) { EXPECT_TRUE(fails(check(Fault::absorbs), CheckRule::energy)); }
TEST(PhaseHarnessItself, SeesAWrongShape) { EXPECT_TRUE(fails(check(Fault::shape), CheckRule::chi_square)); }
TEST(PhaseHarnessItself, SeesAMissingArea) { EXPECT_TRUE(fails(check(Fault::area), CheckRule::reciprocity)); }

}  // namespace
}  // namespace aureole::testing
