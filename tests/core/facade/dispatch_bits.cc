// Not a test: prints which kernels were chosen when the program started, and a digest of what the engine makes of each shape. Linked
// twice, once with low_processor.cc; dispatch.cmake compares what they print.
#include <cstdio>
#include <vector>

#include "core/remesh.h"
#include "tests/core/facade/zoo.h"

namespace meshfront::testing {
namespace {

// FNV-1a, 64 bits.
class Digest {
 public:
  template <class T>
  void Add(const std::vector<T>& values) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
    for (size_t i = 0; i < values.size() * sizeof(T); ++i) value_ = (value_ ^ bytes[i]) * 0x100000001b3u;
  }
  uint64_t value() const { return value_; }

 private:
  uint64_t value_ = 0xcbf29ce484222325u;
};

bool Print(const char* name, const TriangleMesh& input, const RemeshOptions& options) {
  CollectingSink sink;
  const auto report = Remesh({input, options}, sink, {});
  if (!report.ok()) return std::fprintf(stderr, "%s: %s\n", name, report.status().ToString().c_str()), false;
  Digest digest;
  digest.Add(sink.mesh.positions), digest.Add(sink.mesh.normals), digest.Add(sink.mesh.triangles);
  std::printf("%s: %zu triangles %016llx\n", name, sink.mesh.triangles.size(),
              static_cast<unsigned long long>(digest.value()));
  return true;
}

// What rounding in the C library can make of a shape is rounded off: it is the same input on every processor.
TriangleMesh Rounded(TriangleMesh mesh) {
  const auto narrow = [](double x) { return static_cast<double>(static_cast<float>(x)); };
  for (Vec3& p : mesh.positions) p = {narrow(p.x), narrow(p.y), narrow(p.z)};
  return mesh;
}

bool PrintAll() {
  RemeshOptions angle, error;
  angle.rho = 0.5;
  error.sizing = Sizing::kError, error.max_error = Length{0.002, true};
  bool well = true;
  for (const ZooShape& shape : Zoo()) well = Print(shape.name.c_str(), Rounded(shape.make()), angle) && well;
  for (const ZooShape& shape : Zoo())
    well = Print((shape.name + ", by error").c_str(), Rounded(shape.make()), error) && well;
  return well;
}

}  // namespace
}  // namespace meshfront::testing

int main() {
  // The kernels are chosen by what this asks.
  std::printf("kernels: %s\n", __builtin_cpu_supports("avx2") ? "wide" : "narrow");
  return meshfront::testing::PrintAll() ? 0 : 1;
}
