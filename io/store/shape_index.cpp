#include "io/store/shape_index.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "io/store/foreign_file.h"
#include "io/store/schema.h"
#include "io/store/schema_index.h"

namespace ricci {
namespace {

hdf5::Handle open_index(const std::string& path) {
    hdf5::Handle file = hdf5::open_foreign(path);
    if (schema::read_kind(file) != "index") throw FileError(path + ": no index, but a file of results");
    return file;
}

/// Runs `read`; what it does not like about the file is a FileError that begins with the path.
template <class Read>
void naming(const std::string& path, Read read) {
    try {
        read();
    } catch (const FileError& error) {
        const std::string what = error.what();
        throw FileError(what.starts_with(path) ? what : path + ": " + what);
    } catch (const std::invalid_argument& error) {
        throw FileError(path + ": " + error.what());
    }
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
    naming(path, [&] {
        const hdf5::Handle file = open_index(path);
        info_ = schema::read_run_info(file);
        descriptor_version_ = schema::read_descriptor_version(file);
        types_ = schema::read_types(file);
    });
}

std::optional<IndexBucket> IndexReader::bucket(Index genus, Index boundaries) const {
    const std::array<Index, 2> type{genus, boundaries};
    if (std::find(types_.begin(), types_.end(), type) == types_.end()) return std::nullopt;
    const hdf5::Session session;
    IndexBucket bucket;
    naming(path_, [&] {  // the constructor let it in
        bucket = schema::read_bucket(hdf5::open_input(path_), genus, boundaries);
    });
    return bucket;
}

ShapeIndex read_shape_index(const std::string& path) {
    const hdf5::Session session;
    ShapeIndex index;
    naming(path, [&] {
        const hdf5::Handle file = open_index(path);
        index.info = schema::read_run_info(file);
        index.descriptor_version = schema::read_descriptor_version(file);
        index.entries = schema::read_entries(file, index.info.status);
        index.failures = schema::read_failures(file);
        schema::require_valid(index.entries, index.info.status);
    });
    return index;
}

}  // namespace ricci
