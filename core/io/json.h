// A reader of JSON for files that may be hostile: 16 bytes a value, no recursion, no exceptions.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "core/io/source.h"

namespace meshfront {

class JsonDocument;

// A value in a document, which must outlive it; or nothing, of which everything asked is nothing or the fallback.
class JsonValue {
 public:
  JsonValue() = default;

  bool exists() const { return document_ != nullptr; }
  bool is_object() const;
  bool is_array() const;
  bool is_number() const;
  bool is_string() const;
  uint32_t size() const;  // of an array or object

  JsonValue Find(std::string_view key) const;  // the member of an object; O(members)
  std::optional<double> Number() const;
  // An integer in [0, 2⁵³]; nothing for anything else.
  std::optional<uint64_t> Integer() const;
  std::string String() const;                // escapes resolved; "" when it is no string
  bool Equals(std::string_view text) const;  // whether it is the string
  std::string Excerpt() const;               // its text, quoted, for a message
  std::string_view Raw() const;              // its text as it stands in the file; of a string, without the quotes
  uint32_t node() const { return node_; }    // for JsonDocument::At

  // Elements of an array: for (JsonValue v = a.First(); v.exists(); v = v.Next()). Members of an object: the same, with Key().
  JsonValue First() const;
  JsonValue Next() const;
  std::string Key() const;

 private:
  friend class JsonDocument;
  JsonValue(const JsonDocument* document, uint32_t node) : document_(document), node_(node) {}

  const JsonDocument* document_ = nullptr;
  uint32_t node_ = 0;
  uint32_t end_ = 0;  // one past the last node of the container this was taken from
  bool in_object_ = false;
};

class JsonDocument {
 public:
  static constexpr int kMostDepth = 128;

  // `text` must outlive the document. InvalidArgument with the byte for anything that is not one JSON value, for nesting deeper
  // than kMostDepth, and for text of 4 GiB or more.
  static absl::StatusOr<JsonDocument> Parse(const Source& source, std::string_view text);
  JsonValue root() const { return JsonValue(this, 0); }
  JsonValue At(uint32_t node) const { return JsonValue(this, node); }
  size_t bytes() const { return text_.size(); }
  // Counts the members that Find passes, so that a file of many references to a huge object can't take quadratic time: true
  // when the budget is used up, from when on Find finds nothing.
  bool exhausted() const { return steps_left_ <= 0; }

 private:
  friend class JsonValue;
  friend class JsonParser;
  enum class Kind : uint8_t { kNull, kBool, kNumber, kString, kArray, kObject };
  // Containers are followed by what they hold; an object holds key, value, key, value, …
  struct Node {
    uint32_t begin = 0, end = 0;  // in the text; of a string, without its quotes
    uint32_t next = 0;            // the node after this one and all it holds
    uint32_t size : 29 = 0;       // elements or members
    uint32_t kind : 3 = 0;
  };
  static_assert(sizeof(Node) == 16);

  std::string_view text_;
  std::vector<Node> nodes_;
  mutable int64_t steps_left_ = 0;
};

}  // namespace meshfront
