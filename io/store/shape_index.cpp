#include "io/store/shape_index.h"

#include <fmt/format.h>

#include <algorithm>

#include "io/store/schema.h"
#include "io/store/schema_index.h"

namespace ricci {
namespace {

hdf5::Handle open_index(const std::string& path) {
    hdf5::Handle file = hdf5::open_input(path);
    if (schema::read_kind(file) != "index") throw FileError(path + ": no index, but a file of results");
    return file;
}

}  // namespace

std::string type_name(Index genus, Index boundaries) {
    return fmt::format("g{}b{}", genus, boundaries);
}

std::string shape_name(const std::string& file, std::int32_t component, std::int32_t components) {
    return components > 1 ? fmt::format("{}#c{}", file, component) : file;
}

IndexReader::IndexReader(const std::string& path) : path_(path) {
    const hdf5::Session session;
    const hdf5::Handle file = open_index(path);
    info_ = schema::read_run_info(file);
    descriptor_version_ = schema::read_descriptor_version(file);
    types_ = schema::read_types(file);
}

std::optional<IndexBucket> IndexReader::bucket(Index genus, Index boundaries) const {
    const std::array<Index, 2> type{genus, boundaries};
    if (std::find(types_.begin(), types_.end(), type) == types_.end()) return std::nullopt;
    const hdf5::Session session;
    return schema::read_bucket(open_index(path_), genus, boundaries);
}

ShapeIndex read_shape_index(const std::string& path) {
    const hdf5::Session session;
    const hdf5::Handle file = open_index(path);
    ShapeIndex index;
    index.info = schema::read_run_info(file);
    index.descriptor_version = schema::read_descriptor_version(file);
    index.entries = schema::read_entries(file, index.info.status);
    index.failures = schema::read_failures(file);
    try {
        schema::require_valid(index.entries, index.info.status);
    } catch (const std::invalid_argument& error) {
        throw FileError(path + ": " + error.what());
    }
    return index;
}

}  // namespace ricci
