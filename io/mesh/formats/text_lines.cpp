#include "io/mesh/formats/text_lines.h"

#include <algorithm>
#include <charconv>
#include <limits>

#include "io/mesh/formats/polygon_soup.h"

namespace ricci {
namespace {

bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}
bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

/// from_chars knows no leading plus.
std::string_view without_plus(std::string_view token) {
    if (token.size() > 1 && token[0] == '+' && (is_digit(token[1]) || token[1] == '.'))
        token.remove_prefix(1);
    return token;
}

/// Decimal exponent of the leading digit, for numbers that from_chars finds out of range: does it overflow?
bool is_beyond_range(std::string_view token) {
    std::int64_t exponent = 0;
    const std::size_t e = token.find_first_of("eE");
    if (e != std::string_view::npos) {
        const std::string_view digits = without_plus(token.substr(e + 1));
        const bool parsed = parse_integer(digits, exponent);
        if (!parsed) return digits.empty() || digits[0] != '-';  // more than 64 bits of exponent
    }
    constexpr std::int64_t kLimit = std::int64_t{1} << 62;  // so that adding digits cannot overflow
    exponent = std::clamp(exponent, -kLimit, kLimit);
    const std::string_view mantissa = token.substr(0, e);
    const std::size_t point = std::min(mantissa.find('.'), mantissa.size());
    const std::size_t lead = mantissa.find_first_of("123456789");
    if (lead == std::string_view::npos) return false;
    return exponent + static_cast<std::int64_t>(point) - static_cast<std::int64_t>(lead) > 0;
}

}  // namespace

bool parse_number(std::string_view token, double& value) {
    token = without_plus(token);
    const char* end = token.data() + token.size();
    const auto [stop, error] = std::from_chars(token.data(), end, value);
    if (error == std::errc::result_out_of_range && stop == end) {
        value = is_beyond_range(token) ? std::numeric_limits<double>::infinity() : 0.0;
        return true;
    }
    if (error == std::errc() && stop == end) return true;
    if (token.find(".#") != std::string_view::npos) {
        value = std::numeric_limits<double>::quiet_NaN();
        return true;
    }
    return false;
}

bool parse_integer(std::string_view token, std::int64_t& value) {
    token = without_plus(token);
    const char* end = token.data() + token.size();
    const auto [stop, error] = std::from_chars(token.data(), end, value);
    return error == std::errc() && stop == end;
}

bool Tokens::done() {
    std::size_t i = 0;
    while (i < rest_.size() && is_blank(rest_[i])) ++i;
    rest_.remove_prefix(i);
    return rest_.empty();
}

std::string_view Tokens::next() {
    if (done()) return {};
    std::size_t i = 0;
    while (i < rest_.size() && !is_blank(rest_[i])) ++i;
    const std::string_view token = rest_.substr(0, i);
    rest_.remove_prefix(i);
    return token;
}

double Tokens::number(const char* what) {
    const std::string_view token = next();
    double value = 0;
    if (token.empty()) fail(std::string("the line ends where ") + what + " is expected");
    if (!parse_number(token, value)) {
        const bool comma = token.find(',') != std::string_view::npos;
        fail(shown(token) + " is not a number (" + what + ")" +
             (comma ? "; decimals need a point and numbers are separated by blanks, not commas" : ""));
    }
    return value;
}

std::int64_t Tokens::integer(const char* what) {
    const std::string_view token = next();
    std::int64_t value = 0;
    if (token.empty()) fail(std::string("the line ends where ") + what + " is expected");
    if (!parse_integer(token, value)) fail(shown(token) + " is not an integer (" + what + ")");
    return value;
}

std::int64_t Tokens::count_numbers(const char* what) {
    std::int64_t count = 0;
    for (; !done(); ++count) number(what);
    return count;
}

void Tokens::fail(const std::string& message) const {
    throw ContentError("syntax", line_number_, "line " + std::to_string(line_number_) + ": " + message);
}

TextLines::TextLines(std::string_view text, char comment) : text_(text), comment_(comment) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (text_.substr(0, 3) == kByteOrderMark) text_.remove_prefix(3);
    next_feed_ = std::min(text_.find('\n'), text_.size());
}

bool TextLines::next() {
    if (position_ >= text_.size()) return false;
    if (next_feed_ < position_) next_feed_ = std::min(text_.find('\n', position_), text_.size());
    line_ = text_.substr(position_, next_feed_ - position_);
    const std::size_t carriage = std::min(line_.find('\r'), line_.size());
    line_ = line_.substr(0, carriage);
    position_ += carriage;
    if (position_ < text_.size() && text_[position_] == '\r') ++position_;
    if (position_ < text_.size() && text_[position_] == '\n') ++position_;
    ++number_;
    if (comment_ == '\0') return true;
    for (std::size_t i = line_.find(comment_); i != std::string_view::npos; i = line_.find(comment_, i + 1)) {
        // Microsoft's runtime writes 1.#QNAN, 1.#IND, 1.#INF: not a comment but a number that must not be
        // accepted.
        const bool special = i > 0 && line_[i - 1] == '.' && i + 1 < line_.size() &&
                             std::string_view("QSI").find(line_[i + 1]) != std::string_view::npos;
        if (special) continue;
        line_ = line_.substr(0, i);
        break;
    }
    return true;
}

bool TextLines::next_filled() {
    while (next()) {
        if (!std::all_of(line_.begin(), line_.end(), is_blank)) return true;
    }
    return false;
}

std::string shown(std::string_view token) {
    constexpr std::size_t kShown = 40;
    std::string text = "'";
    for (const char c : token.substr(0, kShown)) text += (c >= ' ' && c <= '~') ? c : '?';
    return text + (token.size() > kShown ? "...'" : "'");
}

}  // namespace ricci
