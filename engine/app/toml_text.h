// TOML from files that nobody vouches for.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

namespace ricci::app {

/// Throws std::logic_error.
[[noreturn]] void toml_assertion_failed(const char* expression);

}  // namespace ricci::app

// What toml++ asserts does not hold of every text ("[>"): without NDEBUG it would abort, and with it clang
// would take the assertion for granted. All of this program includes toml++ here, with assertions that throw.
#pragma push_macro("NDEBUG")
#undef NDEBUG
#define TOML_ASSERT(expression) \
    (static_cast<bool>(expression) ? void() : ::ricci::app::toml_assertion_failed(#expression))
#include <toml++/toml.h>
#pragma pop_macro("NDEBUG")

namespace ricci::app {

/// Parses `text`, which is named `source` in messages ("<source>:<line>: ..."). Throws UsageError: what is
/// not TOML, more than 16 MiB, keys of more than 16 parts (a key of a million parts is as many nested
/// tables); values nest at most 256 deep (toml++).
toml::table parse_toml(std::string_view text, const std::string& source);

/// The text of a table; parse_toml() reads the same values from it.
std::string toml_text(const toml::table& table);

/// A whole number: an integer, or a float without a fraction up to 2^53. toml++ itself converts any float,
/// which is undefined for most.
std::optional<std::int64_t> whole_toml_number(const toml::node& node);

/// A value of a type of this program; nothing where the node holds another, or a number that T does not hold.
template <class T>
std::optional<T> toml_value(const toml::node& node) {
    if constexpr (std::is_same_v<T, bool> || std::is_same_v<T, std::string>) {
        return node.value_exact<T>();
    } else if constexpr (std::is_floating_point_v<T>) {
        if (const auto integer = node.value_exact<std::int64_t>()) return static_cast<T>(*integer);
        return node.value_exact<double>();
    } else {
        const auto number = whole_toml_number(node);
        return number && std::in_range<T>(*number) ? std::optional(static_cast<T>(*number)) : std::nullopt;
    }
}

}  // namespace ricci::app
