// 1. Measure: one look over the text for the depth and the number of values, so that the node array is allocated once.
// 2. Parse: a loop over tokens with a stack of open containers (at most kMostDepth of them).
// Rejected: the JSON reader inside tinygltf and that library's model. It keeps a copy of every buffer, some 200 bytes for each value
// of "extras", and its own recursion over them, none of which can be held below the memory bound of this room.
#include "core/io/json.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/base/status_macros.h"

namespace meshfront {
namespace {

bool IsSpace(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }
bool IsDigit(char c) { return c >= '0' && c <= '9'; }

int HexDigit(char c) {
  if (IsDigit(c)) return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

void AppendUtf8(uint32_t code, std::string& out) {
  if (code < 0x80) {
    out.push_back(static_cast<char>(code));
    return;
  }
  const int more = code < 0x800 ? 1 : code < 0x10000 ? 2 : 3;
  constexpr uint8_t kLead[] = {0, 0xc0, 0xe0, 0xf0};
  out.push_back(static_cast<char>(kLead[more] | (code >> (6 * more))));
  for (int i = more - 1; i >= 0; --i) out.push_back(static_cast<char>(0x80 | ((code >> (6 * i)) & 0x3f)));
}

// Four hex digits at text[at]; the parser has seen that they are there.
uint32_t Hex4(std::string_view text, size_t at) {
  uint32_t code = 0;
  for (size_t i = at; i < at + 4; ++i) code = 16 * code + HexDigit(text[i]);
  return code;
}

std::string Unescape(std::string_view text) {
  std::string out;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\\') {
      out.push_back(text[i]);
      continue;
    }
    const char c = text[++i];
    constexpr std::string_view kFrom = "bfnrt", kTo = "\b\f\n\r\t";
    if (c == 'u') {
      uint32_t code = Hex4(text, i + 1);
      i += 4;
      if (code >= 0xd800 && code < 0xdc00 && i + 6 < text.size() && text[i + 1] == '\\' && text[i + 2] == 'u') {
        const uint32_t low = Hex4(text, i + 3);
        if (low >= 0xdc00 && low < 0xe000) code = 0x10000 + ((code - 0xd800) << 10) + (low - 0xdc00), i += 6;
      }
      AppendUtf8(code, out);
    } else {
      const size_t at = kFrom.find(c);
      out.push_back(at == std::string_view::npos ? c : kTo[at]);
    }
  }
  return out;
}

}  // namespace

class JsonParser {
 public:
  JsonParser(const Source& source, std::string_view text) : source_(source), text_(text) { document_.text_ = text; }

  absl::StatusOr<JsonDocument> Parse() {
    if (text_.size() >= 0xffffffffu) return Refuse(source_, "the JSON has ", text_.size(), " bytes; the most is 4 GiB");
    MESHFRONT_RETURN_IF_ERROR(Measure());
    SkipSpace();
    do {
      MESHFRONT_RETURN_IF_ERROR(ParseValue());
      MESHFRONT_RETURN_IF_ERROR(FinishContainers());
    } while (!open_.empty());
    SkipSpace();
    while (at_ < text_.size() && text_[at_] == '\0') ++at_;  // some writers fill a GLB's chunk with zeros
    if (at_ < text_.size()) return Fail("something follows the JSON value");
    document_.steps_left_ = 100 * static_cast<int64_t>(document_.nodes_.size()) + 10'000'000;
    return std::move(document_);
  }

 private:
  using Node = JsonDocument::Node;
  using Kind = JsonDocument::Kind;

  template <class... Parts>
  absl::Status Fail(const Parts&... parts) {
    return Refuse(source_, "byte ", at_, " of the JSON: ", parts...);
  }

  // Every value but the first of a container follows a comma or colon.
  absl::Status Measure() {
    uint64_t values = 1;
    int depth = 0;
    bool in_string = false;
    for (at_ = 0; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      if (in_string) {
        if (c == '\\')
          ++at_;
        else if (c == '"')
          in_string = false;
      } else if (c == '"') {
        in_string = true;
      } else if (c == '[' || c == '{') {
        if (++depth > JsonDocument::kMostDepth) return Fail("nested more than ", JsonDocument::kMostDepth, " deep");
        ++values;
      } else if (c == ']' || c == '}') {
        --depth;
      } else if (c == ',' || c == ':') {
        ++values;
      }
    }
    at_ = 0;
    if (values >= (1u << 29)) return Fail("holds ", values, " values; the most is 536870911");
    document_.nodes_.reserve(values);
    return absl::OkStatus();
  }

  void SkipSpace() {
    while (at_ < text_.size() && IsSpace(text_[at_])) ++at_;
  }
  char Current() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  void Add(Kind kind, size_t begin, size_t end) {
    Node node;
    node.begin = static_cast<uint32_t>(begin), node.end = static_cast<uint32_t>(end);
    node.next = static_cast<uint32_t>(document_.nodes_.size() + 1);
    node.kind = static_cast<uint8_t>(kind);
    document_.nodes_.push_back(node);
  }

  absl::Status ParseValue() {
    const char c = Current();
    if (c == '{' || c == '[') {
      open_.push_back(static_cast<uint32_t>(document_.nodes_.size()));
      Add(c == '{' ? Kind::kObject : Kind::kArray, at_, at_ + 1);
      ++at_;
      SkipSpace();
      const bool empty = Current() == (c == '{' ? '}' : ']');
      return empty ? absl::OkStatus() : BeginElement();
    }
    if (c == '"') return ParseString();
    if (c == '-' || IsDigit(c)) return ParseNumber();
    for (const auto& [word, kind] : {std::pair("true", Kind::kBool), {"false", Kind::kBool}, {"null", Kind::kNull}}) {
      const std::string_view w = word;
      if (text_.substr(at_, w.size()) != w) continue;
      Add(kind, at_, at_ + w.size());
      at_ += w.size();
      return absl::OkStatus();
    }
    if (at_ >= text_.size()) return Fail("the JSON ends too early");
    return Fail(Quote(text_.substr(at_, 12)), " begins no value");
  }

  // In front of an element of the innermost container: counts it and, in an object, takes its key. Leaves a value to parse,
  // which `pending_` says.
  absl::Status BeginElement() {
    Node& container = document_.nodes_[open_.back()];
    container.size = container.size + 1;
    pending_ = true;
    if (container.kind != static_cast<uint8_t>(Kind::kObject)) return absl::OkStatus();
    if (Current() != '"') return Fail("a member of an object needs a name in quotes");
    MESHFRONT_RETURN_IF_ERROR(ParseString());
    SkipSpace();
    if (Current() != ':') return Fail("a member's name needs a colon after it");
    ++at_;
    SkipSpace();
    return absl::OkStatus();
  }

  // After a value: closes what ends here, or stands in front of the next element.
  absl::Status FinishContainers() {
    while (!open_.empty()) {
      if (pending_) {
        pending_ = false;
        return absl::OkStatus();
      }
      SkipSpace();
      const char close = document_.nodes_[open_.back()].kind == static_cast<uint8_t>(Kind::kObject) ? '}' : ']';
      if (Current() == close) {
        Node& container = document_.nodes_[open_.back()];
        container.next = static_cast<uint32_t>(document_.nodes_.size());
        container.end = static_cast<uint32_t>(++at_);
        open_.pop_back();
        continue;
      }
      if (Current() != ',') return Fail("a comma or the end of the ", close == '}' ? "object" : "array", " is missing");
      ++at_;
      SkipSpace();
      MESHFRONT_RETURN_IF_ERROR(BeginElement());
    }
    return absl::OkStatus();
  }

  absl::Status ParseString() {
    const size_t begin = ++at_;
    for (; at_ < text_.size() && text_[at_] != '"'; ++at_) {
      if (static_cast<unsigned char>(text_[at_]) < 0x20) return Fail("a string holds a control character");
      if (text_[at_] != '\\') continue;
      ++at_;
      if (Current() == 'u') {
        for (int i = 0; i < 4; ++i, ++at_) {
          if (at_ + 1 >= text_.size() || HexDigit(text_[at_ + 1]) < 0)
            return Fail("a \\u needs four hexadecimal digits");
        }
      } else if (Current() == '\0' || std::string_view("\"\\/bfnrt").find(Current()) == std::string_view::npos) {
        return Fail("a string holds an unknown escape");
      }
    }
    if (at_ >= text_.size()) return Fail("a string has no end");
    Add(Kind::kString, begin, at_);
    ++at_;
    return absl::OkStatus();
  }

  absl::Status ParseNumber() {
    const size_t begin = at_;
    if (Current() == '-') ++at_;
    while (at_ < text_.size() &&
           (IsDigit(text_[at_]) || std::string_view(".eE+-").find(text_[at_]) != std::string_view::npos)) {
      ++at_;
    }
    double value = 0;
    const auto [stop, error] = std::from_chars(text_.data() + begin, text_.data() + at_, value);
    if (error == std::errc::invalid_argument || stop != text_.data() + at_) {
      return Fail(Quote(text_.substr(begin, at_ - begin)), " is not a number");
    }
    Add(Kind::kNumber, begin, at_);
    return absl::OkStatus();
  }

  const Source& source_;
  std::string_view text_;
  size_t at_ = 0;
  std::vector<uint32_t> open_;  // nodes of the containers that have not ended
  bool pending_ = false;        // a value must follow
  JsonDocument document_;
};

absl::StatusOr<JsonDocument> JsonDocument::Parse(const Source& source, std::string_view text) {
  return JsonParser(source, text).Parse();
}

#define MESHFRONT_JSON_IS(name, which)                                                                   \
  bool JsonValue::name() const {                                                                         \
    return exists() && document_->nodes_[node_].kind == static_cast<uint8_t>(JsonDocument::Kind::which); \
  }
MESHFRONT_JSON_IS(is_object, kObject)
MESHFRONT_JSON_IS(is_array, kArray)
MESHFRONT_JSON_IS(is_number, kNumber)
MESHFRONT_JSON_IS(is_string, kString)
#undef MESHFRONT_JSON_IS

uint32_t JsonValue::size() const { return exists() ? document_->nodes_[node_].size : 0; }

JsonValue JsonValue::Find(std::string_view key) const {
  if (!is_object()) return {};
  for (JsonValue member = First(); member.exists(); member = member.Next()) {
    if (--document_->steps_left_ <= 0) return {};
    const JsonDocument::Node& name = document_->nodes_[member.node_ - 1];
    if (document_->text_.substr(name.begin, name.end - name.begin) == key) return member;
  }
  return {};
}

JsonValue JsonValue::First() const {
  if (!is_object() && !is_array()) return {};
  const JsonDocument::Node& container = document_->nodes_[node_];
  if (container.size == 0) return {};
  JsonValue first(document_, node_ + (is_object() ? 2 : 1));
  first.end_ = container.next, first.in_object_ = is_object();
  return first;
}

JsonValue JsonValue::Next() const {
  if (!exists()) return {};
  // In an object a key stands between two values.
  const uint32_t next = document_->nodes_[node_].next + (in_object_ ? 1 : 0);
  if (next >= end_) return {};
  JsonValue value(document_, next);
  value.end_ = end_, value.in_object_ = in_object_;
  return value;
}

std::string JsonValue::Key() const {
  if (!exists() || !in_object_) return "";
  const JsonDocument::Node& name = document_->nodes_[node_ - 1];
  return Unescape(document_->text_.substr(name.begin, name.end - name.begin));
}

std::optional<double> JsonValue::Number() const {
  if (!is_number()) return std::nullopt;
  const JsonDocument::Node& node = document_->nodes_[node_];
  double value = 0;
  const auto [stop, error] =
      std::from_chars(document_->text_.data() + node.begin, document_->text_.data() + node.end, value);
  if (error != std::errc()) return std::nullopt;  // beyond the range of doubles
  return value;
}

std::optional<uint64_t> JsonValue::Integer() const {
  const std::optional<double> value = Number();
  if (!value || !(*value >= 0 && *value <= 9007199254740992.0) || *value != std::floor(*value)) return std::nullopt;
  return static_cast<uint64_t>(*value);
}

std::string JsonValue::String() const {
  if (!is_string()) return "";
  const JsonDocument::Node& node = document_->nodes_[node_];
  return Unescape(document_->text_.substr(node.begin, node.end - node.begin));
}

std::string_view JsonValue::Raw() const {
  if (!exists()) return "";
  const JsonDocument::Node& node = document_->nodes_[node_];
  return document_->text_.substr(node.begin, node.end - node.begin);
}

bool JsonValue::Equals(std::string_view text) const { return is_string() && Raw() == text; }
std::string JsonValue::Excerpt() const { return exists() ? Quote(Raw()) : "nothing"; }

}  // namespace meshfront
