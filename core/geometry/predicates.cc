// Signs of determinants.
//
// 1. The determinant in doubles with a bound of its rounding error, from the sum of its terms' absolute values.
// 2. Exactly: differences of coordinates as two doubles (their rounding errors are doubles too), sums and products of
//    expansions (sums of doubles that do not overlap, smallest first; zeros left out, so that short inputs stay short).
// Relies on round-to-nearest without contraction (-ffp-contract=off). Expansion arithmetic after J. R. Shewchuk,
// "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates", 1997.
#include "core/geometry/predicates.h"

#include <cmath>

namespace meshfront {
namespace {

constexpr double kHalfUlp = 0x1p-53;
// Rounding errors of the filters' determinants in units of kHalfUlp times the sum of absolute terms: differences 1
// each, products 1 each, sums 1 each, and a little for the bound's own rounding.
constexpr double kFilter2d = 4 * kHalfUlp;
constexpr double kFilter3d = 9 * kHalfUlp;

int SignOf(double x) { return x > 0 ? 1 : x < 0 ? -1 : 0; }

struct Pair {
  double high, low;  // high + low exactly
};

Pair TwoSum(double a, double b) {
  const double sum = a + b, b_part = sum - a, a_part = sum - b_part;
  return {sum, (a - a_part) + (b - b_part)};
}
// |a| >= |b|.
Pair FastTwoSum(double a, double b) {
  const double sum = a + b;
  return {sum, b - (sum - a)};
}
// a as two halves of 26 bits, whose products are exact.
Pair Split(double a) {
  const double scaled = 134217729.0 * a, high = scaled - (scaled - a);
  return {high, a - high};
}
Pair TwoProduct(double a, double b) {
  const double product = a * b;
  const Pair x = Split(a), y = Split(b);
  return {product, x.low * y.low - (((product - x.high * y.high) - x.low * y.high) - x.high * y.low)};
}

template <int kCapacity>
struct Expansion {
  double part[kCapacity];
  int size = 0;

  void Append(double x) {
    if (x != 0) part[size++] = x;
  }
  int Sign() const { return size == 0 ? 0 : SignOf(part[size - 1]); }
};

Expansion<2> Difference(double a, double b) {
  const Pair d = TwoSum(a, -b);
  Expansion<2> out;
  out.Append(d.low);
  out.Append(d.high);
  return out;
}

// Merges by magnitude and sweeps the carries upwards.
template <int kA, int kB>
Expansion<kA + kB> Sum(const Expansion<kA>& a, const Expansion<kB>& b) {
  Expansion<kA + kB> out;
  int i = 0, j = 0;
  const auto next = [&] {
    const bool from_a = j == b.size || (i < a.size && std::abs(a.part[i]) < std::abs(b.part[j]));
    return from_a ? a.part[i++] : b.part[j++];
  };
  const int total = a.size + b.size;
  if (total == 0) return out;
  double carry = next();
  for (int k = 1; k < total; ++k) {
    const double x = next();
    const Pair s = TwoSum(carry, x);
    out.Append(s.low);
    carry = s.high;
  }
  out.Append(carry);
  return out;
}

template <int kA>
Expansion<kA> Negative(Expansion<kA> a) {
  for (int i = 0; i < a.size; ++i) a.part[i] = -a.part[i];
  return a;
}

template <int kA>
Expansion<2 * kA> Scaled(const Expansion<kA>& a, double factor) {
  Expansion<2 * kA> out;
  if (a.size == 0 || factor == 0) return out;
  Pair carry = TwoProduct(a.part[0], factor);
  out.Append(carry.low);
  for (int i = 1; i < a.size; ++i) {
    const Pair product = TwoProduct(a.part[i], factor);
    const Pair low = TwoSum(carry.high, product.low);
    out.Append(low.low);
    carry = FastTwoSum(product.high, low.high);
    out.Append(carry.low);
  }
  out.Append(carry.high);
  return out;
}

template <int kA>
Expansion<4 * kA> Product(const Expansion<kA>& a, const Expansion<2>& b) {
  Expansion<2 * kA> zero;
  return Sum(b.size > 0 ? Scaled(a, b.part[0]) : zero, b.size > 1 ? Scaled(a, b.part[1]) : zero);
}

// a b − c d.
Expansion<16> Minor(const Expansion<2>& a, const Expansion<2>& b, const Expansion<2>& c, const Expansion<2>& d) {
  return Sum(Product(a, b), Negative(Product(c, d)));
}

[[gnu::noinline]] int ExactOrient2d(const Vec2& a, const Vec2& b, const Vec2& c) {
  return Minor(Difference(a.x, c.x), Difference(b.y, c.y), Difference(a.y, c.y), Difference(b.x, c.x)).Sign();
}

[[gnu::noinline]] int ExactOrient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Expansion<2> ax = Difference(a.x, d.x), ay = Difference(a.y, d.y), az = Difference(a.z, d.z);
  const Expansion<2> bx = Difference(b.x, d.x), by = Difference(b.y, d.y), bz = Difference(b.z, d.z);
  const Expansion<2> cx = Difference(c.x, d.x), cy = Difference(c.y, d.y), cz = Difference(c.z, d.z);
  const auto bc = Product(Minor(bx, cy, by, cx), az);
  const auto ca = Product(Minor(cx, ay, cy, ax), bz);
  const auto ab = Product(Minor(ax, by, ay, bx), cz);
  return -Sum(Sum(bc, ca), ab).Sign();
}

}  // namespace

int Orient2d(const Vec2& a, const Vec2& b, const Vec2& c) {
  const double left = (a.x - c.x) * (b.y - c.y), right = (a.y - c.y) * (b.x - c.x);
  const double det = left - right;
  if (std::abs(det) > kFilter2d * (std::abs(left) + std::abs(right))) return SignOf(det);
  return ExactOrient2d(a, b, c);
}

int Orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 p = a - d, q = b - d, r = c - d;
  const double qr1 = q.x * r.y, qr2 = q.y * r.x, rp1 = r.x * p.y, rp2 = r.y * p.x, pq1 = p.x * q.y, pq2 = p.y * q.x;
  const double det = p.z * (qr1 - qr2) + q.z * (rp1 - rp2) + r.z * (pq1 - pq2);
  const double terms = std::abs(p.z) * (std::abs(qr1) + std::abs(qr2)) +
                       std::abs(q.z) * (std::abs(rp1) + std::abs(rp2)) +
                       std::abs(r.z) * (std::abs(pq1) + std::abs(pq2));
  if (std::abs(det) > kFilter3d * terms) return -SignOf(det);
  return ExactOrient3d(a, b, c, d);
}

bool AreCollinear(const Vec3& a, const Vec3& b, const Vec3& c) {
  for (int axis = 0; axis < 3; ++axis) {
    if (Orient2d(DropAxis(a, axis), DropAxis(b, axis), DropAxis(c, axis)) != 0) return false;
  }
  return true;
}

}  // namespace meshfront
