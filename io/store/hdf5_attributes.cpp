// Attributes of the result file and their checksum.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "io/store/durable.h"
#include "io/store/hdf5_file.h"

namespace ricci::hdf5 {
namespace {

// Names that take no part in a group's checksum: the checksums, and what is written last.
bool unsealed(const std::string& name) {
    return name == "attributes_xxh3" || name == "xxh3" || name == "complete";
}

std::string where(hid_t object, const char* name) {
    return name_of(object) + ": attribute " + name;
}

Handle open_attribute(hid_t object, const char* name) {
    const std::string what =
        where(object, name) + " is missing";  // asking for names forgets HDF5's last error
    return {H5Aopen(object, name, H5P_DEFAULT), what};
}

hsize_t value_count(hid_t attribute, const std::string& what) {
    const Handle space(H5Aget_space(attribute), what);
    const hssize_t count = H5Sget_simple_extent_npoints(space);
    check(count, what);
    return static_cast<hsize_t>(count);
}

// Texts of a variable-length attribute. HDF5 allocates them, so they are handed back to it.
std::vector<std::string> texts_of(hid_t attribute, const std::string& what) {
    const Handle type(H5Aget_type(attribute), what);
    if (H5Tis_variable_str(type) <= 0) throw FileError(what + " is not a variable-length string");
    std::vector<char*> pointers(value_count(attribute, what));
    std::vector<std::string> texts;
    if (pointers.empty()) return texts;
    const Handle memory = text_type();
    check(H5Aread(attribute, memory, pointers.data()), what);
    for (const char* pointer : pointers) texts.emplace_back(pointer == nullptr ? "" : pointer);
    const Handle space(H5Aget_space(attribute), what);
    check(H5Dvlen_reclaim(memory, space, H5P_DEFAULT, pointers.data()), what);
    return texts;
}

void write_texts(hid_t object, const char* name, const std::vector<std::string>& texts, hid_t space) {
    std::vector<std::string> stored;
    stored.reserve(texts.size());
    for (const std::string& text : texts) stored.push_back(stored_text(text));
    std::vector<const char*> pointers;
    pointers.reserve(stored.size());
    for (const std::string& text : stored) pointers.push_back(text.c_str());
    const Handle type = text_type();
    const std::string what = where(object, name);
    const Handle attribute(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), what);
    if (!pointers.empty()) check(H5Awrite(attribute, type, pointers.data()), what);
}

}  // namespace

Handle text_type() {
    Handle type(H5Tcopy(H5T_C_S1), "text type");
    check(H5Tset_size(type, H5T_VARIABLE), "text type");
    check(H5Tset_cset(type, H5T_CSET_UTF8), "text type");
    return type;
}

std::vector<std::string> attribute_names(hid_t object) {
    std::vector<std::string> names;
    const auto collect = [](hid_t, const char* name, const H5A_info_t*, void* list) -> herr_t {
        static_cast<std::vector<std::string>*>(list)->emplace_back(name);
        return 0;
    };
    const std::string what = name_of(object) + ": cannot list the attributes";
    hsize_t start = 0;
    check(H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_NATIVE, &start, collect, &names), what);
    std::sort(names.begin(), names.end());
    return names;
}

void write_text_attribute(hid_t object, const char* name, const std::string& text) {
    const Handle space(H5Screate(H5S_SCALAR), name);
    write_texts(object, name, {text}, space);
}

void write_texts_attribute(hid_t object, const char* name, const std::vector<std::string>& texts) {
    const hsize_t count = texts.size();
    const Handle space(H5Screate_simple(1, &count, nullptr), name);
    write_texts(object, name, texts, space);
}

std::string read_text_attribute(hid_t object, const char* name) {
    const std::vector<std::string> texts = read_texts_attribute(object, name);
    if (texts.size() != 1) throw FileError(where(object, name) + " is not one string");
    return texts.front();
}

std::vector<std::string> read_texts_attribute(hid_t object, const char* name) {
    return texts_of(open_attribute(object, name), where(object, name));
}

template <class T>
void write_attribute(hid_t object, const char* name, T value) {
    const std::string what = where(object, name);
    const Handle space(H5Screate(H5S_SCALAR), what);
    const Handle attribute(H5Acreate2(object, name, stored_type<T>(), space, H5P_DEFAULT, H5P_DEFAULT), what);
    check(H5Awrite(attribute, stored_type<T>(), &value), what);
}

template <class T>
T read_attribute(hid_t object, const char* name) {
    const std::string what = where(object, name);
    const Handle attribute = open_attribute(object, name);
    const Handle type(H5Aget_type(attribute), what);
    if (H5Tequal(type, stored_type<T>()) <= 0 || value_count(attribute, what) != 1)
        throw FileError(what + " has the wrong type");
    T value{};
    check(H5Aread(attribute, stored_type<T>(), &value), what);
    return value;
}

template void write_attribute(hid_t, const char*, double);
template void write_attribute(hid_t, const char*, std::int32_t);
template void write_attribute(hid_t, const char*, std::int64_t);
template void write_attribute(hid_t, const char*, std::uint8_t);
template void write_attribute(hid_t, const char*, std::uint64_t);
template double read_attribute(hid_t, const char*);
template std::int32_t read_attribute(hid_t, const char*);
template std::int64_t read_attribute(hid_t, const char*);
template std::uint8_t read_attribute(hid_t, const char*);
template std::uint64_t read_attribute(hid_t, const char*);

std::uint64_t attribute_digest(hid_t object) {
    std::string all;
    for (const std::string& name : attribute_names(object)) {
        if (unsealed(name)) continue;
        const std::string what = where(object, name.c_str());
        const Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), what);
        const Handle type(H5Aget_type(attribute), what);
        std::string values;
        if (H5Tis_variable_str(type) > 0) {
            for (const std::string& value : texts_of(attribute, what))
                values += fmt::format("{}:{}", value.size(), value);
        } else {
            values.resize(value_count(attribute, what) * H5Tget_size(type));
            check(H5Aread(attribute, type, values.data()), what);
        }
        all += fmt::format("{}={}:{};", name, values.size(), values);
    }
    return checksum_of(all);
}

void seal(hid_t object) {
    write_attribute<std::uint64_t>(object, "attributes_xxh3", attribute_digest(object));
}

}  // namespace ricci::hdf5
