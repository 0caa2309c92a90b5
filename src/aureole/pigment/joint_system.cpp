// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/joint_system.h"

#include <limits>
#include <map>
#include <set>

#include "aureole/core/letter_case.h"
#include "aureole/pigment/domain.h"
#include "aureole/pigment/kubelka_munk_inverse.h"
#include "aureole/pigment/prediction.h"

namespace aureole::pigment {
namespace {

/// Levels of K and S of an average paint, per film, and the bounds of their logarithms.
constexpr double kMeanK = -1, kMeanS = 2, kLowestLog = -15, kHighestLog = 9;

}  // namespace

JointSystem::Row JointSystem::row_of(std::size_t index, const Sample& sample) {
  Row row;
  row.sample = index;
  const bool through = sample.quantity == Sample::Quantity::transmittance;
  if (sample.backing == "opaque") {
    if (through)
      throw SampleError(index, -1,
                        "sample \"" + sample.name + "\": an opaque layer transmits nothing" +
                            right_sample_line(sample, [](Sample& r) { r.backing = "none"; }));
    row.kind = Row::Kind::opaque;
    return row;
  }
  if (sample.backing == "none") {
    row.kind = through ? Row::Kind::free_transmittance : Row::Kind::free_reflectance;
    return row;
  }
  if (through)
    throw SampleError(index, -1,
                      "sample \"" + sample.name + "\": transmittance is that of a free film, backing none" +
                          right_sample_line(sample, [](Sample& r) { r.backing = "none"; }));
  if (const auto number = backing_reflectance(sample)) {
    if (!(*number >= 0 && *number <= 1))
      throw SampleError(index, -1,
                        "sample \"" + sample.name + "\": the backing's reflectance must be in [0, 1], got " +
                            sample.backing +
                            right_sample_line(sample, [](Sample& r) { r.backing = "0.04"; }));
    row.substrate.assign(wavelengths_, *number);
    return row;
  }
  std::vector<double> mean(wavelengths_);
  int count = 0;
  for (const Sample& other : table_.samples)
    if (other.paints.empty() && other.name == sample.backing) {
      for (std::size_t l = 0; l < wavelengths_; ++l) mean[l] += other.values[l];
      ++count;
    }
  if (count > 0) {
    for (double& m : mean) m = theory_.card(m / count);
    row.substrate = std::move(mean);
    return row;
  }
  const auto at = std::find(cards_.begin(), cards_.end(), sample.backing);
  row.card = int(at - cards_.begin());
  if (at == cards_.end()) cards_.push_back(sample.backing);
  return row;
}

JointSystem::Specimen JointSystem::specimen_of(const Sample& sample) const {
  Specimen specimen;
  specimen.key = specimen_key(sample);
  specimen.name = sample.specimen.empty() ? sample.name : sample.specimen;
  specimen.series = sample.series;
  for (const Component& c : sample.paints) {
    const int paint = index_of(c.name);
    if (paint < 0) throw std::domain_error("no other sample contains the paint \"" + c.name + "\"");
    specimen.parts.push_back({paint, c.fraction, -1, variant_of(sample.series, paint)});
  }
  // The parts are sorted, since recipes list their paints in any order.
  std::sort(specimen.parts.begin(), specimen.parts.end(),
            [](const Part& a, const Part& b) { return a.paint < b.paint; });
  specimen.ln_thickness = sample.thickness > 0 && metric_ ? std::log(sample.thickness / unit_) : 0;
  return specimen;
}

void JointSystem::collect(const std::vector<std::size_t>& left_out) {
  std::set<std::pair<std::string, std::string>> pairs;
  std::map<std::string, int> series_of;
  double sum = 0;
  int stated = 0;
  const auto used = [&](std::size_t s) {
    return !table_.samples[s].paints.empty() &&
           std::find(left_out.begin(), left_out.end(), s) == left_out.end();
  };
  for (std::size_t s = 0; s < table_.samples.size(); ++s) {
    const Sample& sample = table_.samples[s];
    if (sample.paints.empty() && sample.name.empty())

      throw SampleError(s, -1, "a bare substrate needs a name" + right_sample_line(sample, [](Sample& r) {
                                 r.name = "card";
                               }));
    if (!used(s)) continue;
    for (const Component& c : sample.paints) {
      if (index_of(c.name) < 0) names_.push_back(c.name);
      if (pairs.emplace(sample.series, c.name).second) ++series_of[c.name];
    }
    if (sample.thickness > 0) sum += std::log(sample.thickness), ++stated;
  }
  if (names_.empty()) throw std::domain_error("there are no samples with paints");
  metric_ = stated > 0;
  if (metric_) unit_ = std::exp(sum / stated);
  if (settings_.series_strength > kFixed || settings_.series_k > kFixed || settings_.series_s > kFixed)
    for (const auto& [series, paint] : pairs)
      if (series_of[paint] > 1) variants_.emplace_back(series, index_of(paint));

  std::map<std::string, int> known;
  for (std::size_t s = 0; s < table_.samples.size(); ++s) {
    if (!used(s)) continue;
    const Sample& sample = table_.samples[s];
    const auto [at, is_new] = known.try_emplace(specimen_key(sample), int(specimens_.size()));
    if (is_new) {
      specimens_.push_back(specimen_of(sample));
      Specimen& added = specimens_.back();
      if (added.parts.size() > 1 && settings_.dose > kFixed)
        for (Part& part : added.parts) part.dose = doses_++;
    } else {
      // All samples of a specimen must have the same recipe.
      const Specimen& same = specimens_[std::size_t(at->second)];
      const Specimen now = specimen_of(sample);
      const bool equal = same.parts.size() == now.parts.size() &&
                         std::equal(same.parts.begin(), same.parts.end(), now.parts.begin(),
                                    [](const Part& a, const Part& b) {
                                      return a.paint == b.paint && std::abs(a.fraction - b.fraction) < 1e-6;
                                    });
      if (!equal)
        throw SampleError(
            s, -1,
            "sample \"" + sample.name + "\": its recipe differs from that of other samples of specimen \"" +
                sample.specimen + "\"" + right_sample_line(sample, [](Sample& r) { r.specimen += " b"; }));
      const double stated = table_.samples[rows_[same.rows.front()].sample].thickness;
      if (std::abs(sample.thickness - stated) > 1e-6 * std::max(sample.thickness, stated))
        throw SampleError(
            s, -1,
            "sample \"" + sample.name +
                "\": its thickness differs from that of other samples of specimen \"" +
                (sample.specimen.empty() ? same.name : sample.specimen) +
                "\"; give films of their own the column \"specimen\"" +
                right_sample_line(sample, [](Sample& r) { r.specimen += r.specimen.empty() ? "b" : " b"; }));
    }
    Row row = row_of(s, sample);
    row.specimen = at->second;
    specimens_[std::size_t(at->second)].rows.push_back(rows_.size());
    rows_.push_back(std::move(row));
  }
}

/// Measurements of one specimen over one card repeat each other. Their scatter is the root of their variance, averaged
/// over the wavelengths.
void JointSystem::set_scatter() {
  for (const Specimen& specimen : specimens_) {
    std::map<std::pair<int, std::string>, std::vector<std::size_t>> groups;
    for (const std::size_t r : specimen.rows) {
      const Sample& sample = table_.samples[rows_[r].sample];
      groups[{int(sample.quantity), sample.backing}].push_back(r);
    }
    for (const auto& [key, rows] : groups) {
      if (rows.size() < 2) continue;
      double squares = 0;
      for (std::size_t l = 0; l < wavelengths_; ++l) {
        double mean = 0;
        for (const std::size_t r : rows)
          mean += table_.samples[rows_[r].sample].values[l] / double(rows.size());
        for (const std::size_t r : rows)
          squares += std::pow(table_.samples[rows_[r].sample].values[l] - mean, 2);
      }
      for (const std::size_t r : rows)
        rows_[r].scatter = std::sqrt(squares / (double(rows.size() - 1) * double(wavelengths_)));
    }
  }
}

void JointSystem::set_priors() {
  const int variants = int(variants_.size()), cards = int(cards_.size());
  const int size = card_unknown(cards);
  chain_mean_ = JointVector::Zero(size), level_precision_ = chain_mean_;
  const double count = double(wavelengths_);
  for (int p = 0; p < paints(); ++p) {
    chain_mean_[paint_unknown(p, 0)] = kMeanK, chain_mean_[paint_unknown(p, 1)] = kMeanS;
    level_precision_[paint_unknown(p, 0)] = 1 / (settings_.level_k * settings_.level_k * count);
    level_precision_[paint_unknown(p, 1)] = 1 / (settings_.level_s * settings_.level_s * count);
  }
  for (int c = 0; c < cards; ++c) {
    // A card without a measurement starts as black or white if its name contains that word.
    const std::string name = lower_case(cards_[std::size_t(c)]);
    const bool black = name.find("black") != name.npos, white = name.find("white") != name.npos;
    const double guess = black ? 0.04 : white ? 0.85 : 0.5, sd = black || white ? 0.7 : 2;
    chain_mean_[card_unknown(c)] = std::log(guess / (1 - guess));
    level_precision_[card_unknown(c)] = 1 / (sd * sd * count);
  }
  // Deviations in a series are a Markov chain over the wavelength with this correlation over 10 nm.
  constexpr double kCorrelationK = 0.93, kCorrelationS = 0.97, kCorrelationStrength = 0.97;
  const auto set_variants = [&](double correlation, double sd, int which, double step_nm, JointVector& steps,
                                JointVector* levels) {
    const double r = std::pow(correlation, step_nm / 10),
                 variance = std::max(sd, kFixed) * std::max(sd, kFixed);
    for (int v = 0; v < variants; ++v) {
      steps[variant_unknown(v, which)] = r / (variance * (1 - r * r));
      if (levels) (*levels)[variant_unknown(v, which)] = (1 - r) * (1 - r) / (variance * (1 - r * r));
    }
  };
  for (std::size_t l = 0; l + 1 < wavelengths_; ++l) {
    const double step = table_.nm[l + 1] - table_.nm[l];
    JointVector precision = JointVector::Zero(size);
    for (int p = 0; p < paints(); ++p) {
      precision[paint_unknown(p, 0)] = 10 / (step * settings_.step_k * settings_.step_k);
      precision[paint_unknown(p, 1)] = 10 / (step * settings_.step_s * settings_.step_s);
    }
    for (int c = 0; c < cards; ++c) precision[card_unknown(c)] = 10 / (step * 0.3 * 0.3);
    set_variants(kCorrelationK, settings_.series_k, 0, step, precision, l == 0 ? &level_precision_ : nullptr);
    set_variants(kCorrelationS, settings_.series_s, 1, step, precision, l == 0 ? &level_precision_ : nullptr);
    set_variants(kCorrelationStrength, settings_.series_strength, 2, step, precision,
                 l == 0 ? &level_precision_ : nullptr);
    step_precision_.push_back(std::move(precision));
  }
  if (wavelengths_ == 1)
    for (int v = 0; v < variants; ++v)
      for (const auto& [which, sd] :
           {std::pair{0, settings_.series_k}, {1, settings_.series_s}, {2, settings_.series_strength}})
        level_precision_[variant_unknown(v, which)] = 1 / std::pow(std::max(sd, kFixed), 2);

  border_sd_ = JointVector::Constant(g_unknown(paints()), kFixed);
  for (std::size_t n = 0; n < specimens_.size(); ++n) {
    const bool stated = metric_ && table_.samples[rows_[specimens_[n].rows.front()].sample].thickness > 0;
    border_sd_[thickness_unknown(int(n))] =
        std::max(stated ? settings_.stated_thickness : settings_.thickness, kFixed);
  }
  for (int d = 0; d < doses_; ++d) border_sd_[dose_unknown(d)] = std::max(settings_.dose, kFixed);
  for (int p = 0; p < paints(); ++p)
    border_sd_[volume_unknown(p)] = std::max(settings_.specific_volume, kFixed);
  if (has_g())
    for (int p = 0; p < paints(); ++p) border_sd_[g_unknown(p)] = settings_.g;
  chain_ = chain_mean_.replicate(1, Eigen::Index(wavelengths_));
  border_ = JointVector::Zero(border_sd_.size());
}

JointSystem::Local JointSystem::evaluate(const Specimen& specimen, const Row& row, std::size_t l,
                                         const ColumnMatrix& chain, const JointVector& border,
                                         bool with_thickness) const {
  const auto column = chain.col(Eigen::Index(l));
  // Volume fractions from masses, with the deviation of each amount.
  double volume = 0;
  for (const Part& part : specimen.parts)
    volume += part.fraction * std::exp(border[volume_unknown(part.paint)]);
  Local local;
  double k = 0, s = 0;
  for (const Part& part : specimen.parts) {
    double ln = std::log(part.fraction / volume) + border[volume_unknown(part.paint)];
    if (part.dose >= 0) ln += border[dose_unknown(part.dose)];
    double ln_k = ln + column[paint_unknown(part.paint, 0)], ln_s = ln + column[paint_unknown(part.paint, 1)];
    if (part.variant >= 0)
      ln_k += column[variant_unknown(part.variant, 0)] + column[variant_unknown(part.variant, 2)],
          ln_s += column[variant_unknown(part.variant, 1)] + column[variant_unknown(part.variant, 2)];
    local.k.push_back(std::exp(ln_k)), local.s.push_back(std::exp(ln_s));
    k += local.k.back(), s += local.s.back();
  }
  for (double& v : local.k) v /= k;
  for (double& v : local.s) v /= s;
  double thickness = specimen.ln_thickness;
  if (with_thickness && row.specimen >= 0) thickness += border[thickness_unknown(row.specimen)];
  FilmLayer layer{std::log(k) + thickness, std::log(s) + thickness};
  if (has_g()) {
    // sigma_s of the parts add up, and so do sigma_s (1 - g), proportional to S: 1/(1 - g) of the layer is the mean of
    // those of the parts, weighted by S.
    double sum = 0;
    for (std::size_t i = 0; i < specimen.parts.size(); ++i)
      sum += local.g.emplace_back(local.s[i] * std::exp(-border[g_unknown(specimen.parts[i].paint)]));
    for (double& v : local.g) v /= sum;
    layer.g_shift = -std::log(sum);
  }
  switch (row.kind) {
    case Row::Kind::over: {
      const double substrate =
          row.card < 0 ? row.substrate[l] : 1 / (1 + std::exp(-column[card_unknown(row.card)]));
      local.film = theory_.over(layer, substrate);
      local.film.by_substrate *= substrate * (1 - substrate);
      break;
    }
    case Row::Kind::opaque:
      local.film = theory_.opaque(layer);
      break;
    case Row::Kind::free_reflectance:
      local.film = theory_.free_reflectance(layer);
      break;
    case Row::Kind::free_transmittance:
      local.film = theory_.free_transmittance(layer);
      break;
  }
  return local;
}

void JointSystem::derivatives(const Specimen& specimen, const Local& local, const Row& row, std::size_t,
                              Eigen::Ref<Eigen::RowVectorXd> chain,
                              Eigen::Ref<Eigen::RowVectorXd> border) const {
  const double by_k = local.film.by_ln_k, by_s = local.film.by_ln_s;
  if (row.specimen >= 0) border[thickness_unknown(row.specimen)] += by_k + by_s;
  double volume = 0;
  for (const Part& part : specimen.parts)
    volume += part.fraction * std::exp(border_[volume_unknown(part.paint)]);
  for (std::size_t i = 0; i < specimen.parts.size(); ++i) {
    const Part& part = specimen.parts[i];
    double s = by_s * local.s[i];
    if (!local.g.empty()) {
      border[g_unknown(part.paint)] += local.film.by_g_shift * local.g[i];
      s += local.film.by_g_shift * (local.s[i] - local.g[i]);
    }
    const double k = by_k * local.k[i];
    chain[paint_unknown(part.paint, 0)] += k, chain[paint_unknown(part.paint, 1)] += s;
    if (part.variant >= 0)
      chain[variant_unknown(part.variant, 0)] += k, chain[variant_unknown(part.variant, 1)] += s,
          chain[variant_unknown(part.variant, 2)] += k + s;
    if (part.dose >= 0) border[dose_unknown(part.dose)] += k + s;
    const double fraction = part.fraction * std::exp(border_[volume_unknown(part.paint)]) / volume;
    border[volume_unknown(part.paint)] += k + s - fraction * (by_k + by_s);
  }
  if (row.card >= 0) chain[card_unknown(row.card)] += local.film.by_substrate;
}

double JointSystem::total_cost(const ColumnMatrix& chain, const JointVector& border) const {
  double cost = (border.array() / border_sd_.array()).square().sum();
  cost += ((chain.colwise() - chain_mean_).array().square().colwise() * level_precision_.array()).sum();
  for (std::size_t l = 0; l + 1 < wavelengths_; ++l) {
    const auto i = Eigen::Index(l);
    cost += ((chain.col(i + 1) - chain.col(i)).array().square() * step_precision_[l].array()).sum();
  }
  for (const Row& row : rows_) {
    const Specimen& specimen = specimens_[std::size_t(row.specimen)];
    const std::vector<double>& measured = table_.samples[row.sample].values;
    for (std::size_t l = 0; l < wavelengths_; ++l) {
      const double z = (evaluate(specimen, row, l, chain, border).film.value - measured[l]) /
                       sigma(measured[l], row.scatter);
      cost += specimen.weight * z * z;
    }
  }
  return cost;
}

void JointSystem::assemble(NormalChain& matrix, std::vector<ColumnMatrix>& gradient,
                           ColumnMatrix& border_gradient) const {
  const Eigen::Index size = chain_.rows(), edge = border_.size(), rows = Eigen::Index(rows_.size());
  matrix.blocks.assign(wavelengths_, {}), matrix.to_border.assign(wavelengths_, {});
  matrix.coupling = step_precision_;
  gradient.assign(wavelengths_, {});
  matrix.border = ColumnMatrix(border_sd_.array().square().inverse().matrix().asDiagonal());
  border_gradient = (border_.array() / border_sd_.array().square()).matrix();
  JointMatrix chain(rows, size), border(rows, edge);
  JointVector residual(rows);
  for (std::size_t l = 0; l < wavelengths_; ++l) {
    chain.setZero(), border.setZero();
    for (Eigen::Index r = 0; r < rows; ++r) {
      const Row& row = rows_[std::size_t(r)];
      const Specimen& specimen = specimens_[std::size_t(row.specimen)];
      const double measured = table_.samples[row.sample].values[l];
      const double weight = std::sqrt(specimen.weight) / sigma(measured, row.scatter);
      const Local local = evaluate(specimen, row, l, chain_, border_);
      residual[r] = weight * (local.film.value - measured);
      derivatives(specimen, local, row, l, chain.row(r), border.row(r));
      chain.row(r) *= weight, border.row(r) *= weight;
    }
    matrix.blocks[l].noalias() = chain.transpose() * chain;
    matrix.to_border[l].noalias() = chain.transpose() * border;
    matrix.border.noalias() += border.transpose() * border;
    const auto i = Eigen::Index(l);
    gradient[l] = chain.transpose() * residual;
    border_gradient.noalias() += border.transpose() * residual;
    matrix.blocks[l].diagonal() += level_precision_;
    gradient[l] += (level_precision_.array() * (chain_.col(i) - chain_mean_).array()).matrix();
    if (l > 0) {
      matrix.blocks[l].diagonal() += step_precision_[l - 1];
      gradient[l] += (step_precision_[l - 1].array() * (chain_.col(i) - chain_.col(i - 1)).array()).matrix();
    }
    if (l + 1 < wavelengths_) {
      matrix.blocks[l].diagonal() += step_precision_[l];
      gradient[l] += (step_precision_[l].array() * (chain_.col(i) - chain_.col(i + 1)).array()).matrix();
    }
  }
}

void JointSystem::start_from(const JointSystem& other) {
  const auto block = [&](int to, int from) { chain_.row(to) = other.chain_.row(from); };
  for (int p = 0; p < paints(); ++p) {
    const int from = other.index_of(names_[std::size_t(p)]);
    if (from < 0) continue;
    for (const int which : {0, 1}) block(paint_unknown(p, which), other.paint_unknown(from, which));
    border_[volume_unknown(p)] = other.border_[other.volume_unknown(from)];
    border_[g_unknown(p)] = other.border_[other.g_unknown(from)];
  }
  for (std::size_t v = 0; v < variants_.size(); ++v) {
    const auto& [series, paint] = variants_[v];
    const int from = other.variant_of(series, other.index_of(names_[std::size_t(paint)]));
    for (const int which : {0, 1, 2})
      if (from >= 0) block(variant_unknown(int(v), which), other.variant_unknown(from, which));
  }
  for (std::size_t n = 0; n < specimens_.size(); ++n)
    for (std::size_t m = 0; m < other.specimens_.size(); ++m) {
      if (other.specimens_[m].key != specimens_[n].key) continue;
      const Specimen& from = other.specimens_[m];
      border_[thickness_unknown(int(n))] = other.border_[other.thickness_unknown(int(m))];
      specimens_[n].weight = from.weight;
      for (std::size_t i = 0; i < from.parts.size(); ++i)
        if (from.parts[i].dose >= 0 && specimens_[n].parts[i].dose >= 0)
          border_[dose_unknown(specimens_[n].parts[i].dose)] =
              other.border_[other.dose_unknown(from.parts[i].dose)];
    }
}

/// K and S of pure paints over two cards, in closed form, where the data allow it; elsewhere the values of
/// the nearest wavelength at which they do.
void JointSystem::start_from_closed_forms() {
  for (const Specimen& specimen : specimens_) {
    if (specimen.parts.size() != 1) continue;
    const Row *dark = nullptr, *light = nullptr;
    for (const std::size_t r : specimen.rows) {
      const Row& row = rows_[r];
      if (row.kind != Row::Kind::over || row.card >= 0) continue;
      const std::size_t middle = wavelengths_ / 2;
      if (!dark || row.substrate[middle] < dark->substrate[middle]) dark = &row;
      if (!light || row.substrate[middle] > light->substrate[middle]) light = &row;
    }
    if (!dark || dark == light) continue;
    std::vector<std::pair<std::size_t, Coefficients>> found;
    for (std::size_t l = 0; l < wavelengths_; ++l) try {
        const auto inner = [&](const Row& row) { return theory_.card(table_.samples[row.sample].values[l]); };
        const Coefficients c = coefficients_of_drawdowns({inner(*dark), dark->substrate[l]},
                                                         {inner(*light), light->substrate[l]}, 1);
        if (c.k > 1e-4 && c.s > 1e-4 && c.k < 1e3 && c.s < 1e3) found.emplace_back(l, c);
      } catch (const std::domain_error&) {
      }
    if (found.empty()) continue;
    const int paint = specimen.parts[0].paint;
    for (std::size_t l = 0; l < wavelengths_; ++l) {
      const auto nearest = std::min_element(found.begin(), found.end(), [l](const auto& a, const auto& b) {
        return std::abs(double(a.first) - double(l)) < std::abs(double(b.first) - double(l));
      });
      chain_(paint_unknown(paint, 0), Eigen::Index(l)) = std::log(nearest->second.k) - specimen.ln_thickness;
      chain_(paint_unknown(paint, 1), Eigen::Index(l)) = std::log(nearest->second.s) - specimen.ln_thickness;
    }
  }
}

void JointSystem::solve() {
  constexpr double kTolerance = 1e-5, kLargestStep = 3;
  const int rounds = settings_.outlier_scale > 0 ? 3 : 1;
  iterations_ = 0;
  for (int round = 0; round < rounds; ++round) {
    double damping = 1e-3;
    cost_ = total_cost(chain_, border_);
    converged_ = false;
    for (int i = 0; i < settings_.iterations; ++i, ++iterations_) {
      auto matrix = std::make_shared<NormalChain>();
      std::vector<ColumnMatrix> gradient;
      ColumnMatrix edge;
      assemble(*matrix, gradient, edge);
      double decrease = 0;
      for (int attempt = 0; attempt < 12; ++attempt, damping *= 6) {
        const NormalChainFactors factors(*matrix, damping);
        if (!factors.good()) continue;
        std::vector<ColumnMatrix> step = gradient;
        ColumnMatrix edge_step = edge;
        factors.solve(step, edge_step);
        double largest = edge_step.size() > 0 ? edge_step.cwiseAbs().maxCoeff() : 0;
        for (const ColumnMatrix& s : step) largest = std::max(largest, s.cwiseAbs().maxCoeff());
        if (!std::isfinite(largest)) continue;
        const double scale = std::min(1.0, kLargestStep / std::max(largest, 1e-300));
        ColumnMatrix chain = chain_;
        for (std::size_t l = 0; l < wavelengths_; ++l) chain.col(Eigen::Index(l)) -= scale * step[l].col(0);
        chain = chain.cwiseMax(kLowestLog).cwiseMin(kHighestLog);
        const JointVector border = border_ - scale * edge_step.col(0);
        const double cost = total_cost(chain, border);
        if (!(cost < cost_)) continue;
        decrease = cost_ - cost;
        chain_ = std::move(chain), border_ = border, cost_ = cost;
        damping = std::max(damping / 6, 1e-9);
        break;
      }
      if (decrease <= kTolerance * cost_) {
        converged_ = true;
        break;
      }
    }
    if (round + 1 == rounds) break;
    // Weights of Student's distribution, one for each specimen, since the errors of a specimen are
    // correlated.
    for (Specimen& specimen : specimens_) {
      double sum = 0;
      for (const std::size_t r : specimen.rows) {
        const std::vector<double>& measured = table_.samples[rows_[r].sample].values;
        for (std::size_t l = 0; l < wavelengths_; ++l)
          sum += std::pow((evaluate(specimen, rows_[r], l, chain_, border_).film.value - measured[l]) /
                              sigma(measured[l], rows_[r].scatter),
                          2);
      }
      const double mean = sum / double(specimen.rows.size() * wavelengths_);
      specimen.weight = std::min(1.0, (1 + settings_.outlier_scale) / (mean + settings_.outlier_scale));
    }
  }
}

}  // namespace aureole::pigment
