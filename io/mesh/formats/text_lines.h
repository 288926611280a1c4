// Lines and numbers of a text file in memory.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace ricci {

/// Parses a whole token as a decimal number, whatever the locale: an optional sign, digits, exponent; inf and
/// nan in any case, and Microsoft's "1.#QNAN". Beyond the range of double: infinity or zero, as rounding
/// says.
bool parse_number(std::string_view token, double& value);

/// Parses a whole token as an integer of 64 bits (optional sign).
bool parse_integer(std::string_view token, std::int64_t& value);

/// The tokens of one line, separated by blanks.
class Tokens {
  public:
    Tokens(std::string_view line, std::int64_t line_number) : rest_(line), line_number_(line_number) {}

    /// True when nothing but blanks is left.
    [[nodiscard]] bool done();
    /// The next token, empty at the end of the line.
    [[nodiscard]] std::string_view next();
    /// The next token as a number or integer. Throws ContentError (syntax) naming `what` otherwise.
    double number(const char* what);
    std::int64_t integer(const char* what);
    /// Requires that only numbers are left and returns how many.
    std::int64_t count_numbers(const char* what);
    [[nodiscard]] std::int64_t line_number() const { return line_number_; }
    [[noreturn]] void fail(const std::string& message) const;

  private:
    std::string_view rest_;
    std::int64_t line_number_;
};

/// Walks over the lines of a text. Lines end with LF, CR LF or CR; a UTF-8 byte order mark is skipped.
class TextLines {
  public:
    /// `comment`: the character that starts a comment, or 0.
    explicit TextLines(std::string_view text, char comment = '\0');

    /// Moves to the next line; false at the end.
    bool next();
    /// Moves to the next line that holds more than blanks and comment; false at the end.
    bool next_filled();
    /// The current line without its end and comment.
    [[nodiscard]] std::string_view line() const { return line_; }
    [[nodiscard]] std::int64_t number() const { return number_; }
    [[nodiscard]] Tokens tokens() const { return {line_, number_}; }
    /// Offset of the first byte behind the current line.
    [[nodiscard]] std::size_t position() const { return position_; }
    /// Bytes behind the current line: a bound for whatever can still come.
    [[nodiscard]] std::size_t remaining() const { return text_.size() - position_; }

  private:
    std::string_view text_;
    std::string_view line_;
    std::size_t position_ = 0;
    std::size_t next_feed_ = 0;  // next LF at or behind position_, found once: a file of CRs stays linear
    std::int64_t number_ = 0;
    char comment_;
};

/// A token made fit for a message: cut to a few characters, unprintable bytes as '?'.
std::string shown(std::string_view token);

}  // namespace ricci
