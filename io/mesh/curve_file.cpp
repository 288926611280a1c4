#include "io/mesh/curve_file.h"

#include <limits>
#include <map>

#include "io/mesh/formats/file_bytes.h"
#include "io/mesh/formats/polygon_soup.h"
#include "io/mesh/formats/text_lines.h"
#include "io/mesh/mesh_file.h"

namespace ricci {
namespace {

VertexCurve parse_curve(Tokens tokens) {
    VertexCurve curve;
    curve.name = tokens.next();
    curve.line = tokens.line_number();
    while (!tokens.done()) {
        const std::int64_t vertex = tokens.integer("a vertex of the curve");
        if (vertex < 0 || vertex > std::numeric_limits<Index>::max())
            tokens.fail("vertex " + std::to_string(vertex) + " of curve " + shown(curve.name) +
                        " is out of range");
        curve.vertices.push_back(static_cast<Index>(vertex));
    }
    if (curve.vertices.empty()) tokens.fail("curve " + shown(curve.name) + " has no vertices");
    return curve;
}

}  // namespace

std::vector<VertexCurve> read_curves(const std::string& path) {
    const std::string bytes = read_file_bytes(path);
    std::vector<VertexCurve> curves;
    std::map<std::string, std::int64_t> lines_of;  // ordered: no file can make its names collide
    try {
        for (TextLines lines(bytes, '#'); lines.next_filled();) {
            curves.push_back(parse_curve(lines.tokens()));
            const auto [first, fresh] = lines_of.emplace(curves.back().name, lines.number());
            if (!fresh)
                lines.tokens().fail("curve " + shown(first->first) + " has been given in line " +
                                    std::to_string(first->second) + " already");
        }
    } catch (const ContentError& error) {
        throw FileError(path + ": " + error.what());
    }
    if (curves.empty()) throw FileError(path + ": the file holds no curve (one per line: NAME v0 v1 v2 ...)");
    return curves;
}

}  // namespace ricci
