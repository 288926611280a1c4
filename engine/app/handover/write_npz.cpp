#include "engine/app/console.h"
#include "engine/app/handover/handover.h"
#include "engine/app/handover/scene_description.h"
#include "io/exchange/npz.h"

namespace ricci::app {
namespace {

void add_arrays(NpzFile& file, const std::string& where, const std::vector<DataArray>& arrays) {
    for (const DataArray& array : arrays)
        std::visit(
            [&]<class T>(const std::vector<T>& values) {
                if constexpr (!std::is_same_v<T, std::string>) {  // texts are in `about`
                    NpzFile::Shape shape{array.rows()};
                    if (array.components > 1) shape.push_back(array.components);
                    file.add(where + array.name, std::span<const T>(values), shape);
                }
            },
            array.values);
}

void add_block(NpzFile& file, const GeometryBlock& block) {
    const std::string where = block.name + "/";
    const std::span<const double> points(block.points.empty() ? nullptr : block.points.front().data(),
                                         3 * block.points.size());
    file.add(where + "points", points, {block.points.size(), 3});
    file.add(where + "corners", std::span<const std::int32_t>(block.corners), {block.corners.size()});
    file.add(where + "first", std::span<const std::int32_t>(block.first), {block.first.size()});
    add_arrays(file, where + "point_data/", block.point_data);
    add_arrays(file, where + "cell_data/", block.cell_data);
    add_arrays(file, where + "field_data/", block.field_data);
}

}  // namespace

void write_npz(const std::string& path, const ItemSource& source, const HandoverOptions& options) {
    const std::vector<std::string> names = wanted_blocks(source, options.what, block_names());
    if (names.empty()) throw UsageError(source.item().item.name + " holds nothing that can be shown");
    nlohmann::json about =
        describe_scene(source, options, choose_field(source.item(), options.field, source.has_layout()));
    NpzFile file(path);
    for (const std::string& name : names) {
        const GeometryBlock block = make_block(name, source);
        about["blocks"][name] = describe_block(block);
        add_block(file, block);
    }
    const std::string text = json_text(about);
    const std::span<const std::uint8_t> bytes(reinterpret_cast<const std::uint8_t*>(text.data()),
                                              text.size());
    file.add("about", bytes, {bytes.size()});
    file.close();
}

}  // namespace ricci::app
