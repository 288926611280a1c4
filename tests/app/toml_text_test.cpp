#include "engine/app/toml_text.h"

#include <gtest/gtest.h>

#include "engine/app/console.h"

namespace ricci::app {
namespace {

std::string complaint(const std::string& text) {
    try {
        parse_toml(text, "c.toml");
    } catch (const UsageError& error) {
        return error.what();
    }
    return "";
}

std::string repeated(const std::string& piece, int times) {
    std::string text;
    for (int i = 0; i < times; ++i) text += piece;
    return text;
}

// Each part of a key is a table within a table; taking a million of them down again would overflow the stack.
TEST(TomlText, RefusesKeysOfManyParts) {
    EXPECT_EQ(complaint("\n\n" + repeated("a.", 1'000'000) + "a = 1\n"),
              "c.toml:3: a key has more than 16 parts");
    EXPECT_EQ(complaint("[" + repeated("a.", 16) + "a]\n"), "c.toml:1: a key has more than 16 parts");
    EXPECT_EQ(complaint("[[" + repeated("\"x\" . ", 16) + "a]]\n"), "c.toml:1: a key has more than 16 parts");
    EXPECT_EQ(complaint(repeated("a.", 15) + "a = 1\n"), "");
}

TEST(TomlText, CountsNoDotsInStringsAndComments) {
    const std::string dots = repeated("a.", 40);
    EXPECT_EQ(complaint("a = \"" + dots + "\"\n"), "");
    EXPECT_EQ(complaint("a = '" + dots + "'\n"), "");
    EXPECT_EQ(complaint("a = \"\"\"\n" + dots + "\n\"quoted\" \\\" \"\"\"\"\"\nb = '''" + dots + "'''\n"),
              "");
    EXPECT_EQ(complaint("# " + dots + "\na = [ 1.5, 2.5, 3.5 ] # " + dots), "");
    EXPECT_EQ(complaint("a = \"\\\"" + dots + "\"\n"), "");
    EXPECT_EQ(complaint("a = \"x\"\n" + dots + "b = 1\n"), "c.toml:2: a key has more than 16 parts");
}

TEST(TomlText, PrintsWhatItReads) {
    for (const std::string text : {"\nlist", "a\nb", "tab\tand \"quotes\" '", "\r\n\\", "\x7f\x01"}) {
        const toml::table table{{"a", text}};
        EXPECT_EQ(*toml_value<std::string>(*parse_toml(toml_text(table), "test").get("a")), text);
    }
}

TEST(TomlText, ConvertsOnlyWhatTheTypeHolds) {
    const toml::table table = parse_toml(
        "whole = 5.0\nbroken = 5.5\nhuge = -9.2e99\nnone = nan\nlarge = 3000000000\ntext = '5'\nyes = true\n",
        "test");
    const auto number = [&](const char* key) { return toml_value<int>(*table.get(key)); };
    EXPECT_EQ(number("whole"), 5);
    for (const char* key : {"broken", "huge", "none", "large", "text", "yes"})
        EXPECT_EQ(number(key), std::nullopt) << key;
    EXPECT_EQ(toml_value<std::int64_t>(*table.get("large")), 3000000000);
    EXPECT_EQ(toml_value<double>(*table.get("large")), 3e9);
    EXPECT_EQ(toml_value<double>(*table.get("yes")), std::nullopt);
    EXPECT_EQ(toml_value<bool>(*table.get("whole")), std::nullopt);
}

TEST(TomlText, RefusesWhatIsDeepOrLarge) {
    EXPECT_NE(complaint("a = " + repeated("[", 100'000)).find("c.toml:1: "), std::string::npos);
    EXPECT_NE(complaint("a = " + repeated("{a = ", 100'000)).find("c.toml:1: "), std::string::npos);
    EXPECT_EQ(complaint(std::string((std::size_t{1} << 24U) + 1, '\n')),
              "c.toml: is larger than 16777216 bytes, too large for a configuration");
}

}  // namespace
}  // namespace ricci::app
