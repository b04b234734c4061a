// Forward-mode differentiation (sec. 3.2, "metaprogramming"): a number that carries its derivatives by x, y and z, so
// that a formula written once in plain arithmetic gives value, gradient and Hessian, and the compiler does the chain
// rule.
#pragma once

#include <array>
#include <cmath>

#include "core/geometry/vec3.h"

namespace meshfront {

// A function's value and its derivatives at a place, up to the order: f; fx, fy, fz; fxx, fxy, fxz, fyy, fyz, fzz.
//   const auto [x, y, z] = JetVariables<2>(place);
//   const Jet<2> f = Sqrt(x * x + y * y + z * z) - 1.0;   // f.Gradient(), f.Hessian() are those of a sphere's distance
template <int kOrder>
struct Jet {
  static_assert(kOrder == 1 || kOrder == 2);
  static constexpr int kSize = kOrder == 1 ? 4 : 10;
  double v[kSize] = {};

  constexpr double value() const { return v[0]; }
  constexpr Vec3 Gradient() const { return {v[1], v[2], v[3]}; }
  // The Hessian times a vector.
  constexpr Vec3 HessianTimes(const Vec3& a) const requires(kOrder == 2) {
    return {v[4] * a.x + v[5] * a.y + v[6] * a.z, v[5] * a.x + v[7] * a.y + v[8] * a.z,
            v[6] * a.x + v[8] * a.y + v[9] * a.z};
  }
};

template <int kOrder>
constexpr std::array<Jet<kOrder>, 3> JetVariables(const Vec3& place) {
  std::array<Jet<kOrder>, 3> x;
  for (int i = 0; i < 3; ++i) x[i].v[0] = place[i], x[i].v[1 + i] = 1;
  return x;
}

template <int kOrder>
constexpr Jet<kOrder>& operator+=(Jet<kOrder>& a, const Jet<kOrder>& b) {
  for (int i = 0; i < Jet<kOrder>::kSize; ++i) a.v[i] += b.v[i];
  return a;
}
template <int kOrder>
constexpr Jet<kOrder> operator+(Jet<kOrder> a, const Jet<kOrder>& b) {
  return a += b;
}
template <int kOrder>
constexpr Jet<kOrder> operator-(Jet<kOrder> a, const Jet<kOrder>& b) {
  for (int i = 0; i < Jet<kOrder>::kSize; ++i) a.v[i] -= b.v[i];
  return a;
}
template <int kOrder>
constexpr Jet<kOrder> operator*(double s, Jet<kOrder> a) {
  for (int i = 0; i < Jet<kOrder>::kSize; ++i) a.v[i] *= s;
  return a;
}
template <int kOrder>
constexpr Jet<kOrder> operator-(Jet<kOrder> a, double s) {
  a.v[0] -= s;
  return a;
}
template <int kOrder>
constexpr Jet<kOrder> operator-(double s, const Jet<kOrder>& a) {
  Jet<kOrder> r = -1.0 * a;
  r.v[0] += s;
  return r;
}
// a += s b, without a copy between: what sums over many samples are made of.
template <int kOrder>
constexpr void AddScaled(Jet<kOrder>& a, double s, const Jet<kOrder>& b) {
  for (int i = 0; i < Jet<kOrder>::kSize; ++i) a.v[i] += s * b.v[i];
}

// A sum of scaled jets that stays in registers, four numbers to a lane, the last ones unused; the same bits as AddScaled on jets. Inlined
// wherever it is used, so that the width is that of the caller's processor (core/base/processor.h).
template <int kOrder>
struct JetLanes {
  using Lane = double __attribute__((vector_size(32)));
  static constexpr int kLanes = (Jet<kOrder>::kSize + 3) / 4;
  Lane lanes[kLanes] = {};

  [[gnu::always_inline]] static inline JetLanes Of(const Jet<kOrder>& a) {
    JetLanes r;
    for (int i = 0; i < Jet<kOrder>::kSize; ++i) r.lanes[i / 4][i % 4] = a.v[i];
    return r;
  }
  [[gnu::always_inline]] inline Jet<kOrder> Get() const {
    Jet<kOrder> r;
    for (int i = 0; i < Jet<kOrder>::kSize; ++i) r.v[i] = lanes[i / 4][i % 4];
    return r;
  }
  [[gnu::always_inline]] inline void AddScaled(double s, const JetLanes& b) {
    for (int i = 0; i < kLanes; ++i) lanes[i] += s * b.lanes[i];
  }
};

template <int kOrder>
constexpr Jet<kOrder> operator*(const Jet<kOrder>& a, const Jet<kOrder>& b) {
  Jet<kOrder> r;
  r.v[0] = a.v[0] * b.v[0];
  for (int i = 1; i < 4; ++i) r.v[i] = a.v[0] * b.v[i] + a.v[i] * b.v[0];
  if constexpr (kOrder == 2) {
    for (int i = 1, at = 4; i < 4; ++i) {
      for (int j = i; j < 4; ++j, ++at)
        r.v[at] = (a.v[0] * b.v[at] + a.v[at] * b.v[0]) + (a.v[i] * b.v[j] + a.v[j] * b.v[i]);
    }
  }
  return r;
}

// f(u) from f, f' and f'' at u's value: every function of one number below is this.
template <int kOrder>
constexpr Jet<kOrder> Chain(const Jet<kOrder>& u, double f, double df, double ddf) {
  Jet<kOrder> r;
  r.v[0] = f;
  for (int i = 1; i < Jet<kOrder>::kSize; ++i) r.v[i] = df * u.v[i];
  if constexpr (kOrder == 2) {
    for (int i = 1, at = 4; i < 4; ++i) {
      for (int j = i; j < 4; ++j, ++at) r.v[at] += ddf * u.v[i] * u.v[j];
    }
  }
  return r;
}
// u ≠ 0.
template <int kOrder>
constexpr Jet<kOrder> Reciprocal(const Jet<kOrder>& u) {
  const double f = 1 / u.v[0];
  return Chain(u, f, -f * f, 2 * f * f * f);
}
template <int kOrder>
constexpr Jet<kOrder> operator/(const Jet<kOrder>& a, const Jet<kOrder>& b) {
  return a * Reciprocal(b);
}
// u > 0.
template <int kOrder>
Jet<kOrder> Sqrt(const Jet<kOrder>& u) {
  const double f = std::sqrt(u.v[0]);
  return Chain(u, f, 0.5 / f, -0.25 / (f * u.v[0]));
}
template <int kOrder>
constexpr Jet<kOrder> FourthPower(const Jet<kOrder>& u) {
  const double u2 = u.v[0] * u.v[0];
  return Chain(u, u2 * u2, 4 * u2 * u.v[0], 12 * u2);
}
template <int kOrder>
constexpr Jet<kOrder> Dot(const std::array<Jet<kOrder>, 3>& a, const std::array<Jet<kOrder>, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
// |x − p|² of the variables themselves, whose derivatives are too simple to multiply out.
template <int kOrder>
constexpr Jet<kOrder> SquaredDistanceToPlace(const Vec3& x, const Vec3& p) {
  const Vec3 d = x - p;
  Jet<kOrder> r;
  r.v[0] = SquaredNorm(d), r.v[1] = 2 * d.x, r.v[2] = 2 * d.y, r.v[3] = 2 * d.z;
  if constexpr (kOrder == 2) r.v[4] = r.v[7] = r.v[9] = 2;
  return r;
}

// The principal curvatures of the level set of f through the place, by increasing value, positive where it bends away
// from the gradient: those of a sphere around which f grows are 1 / radius. 0 where there is no gradient.
inline std::array<double, 2> PrincipalCurvatures(const Jet<2>& f) {
  const Vec3 gradient = f.Gradient();
  const double slope = Norm(gradient);
  if (!(slope > 0)) return {0, 0};
  const Vec3 n = gradient / slope;
  const Vec3 s = Normalized(Cross(n, std::abs(n.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0})), t = Cross(n, s);
  const Vec3 hs = f.HessianTimes(s), ht = f.HessianTimes(t);
  const double a = Dot(s, hs), b = Dot(s, ht), c = Dot(t, ht);
  const double middle = 0.5 * (a + c), half = std::sqrt(0.25 * (a - c) * (a - c) + b * b);
  return {(middle - half) / slope, (middle + half) / slope};
}

}  // namespace meshfront
