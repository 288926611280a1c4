#include "io/exchange/vtk_xml.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <filesystem>
#include <functional>
#include <iterator>

#include "io/exchange/staged_file.h"
#include "io/exchange/vtk_cells.h"
#include "io/store/stored_text.h"

namespace ricci {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are written as they lie in memory");

std::string escaped(const std::string& name) {
    std::string text;
    for (const char c : hdf5::stored_text(name)) {
        switch (c) {
            case '&':
                text += "&amp;";
                break;
            case '<':
                text += "&lt;";
                break;
            case '>':  // legal XML, but VTK takes it for the end of the tag
                text += "&gt;";
                break;
            case '"':
                text += "&quot;";
                break;
            default:
                text += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
        }
    }
    return text;
}

/// An array behind the header: how many bytes, and what writes them.
struct Appended {
    std::uint64_t bytes = 0;
    std::function<void(StagedFile&)> write;
};

/// Collects the header's text and the arrays it refers to.
class VtkText {
  public:
    void add(const std::string& text) { header_ += text; }

    template <class T>
    void array(const char* type, const std::string& attributes, const std::string& inner,
               std::span<const T> values) {
        declare(type, attributes, inner,
                {values.size_bytes(), [values](StagedFile& file) { file.write_values(values); }});
    }

    void data(const DataArray& array, bool field) {
        const std::string inner =
            array.unit.empty() ? ""
                               : fmt::format(
                                     "<InformationKey name=\"UNITS_LABEL\" location=\"vtkDataArray\">{}"
                                     "</InformationKey>\n",
                                     escaped(array.unit));
        std::string attributes =
            fmt::format("Name=\"{}\" NumberOfComponents=\"{}\"", escaped(array.name), array.components);
        if (field) attributes += fmt::format(" NumberOfTuples=\"{}\"", array.rows());
        std::visit([&](const auto& values) { typed(attributes, inner, values); }, array.values);
    }

    void save(const std::string& path) const {
        StagedFile file(path);
        file.write(header_);
        file.write("<AppendedData encoding=\"raw\">\n_");
        for (const Appended& array : arrays_) {
            file.write_value(array.bytes);
            array.write(file);
        }
        file.write("\n</AppendedData>\n</VTKFile>\n");
        file.close();
    }

  private:
    void declare(const char* type, const std::string& attributes, const std::string& inner, Appended array) {
        header_ +=
            fmt::format("<DataArray type=\"{}\" {} format=\"appended\" offset=\"{}\">\n{}</DataArray>\n",
                        type, attributes, offset_, inner);
        offset_ += sizeof(std::uint64_t) + array.bytes;
        arrays_.push_back(std::move(array));
    }
    void typed(const std::string& attributes, const std::string& inner, const std::vector<double>& values) {
        array<double>("Float64", attributes, inner, values);
    }
    void typed(const std::string& attributes, const std::string& inner,
               const std::vector<std::int32_t>& values) {
        array<std::int32_t>("Int32", attributes, inner, values);
    }
    void typed(const std::string& attributes, const std::string& inner,
               const std::vector<std::uint8_t>& values) {
        array<std::uint8_t>("UInt8", attributes, inner, values);
    }
    // Each text is closed by a zero.
    void typed(const std::string& attributes, const std::string& inner,
               const std::vector<std::string>& values) {
        std::string bytes;
        for (const std::string& text : values) (bytes += hdf5::stored_text(text)) += '\0';
        const std::uint64_t size = bytes.size();
        declare("String", attributes, inner,
                {size, [bytes = std::move(bytes)](StagedFile& file) { file.write(bytes); }});
    }

    std::string header_;
    std::vector<Appended> arrays_;
    std::uint64_t offset_ = 0;
};

void add_cells(VtkText& text, const VtkCells& cells, const std::vector<std::uint8_t>& types) {
    text.array<std::int64_t>("Int64", "Name=\"connectivity\"", "", cells.corners);
    text.array<std::int64_t>("Int64", "Name=\"offsets\"", "", cells.ends);
    if (!types.empty()) text.array<std::uint8_t>("UInt8", "Name=\"types\"", "", types);
}

void add_data(VtkText& text, const char* element, const std::vector<DataArray>& arrays,
              const std::string& texture, const std::string& normals) {
    std::string active;
    if (!texture.empty()) active += fmt::format(" TCoords=\"{}\"", escaped(texture));
    if (!normals.empty()) active += fmt::format(" Normals=\"{}\"", escaped(normals));
    text.add(fmt::format("<{}{}>\n", element, active));
    for (const DataArray& array : arrays) text.data(array, false);
    text.add(fmt::format("</{}>\n", element));
}

const char* element_of(CellKind kind) {
    if (kind == CellKind::point) return "Verts";
    return kind == CellKind::line ? "Lines" : "Polys";
}

/// The piece's head with the counts that PolyData and UnstructuredGrid want.
std::string piece_of(const GeometryBlock& block, bool grid) {
    std::string piece = fmt::format("<Piece NumberOfPoints=\"{}\"", block.points.size());
    if (grid) return piece + fmt::format(" NumberOfCells=\"{}\">\n", block.cell_count());
    for (const CellKind kind : {CellKind::point, CellKind::line, CellKind::polygon})
        piece +=
            fmt::format(" NumberOf{}=\"{}\"", element_of(kind), kind == block.kind ? block.cell_count() : 0);
    return piece + " NumberOfStrips=\"0\">\n";
}

constexpr const char* kHead =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
    "<VTKFile type=\"{0}\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<{0}>\n";

}  // namespace

void save_vtk_xml(const std::string& path, const GeometryBlock& block) {
    const std::string suffix = std::filesystem::path(path).extension().string();
    if (suffix != ".vtp" && suffix != ".vtu")
        throw FileError(path + ": VTK's XML formats are written as .vtp or .vtu");
    require_valid(block);
    const bool grid = suffix == ".vtu";
    const char* type = grid ? "UnstructuredGrid" : "PolyData";
    const VtkCells cells(block);
    const std::vector<std::uint8_t> types = grid ? vtk_types(block) : std::vector<std::uint8_t>();
    VtkText text;
    text.add(fmt::format(kHead, type));
    text.add("<FieldData>\n");
    for (const DataArray& array : block.field_data) text.data(array, true);
    text.add("</FieldData>\n");
    text.add(piece_of(block, grid) + "<Points>\n");
    text.array<double>(
        "Float64", "Name=\"Points\" NumberOfComponents=\"3\"", "",
        std::span(block.points.empty() ? nullptr : block.points.front().data(), 3 * block.points.size()));
    const char* element = grid ? "Cells" : element_of(block.kind);
    text.add(fmt::format("</Points>\n<{}>\n", element));
    add_cells(text, cells, types);
    text.add(fmt::format("</{}>\n", element));
    add_data(text, "PointData", block.point_data, block.texture, block.normals);
    add_data(text, "CellData", block.cell_data, "", "");
    text.add(fmt::format("</Piece>\n</{}>\n", type));
    text.save(path);
}

namespace {

void append_tree(std::string& text, std::span<const VtkBlockTree> blocks) {
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        const VtkBlockTree& block = blocks[i];
        if (block.children.empty()) {
            fmt::format_to(std::back_inserter(text), "<DataSet index=\"{}\" name=\"{}\" file=\"{}\"/>\n", i,
                           escaped(block.name), escaped(block.file));
            continue;
        }
        fmt::format_to(std::back_inserter(text), "<Block index=\"{}\" name=\"{}\">\n", i,
                       escaped(block.name));
        append_tree(text, block.children);
        text += "</Block>\n";
    }
}

}  // namespace

void save_vtm(const std::string& path, std::span<const VtkBlockTree> blocks) {
    constexpr const char* kType = "vtkMultiBlockDataSet";
    std::string text = fmt::format(kHead, kType);
    append_tree(text, blocks);
    write_text_durably(path, text + fmt::format("</{}>\n</VTKFile>\n", kType));
}

}  // namespace ricci
