// SPDX-License-Identifier: Apache-2.0
// The samplers' points: stratification that no scrambling may break, statistics of random numbers.
#include "aureole/sampler/sampler.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <memory>
#include <numeric>
#include <set>

#include "aureole/core/random.h"
#include "aureole/math/significance.h"
#include "tests/harness/properties_builder.h"

namespace aureole::testing {
namespace {

constexpr int kTable = 256;

std::shared_ptr<Sampler> make(const std::string& type, const std::string& parameters = "") {
  return build<Sampler>("<sampler type=\"" + type + "\">" + parameters + "</sampler>");
}

float coordinate(const Sampler& s, std::uint64_t key, std::uint32_t sample, int dimension) {
  float out[Sampler::kBlock];
  s.block(key, sample, dimension / Sampler::kBlock, out);
  return out[dimension % Sampler::kBlock];
}

/// True where each of the 2^k intervals of [0, 1) has exactly one of the numbers.
bool stratified(const std::vector<float>& x) {
  std::vector<int> count(x.size());
  for (float v : x)
    if (++count[std::size_t(v * float(x.size()))] > 1) return false;
  return true;
}

/// The smallest t for which the points are a (t, m, 2)-net in base 2.
int net_quality(const std::vector<Vec2>& points) {
  const int m = std::countr_zero(points.size());
  for (int t = 0; t < m; ++t) {
    bool good = true;
    for (int a = 0; a <= m - t && good; ++a) {
      std::vector<int> count(std::size_t(1) << (m - t));
      for (const Vec2& p : points)
        ++count[(std::size_t(p.x * float(1 << a)) << (m - t - a)) +
                std::size_t(p.y * float(1 << (m - t - a)))];
      for (int c : count) good &= c == 1 << t;
    }
    if (good) return t;
  }
  return m;
}

std::vector<Vec2> points(const Sampler& s, std::uint64_t key, int d0, int d1, std::uint32_t first,
                         std::uint32_t n) {
  std::vector<Vec2> p;
  for (std::uint32_t i = first; i < first + n; ++i)
    p.push_back({coordinate(s, key, i, d0), coordinate(s, key, i, d1)});
  return p;
}

TEST(SobolSampler, EveryAlignedBlockIsStratifiedInEveryDimension) {
  const auto sobol = make("sobol");
  float out[Sampler::kBlock];
  for (std::uint64_t key : {0x0ull, 0x123456789abcdefull})
    for (int block = 0; block < kTable / Sampler::kBlock; ++block)
      for (std::uint32_t n : {2u, 16u, 256u, 4096u})
        for (std::uint32_t first : {0u, n, 5 * n, (1u << 31) - n, 0u - n}) {
          if (n == 4096 && first != n) continue;
          std::vector<float> x[Sampler::kBlock];
          for (std::uint32_t i = 0; i < n; ++i) {
            sobol->block(key, first + i, block, out);
            for (int k = 0; k < Sampler::kBlock; ++k) x[k].push_back(out[k]);
          }
          for (int k = 0; k < Sampler::kBlock; ++k)
            ASSERT_TRUE(stratified(x[k]))
                << "dimension " << 8 * block + k << ", " << n << " points from " << first;
        }
}

TEST(SobolSampler, RepeatedDimensionsAreStratifiedFromTheFirstPoint) {
  const auto sobol = make("sobol");
  for (int d : {256, 300, 511, 512, 5000})
    for (std::uint32_t n : {16u, 1024u}) {
      std::vector<float> x;
      for (std::uint32_t i = 0; i < n; ++i) x.push_back(coordinate(*sobol, 77, i, d));
      EXPECT_TRUE(stratified(x)) << d;
    }
}

TEST(SobolSampler, FirstTwoDimensionsAreAZeroTwoSequence) {
  const auto sobol = make("sobol");
  for (std::uint64_t key : {1ull, 0xfedcba9876543210ull})
    for (std::uint32_t m = 1; m <= 10; ++m)
      for (std::uint32_t k : {0u, 1u, 6u})
        EXPECT_EQ(net_quality(points(*sobol, key, 0, 1, k << m, 1u << m)), 0) << "2^" << m << ", block " << k;
}

// Owen scrambling leaves the qualities of nets unchanged, so they identify the direction numbers. The
// references are those of scipy's unscrambled points of Joe & Kuo (make_sobol_qualities.py).
struct Quality {
  int d0, d1, m4, m6, m8, m10;
};
const Quality kQualities[] = {
#include "tests/sampler/sobol_qualities.inc"
};

TEST(SobolSampler, ProjectionsHaveThePublishedQuality) {
  const auto sobol = make("sobol");
  for (const Quality& q : kQualities) {
    const int expected[] = {q.m4, q.m6, q.m8, q.m10};
    for (int k = 0; k < 4; ++k)
      EXPECT_EQ(net_quality(points(*sobol, 99, q.d0, q.d1, 0, 1u << (4 + 2 * k))), expected[k])
          << "dimensions " << q.d0 << ", " << q.d1 << ", 2^" << 4 + 2 * k;
  }
}

TEST(SobolSampler, ScramblingIsUniform) {
  // Each sample of its own, over pixels, is a uniform random number: moments and a chi-square.
  const auto sobol = make("sobol");
  for (int d : {0, 1, 17, 255, 300})
    for (std::uint32_t sample : {0u, 1u, 1000u}) {
      constexpr int n = 40000, bins = 64;
      int count[bins] = {};
      for (int k = 0; k < n; ++k)
        ++count[int(coordinate(*sobol, combine_bits(5, std::uint64_t(k)), sample, d) * bins)];
      double chi2 = 0;
      for (int c : count) chi2 += (c - n / double(bins)) * (c - n / double(bins)) / (n / double(bins));
      EXPECT_GT(chi_square_p_value(chi2, bins - 1), 1e-4) << d << " " << sample;
    }
}

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  double aa = 0, bb = 0, ab = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double x = a[i] - 0.5, y = b[i] - 0.5;
    aa += x * x, bb += y * y, ab += x * y;
  }
  return ab / std::sqrt(aa * bb);
}

class EverySampler : public ::testing::TestWithParam<const char*> {};

TEST_P(EverySampler, PixelsAndSeedsAreUncorrelated) {
  const auto s = make(GetParam());
  // Neighbours as RenderJob makes them: a hash, and also keys that differ by one bit only.
  for (int test = 0; test < 3; ++test) {
    std::vector<double> a, b;
    for (std::uint64_t k = 0; k < 20000; ++k) {
      const std::uint64_t key = combine_bits(combine_bits(0, 0), k);
      const std::uint64_t other = test == 0   ? combine_bits(combine_bits(0, 0), k + 1)
                                  : test == 1 ? combine_bits(combine_bits(1, 0), k)
                                              : key ^ (1ull << (k % 64));
      a.push_back(coordinate(*s, key, 3, 2));
      b.push_back(coordinate(*s, other, 3, 2));
    }
    EXPECT_LT(std::abs(correlation(a, b)), 4.5 / std::sqrt(20000.0)) << test;
  }
}

TEST_P(EverySampler, MeansOfPixelsAreIndependent) {
  // The error of an integral over few samples must not repeat from pixel to pixel.
  const auto s = make(GetParam());
  std::vector<double> error;
  for (std::uint64_t pixel = 0; pixel < 8000; ++pixel) {
    double sum = 0;
    for (std::uint32_t i = 0; i < 5; ++i) {
      SampleStream stream(*s, combine_bits(9, pixel), i);
      const Vec2 u = stream.get2(10);
      sum += u.x * u.y > 0.2f;
    }
    error.push_back(sum / 5);
  }
  const double mean = std::accumulate(error.begin(), error.end(), 0.0) / double(error.size());
  double variance = 0, neighbours = 0;
  for (std::size_t i = 0; i + 1 < error.size(); ++i) {
    variance += (error[i] - mean) * (error[i] - mean);
    neighbours += (error[i] - mean) * (error[i + 1] - mean);
  }
  // Area of xy > c: 1 - c + c ln c.
  EXPECT_NEAR(mean, 0.8 + 0.2 * std::log(0.2), 4.5 * std::sqrt(variance) / double(error.size()));
  EXPECT_LT(std::abs(neighbours / variance), 4.5 / std::sqrt(8000.0));
}

TEST_P(EverySampler, StreamsAreConsistentInAnyOrder) {
  const auto s = make(GetParam());
  SampleStream forward(*s, 4711, 12), backward(*s, 4711, 12), pairs(*s, 4711, 12);
  std::vector<float> x(600);
  for (int d = 0; d < 600; ++d) x[std::size_t(d)] = forward.get1(d);
  for (int d = 599; d >= 0; --d) ASSERT_EQ(backward.get1(d), x[std::size_t(d)]);
  for (int k = 0; k < 600; ++k) {
    const int d = (k * 251) % 599;  // also pairs that straddle two blocks
    const Vec2 p = pairs.get2(d);
    ASSERT_EQ(p.x, x[std::size_t(d)]);
    ASSERT_EQ(p.y, x[std::size_t(d) + 1]);
    ASSERT_EQ(coordinate(*s, 4711, 12, d), x[std::size_t(d)]);
  }
  for (float v : x) {
    ASSERT_GE(v, 0.f);
    ASSERT_LT(v, 1.f);
  }
  EXPECT_GT(std::set<float>(x.begin(), x.end()).size(), 590u) << "dimensions repeat";
  std::set<std::uint32_t> keys;
  for (int d = 0; d < 1000; ++d) keys.insert(forward.key(d));
  for (std::uint32_t i = 0; i < 1000; ++i) keys.insert(SampleStream(*s, 4711, 100 + i).key(0));
  EXPECT_GT(keys.size(), 1998u);
  EXPECT_EQ(forward.key(5), backward.key(5));
}

TEST_P(EverySampler, Parameters) {
  EXPECT_EQ(make(GetParam())->sample_count(), 4);
  EXPECT_EQ(make(GetParam())->seed(), 0u);
  const auto s =
      make(GetParam(), R"(<integer name="sample_count" value="100"/><integer name="seed" value="9"/>)");
  EXPECT_EQ(s->sample_count(), 100);
  EXPECT_EQ(s->seed(), 9u);
  EXPECT_THROW(make(GetParam(), R"(<integer name="sample_count" value="0"/>)"), Error);
  EXPECT_THROW(make(GetParam(), R"(<integer name="sample_count" value="4294967296"/>)"), Error);
  EXPECT_THROW(make(GetParam(), R"(<integer name="seed" value="-1"/>)"), Error);
}

INSTANTIATE_TEST_SUITE_P(Samplers, EverySampler, ::testing::Values("sobol", "independent"),
                         [](const auto& info) { return std::string(info.param); });

TEST(IndependentSampler, Moments) {
  const auto s = make("independent");
  constexpr int n = 100000;
  for (int d : {0, 1, 7, 8, 1001}) {
    double m[5] = {};
    for (std::uint32_t i = 0; i < n; ++i) {
      const double x = coordinate(*s, 31, i, d);
      for (int k = 1; k < 5; ++k) m[k] += std::pow(x, k) / n;
    }
    for (int k = 1; k < 5; ++k) {
      const double sigma = std::sqrt((1.0 / (2 * k + 1) - 1.0 / ((k + 1) * (k + 1))) / n);
      EXPECT_NEAR(m[k], 1.0 / (k + 1), 4.5 * sigma) << d << " " << k;
    }
  }
}

TEST(IndependentSampler, PairsFillTheSquare) {
  const auto s = make("independent");
  // Pairs of dimensions of one sample, the two halves of one hash among them, and of successive samples.
  for (int test = 0; test < 4; ++test) {
    constexpr int n = 100000, side = 16;
    int count[side * side] = {};
    for (std::uint32_t i = 0; i < n; ++i) {
      const float x = coordinate(*s, 8, i, 6);
      const float y = test == 0   ? coordinate(*s, 8, i, 7)
                      : test == 1 ? coordinate(*s, 8, i, 8)
                      : test == 2 ? coordinate(*s, 8, i + 1, 6)
                                  : coordinate(*s, 9, i, 6);
      ++count[int(x * side) * side + int(y * side)];
    }
    double chi2 = 0;
    const double expected = n / double(side * side);
    for (int c : count) chi2 += (c - expected) * (c - expected) / expected;
    EXPECT_GT(chi_square_p_value(chi2, side * side - 1), 1e-4) << test;
    EXPECT_LT(chi_square_p_value(chi2, side * side - 1), 1 - 1e-4) << test << ": too even";
  }
}

/// RMS error over pixels of the integral of a smooth function of two dimensions.
double rms(const Sampler& s, int d0, int d1, std::uint32_t n) {
  double sum = 0;
  constexpr int kPixels = 200;
  for (int pixel = 0; pixel < kPixels; ++pixel) {
    double mean = 0;
    for (std::uint32_t i = 0; i < n; ++i) {
      const double x = coordinate(s, combine_bits(3, std::uint64_t(pixel)), i, d0);
      const double y = coordinate(s, combine_bits(3, std::uint64_t(pixel)), i, d1);
      mean += std::exp(x * y) * x / n;
    }
    const double error = mean - (M_E - 2);  // of x exp(xy)
    sum += error * error / kPixels;
  }
  return std::sqrt(sum);
}

TEST(SobolSampler, ErrorFallsFasterThanRandom) {
  const auto sobol = make("sobol"), independent = make("independent");
  for (const auto& [d0, d1] : {std::pair{0, 1}, {40, 41}, {300, 301}, {1000, 1001}}) {
    const double coarse = rms(*sobol, d0, d1, 16), fine = rms(*sobol, d0, d1, 1024);
    const double random = rms(*independent, d0, d1, 1024);
    EXPECT_LT(fine, coarse / 20) << d0 << ": a random one falls by 8";
    EXPECT_LT(fine, random / 4) << d0;
    RecordProperty("rms_ratio_" + std::to_string(d0), std::to_string(coarse / fine));
  }
  // A dimension of the table together with its own repetition, and two repetitions: no worse than random.
  for (const auto& [d0, d1] : {std::pair{0, 256}, {300, 44}, {256, 512}, {10, 266}, {255, 256}}) {
    const double random = rms(*independent, d0, d1, 1024);
    EXPECT_LT(rms(*sobol, d0, d1, 1024), 1.15 * random) << d0 << ", " << d1;
  }
}

}  // namespace
}  // namespace aureole::testing
