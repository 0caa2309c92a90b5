// SPDX-License-Identifier: Apache-2.0
#include "harness/rendered.h"

#include <gtest/gtest.h>

#include <cmath>

#include "aureole/render/job.h"

namespace aureole::testing {

Picture render(const std::string& content) {
  RenderOptions options;
  options.replicates = kReplicates;
  options.threads = 2;
  return render(load_scene_from_string("<scene version=\"3.0.0\">" + content + "</scene>", "rendered.xml"),
                options);
}

Picture render(const LoadedScene& scene, const RenderOptions& options) {
  RenderJob job(scene, options);
  const std::atomic<bool> stop{false};
  EXPECT_EQ(job.run(stop), RenderJob::Outcome::finished);
  EXPECT_EQ(job.state().invalid_samples, 0u);
  Picture p;
  p.width = job.state().identity.width, p.height = job.state().identity.height;
  const int channels = job.state().identity.measured_channels;
  const std::size_t n = std::size_t(p.width * p.height);
  p.mean.assign(n, 0), p.error.assign(n, 0);
  const std::size_t replicates = job.state().films.size();
  double all_squares = 0;
  const auto value = [&](const FilmBuffer& film, std::size_t i) {
    double measured[8], alpha;
    film.mean(int(i) % p.width, int(i) / p.width, measured, &alpha);
    return measured[channels == 3 ? 1 : 0];
  };
  for (std::size_t r = 0; r < replicates; ++r) {
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) {
      double v = value(job.state().films[r], i);
      if (!job.state().splats.empty()) v += value(job.state().splats[r], i);
      p.mean[i] += v / double(replicates), p.error[i] += v * v / double(replicates), sum += v / double(n);
    }
    p.all += sum / double(replicates), all_squares += sum * sum / double(replicates);
  }
  const auto standard_error = [&](double mean, double squares) {
    return std::sqrt(std::max(0.0, squares - mean * mean) / double(replicates - 1));
  };
  for (std::size_t i = 0; i < n; ++i) p.error[i] = standard_error(p.mean[i], p.error[i]);
  p.all_error = standard_error(p.all, all_squares);
  return p;
}

double largest_difference(const Picture& a, const Picture& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.mean.size(); ++i)
    largest = std::max(largest, std::abs(a.mean[i] - b.mean[i]) / std::hypot(a.error[i], b.error[i]));
  return largest;
}

void expect_mean(const Picture& p, double expected, double largest_error) {
  EXPECT_NEAR(p.all, expected, 4.5 * p.all_error + 2e-4 * expected);
  EXPECT_LT(p.all_error, largest_error * expected + 1e-9);
}
void expect_pixels(const Picture& p, double expected) {
  // With 15 degrees of freedom |t| > 6 has a probability of 2e-5.
  for (std::size_t i = 0; i < p.mean.size(); ++i)
    EXPECT_NEAR(p.mean[i], expected, 6 * p.error[i] + 5e-4 * expected) << "pixel " << i;
}

}  // namespace aureole::testing
