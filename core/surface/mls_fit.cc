// FitPlane: Newton's method for the energy E(n, t), with n turned along two tangents. FitTerms: normal equations.
// DeriveSignedDistance: both are roots of F(unknowns; x) = 0. From values that solve it, one step of Newton's method with
// the matrix held and F in Jet arithmetic gives the first derivatives of the unknowns, another one the second (Improve),
// so that F alone is written down and the chain
// rule is Jet's. Rejected: one Newton's method in Jet arithmetic for all; values need no derivatives until they are right.
#include "core/surface/mls_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/surface/tolerances.h"

namespace meshfront {
namespace {

using namespace surface_tolerances;

constexpr int kTerms = MlsFit::kTerms;
using TermMatrix = Eigen::Matrix<double, kTerms, kTerms>;

// Coordinates on the plane to the polynomial's terms.
template <typename T>
std::array<T, kTerms> TermsAt(const T& a, const T& b, const T& one) {
  static_assert(MlsFit::kDegree == 2);
  return {one, a, b, a * a, a * b, b * b};
}

// First and second derivatives of the energy by turns of the normal along u and v, and by t.
struct Energy {
  double a = 0, b = 0, t = 0;
  double aa = 0, ab = 0, at = 0, bb = 0, bt = 0, tt = 0;
  int count = 0;
};

// With r = |p − q|²: E = Σ w(r) h², and h and r are functions of a, b and t.
Energy SumEnergy(absl::Span<const MlsNear> near, const MlsFit& fit) {
  Energy e;
  const double t = fit.t;
  double around = 0;
  for (const MlsNear& p : near) {
    const double s = Dot(fit.normal, p.d), h = s - t, r = SquaredNorm(p.d) - 2 * t * s + t * t;
    const double y = 1 - r * p.inverse_squared_support;
    if (y <= 0) continue;
    const double y2 = y * y, w = y2 * y2, dw = -4 * p.inverse_squared_support * y2 * y;
    const double ddw = 12 * p.inverse_squared_support * p.inverse_squared_support * y2;
    const double by_h = 2 * w * h, by_r = dw * h * h, hh = 2 * w, hr = 2 * dw * h, rr = ddw * h * h;
    const double alpha = Dot(fit.u, p.d), beta = Dot(fit.v, p.d), turn = by_h - 2 * t * by_r;
    e.a += alpha * turn, e.b += beta * turn, e.t -= by_h + 2 * h * by_r;
    const double twice = hh - 4 * t * hr + 4 * t * t * rr, mixed = -hh + 2 * hr * (t - h) + 4 * t * h * rr - 2 * by_r;
    e.aa += alpha * alpha * twice, e.ab += alpha * beta * twice, e.bb += beta * beta * twice;
    e.at += alpha * mixed, e.bt += beta * mixed;
    e.tt += hh + 4 * h * hr + 4 * h * h * rr + 2 * by_r;
    around += s * turn;
    ++e.count;
  }
  e.aa -= around, e.bb -= around;
  return e;
}

// The upper half of the inverse; false where the matrix is not positive definite.
bool Invert(const Energy& e, std::array<double, 6>& inverse) {
  const double c0 = e.bb * e.tt - e.bt * e.bt, c1 = e.at * e.bt - e.ab * e.tt, c2 = e.ab * e.bt - e.at * e.bb;
  const double minor = e.aa * e.bb - e.ab * e.ab, det = e.aa * c0 + e.ab * c1 + e.at * c2;
  if (!(e.aa > 0 && minor > 0 && det > kLeastPlaneMinor * minor * e.tt)) return false;
  inverse = {c0, c1, c2, e.aa * e.tt - e.at * e.at, e.ab * e.at - e.aa * e.bt, minor};
  for (double& entry : inverse) entry /= det;
  return true;
}

// Its fourth power is the sample's weight, where it is positive.
double WeightRoot(const MlsNear& p, const MlsFit& fit) {
  const double s = Dot(fit.normal, p.d);
  return 1 - (SquaredNorm(p.d) - 2 * fit.t * s + fit.t * fit.t) * p.inverse_squared_support;
}

void SetNormal(const Vec3& normal, MlsFit& fit) {
  fit.normal = normal;
  fit.u = Normalized(Cross(normal, std::abs(normal.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
  fit.v = Cross(normal, fit.u);
}

bool FitPlane(absl::Span<const MlsNear> near, MlsFit& fit) {
  for (int step = 0; step < kMaxPlaneSteps; ++step) {
    const Energy e = SumEnergy(near, fit);
    if (e.count < kTerms + kSpareMlsSamples || !Invert(e, fit.inverse_bend)) return false;
    const std::array<double, 6>& i = fit.inverse_bend;
    const double a = -(i[0] * e.a + i[1] * e.b + i[2] * e.t), b = -(i[1] * e.a + i[3] * e.b + i[4] * e.t);
    const double t = -(i[2] * e.a + i[4] * e.b + i[5] * e.t);
    const double size2 = a * a + b * b + (t / fit.unit) * (t / fit.unit);
    if (!(size2 < kLongestPlaneStep * kLongestPlaneStep)) return false;
    fit.t += t;
    if (std::abs(fit.t) > kMostPlaneOffset * fit.unit) return false;
    const Vec3 turned = Normalized(fit.normal + a * fit.u + b * fit.v);
    if (size2 <= kLastPlaneStep * kLastPlaneStep) {  // the axes stay those of the second derivatives
      fit.u = Normalized(fit.u - Dot(fit.u, turned) * turned);
      fit.normal = turned, fit.v = Cross(turned, fit.u);
      return true;
    }
    SetNormal(turned, fit);
  }
  return false;
}

bool FitTerms(absl::Span<const MlsNear> near, MlsFit& fit) {
  TermMatrix gram = TermMatrix::Zero();
  Eigen::Matrix<double, kTerms, 1> right = Eigen::Matrix<double, kTerms, 1>::Zero();
  const double scale = 1 / fit.unit;
  for (const MlsNear& p : near) {
    const double h = Dot(fit.normal, p.d) - fit.t, y = WeightRoot(p, fit), w = y * y * y * y;
    const auto terms = TermsAt(scale * Dot(fit.u, p.d), scale * Dot(fit.v, p.d), 1.0);
    for (int i = 0; i < kTerms; ++i) {
      const double wi = w * terms[i];
      right[i] += wi * h;
      for (int j = i; j < kTerms; ++j) gram(j, i) += wi * terms[j];
    }
  }
  const Eigen::LLT<TermMatrix> cholesky(gram);
  if (cholesky.info() != Eigen::Success) return false;
  const double least = cholesky.matrixLLT().diagonal().minCoeff();
  if (!(least * least > kLeastTermPivot * gram(0, 0))) return false;
  const Eigen::Matrix<double, kTerms, 1> solved = cholesky.solve(right);
  for (int i = 0; i < kTerms; ++i) {
    fit.polynomial[i] = solved[i];
    for (int j = 0; j < kTerms; ++j) fit.gram[i * kTerms + j] = gram(std::max(i, j), std::min(i, j));
  }
  return true;
}

template <int kOrder>
struct Unknowns {
  std::array<Jet<kOrder>, 3> plane;  // turns along u and v, t
  std::array<Jet<kOrder>, kTerms> terms;
};

Jet<1> Lifted(double value) {
  Jet<1> jet;
  jet.v[0] = value;
  return jet;
}
Jet<2> Lifted(const Jet<1>& low) {
  Jet<2> jet;
  std::copy(low.v, low.v + Jet<1>::kSize, jet.v);
  return jet;
}

// a += b d where d is a coordinate of p − x: its derivatives are 0 but for a −1.
template <int kOrder>
void AddTimesOffset(Jet<kOrder>& a, const Jet<kOrder>& b, double d, int axis) {
  AddScaled(a, d, b);
  a.v[1 + axis] -= b.v[0];
  if constexpr (kOrder == 2) {
    constexpr int kAt[3][3] = {{4, 5, 6}, {5, 7, 8}, {6, 8, 9}};
    for (int i = 0; i < 3; ++i) a.v[kAt[axis][i]] -= b.v[1 + i];
    a.v[kAt[axis][axis]] -= b.v[1 + axis];
  }
}

// What both sums need of a sample: n·d, the height over the plane, and 1 − |p − q|²/h_i².
template <int kOrder>
struct Seen {
  using J = Jet<kOrder>;
  J s, h, y;

  Seen(const MlsNear& p, const std::array<J, 3>& normal, const J& t) {
    for (int axis = 0; axis < 3; ++axis) AddTimesOffset(s, normal[axis], p.d[axis], axis);
    h = s - t;
    const J r = SquaredDistanceToPlace<kOrder>(Vec3{}, p.d) + t * (t - 2.0 * s);
    y = 1.0 - p.inverse_squared_support * r;
  }
};

template <int kOrder>
std::array<Jet<kOrder>, 3> NormalOf(const MlsFit& fit, const Unknowns<kOrder>& at) {
  using J = Jet<kOrder>;
  J one;
  one.v[0] = 1;
  const J inverse = Reciprocal(Sqrt(one + at.plane[0] * at.plane[0] + at.plane[1] * at.plane[1]));
  std::array<J, 3> normal;
  for (int axis = 0; axis < 3; ++axis) {
    normal[axis].v[0] = fit.normal[axis];
    AddScaled(normal[axis], fit.u[axis], at.plane[0]);
    AddScaled(normal[axis], fit.v[axis], at.plane[1]);
    normal[axis] = normal[axis] * inverse;
  }
  return normal;
}

template <int kOrder>
Jet<kOrder> Along(const Vec3& axis, const std::array<Jet<kOrder>, 3>& a) {
  Jet<kOrder> sum;
  for (int i = 0; i < 3; ++i) AddScaled(sum, axis[i], a[i]);
  return sum;
}

// … of p − x.
template <int kOrder>
Jet<kOrder> OffsetAlong(const Vec3& axis, const Vec3& d) {
  Jet<kOrder> sum;
  sum.v[0] = Dot(axis, d), sum.v[1] = -axis.x, sum.v[2] = -axis.y, sum.v[3] = -axis.z;
  return sum;
}

template <int kOrder>
void ImprovePlane(absl::Span<const MlsNear> near, const MlsFit& fit, Unknowns<kOrder>& at) {
  using J = Jet<kOrder>;
  const std::array<J, 3> normal = NormalOf(fit, at);
  const J& t = at.plane[2];
  std::array<J, 3> by_normal;
  J by_t;
  for (const MlsNear& p : near) {
    const Seen<kOrder> seen(p, normal, t);
    const double y = seen.y.value();
    const J w = FourthPower(seen.y), cube = Chain(seen.y, y * y * y, 3 * y * y, 6 * y);
    const J by_h = 2.0 * (w * seen.h), by_r = (-4 * p.inverse_squared_support) * (cube * (seen.h * seen.h));
    const J turn = by_h - 2.0 * (t * by_r);
    for (int axis = 0; axis < 3; ++axis) AddTimesOffset(by_normal[axis], turn, p.d[axis], axis);
    by_t = by_t - by_h - 2.0 * (seen.h * by_r);
  }
  const J lengthwise = Dot(by_normal, normal);  // no turn changes that
  const std::array<J, 3> slope = {Along(fit.u, by_normal) - Along(fit.u, normal) * lengthwise,
                                  Along(fit.v, by_normal) - Along(fit.v, normal) * lengthwise, by_t};
  const std::array<double, 6>& i = fit.inverse_bend;
  const double rows[3][3] = {{i[0], i[1], i[2]}, {i[1], i[3], i[4]}, {i[2], i[4], i[5]}};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) AddScaled(at.plane[row], -rows[row][column], slope[column]);
  }
}

template <int kOrder>
void ImproveTerms(absl::Span<const MlsNear> near, const MlsFit& fit, const TermMatrix& inverse, bool only_first,
                  Unknowns<kOrder>& at) {
  using J = Jet<kOrder>;
  const std::array<J, 3> normal = NormalOf(fit, at);
  // The axes u and v laid into the plane: no rotation, but the polynomials over it are the same.
  const J u_off = Along(fit.u, normal), v_off = Along(fit.v, normal);
  J one;
  one.v[0] = 1;
  std::array<J, kTerms> rest;
  J first;
  for (const MlsNear& p : near) {
    const Seen<kOrder> seen(p, normal, at.plane[2]);
    const J a = (1 / fit.unit) * (OffsetAlong<kOrder>(fit.u, p.d) - u_off * seen.s);
    const J b = (1 / fit.unit) * (OffsetAlong<kOrder>(fit.v, p.d) - v_off * seen.s);
    const std::array<J, kTerms> terms = TermsAt(a, b, one);
    J residual = seen.h - at.terms[0];
    for (int i = 1; i < kTerms; ++i) residual = residual - at.terms[i] * terms[i];
    residual = FourthPower(seen.y) * residual;
    if (only_first) {
      J sum;
      for (int i = 0; i < kTerms; ++i) AddScaled(sum, inverse(0, i), terms[i]);
      first += sum * residual;
      continue;
    }
    for (int i = 0; i < kTerms; ++i) rest[i] += terms[i] * residual;
  }
  if (only_first) {
    at.terms[0] += first;
    return;
  }
  for (int i = 0; i < kTerms; ++i) {
    for (int j = 0; j < kTerms; ++j) AddScaled(at.terms[i], inverse(i, j), rest[j]);
  }
}

}  // namespace

void FindNearSamples(const MlsSamples& samples, const Vec3& x, uint32_t patch, std::vector<MlsNear>& near) {
  near.clear();
  constexpr double kReach2 = (1 + kMostPlaneOffset) * (1 + kMostPlaneOffset);
  for (const uint32_t i : samples.ListOf(patch)) {
    const MlsSample& s = samples.samples()[i];
    const Vec3 d = s.position - x;
    const double inverse_squared_support = 1 / (s.support * s.support);
    if (SquaredNorm(d) * inverse_squared_support < kReach2) near.push_back({d, inverse_squared_support});
  }
}

std::optional<MlsFit> FitPolynomial(std::vector<MlsNear>& near, double support, const Vec3& normal, double t) {
  MlsFit fit;
  fit.unit = support, fit.t = t;
  SetNormal(normal, fit);
  if (!FitPlane(near, fit)) return std::nullopt;
  near.erase(std::remove_if(near.begin(), near.end(), [&](const MlsNear& p) { return WeightRoot(p, fit) <= 0; }),
             near.end());
  if (!FitTerms(near, fit)) return std::nullopt;
  return fit;
}

template <int kOrder>
Jet<kOrder> DeriveSignedDistance(absl::Span<const MlsNear> near, const MlsFit& fit) {
  const TermMatrix gram = Eigen::Map<const TermMatrix>(fit.gram.data());
  const TermMatrix inverse = gram.llt().solve(TermMatrix::Identity());
  Unknowns<1> at;
  at.plane[2] = Lifted(fit.t);
  for (int i = 0; i < kTerms; ++i) at.terms[i] = Lifted(fit.polynomial[i]);
  ImprovePlane(near, fit, at);
  ImproveTerms(near, fit, inverse, kOrder == 1, at);
  if constexpr (kOrder == 1) {
    return -1.0 * (at.plane[2] + at.terms[0]);
  } else {
    Unknowns<2> second;
    for (int i = 0; i < 3; ++i) second.plane[i] = Lifted(at.plane[i]);
    for (int i = 0; i < kTerms; ++i) second.terms[i] = Lifted(at.terms[i]);
    ImprovePlane(near, fit, second);
    ImproveTerms(near, fit, inverse, true, second);
    return -1.0 * (second.plane[2] + second.terms[0]);
  }
}
template Jet<1> DeriveSignedDistance<1>(absl::Span<const MlsNear>, const MlsFit&);
template Jet<2> DeriveSignedDistance<2>(absl::Span<const MlsNear>, const MlsFit&);

}  // namespace meshfront
