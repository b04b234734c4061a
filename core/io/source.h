// What every reader gets: bytes, a name for messages, limits; and how refusals are worded.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/types/span.h"
#include "core/io/mesh_io.h"

namespace meshfront {

struct Source {
  absl::Span<const uint8_t> bytes;
  std::string name;         // starts every message
  std::string base_folder;  // for files named inside the file; empty: none may be opened
  ReadLimits limits;

  std::string_view text() const { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }
};

// absl::StrCat for std::string_view as well (Debian's Abseil has its own string_view).
inline absl::string_view AsPiece(std::string_view text) { return {text.data(), text.size()}; }
template <class T>
const T& AsPiece(const T& value) {
  return value;
}
template <class... Parts>
std::string Concat(const Parts&... parts) {
  return absl::StrCat(AsPiece(parts)...);
}

// "NAME: what is wrong."
template <class... Parts>
absl::Status Refuse(const Source& source, const Parts&... parts) {
  return absl::InvalidArgumentError(Concat(source.name, ": ", parts...));
}
template <class... Parts>
absl::Status RefuseAtLine(const Source& source, uint64_t line, const Parts&... parts) {
  return absl::InvalidArgumentError(Concat(source.name, ": line ", line, ": ", parts...));
}

// For text formats: a zero byte means that this is no text.
inline absl::Status RefuseZeroBytes(const Source& source) {
  const size_t at = source.text().find('\0');
  if (at == std::string_view::npos) return absl::OkStatus();
  return Refuse(source, "byte ", at, " is 0, which no text holds (UTF-16 is not read)");
}

// A piece of a file as it may stand in a message: quoted, printable, at most 24 characters.
inline std::string Quote(std::string_view token) {
  const bool cut = token.size() > 24;
  return absl::StrCat("\"", absl::CHexEscape(absl::string_view(token.data(), cut ? 24 : token.size())),
                      cut ? "…\"" : "\"");
}

inline std::string NotFiniteAttributes(uint64_t count) {
  return Concat(count, " numbers of attributes are not finite; they are read as 0");
}

// Adds a name once, and not without end.
inline void NoteDropped(TriangleMesh& mesh, std::string name) {
  if (mesh.dropped_attributes.size() >= 64) return;
  if (name.size() > 64) name.resize(64);
  for (const std::string& known : mesh.dropped_attributes) {
    if (known == name) return;
  }
  mesh.dropped_attributes.push_back(std::move(name));
}

}  // namespace meshfront
