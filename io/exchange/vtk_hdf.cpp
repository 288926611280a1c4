#include "io/exchange/vtk_hdf.h"

#include <stdexcept>
#include <string_view>

#include "io/exchange/vtk_cells.h"
#include "io/store/durable.h"
#include "io/store/hdf5_file.h"

namespace ricci {
namespace {

using hdf5::Handle;

// VTK compares the attribute as fixed-length ASCII; it does not read variable-length text here.
void write_type(hid_t group) {
    constexpr std::string_view kType = "UnstructuredGrid";
    const Handle type(H5Tcopy(H5T_C_S1), "Type");
    hdf5::check(H5Tset_size(type, kType.size()), "Type");
    hdf5::check(H5Tset_strpad(type, H5T_STR_NULLPAD), "Type");
    hdf5::check(H5Tset_cset(type, H5T_CSET_ASCII), "Type");
    const Handle space(H5Screate(H5S_SCALAR), "Type");
    const Handle attribute(H5Acreate2(group, "Type", type, space, H5P_DEFAULT, H5P_DEFAULT), "Type");
    hdf5::check(H5Awrite(attribute, type, kType.data()), "Type");
}

void write_version(hid_t group) {
    const hsize_t count = 2;
    const std::int64_t version[2] = {1, 0};
    const Handle space(H5Screate_simple(1, &count, nullptr), "Version");
    const Handle attribute(H5Acreate2(group, "Version", H5T_STD_I64LE, space, H5P_DEFAULT, H5P_DEFAULT),
                           "Version");
    hdf5::check(H5Awrite(attribute, H5T_STD_I64LE, version), "Version");
}

void write_grid(hid_t group, const GeometryBlock& block) {
    const VtkCells cells(block);
    using Counts = std::vector<std::int64_t>;
    const auto count = [](std::size_t n) { return Counts{static_cast<std::int64_t>(n)}; };
    hdf5::write_array(group, "NumberOfPoints", count(block.points.size()));
    hdf5::write_array(group, "NumberOfCells", count(block.cell_count()));
    hdf5::write_array(group, "NumberOfConnectivityIds", count(block.corners.size()));
    const std::span<const double> coordinates(block.points.front().data(), 3 * block.points.size());
    hdf5::write_array(group, "Points", coordinates, {block.points.size(), 3});
    hdf5::write_array(group, "Connectivity", cells.corners);
    Counts offsets{0};
    offsets.insert(offsets.end(), cells.ends.begin(), cells.ends.end());
    hdf5::write_array(group, "Offsets", offsets);
    hdf5::write_array(group, "Types", vtk_types(block));
}

void write_data(hid_t root, const char* name, const std::vector<DataArray>& arrays) {
    const Handle group = hdf5::create_group(root, name);
    for (const DataArray& array : arrays) {
        const std::string stored = hdf5::stored_text(array.name);
        hdf5::Shape shape{array.rows()};
        if (array.components > 1) shape.push_back(array.components);
        const bool written = std::visit(
            [&]<class T>(const std::vector<T>& values) {
                // VTK 9.1 stops at texts in these groups.
                if constexpr (std::is_same_v<T, std::string>)
                    return false;
                else
                    hdf5::write_array(group, stored, std::span<const T>(values), shape);
                return true;
            },
            array.values);
        if (!written || array.unit.empty()) continue;
        const hdf5::Input dataset(group, stored);
        hdf5::write_text_attribute(dataset.id(), "units", array.unit);
    }
}

}  // namespace

void save_vtkhdf(const std::string& path, const GeometryBlock& block) {
    require_valid(block);
    if (block.points.empty()) throw std::invalid_argument(block.name + ": there are no points to write");
    const hdf5::Session session;
    const std::string temporary = path + ".tmp";
    hdf5::write_file(temporary, [&](hdf5::OutputFile& file) {
        const Handle group = hdf5::create_group(file.root(), "VTKHDF");
        write_version(group);
        write_type(group);
        write_grid(group, block);
        write_data(group, "PointData", block.point_data);
        write_data(group, "CellData", block.cell_data);
        write_data(group, "FieldData", block.field_data);
    });
    rename_durably(temporary, path);
}

}  // namespace ricci
