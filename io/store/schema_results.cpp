// Results of further kinds in the file: any attributes and arrays, checked for what a ResultGroup can hold.
#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <type_traits>

#include "io/store/schema.h"

namespace ricci::schema {
namespace {

using hdf5::Handle;
using hdf5::Shape;

bool own_attribute(const std::string& name) {
    return name == "status" || name == "attributes_xxh3";
}

// Pointers to the entries in ascending order of a key: the same contents give the same file.
template <class Entry>
std::vector<const Entry*> ascending(const std::vector<Entry>& entries, std::string Entry::*key) {
    std::vector<const Entry*> sorted;
    sorted.reserve(entries.size());
    for (const Entry& entry : entries) sorted.push_back(&entry);
    std::sort(sorted.begin(), sorted.end(),
              [&](const Entry* a, const Entry* b) { return a->*key < b->*key; });
    return sorted;
}

void write_one(hid_t group, const ResultAttribute& attribute) {
    const char* name = attribute.name.c_str();
    std::visit(
        [&](const auto& value) {
            using Value = std::decay_t<decltype(value)>;
            if constexpr (std::is_same_v<Value, std::string>)
                hdf5::write_text_attribute(group, name, value);
            else if constexpr (std::is_same_v<Value, std::vector<std::string>>)
                hdf5::write_texts_attribute(group, name, value);
            else
                hdf5::write_attribute<Value>(group, name, value);
        },
        attribute.value);
}

ResultAttribute read_one_attribute(hid_t group, const std::string& name) {
    const std::string where = hdf5::name_of(group) + ": attribute " + name;
    const Handle attribute(H5Aopen(group, name.c_str(), H5P_DEFAULT), where);
    const Handle type(H5Aget_type(attribute), where);
    const Handle space(H5Aget_space(attribute), where);
    const int rank = H5Sget_simple_extent_ndims(space);
    const auto is = [&](hid_t candidate) { return rank == 0 && H5Tequal(type, candidate) > 0; };
    const bool texts = H5Tequal(type, hdf5::text_type()) > 0;
    if (texts && rank == 0) return {name, hdf5::read_text_attribute(group, name.c_str())};
    if (texts && rank == 1) return {name, hdf5::read_texts_attribute(group, name.c_str())};
    if (is(hdf5::stored_type<double>())) return {name, hdf5::read_attribute<double>(group, name.c_str())};
    if (is(hdf5::stored_type<std::int32_t>()))
        return {name, hdf5::read_attribute<std::int32_t>(group, name.c_str())};
    if (is(hdf5::stored_type<std::int64_t>()))
        return {name, hdf5::read_attribute<std::int64_t>(group, name.c_str())};
    if (is(hdf5::stored_type<std::uint8_t>()))
        return {name, hdf5::read_attribute<std::uint8_t>(group, name.c_str())};
    throw FileError(where + " has a type that no result has");
}

void write_values_of(hid_t group, const std::string& name, const ResultArray& array) {
    const Shape shape(array.shape.begin(), array.shape.end());
    std::visit(
        [&](const auto& values) {
            using Value = typename std::decay_t<decltype(values)>::value_type;
            if constexpr (std::is_same_v<Value, std::string>) {
                hdf5::write_text_list(group, name, values, shape);
            } else {
                hdf5::write_array(group, name, std::span<const Value>(values), shape);
            }
        },
        array.values);
}

// Creates the subgroups of the path that are not there yet.
void write_one(hid_t group, const ResultArray& array, std::size_t start = 0) {
    const std::size_t slash = array.path.find('/', start);
    const std::string name = array.path.substr(start, slash - start);
    if (slash == std::string::npos) return write_values_of(group, name, array);
    const Handle below =
        hdf5::has_link(group, name) ? hdf5::open_group(group, name) : hdf5::create_group(group, name);
    write_one(below, array, slash + 1);
}

template <class Value>
std::vector<Value> values_of(const hdf5::Input& input) {
    std::vector<Value> values(input.size());
    input.read_into(hdf5::stored_type<Value>(), values.data());
    return values;
}

ResultArray read_one_array(hid_t group, const std::string& name, const std::string& path) {
    const hdf5::Input input(group, name);
    const Handle type(H5Dget_type(input.id()), input.name());
    const Handle text = hdf5::text_type();
    ResultArray array{path, {input.shape().begin(), input.shape().end()}, {}};
    if (H5Tequal(type, text) > 0)
        array.values = hdf5::read_texts(input, text, 1);
    else if (H5Tequal(type, hdf5::stored_type<double>()) > 0)
        array.values = values_of<double>(input);
    else if (H5Tequal(type, hdf5::stored_type<std::int32_t>()) > 0)
        array.values = values_of<std::int32_t>(input);
    else if (H5Tequal(type, hdf5::stored_type<std::uint8_t>()) > 0)
        array.values = values_of<std::uint8_t>(input);
    else
        throw FileError(input.name() + " has a type that no result has");
    return array;
}

void read_arrays(hid_t group, const std::string& prefix, std::vector<ResultArray>& arrays) {
    for (const std::string& name : hdf5::link_names(group)) {
        const std::string path = prefix + name;
        const Handle object(H5Oopen(group, name.c_str(), H5P_DEFAULT),
                            hdf5::name_of(group) + ": cannot open " + name);
        if (H5Iget_type(object) == H5I_DATASET) {
            arrays.push_back(read_one_array(group, name, path));
            continue;
        }
        const std::string where = hdf5::name_of(object);
        if (H5Iget_type(object) != H5I_GROUP) throw FileError(where + " is neither an array nor a group");
        if (!hdf5::attribute_names(object).empty()) throw FileError(where + ": a subgroup has attributes");
        const std::size_t before = arrays.size();
        read_arrays(object, path + "/", arrays);
        if (arrays.size() == before) throw FileError(where + ": a subgroup without arrays");
    }
}

}  // namespace

std::vector<std::string> result_kinds(hid_t item_group) {
    std::vector<std::string> kinds;
    for (const std::string& name : hdf5::link_names(item_group))
        if (name != "mesh" && name != "sweep" && name != "flow") kinds.push_back(name);
    std::sort(kinds.begin(), kinds.end());
    return kinds;
}

void write_result(hid_t group, const ResultGroup& result, const StatusNames& status) {
    write_status(group, result.status, status);
    for (const ResultAttribute* attribute : ascending(result.attributes, &ResultAttribute::name))
        write_one(group, *attribute);
    hdf5::seal(group);
    for (const ResultArray* array : ascending(result.arrays, &ResultArray::path)) write_one(group, *array);
}

ResultGroup read_result(hid_t group, const std::string& item, const std::string& kind,
                        const StatusNames& status) {
    ResultGroup result{item, kind, read_status(group, status)};
    bool sealed = false;
    for (const std::string& name : hdf5::attribute_names(group)) {
        sealed = sealed || name == "attributes_xxh3";
        if (!own_attribute(name)) result.attributes.push_back(read_one_attribute(group, name));
    }
    if (!sealed) throw FileError(hdf5::name_of(group) + ": attribute attributes_xxh3 is missing");
    read_arrays(group, "", result.arrays);
    std::sort(result.arrays.begin(), result.arrays.end(),
              [](const ResultArray& a, const ResultArray& b) { return a.path < b.path; });
    try {
        require_valid(result, status);
    } catch (const std::invalid_argument& error) {
        throw FileError(hdf5::name_of(group) + ": " + error.what());
    }
    return result;
}

}  // namespace ricci::schema
