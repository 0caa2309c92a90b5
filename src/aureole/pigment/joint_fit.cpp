// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/joint_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>

#include "aureole/pigment/domain.h"
#include "aureole/pigment/joint_system.h"
#include "aureole/pigment/prediction.h"

namespace aureole::pigment {

std::string specimen_key(const Sample& sample) {
  if (!sample.specimen.empty()) return sample.series + "\n" + sample.specimen;
  std::vector<Component> recipe = sample.paints;
  std::sort(recipe.begin(), recipe.end(),
            [](const Component& a, const Component& b) { return a.name < b.name; });
  return sample.series + "\n" + recipe_text(recipe, 6) + "\n" + number_text(sample.thickness);
}

JointSettings JointSettings::plain() {
  JointSettings s;
  s.noise_relative = 0;
  s.thickness = s.stated_thickness = s.dose = s.specific_volume = s.series_strength = s.series_k =
      s.series_s = s.g = 0;
  s.step_k = s.step_s = std::numeric_limits<double>::infinity();
  s.level_k = s.level_s = 50;
  s.outlier_scale = 0;
  s.iterations = 200;
  return s;
}

JointFit::JointFit(const SampleTable& table, const FilmTheory& theory, const JointSettings& settings,
                   const std::vector<std::size_t>& left_out, const JointFit* start)
    : system_(std::make_unique<JointSystem>(table, theory, settings, left_out)) {
  system_->start_from_closed_forms();
  if (start) system_->start_from(*start->system_);
  system_->solve();
  const JointSystem& s = *system_;
  palette_.nm = table.nm;
  palette_.relative = palette_.per_film = !s.metric_;
  palette_.by_volume = true;
  if (const auto by = theory.streams())
    palette_.streams = {.index = by->index, .g = by->g, .geometry = by->geometry, .specular = by->specular};
  for (int p = 0; p < s.paints(); ++p) {
    Pigment& pigment = palette_.pigments.emplace_back();
    pigment.name = s.names_[std::size_t(p)];
    pigment.density = std::exp(-s.border_[s.volume_unknown(p)]);
    if (s.has_g()) pigment.g = s.mean_cosine(p);
    for (std::size_t l = 0; l < table.nm.size(); ++l) {
      pigment.k.push_back(std::exp(s.chain_(s.paint_unknown(p, 0), Eigen::Index(l))) / s.unit_);
      pigment.s.push_back(std::exp(s.chain_(s.paint_unknown(p, 1), Eigen::Index(l))) / s.unit_);
    }
  }
}
JointFit::~JointFit() = default;
JointFit::JointFit(JointFit&&) noexcept = default;

const std::vector<std::string>& JointFit::unknown_cards() const { return system_->cards_; }

std::vector<std::string> JointFit::over_equal_cards() const {
  constexpr double kAlike = 0.05;
  std::vector<std::string> names;
  for (const JointSystem::Specimen& specimen : system_->specimens_) {
    double lowest = 1, highest = 0;
    std::set<std::string> cards;
    for (const std::size_t r : specimen.rows) {
      const JointSystem::Row& row = system_->rows_[r];
      if (row.kind != JointSystem::Row::Kind::over || row.card >= 0) continue;
      cards.insert(system_->table_.samples[row.sample].backing);
      const double reflectance = row.substrate[row.substrate.size() / 2];
      lowest = std::min(lowest, reflectance), highest = std::max(highest, reflectance);
    }
    if (cards.size() > 1 && highest - lowest < kAlike) names.push_back(specimen.name);
  }
  return names;
}

std::vector<std::string> JointFit::swapped_cards() const {
  const JointSystem& s = *system_;
  std::vector<std::string> all;
  /// Repeats over one card, and the mean reflectance of the card within the binder.
  struct Over {
    double card = 0;
    std::vector<double> mean;
    int count = 0;
  };
  for (const JointSystem::Specimen& specimen : s.specimens_) {
    std::map<std::string, Over> cards;
    for (const std::size_t r : specimen.rows) {
      const JointSystem::Row& row = s.rows_[r];
      if (row.kind != JointSystem::Row::Kind::over || row.card >= 0) continue;
      const Sample& sample = s.table_.samples[row.sample];
      Over& over = cards[sample.backing];
      over.mean.resize(s.wavelengths_), over.card = 0;
      for (std::size_t l = 0; l < s.wavelengths_; ++l) {
        over.card += row.substrate[l] / double(s.wavelengths_);
        over.mean[l] = (over.mean[l] * over.count + sample.values[l]) / (over.count + 1);
      }
      ++over.count;
    }
    if (cards.size() < 2) continue;
    const auto [dark, bright] =
        std::minmax_element(cards.begin(), cards.end(),
                            [](const auto& a, const auto& b) { return a.second.card < b.second.card; });
    std::size_t count = 0;
    for (std::size_t l = 0; l < s.wavelengths_; ++l)
      count += dark->second.mean[l] - bright->second.mean[l] > s.settings_.noise;
    if (2 * count <= s.wavelengths_) continue;
    all.push_back("\"" + specimen.name + "\" is darker over the brighter card \"" + bright->first +
                  "\" than over \"" + dark->first + "\", by more than the noise at " + std::to_string(count) +
                  " of " + std::to_string(s.wavelengths_) + " wavelengths: are the cards swapped?");
  }
  return all;
}

double JointFit::cost() const { return system_->cost_; }
int JointFit::iterations() const { return system_->iterations_; }
bool JointFit::converged() const { return system_->converged_; }

std::vector<UnknownPaint> JointFit::unknown_paints() const {
  // Thresholds of the relative difference of thickness, which stated errors may hide, and of the difference
  // in reflectance below which two cards count as alike.
  constexpr double kThicker = 0.1, kAlike = 0.05;
  const JointSystem& s = *system_;
  /// The measurements of one paint alone. Films that differ in thickness or card depend in different ways on
  /// K and S.
  struct Film {
    double ln_thickness = 0;
    const JointSystem::Row* row = nullptr;
  };
  struct Evidence {
    bool is_told = false, has_opaque = false;
    std::vector<Film> films;
  };
  const auto differ = [&](const Film& a, const Film& b) {
    if (std::abs(a.ln_thickness - b.ln_thickness) > kThicker) return true;
    if (a.row->card >= 0 || b.row->card >= 0) return a.row->card != b.row->card;
    double difference = 0;
    for (std::size_t l = 0; l < s.wavelengths_; ++l)
      difference += std::abs(a.row->substrate[l] - b.row->substrate[l]) / double(s.wavelengths_);
    return difference > kAlike;
  };
  std::vector<Evidence> all(s.names_.size());
  for (const JointSystem::Specimen& specimen : s.specimens_)
    for (const JointSystem::Part& part : specimen.parts) {
      Evidence& paint = all[std::size_t(part.paint)];
      if (specimen.parts.size() > 1) paint.is_told = true;
      for (const std::size_t r : specimen.rows) {
        const JointSystem::Row& row = s.rows_[r];
        if (row.kind == JointSystem::Row::Kind::opaque)
          paint.has_opaque = true;
        else if (row.kind == JointSystem::Row::Kind::over)
          paint.films.push_back({specimen.ln_thickness, &row});
        else
          paint.is_told = true;
      }
    }
  std::vector<UnknownPaint> unknown;
  for (std::size_t p = 0; p < all.size(); ++p) {
    const Evidence& e = all[p];
    // Two films that differ in thickness or card give two equations for K and S; so do an opaque layer and a
    // film.
    const bool two_films = std::any_of(e.films.begin(), e.films.end(),
                                       [&](const Film& film) { return differ(film, e.films.front()); });
    if (!e.is_told && !two_films && !(e.has_opaque && !e.films.empty()))
      unknown.push_back({s.names_[p], e.has_opaque});
  }
  return unknown;
}

double joint_fit_seconds(const SampleTable& table, const JointSettings& settings) {
  std::set<std::string> paints, specimens;
  std::set<std::pair<std::string, std::string>> variants;
  std::map<std::string, int> series;
  double doses = 0;
  for (const Sample& sample : table.samples) {
    if (sample.paints.empty()) continue;
    if (specimens.insert(specimen_key(sample)).second && sample.paints.size() > 1 && settings.dose > kFixed)
      doses += double(sample.paints.size());
    for (const Component& c : sample.paints) {
      paints.insert(c.name);
      if (variants.emplace(sample.series, c.name).second) ++series[c.name];
    }
  }
  double local = 2 * double(paints.size());
  for (const auto& [of_series, name] : variants) local += series[name] > 1 ? 3 : 0;
  const double border = double(specimens.size() + paints.size()) + doses;
  // Number of operations of a step: factorisations of the blocks, their products with the border, and the
  // factorisation of the border.
  const double step = double(table.nm.size()) * local * (local * local + local * border + border * border) +
                      border * border * border;
  constexpr double kSecondsPerOperation = 2.6e-10, kSteps = 20;
  return kSteps * kSecondsPerOperation * step;
}

namespace {

/// Factorises the system, so that the covariance of all unknowns can be applied to columns.
void factorise(JointSystem& s) {
  if (s.factors_) return;
  s.matrix_ = std::make_shared<NormalChain>();
  std::vector<ColumnMatrix> gradient;
  ColumnMatrix edge;
  s.assemble(*s.matrix_, gradient, edge);
  s.factors_ = std::make_shared<NormalChainFactors>(*s.matrix_, 1e-12);
  if (!s.factors_->good()) throw std::domain_error("the data and the stated errors do not determine the fit");
}

/// Returns the covariance of the unknowns that all wavelengths share.
ColumnMatrix border_covariance(JointSystem& s) {
  factorise(s);
  ColumnMatrix covariance = ColumnMatrix::Identity(s.border_.size(), s.border_.size());
  std::vector<ColumnMatrix> chain(s.wavelengths_, ColumnMatrix::Zero(s.chain_.rows(), s.border_.size()));
  s.factors_->solve(chain, covariance);
  return covariance;
}

}  // namespace

/// Relative error that stands for an unknown number: no interval excludes any value.
constexpr double kUnknownError = 1e3;

std::vector<PaintErrors> JointFit::errors(double noise_scale) {
  JointSystem& s = *system_;
  // Factors of the equations with this noise; those with the stated noise are kept.
  auto factors = std::move(s.factors_);
  auto matrix = std::move(s.matrix_);
  const auto restore = [&] { s.noise_scale_ = 1, s.factors_ = factors, s.matrix_ = matrix; };
  s.noise_scale_ = noise_scale;
  if (noise_scale == 1) restore();
  std::vector<PaintErrors> all(std::size_t(s.paints()));
  try {
    factorise(s);
    const Eigen::Index size = s.chain_.rows(), edge = s.border_.size(), columns = 2 * s.paints();
    for (PaintErrors& e : all)
      e.k.resize(s.wavelengths_), e.s.resize(s.wavelengths_), e.ratio.resize(s.wavelengths_);
    for (std::size_t l = 0; l < s.wavelengths_; ++l) {
      std::vector<ColumnMatrix> chain(s.wavelengths_, ColumnMatrix::Zero(size, columns));
      ColumnMatrix border = ColumnMatrix::Zero(edge, columns);
      chain[l].topRows(columns).setIdentity();
      s.factors_->solve(chain, border);
      for (int p = 0; p < s.paints(); ++p) {
        const int k = s.paint_unknown(p, 0), t = s.paint_unknown(p, 1);
        const double kk = chain[l](k, k), ss = chain[l](t, t), ks = chain[l](k, t);
        PaintErrors& e = all[std::size_t(p)];
        e.k[l] = std::sqrt(kk), e.s[l] = std::sqrt(ss),
        e.ratio[l] = std::sqrt(std::max(0.0, kk + ss - 2 * ks));
      }
    }
  } catch (...) {
    if (noise_scale != 1) restore();
    throw;
  }
  if (noise_scale != 1) restore();
  for (const UnknownPaint& paint : unknown_paints())
    if (!paint.ratio_is_known) {
      const std::vector<double> unknown(s.wavelengths_, kUnknownError);
      all[*palette_.find(paint.name)] = {unknown, unknown, unknown};
    }
  return all;
}

void JointFit::with_errors() {
  ratio_error_.clear();
  const std::vector<PaintErrors> all = errors();
  for (std::size_t p = 0; p < all.size(); ++p) {
    Pigment& pigment = palette_.pigments[p];
    pigment.k_error = pigment.k, pigment.s_error = pigment.s;
    for (std::size_t l = 0; l < pigment.k.size(); ++l)
      pigment.k_error[l] *= all[p].k[l], pigment.s_error[l] *= all[p].s[l];
    ratio_error_.push_back(all[p].ratio);
  }
}

ResidualReport JointFit::residuals() const {
  JointSystem& s = *system_;
  factorise(s);
  constexpr Eigen::Index kProbes = 32;
  std::vector<ColumnMatrix> chain(s.wavelengths_, ColumnMatrix::Zero(s.chain_.rows(), kProbes));
  ColumnMatrix border = ColumnMatrix::Zero(s.border_.size(), kProbes);
  std::mt19937 random(1);
  ResidualReport report;
  double squares = 0;
  for (const JointSystem::Row& row : s.rows_) {
    const JointSystem::Specimen& specimen = s.specimens_[std::size_t(row.specimen)];
    for (std::size_t l = 0; l < s.wavelengths_; ++l) {
      const double measured = s.table_.samples[row.sample].values[l],
                   weight = std::sqrt(specimen.weight) / s.sigma(measured, row.scatter);
      const JointSystem::Local local = s.evaluate(specimen, row, l, s.chain_, s.border_);
      Eigen::RowVectorXd at = Eigen::RowVectorXd::Zero(s.chain_.rows()),
                         shared = Eigen::RowVectorXd::Zero(s.border_.size());
      s.derivatives(specimen, local, row, l, at, shared);
      Eigen::RowVectorXd signs(kProbes);
      for (Eigen::Index p = 0; p < kProbes; ++p) signs[p] = random() & 1 ? weight : -weight;
      chain[l].noalias() += at.transpose() * signs, border.noalias() += shared.transpose() * signs;
      squares += std::pow(weight * (local.film.value - measured), 2);
      report.values += specimen.weight;
    }
  }
  const std::vector<ColumnMatrix> right = chain;
  const ColumnMatrix right_border = border;
  s.factors_->solve(chain, border);
  double trace = right_border.cwiseProduct(border).sum();
  for (std::size_t l = 0; l < s.wavelengths_; ++l) trace += right[l].cwiseProduct(chain[l]).sum();
  report.freedom = std::max(0.0, report.values - trace / double(kProbes));
  // With few degrees of freedom residuals are small whatever the noise is.
  constexpr double kLeast = 10, kLeastShare = 0.05;
  if (report.freedom > std::max(kLeast, kLeastShare * report.values))
    report.relative = std::sqrt(squares / report.freedom);
  return report;
}

std::vector<SpecimenReport> JointFit::specimens(bool with_errors) const {
  const JointSystem& s = *system_;
  std::vector<SpecimenReport> all;
  const ColumnMatrix covariance = with_errors ? border_covariance(*system_) : ColumnMatrix();
  const auto error = [&](int unknown) { return with_errors ? std::sqrt(covariance(unknown, unknown)) : 0.0; };
  for (std::size_t n = 0; n < s.specimens_.size(); ++n) {
    const JointSystem::Specimen& specimen = s.specimens_[n];
    SpecimenReport& report = all.emplace_back();
    report.name = specimen.name, report.weight = specimen.weight;
    double sum = 0;
    for (const std::size_t r : specimen.rows) {
      const std::size_t sample = s.rows_[r].sample;
      report.samples.push_back(sample);
      const std::vector<double>& measured = s.table_.samples[sample].values;
      for (std::size_t l = 0; l < s.wavelengths_; ++l) {
        const double difference =
            s.evaluate(specimen, s.rows_[r], l, s.chain_, s.border_).film.value - measured[l];
        sum += difference * difference;
        if (std::abs(difference) <= std::abs(report.worst)) continue;
        report.worst = difference, report.worst_sample = sample, report.worst_nm = s.table_.nm[l];
      }
    }
    report.rms = std::sqrt(sum / double(specimen.rows.size() * s.wavelengths_));
    // Amounts are reported relative to each other: their common factor is thickness.
    double volume = 0, fitted = 0;
    for (const JointSystem::Part& part : specimen.parts) {
      const double v = part.fraction * std::exp(s.border_[s.volume_unknown(part.paint)]);
      volume += v, fitted += part.dose >= 0 ? v * std::exp(s.border_[s.dose_unknown(part.dose)]) : v;
    }
    report.thickness = std::exp(s.border_[s.thickness_unknown(int(n))]) * fitted / volume;
    report.thickness_error = report.thickness * error(s.thickness_unknown(int(n)));
    for (const JointSystem::Part& part : specimen.parts)
      if (part.dose >= 0) {
        const double factor = std::exp(s.border_[s.dose_unknown(part.dose)]) * volume / fitted;
        report.doses.push_back(
            {s.names_[std::size_t(part.paint)], factor, factor * error(s.dose_unknown(part.dose))});
      }
  }
  return all;
}

std::vector<double> JointFit::specific_volumes() const {
  const JointSystem& s = *system_;
  std::vector<double> all;
  for (int p = 0; p < s.paints(); ++p) all.push_back(std::exp(s.border_[s.volume_unknown(p)]));
  return all;
}

std::vector<MeanCosine> JointFit::mean_cosines() const {
  const JointSystem& s = *system_;
  std::vector<MeanCosine> all;
  if (!s.has_g()) return all;
  const ColumnMatrix covariance = border_covariance(*system_);
  for (int p = 0; p < s.paints(); ++p) {
    const double g = s.mean_cosine(p);
    all.push_back({g, (1 - g) * std::sqrt(covariance(s.g_unknown(p), s.g_unknown(p)))});
  }
  return all;
}

JointPrediction JointFit::predict(const Sample& sample, bool with_error) const {
  JointSystem& s = *system_;
  const JointSystem::Specimen specimen = s.specimen_of(sample);
  const std::size_t cards = s.cards_.size();
  const JointSystem::Row row = s.row_of(0, sample);
  if (s.cards_.size() > cards) {
    s.cards_.pop_back();
    throw std::domain_error("there is no bare substrate \"" + sample.backing + "\"");
  }
  JointPrediction result;
  const Eigen::Index size = s.chain_.rows(), edge = s.border_.size(), count = Eigen::Index(s.wavelengths_);
  std::vector<ColumnMatrix> chain;
  ColumnMatrix border;
  if (with_error) {
    factorise(s);
    chain.assign(s.wavelengths_, ColumnMatrix::Zero(size, count)), border = ColumnMatrix::Zero(edge, count);
  }
  std::vector<double> own(s.wavelengths_);
  for (std::size_t l = 0; l < s.wavelengths_; ++l) {
    const JointSystem::Local local = s.evaluate(specimen, row, l, s.chain_, s.border_, false);
    result.values.push_back(local.film.value);
    if (!with_error) continue;
    Eigen::RowVectorXd at = Eigen::RowVectorXd::Zero(size), shared = Eigen::RowVectorXd::Zero(edge);
    s.derivatives(specimen, local, row, l, at, shared);
    chain[l].col(Eigen::Index(l)) = at.transpose(), border.col(Eigen::Index(l)) = shared.transpose();
    // Only the specimen itself determines its own deviations, not the other specimens.
    const bool stated = s.metric_ && sample.thickness > 0;
    const double thickness = stated ? s.settings_.stated_thickness : s.settings_.thickness;
    double variance = std::pow(s.sigma(local.film.value), 2);
    if (row.kind != JointSystem::Row::Kind::opaque)
      variance += std::pow(thickness * (local.film.by_ln_k + local.film.by_ln_s), 2);
    if (specimen.parts.size() > 1)
      for (std::size_t i = 0; i < specimen.parts.size(); ++i)
        variance += std::pow(
            s.settings_.dose * (local.film.by_ln_k * local.k[i] + local.film.by_ln_s * local.s[i]), 2);
    own[l] = variance;
  }
  if (!with_error) return result;
  const std::vector<ColumnMatrix> right = chain;
  const ColumnMatrix right_border = border;
  s.factors_->solve(chain, border);
  for (std::size_t l = 0; l < s.wavelengths_; ++l) {
    const auto i = Eigen::Index(l);
    const double variance = right[l].col(i).dot(chain[l].col(i)) + right_border.col(i).dot(border.col(i));
    result.error.push_back(std::sqrt(std::max(0.0, variance) + own[l]));
  }
  return result;
}

std::vector<std::string> joint_notes(const JointFit& fit) {
  std::vector<std::string> notes;
  for (const std::string& card : fit.unknown_cards())
    notes.push_back("no line without paints is called \"" + card +
                    "\": the reflectance of this card is an unknown");
  for (const UnknownPaint& paint : fit.unknown_paints())
    notes.push_back(
        "the paint \"" + paint.name +
        (paint.ratio_is_known
             ? "\" was measured alone and opaque: only K/S is known; missing is a tint with a white, or a film"
             : "\" was measured as one film over one card, or over cards that are alike: neither K nor S nor K/S is "
               "known, and the numbers are guesses; missing is the film over a card that differs, an opaque layer, "
               "or a tint with a white"));
  for (std::string& note : fit.swapped_cards()) notes.push_back(std::move(note));
  if (!fit.converged())
    notes.push_back("the fit did not converge in " + std::to_string(fit.iterations()) +
                    " steps; its numbers are those of the last one");
  std::string names;
  for (const std::string& name : fit.over_equal_cards()) names += (names.empty() ? "" : ", ") + name;
  if (!names.empty())
    notes.push_back("the cards below " + names +
                    " reflect nearly the same, so that they tell nothing of transmission");
  return notes;
}

std::vector<std::string> range_notes(const SampleTable& table, const Surface& surface) {
  constexpr double kLargest = 1.05;
  int count = 0;
  std::string first;
  for (std::size_t s = 0; s < table.samples.size(); ++s) {
    const Sample& sample = table.samples[s];
    for (std::size_t l = 0; l < sample.values.size(); ++l) {
      const double value = sample.values[l];
      const std::string at = "sample \"" + sample.name + "\" at " + number_text(table.nm[l]) + " nm: ";
      if (value > kLargest)
        throw SampleError(s, int(l),
                          at + number_text(value) +
                              " is above 1.05; are these per cent, or is a digit wrong?" +
                              right_reflectance_line(sample, table.nm[l], value, kLargest));
      if (sample.quantity == Sample::Quantity::transmittance) continue;
      try {
        inner_reflectance(surface, value);
      } catch (const std::domain_error& e) {
        if (count++ == 0)
          first = (sample.line > 0 ? "line " + std::to_string(sample.line) + ", " : "") + at + e.what();
      }
    }
  }
  if (count == 0) return {};
  return {std::to_string(count) + (count == 1 ? " value" : " values") +
          " that no paint has under this interface count as noise; the first: " + first};
}

}  // namespace aureole::pigment
