#include "server/array_writer.h"

#include <algorithm>
#include <cstring>

#include "absl/strings/str_cat.h"
#include "proto/wire/convert.h"

namespace meshfront {
namespace {

constexpr uint64_t kFirstCapacity = 4096;

// Room for `size` elements where there is room for `capacity`. Doubles, but never beyond what was announced: a big mesh
// does not end with a third unused.
uint64_t CapacityFor(uint64_t size, uint64_t capacity, uint64_t announced) {
  if (size <= capacity) return capacity;
  return std::min(announced, std::max({size, 2 * capacity, kFirstCapacity}));
}

// Makes `out` hold `size` elements.
template <class T>
void GrowTo(std::vector<T>& out, uint64_t size, uint64_t announced) {
  out.reserve(CapacityFor(size, out.capacity(), announced));
  out.resize(size);
}

// Elements that lie in memory as they do on the wire. Bytes of an element that is not whole yet are in place already.
template <class T>
void CopyBytes(std::vector<T>& out, uint64_t announced, uint64_t offset, absl::string_view data) {
  GrowTo(out, (offset + data.size() + sizeof(T) - 1) / sizeof(T), announced);
  std::memcpy(reinterpret_cast<char*>(out.data()) + offset, data.data(), data.size());
}

// Widens floats to the doubles of `out`; holds back the bytes of one that is not whole.
class FloatWidener {
 public:
  FloatWidener(std::vector<Vec3>* out, uint64_t announced) : out_(out), announced_(announced) {}

  void operator()(uint64_t offset, absl::string_view data) {
    uint64_t scalar = offset / 4;
    GrowTo(*out_, (offset + data.size() + 11) / 12, announced_);
    while (!data.empty()) {
      const size_t taken = std::min<size_t>(4 - held_, data.size());
      std::memcpy(part_ + held_, data.data(), taken);
      data.remove_prefix(taken);
      held_ += taken;
      if (held_ < 4) return;
      float value;
      std::memcpy(&value, part_, 4);
      (*out_)[scalar / 3][static_cast<int>(scalar % 3)] = value;
      ++scalar;
      held_ = 0;
    }
  }

 private:
  std::vector<Vec3>* out_;
  uint64_t announced_;
  char part_[4];
  size_t held_ = 0;
};

}  // namespace

ArrayWriter ArrayWriter::ForPoints(v1::Array array, std::vector<Vec3>* out, uint64_t count,
                                   v1::ScalarType scalar_type) {
  static_assert(sizeof(Vec3) == 24);
  const auto capacity = [out] { return out->capacity(); };
  if (scalar_type == v1::SCALAR_TYPE_FLOAT32)
    return ArrayWriter(array, count * 12, {12, sizeof(Vec3), capacity}, FloatWidener(out, count));
  return ArrayWriter(array, count * 24, {24, sizeof(Vec3), capacity},
                     [out, count](uint64_t offset, absl::string_view data) { CopyBytes(*out, count, offset, data); });
}

ArrayWriter ArrayWriter::ForTriangles(std::vector<Triangle>* out, uint64_t count) {
  return ArrayWriter(v1::ARRAY_TRIANGLES, count * 12, {12, sizeof(Triangle), [out] { return out->capacity(); }},
                     [out, count](uint64_t offset, absl::string_view data) { CopyBytes(*out, count, offset, data); });
}

ArrayWriter ArrayWriter::ForFloats(v1::Array array, std::vector<float>* out, uint64_t count) {
  return ArrayWriter(array, count * 4, {4, 4, [out] { return out->capacity(); }},
                     [out, count](uint64_t offset, absl::string_view data) { CopyBytes(*out, count, offset, data); });
}

ArrayWriter ArrayWriter::ForNumbers(v1::Array array, std::vector<uint32_t>* out, uint64_t count) {
  return ArrayWriter(array, count * 4, {4, 4, [out] { return out->capacity(); }},
                     [out, count](uint64_t offset, absl::string_view data) { CopyBytes(*out, count, offset, data); });
}

ArrayWriter ArrayWriter::ForTriples(v1::Array array, std::vector<CornerWedges>* out, uint64_t count) {
  return ArrayWriter(array, count * 12, {12, sizeof(CornerWedges), [out] { return out->capacity(); }},
                     [out, count](uint64_t offset, absl::string_view data) { CopyBytes(*out, count, offset, data); });
}

ArrayWriter ArrayWriter::ForFile(std::vector<uint8_t>* out, uint64_t bytes) {
  return ArrayWriter(v1::ARRAY_FILE, bytes, {1, 1, [out] { return out->capacity(); }},
                     [out, bytes](uint64_t offset, absl::string_view data) { CopyBytes(*out, bytes, offset, data); });
}

ArrayWriter ArrayWriter::ForNothing(v1::Array array, uint64_t bytes) {
  return ArrayWriter(array, bytes, {1, 1, [] { return 0; }}, [](uint64_t, absl::string_view) {});
}

uint64_t ArrayWriter::GrowthFor(uint64_t bytes) const {
  const uint64_t announced = announced_ / memory_.wire_bytes, capacity = memory_.capacity();
  if (announced == 0 || bytes > announced_ - received_) return 0;  // Write will refuse it
  const uint64_t size = (received_ + bytes + memory_.wire_bytes - 1) / memory_.wire_bytes;
  const uint64_t needed = CapacityFor(size, capacity, announced);
  return needed > capacity ? needed * memory_.element_bytes : 0;
}

absl::Status ArrayWriter::Write(uint64_t offset, absl::string_view data) {
  if (offset != received_) {
    return absl::InvalidArgumentError(absl::StrCat("block.offset is ", offset, "; ", v1::Array_Name(array_), " has ",
                                                   received_, " bytes so far and blocks come without gap"));
  }
  if (data.empty()) return absl::InvalidArgumentError("block.data is empty; it must hold at least one byte");
  if (data.size() > announced_ - received_) {
    return absl::InvalidArgumentError(absl::StrCat("block.data goes to byte ", offset + data.size(), " of ",
                                                   v1::Array_Name(array_), "; the header announced ", announced_,
                                                   " bytes"));
  }
  store_(offset, data);
  received_ += data.size();
  return absl::OkStatus();
}

}  // namespace meshfront
