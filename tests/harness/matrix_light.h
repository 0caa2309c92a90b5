// SPDX-License-Identifier: Apache-2.0
// Light of two components and maps of it that do not commute, without any physics: whoever composes them in
// another order than that in which light passes finds other pictures.
#pragma once

#include <cmath>

#include "aureole/spectrum/weight.h"

namespace aureole::testing {

struct MatrixLight {
  struct Light {
    Spectrum a{0.f}, b{0.f};
  };

  class Weight {
  public:
    Weight() : Weight(Spectrum(1.f)) {}
    explicit Weight(const Spectrum& factor) : m_{{factor, Spectrum(0.f)}, {Spectrum(0.f), factor}} {}
    Weight(const Spectrum& f, float aa, float ab, float ba, float bb)
        : m_{{f * aa, f * ab}, {f * ba, f * bb}} {}

    Light of(const Light& l) const {
      return {m_[0][0] * l.a + m_[0][1] * l.b, m_[1][0] * l.a + m_[1][1] * l.b};
    }
    /// The product in the order of light, first `first` and then this.
    Weight after(const Weight& first) const {
      Weight r;
      for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j) r.m_[i][j] = m_[i][0] * first.m_[0][j] + m_[i][1] * first.m_[1][j];
      return r;
    }
    Weight scaled(const Spectrum& s) const {
      Weight r = *this;
      for (auto& row : r.m_)
        for (Spectrum& x : row) x *= s;
      return r;
    }
    Spectrum magnitude() const { return 0.5f * (m_[0][0] + m_[0][1] + m_[1][0] + m_[1][1]); }

  private:
    Spectrum m_[2][2];
  };

  /// f M(p), M a matrix of the position, transposed for light that travels the reverse direction.
  static Weight lift(const Spectrum& f, const Vec3& p, const Vec3& in, const Vec3& out) {
    // Light of the second component becomes light of the first one, or the reverse where it travels backwards.
    const float part = 0.9f + 0.1f * std::sin(2.2f * (p.x + 2 * p.y - 1.5f * p.z) + 1);
    const float aa = 0.15f, ab = 0.85f * part, ba = 0.85f * (1 - part), bb = 0.15f;
    const bool forward = dot(in + out, Vec3{0.1f, -0.05f, 1}) > 0;
    return forward ? Weight(f, aa, ab, ba, bb) : Weight(f, aa, ba, ab, bb);
  }
  static Light emitted(const Spectrum& radiance) { return {radiance, radiance * 0.1f}; }
  static Spectrum measured(const Light& light) { return light.a; }

  static Light scaled(const Light& l, const Spectrum& s) { return {l.a * s, l.b * s}; }
  static Weight scaled(const Weight& w, const Spectrum& s) { return w.scaled(s); }
  static Spectrum magnitude(const Light& l) { return l.a + l.b; }
  static Spectrum magnitude(const Weight& w) { return w.magnitude(); }
  static bool is_black(const Light& l) { return aureole::is_black(l.a) && aureole::is_black(l.b); }
  static bool is_black(const Weight& w) { return aureole::is_black(w.magnitude()); }
};

/// `MatrixLight` with the product of two maps in the wrong order: a test that passes with it shows nothing.
struct SwappedLight : MatrixLight {
  class Weight : public MatrixLight::Weight {
  public:
    Weight() = default;
    explicit Weight(const Spectrum& factor) : MatrixLight::Weight(factor) {}
    Weight(const MatrixLight::Weight& w) : MatrixLight::Weight(w) {}  // NOLINT
    Weight after(const Weight& first) const { return first.MatrixLight::Weight::after(*this); }
    Weight scaled(const Spectrum& s) const { return MatrixLight::Weight::scaled(s); }
  };
  static Weight lift(const Spectrum& f, const Vec3& p, const Vec3& in, const Vec3& out) {
    return MatrixLight::lift(f, p, in, out);
  }
  using MatrixLight::scaled;
  static Weight scaled(const Weight& w, const Spectrum& s) { return w.scaled(s); }
};

}  // namespace aureole::testing
