// Wavefront OBJ. Only v and f matter here; statements about appearance are skipped, free-form geometry is
// refused.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "io/mesh/formats/element_defects.h"
#include "io/mesh/formats/formats.h"
#include "io/mesh/formats/text_lines.h"

namespace ricci {
namespace {

constexpr std::array<std::string_view, 22> kSkipped = {
    "vt",     "vn", "g",     "o",        "s",        "usemtl", "mtllib",     "usemap",
    "maplib", "mg", "bevel", "c_interp", "d_interp", "lod",    "shadow_obj", "trace_obj",
    "matlib", "vc", "vp",    "ctech",    "stech",    "mtl"};
constexpr std::array<std::string_view, 14> kFreeForm = {"cstype", "deg",  "curv", "curv2", "surf",
                                                        "parm",   "trim", "hole", "scrv",  "sp",
                                                        "end",    "con",  "bmat", "step"};

template <std::size_t N>
bool contains(const std::array<std::string_view, N>& words, std::string_view word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

class ObjParser {
  public:
    explicit ObjParser(std::string_view text) : lines_(text, '#') { file_.soup.index_base = 1; }

    ParsedFile parse() {
        while (lines_.next()) statement();
        if (lines_and_points_ > 0) {
            file_.notes.add("ignored_elements", "file", -1,
                            std::to_string(lines_and_points_) + " line or point statements (l, p) ignored");
        }
        return std::move(file_);
    }

  private:
    /// One statement, which a backslash at the end of a line continues on the next one.
    void statement() {
        std::string_view line = lines_.line();
        const std::int64_t number = lines_.number();
        if (line.empty() || line.back() != '\\') return dispatch(Tokens(line, number));
        std::string joined;
        while (!line.empty() && line.back() == '\\') {
            joined.append(line.substr(0, line.size() - 1)).push_back(' ');
            if (!lines_.next()) throw ContentError("truncated", number, "the file ends in a continued line");
            line = lines_.line();
        }
        joined.append(line);
        dispatch(Tokens(joined, number));
    }

    void dispatch(Tokens tokens) {
        const std::string_view word = tokens.next();
        if (word.empty()) return;
        if (word == "v") return vertex(tokens);
        if (word == "f" || word == "fo") return face(tokens);
        if (contains(kSkipped, word)) return;
        if (word == "l" || word == "p") {
            ++lines_and_points_;
            return;
        }
        if (contains(kFreeForm, word)) {
            throw ContentError("unsupported_format", tokens.line_number(),
                               "line " + std::to_string(tokens.line_number()) + ": free-form geometry (" +
                                   shown(word) + ") is not supported; convert it to polygons first");
        }
        tokens.fail("unknown statement " + shown(word));
    }

    void vertex(Tokens& tokens) {
        Point point;
        for (double& coordinate : point)
            coordinate = tokens.number("one of the three coordinates of a vertex");
        tokens.count_numbers("weight or colour of a vertex");
        add_point(file_, point, tokens.line_number());
    }

    void face(Tokens& tokens) {
        PolygonSoup& soup = file_.soup;
        while (!tokens.done()) soup.corners.push_back(corner(tokens));
        end_face_of_line(file_, tokens.line_number());
    }

    /// "v", "v/vt", "v//vn", "v/vt/vn": the vertex counts from 1, or from the last one backwards.
    std::int64_t corner(Tokens& tokens) {
        const std::string_view token = tokens.next();
        const std::size_t slash = std::min(token.find('/'), token.size());
        std::int64_t number = 0;
        if (!parse_integer(token.substr(0, slash), number) || !other_numbers(token.substr(slash))) {
            tokens.fail(shown(token) +
                        " is not a corner of a face (vertex, vertex/texture or vertex/texture/normal)");
        }
        if (number > 0) return number - 1;
        const auto count = static_cast<std::int64_t>(file_.soup.points.size());
        if (number < 0 && number >= -count) return count + number;
        const auto f = static_cast<std::int64_t>(file_.soup.face_count());
        file_.errors.add("index_out_of_range", "face", f, [&] {
            return "line " + std::to_string(tokens.line_number()) + ", face " + std::to_string(f) +
                   ": vertex number " + std::to_string(number) +
                   (number == 0 ? " (OBJ counts from 1)"
                                : " counts back beyond the first of the " + std::to_string(count) +
                                      " vertices so far");
        });
        return kReportedCorner;
    }

    /// What follows the vertex number: at most two more, each of which may be left out.
    static bool other_numbers(std::string_view rest) {
        for (int i = 0; !rest.empty(); ++i) {
            if (i == 2 || rest[0] != '/') return false;
            rest.remove_prefix(1);
            const std::size_t slash = std::min(rest.find('/'), rest.size());
            std::int64_t ignored = 0;
            if (slash > 0 && !parse_integer(rest.substr(0, slash), ignored)) return false;
            rest.remove_prefix(slash);
        }
        return true;
    }

    TextLines lines_;
    ParsedFile file_;
    std::int64_t lines_and_points_ = 0;
};

}  // namespace

ParsedFile parse_obj(std::string_view text) {
    return ObjParser(text).parse();
}

}  // namespace ricci
