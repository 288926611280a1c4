#include "engine/app/toml_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <sstream>
#include <stdexcept>

#include "engine/app/console.h"

namespace ricci::app {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{1} << 24;
constexpr std::size_t kMaxParts = 16;

/// Walks over a text outside of strings and comments, counting the dots of each key.
class KeyDepth {
  public:
    explicit KeyDepth(std::string_view text) : text_(text) {}

    /// The line of a key of more than kMaxParts parts; 0: there is none.
    std::int64_t line_too_deep() {
        std::size_t parts = 1;
        for (; at_ < text_.size(); ++at_) {
            const char c = text_[at_];
            if (c == '#') at_ = std::min(text_.find('\n', at_), text_.size() - 1);
            if (c == '"' || c == '\'') skip_string(c);
            if (at_ >= text_.size()) break;
            if (c == '.' && ++parts > kMaxParts) return line();
            if (std::string_view("\n=,[]{}#").find(c) != std::string_view::npos) parts = 1;
        }
        return 0;
    }

  private:
    [[nodiscard]] std::int64_t line() const {
        return 1 + std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(at_), '\n');
    }

    /// From the opening quote to the last character of the string.
    void skip_string(char quote) {
        const std::string three(3, quote);
        const bool several_lines = text_.substr(at_, 3) == three;
        at_ += several_lines ? 3 : 1;
        for (; at_ < text_.size(); ++at_) {
            if (quote == '"' && text_[at_] == '\\') {
                ++at_;
            } else if (several_lines && text_.substr(at_, 3) == three) {
                at_ += 2;  // of the quotes that end it; two more may belong to the contents
                for (int k = 0; k < 2 && at_ + 1 < text_.size() && text_[at_ + 1] == quote; ++k) ++at_;
                return;
            } else if (!several_lines && (text_[at_] == quote || text_[at_] == '\n')) {
                return;
            }
        }
    }

    std::string_view text_;
    std::size_t at_ = 0;
};

}  // namespace

void toml_assertion_failed(const char* expression) {
    throw std::logic_error(expression);
}

toml::table parse_toml(std::string_view text, const std::string& source) {
    if (text.size() > kMaxBytes)
        throw UsageError(
            fmt::format("{}: is larger than {} bytes, too large for a configuration", source, kMaxBytes));
    if (const std::int64_t line = KeyDepth(text).line_too_deep(); line > 0)
        throw UsageError(fmt::format("{}:{}: a key has more than {} parts", source, line, kMaxParts));
    try {
        return toml::parse(text);
    } catch (const toml::parse_error& e) {
        throw UsageError(
            fmt::format("{}:{}: {}", source, e.source().begin.line, std::string(e.description())));
    } catch (const std::logic_error& e) {
        throw UsageError(fmt::format("{}: is not TOML ({})", source, e.what()));
    }
}

std::string toml_text(const toml::table& table) {
    const auto printed = [&](toml::format_flags flags) {
        std::ostringstream text;
        text << toml::toml_formatter{table, flags} << "\n";
        return text.str();
    };
    using Formatter = toml::toml_formatter;
    std::string text = printed(Formatter::default_flags);
    try {
        if (toml::parse(text) == table) return text;
    } catch (const toml::parse_error&) {
    }
    // Control characters: a text that begins with a new line loses it in several lines, others are printed
    // raw.
    return printed(Formatter::default_flags & ~toml::format_flags::allow_multi_line_strings &
                   ~toml::format_flags::allow_literal_strings);
}

std::optional<std::int64_t> whole_toml_number(const toml::node& node) {
    if (const auto integer = node.value_exact<std::int64_t>()) return integer;
    const auto number = node.value_exact<double>();
    if (!number || !(std::abs(*number) <= 0x1p53) || std::trunc(*number) != *number) return std::nullopt;
    return static_cast<std::int64_t>(*number);
}

}  // namespace ricci::app
