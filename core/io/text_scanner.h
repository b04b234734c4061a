// A cursor over the lines and tokens of a text file, with line numbers for messages.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace meshfront {

// Lines end in LF, CR LF or CR. A comment sign hides the rest of its line where it begins a token. Blanks are spaces, tabs,
// vertical tabs and form feeds. Does not own the text. Every call is O(what it passes over); nothing is allocated.
class TextScanner {
 public:
  struct Dialect {
    char comment = '#';      // 0: none
    bool continued = false;  // a backslash at the end of a line joins the next one to it (OBJ)
  };
  explicit TextScanner(std::string_view text) : TextScanner(text, Dialect()) {}
  TextScanner(std::string_view text, Dialect dialect);

  uint64_t line() const { return line_; }  // of the cursor, from 1
  size_t offset() const { return at_ - begin_; }
  size_t remaining() const { return end_ - at_; }

  bool AtLineEnd();          // passes blanks; true before a comment, a line end or the end of the text
  bool SkipToContent();      // passes blanks, comments and line ends; false at the end of the text
  void SkipLine();           // to the beginning of the next line
  std::string_view Peek();   // the token at the cursor, up to a blank or line end; empty at a line end
  std::string_view Token();  // the same, and moves past it
  std::string_view
  RestOfLine();  // up to the line end, blanks trimmed, comment signs included; the cursor stays before the line end

  // A number that fills its token; the cursor stays where it was when there is none. Takes a leading '+', "nan" and "inf"; a
  // number beyond the range of doubles becomes infinite (or zero, when it is too small).
  bool ReadDouble(double& value);
  // A decimal integer that fills its token and fits 64 bits.
  bool ReadInt(int64_t& value);
  // As above, up to any character that is not a digit: for "7/1/2".
  bool ReadLeadingInt(int64_t& value);
  bool AtTokenEnd() const { return IsTokenEnd(at_); }

 private:
  bool IsTokenEnd(const char* p) const;
  void PassBlanks();

  const char* begin_;
  const char* at_;
  const char* end_;
  const char* next_lf_ = nullptr;  // the first LF at or after the cursor when it was last looked for
  Dialect dialect_;
  uint64_t line_ = 1;
};

}  // namespace meshfront
