#include "io/mesh/save_curves.h"

#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <string_view>

#include "io/mesh/formats/file_bytes.h"
#include "io/mesh/formats/mesh_text.h"
#include "io/mesh/mesh_file.h"

namespace ricci {
namespace {

bool closed(const NamedCurve& curve) {
    return curve.points.size() > 2 && curve.points.front() == curve.points.back();
}

void check(std::span<const NamedCurve> curves) {
    for (const NamedCurve& curve : curves) {
        if (curve.points.size() < 2)
            throw std::invalid_argument("save_curves: curve " + curve.name + " has fewer than two points");
        bool finite = std::isfinite(curve.length);
        for (const Point& p : curve.points)
            for (const double x : p) finite = finite && std::isfinite(x);
        if (!finite)
            throw std::invalid_argument("save_curves: curve " + curve.name +
                                        " has numbers that are not finite");
    }
}

/// Points to write, numbered through, and the numbers that each curve runs through.
struct Lines {
    std::vector<Point> points;
    std::vector<std::vector<Index>> vertices;
    Index corners = 0;
};

Lines lines_of(std::span<const NamedCurve> curves) {
    Lines lines;
    for (const NamedCurve& curve : curves) {
        const auto first = static_cast<Index>(lines.points.size());
        const auto count = static_cast<Index>(curve.points.size()) - (closed(curve) ? 1 : 0);
        lines.points.insert(lines.points.end(), curve.points.begin(), curve.points.begin() + count);
        std::vector<Index>& line = lines.vertices.emplace_back();
        for (Index i = 0; i < count; ++i) line.push_back(first + i);
        if (closed(curve)) line.push_back(first);
        lines.corners += static_cast<Index>(line.size());
    }
    return lines;
}

void write_points(MeshText& out, const std::vector<Point>& points, std::string_view prefix) {
    for (const Point& p : points) out << prefix << p[0] << " " << p[1] << " " << p[2] << "\n";
}

/// The bytes of a name that are not letters, digits or one of "_-.^": as %XX, or all as '_'.
std::string plain_name(const std::string& name, bool percent) {
    constexpr std::string_view kDigits = "0123456789ABCDEF", kKept = "_-.^";
    std::string text;
    for (const char c : name) {
        const auto byte = static_cast<unsigned char>(c);
        const bool alphanumeric = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
        if (alphanumeric || kKept.find(c) != std::string_view::npos) {
            text += c;
        } else if (percent) {
            text += {'%', kDigits[byte / 16], kDigits[byte % 16]};
        } else {
            text += byte <= ' ' || byte == 127 ? '_' : c;
        }
    }
    return text;
}

void write_obj(MeshText& out, std::span<const NamedCurve> curves) {
    const Lines lines = lines_of(curves);
    write_points(out, lines.points, "v ");
    for (std::size_t i = 0; i < curves.size(); ++i) {
        out << "o " << plain_name(curves[i].name, false) << "\nl";
        for (const Index v : lines.vertices[i]) out << " " << v + 1;
        out << "\n";
    }
}

void write_vtk(MeshText& out, std::span<const NamedCurve> curves) {
    const Lines lines = lines_of(curves);
    const auto count = static_cast<Index>(curves.size());
    out << "# vtk DataFile Version 3.0\ncurves on a surface\nASCII\nDATASET POLYDATA\nPOINTS "
        << static_cast<Index>(lines.points.size()) << " double\n";
    write_points(out, lines.points, "");
    out << "LINES " << count << " " << count + lines.corners << "\n";
    for (const std::vector<Index>& line : lines.vertices) {
        out << static_cast<Index>(line.size());
        for (const Index v : line) out << " " << v;
        out << "\n";
    }
    out << "CELL_DATA " << count << "\nSCALARS curve int 1\nLOOKUP_TABLE default\n";
    for (Index i = 0; i < count; ++i) out << i << "\n";
    out << "SCALARS length double 1\nLOOKUP_TABLE default\n";
    for (const NamedCurve& curve : curves) out << curve.length << "\n";
    out << "FIELD FieldData 1\nname 1 " << count << " string\n";
    for (const NamedCurve& curve : curves) out << plain_name(curve.name, true) << "\n";
}

void open_array(MeshText& out, std::string_view type, std::string_view name) {
    out << "<DataArray type=\"" << type << "\" Name=\"" << name << "\" format=\"ascii\">\n";
}
constexpr std::string_view kCloseArray = "</DataArray>\n";

void write_vtp_lines(MeshText& out, const Lines& lines) {
    out << "<Lines>\n";
    open_array(out, "Int32", "connectivity");
    for (const std::vector<Index>& line : lines.vertices) {
        for (const Index v : line) out << v << " ";
        out << "\n";
    }
    out << kCloseArray;
    open_array(out, "Int32", "offsets");
    Index end = 0;
    for (const std::vector<Index>& line : lines.vertices) {
        end += static_cast<Index>(line.size());
        out << end << "\n";
    }
    out << kCloseArray << "</Lines>\n";
}

void write_vtp_data(MeshText& out, std::span<const NamedCurve> curves) {
    out << "<CellData>\n";
    open_array(out, "Int32", "curve");
    for (Index i = 0; i < static_cast<Index>(curves.size()); ++i) out << i << "\n";
    out << kCloseArray;
    open_array(out, "Float64", "length");
    for (const NamedCurve& curve : curves) out << curve.length << "\n";
    out << kCloseArray;
    open_array(out, "String", "name");  // the codes of the bytes, each name closed by a zero
    for (const NamedCurve& curve : curves) {
        for (const char c : curve.name) out << Index{static_cast<unsigned char>(c)} << " ";
        out << "0\n";
    }
    out << kCloseArray << "</CellData>\n";
}

void write_vtp(MeshText& out, std::span<const NamedCurve> curves) {
    const Lines lines = lines_of(curves);
    out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"0.1\" "
           "byte_order=\"LittleEndian\">\n"
        << "<PolyData>\n<Piece NumberOfPoints=\"" << static_cast<Index>(lines.points.size())
        << "\" NumberOfVerts=\"0\" NumberOfLines=\"" << static_cast<Index>(curves.size())
        << "\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n<Points>\n"
        << "<DataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\" format=\"ascii\">\n";
    write_points(out, lines.points, "");
    out << kCloseArray << "</Points>\n";
    write_vtp_lines(out, lines);
    write_vtp_data(out, curves);
    out << "</Piece>\n</PolyData>\n</VTKFile>\n";
}

using CurveWriter = void (*)(MeshText& out, std::span<const NamedCurve> curves);

CurveWriter writer_for(const std::string& path) {
    std::string suffix = std::filesystem::path(path).extension().string();
    for (char& c : suffix) c = (c >= 'A' && c <= 'Z') ? static_cast<char>(c + ('a' - 'A')) : c;
    if (suffix == ".obj") return write_obj;
    if (suffix == ".vtk") return write_vtk;
    if (suffix == ".vtp") return write_vtp;
    throw FileError(path + ": curves are written as .obj, .vtk or .vtp");
}

}  // namespace

void require_curve_file(const std::string& path) {
    writer_for(path);
}

void save_curves(const std::string& path, std::span<const NamedCurve> curves) {
    const CurveWriter write = writer_for(path);
    check(curves);
    MeshText out;
    write(out, curves);
    write_file_bytes(path, out.text());
}

}  // namespace ricci
