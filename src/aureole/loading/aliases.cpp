// SPDX-License-Identifier: Apache-2.0
#include "aureole/loading/aliases.h"

#include "aureole/plugin/registry.h"

namespace aureole {

namespace {

constexpr std::string_view kOneIntegrator = "one integrator does surfaces and media";
constexpr std::string_view kBetterSampler = "it is stratified in every dimension";

constexpr std::string_view kPlain = "its picture is the same; derivatives of pictures are not computed";
/// Parameters of Mitsuba's differentiable integrators that say how to estimate derivatives.
const std::vector<std::string_view> kDerivatives = {"sppc",
                                                    "sppp",
                                                    "sppi",
                                                    "guiding",
                                                    "guiding_proj",
                                                    "guiding_rounds",
                                                    "reparam_max_depth",
                                                    "reparam_rays",
                                                    "reparam_kappa",
                                                    "reparam_exp",
                                                    "reparam_antithetic",
                                                    "reparam_unroll"};

const std::vector<PluginAlias> kAliases = {
    {"bsdf", "roughdiffuse", "oren_nayar", "the name of that model", {}},
    {"integrator", "direct_projective", "direct", kPlain, kDerivatives},
    {"integrator", "direct_reparam", "direct", kPlain, kDerivatives},
    {"integrator", "emission_reparam", "path", kPlain, kDerivatives},
    {"integrator", "prb", "path", kPlain, kDerivatives},
    {"integrator", "prb_basic", "path", kPlain, kDerivatives},
    {"integrator", "prb_projective", "path", kPlain, kDerivatives},
    {"integrator", "prb_reparam", "path", kPlain, kDerivatives},
    {"integrator", "prbvolpath", "path", kPlain, kDerivatives, "count_crossings"},
    {"integrator", "volpath_simple", "path", kOneIntegrator, {}, "count_crossings"},
    {"integrator", "volpath", "path", kOneIntegrator, {}, "count_crossings"},
    {"integrator", "volpathmis", "path", kOneIntegrator, {"use_spectral_mis"}, "count_crossings"},
    {"sampler", "halton", "sobol", kBetterSampler, {"scramble", "dimension"}},
    {"sampler", "hammersley", "sobol", kBetterSampler, {"scramble", "dimension"}},
    {"sampler", "ldsampler", "sobol", kBetterSampler, {"dimension"}},
    {"sampler", "multijitter", "sobol", kBetterSampler, {"jitter"}},
    {"sampler", "orthogonal", "sobol", kBetterSampler, {"jitter", "strength"}},
    {"sampler", "stratified", "sobol", kBetterSampler, {"dimension", "jitter"}},
};

}  // namespace

const PluginAlias* find_alias(std::string_view family, std::string_view name) {
  // A registered plug-in of this name takes precedence over a replacement.
  if (Registry::instance().find(family, name)) return nullptr;
  for (const PluginAlias& alias : kAliases)
    if (alias.family == family && alias.name == name) return &alias;
  return nullptr;
}

const PluginInfo* find_plugin(std::string_view family, std::string_view name) {
  const PluginAlias* alias = find_alias(family, name);
  return Registry::instance().find(family, alias ? alias->replacement : name);
}

}  // namespace aureole
