// Reading back what SvgPicture wrote, by code that knows the standard and not the writer.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

namespace ricci::svg_reading {

/// A command of a path with its end in absolute pixels, y downwards.
struct Command {
    char verb = 'm';
    std::array<double, 2> from{}, to{};
    double radius = 0.0;
    bool large = false, sweep = false;
};

/// Commands of path data with the verbs m, l, a and z, all relative.
inline std::vector<Command> read_path(const std::string& data) {
    std::vector<Command> commands;
    std::array<double, 2> at{}, start{};
    const char* p = data.c_str();
    const auto number = [&] {
        char* end = nullptr;
        const double value = std::strtod(p, &end);
        EXPECT_NE(p, end) << "no number at: " << p;
        p = end;
        return value;
    };
    while (*p != '\0') {
        Command command;
        command.verb = *p++;
        command.from = at;
        if (command.verb == 'z') {
            at = start;
        } else {
            if (command.verb == 'a') {
                command.radius = number();
                EXPECT_EQ(number(), command.radius);
                EXPECT_EQ(number(), 0.0);
                command.large = number() != 0.0;
                command.sweep = number() != 0.0;
            }
            const double dx = number();
            at = {at[0] + dx, at[1] + number()};
            if (command.verb == 'm') start = at;
        }
        command.to = at;
        commands.push_back(command);
    }
    return commands;
}

/// Centre of an arc by the rules of SVG 1.1, appendix F.6.5, for circles.
inline std::array<double, 2> centre_of(const Command& arc) {
    const double dx = 0.5 * (arc.from[0] - arc.to[0]), dy = 0.5 * (arc.from[1] - arc.to[1]);
    const double half = dx * dx + dy * dy;
    const double factor = std::sqrt(std::max(0.0, arc.radius * arc.radius / half - 1.0)) *
                          (arc.large == arc.sweep ? -1.0 : 1.0);
    return {0.5 * (arc.from[0] + arc.to[0]) + factor * dy, 0.5 * (arc.from[1] + arc.to[1]) - factor * dx};
}

/// Values of an attribute in the order of the file.
inline std::vector<std::string> attributes(const std::string& document, const std::string& name) {
    std::vector<std::string> values;
    const std::string start = " " + name + "=\"";
    for (std::size_t at = document.find(start); at != std::string::npos; at = document.find(start, at)) {
        at += start.size();
        values.push_back(document.substr(at, document.find('"', at) - at));
    }
    return values;
}

/// The path data of a document.
inline std::vector<std::string> paths(const std::string& document) {
    return attributes(document, "d");
}

/// What keeps the document from being well-formed XML, "" when nothing does: tags nest, attributes are quoted
/// and told apart by blanks, every & starts a known entity.
inline std::string malformed(const std::string& document) {
    std::vector<std::string> open;
    std::size_t at = document.find("?>");
    if (document.compare(0, 5, "<?xml") != 0 || at == std::string::npos) return "no declaration";
    at += 2;
    const auto entity_ok = [&](std::size_t i) {
        for (const std::string_view entity : {"&amp;", "&lt;", "&gt;", "&quot;"})
            if (document.compare(i, entity.size(), entity) == 0) return true;
        return false;
    };
    bool in_tag = false, quoted = false;
    std::size_t tag = 0;
    for (; at < document.size(); ++at) {
        const char c = document[at];
        if (static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t') return "control character";
        if (c == '&' && !entity_ok(at)) return "stray & at " + document.substr(at, 10);
        if (in_tag && c == '"') {
            quoted = !quoted;
        } else if (c == '<') {
            if (in_tag) return "< within a tag";
            in_tag = true;
            tag = at + 1;
        } else if (c == '>' && !quoted) {
            if (!in_tag) return "> outside a tag";
            in_tag = false;
            const std::string words = document.substr(tag, at - tag);
            const std::string name = words.substr(0, words.find(' '));
            if (words.front() == '/') {
                if (open.empty() || "/" + open.back() != words) return "unexpected " + words;
                open.pop_back();
            } else if (words.back() != '/') {
                open.push_back(name);
            }
        }
    }
    return open.empty() && !in_tag ? "" : "unclosed " + (open.empty() ? "tag" : open.back());
}

}  // namespace ricci::svg_reading
