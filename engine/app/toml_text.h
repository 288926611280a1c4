// TOML from files that nobody vouches for.
#pragma once

#include <string>
#include <string_view>

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

}  // namespace ricci::app
