#include <cstring>
#include <string_view>

#include "io/store/durable.h"
#include "io/store/export_fields.h"
#include "io/store/hdf5_file.h"
#include "io/store/run_store.h"

namespace ricci {
namespace {

using hdf5::Handle;

constexpr std::uint8_t kVtkTriangle = 5;

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

void write_grid(hid_t group, const ItemRecord& item) {
    const std::size_t faces = item.triangles.size();
    std::vector<std::int64_t> corners;
    std::vector<std::int64_t> offsets{0};
    for (const Triangle& triangle : item.triangles) {
        corners.insert(corners.end(), triangle.begin(), triangle.end());
        offsets.push_back(static_cast<std::int64_t>(corners.size()));
    }
    using Counts = std::vector<std::int64_t>;
    hdf5::write_array(group, "NumberOfPoints", Counts{static_cast<std::int64_t>(item.points.size())});
    hdf5::write_array(group, "NumberOfCells", Counts{static_cast<std::int64_t>(faces)});
    hdf5::write_array(group, "NumberOfConnectivityIds", Counts{static_cast<std::int64_t>(corners.size())});
    const std::span<const double> coordinates(item.points.front().data(), 3 * item.points.size());
    hdf5::write_array(group, "Points", coordinates, {item.points.size(), 3});
    hdf5::write_array(group, "Connectivity", corners);
    hdf5::write_array(group, "Offsets", offsets);
    hdf5::write_array(group, "Types", std::vector<std::uint8_t>(faces, kVtkTriangle));
}

}  // namespace

void export_vtkhdf(const std::string& path, const ItemRecord& item, const std::vector<PointField>& fields) {
    require_exportable(item, fields);
    const hdf5::Session session;
    const std::string temporary = path + ".tmp";
    hdf5::write_file(temporary, [&](hdf5::OutputFile& file) {
        const Handle group = hdf5::create_group(file.root(), "VTKHDF");
        write_version(group);
        write_type(group);
        write_grid(group, item);
        const Handle data = hdf5::create_group(group, "PointData");
        for (const PointField& field : fields)
            hdf5::write_array(data, hdf5::stored_text(field.name), field.values);
    });
    rename_durably(temporary, path);
}

}  // namespace ricci
