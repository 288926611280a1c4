#include "tests/fuzz/hdf5_tree.h"

#include <algorithm>
#include <cstring>
#include <set>

namespace ricci::fuzz {
namespace {

using hdf5::Handle;

std::size_t count_of(const hdf5::Shape& shape) {
    std::size_t count = 1;
    for (const hsize_t extent : shape) count *= extent;
    return count;
}

std::size_t text_members(hid_t type) {
    if (H5Tis_variable_str(type) > 0) return 1;
    return H5Tget_class(type) == H5T_COMPOUND ? static_cast<std::size_t>(H5Tget_nmembers(type)) : 0;
}

hdf5::Shape shape_of(hid_t space) {
    hdf5::Shape shape(static_cast<std::size_t>(std::max(0, H5Sget_simple_extent_ndims(space))));
    if (!shape.empty()) H5Sget_simple_extent_dims(space, shape.data(), nullptr);
    return shape;
}

TreeValues read_dataset(hid_t parent, const std::string& name) {
    const hdf5::Input input(parent, name);
    TreeValues values;
    values.type = Handle(H5Dget_type(input.id()), name);
    values.shape = input.shape();
    values.members = text_members(values.type);
    if (values.members > 0) {
        values.texts = hdf5::read_texts(input, values.type, values.members);
    } else {
        values.bytes.resize(input.size() * H5Tget_size(values.type));
        input.read_into(values.type, values.bytes.data());
    }
    return values;
}

std::vector<TreeAttribute> read_attributes(hid_t object) {
    std::vector<TreeAttribute> attributes;
    for (const std::string& name : hdf5::attribute_names(object)) {
        if (name == "xxh3") continue;
        const Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), name);
        const Handle space(H5Aget_space(attribute), name);
        TreeAttribute read{name, {}};
        read.values.type = Handle(H5Aget_type(attribute), name);
        read.values.shape = shape_of(space);
        read.values.members = text_members(read.values.type);
        if (read.values.members > 0) {
            read.values.texts = hdf5::read_texts_attribute(object, name.c_str());
        } else {
            read.values.bytes.resize(count_of(read.values.shape) * H5Tget_size(read.values.type));
            hdf5::check(H5Aread(attribute, read.values.type, read.values.bytes.data()), name);
        }
        attributes.push_back(std::move(read));
    }
    return attributes;
}

void read_group(hid_t group, const std::string& path, Tree& tree) {
    tree.push_back({path, true, {}, read_attributes(group)});
    for (const std::string& link : hdf5::link_names(group)) {
        const Handle child(H5Oopen(group, link.c_str(), H5P_DEFAULT), link);
        if (H5Iget_type(child) == H5I_GROUP)
            read_group(child, path + "/" + link, tree);
        else
            tree.push_back({path + "/" + link, false, read_dataset(group, link), read_attributes(child)});
    }
}

std::vector<const char*> pointers_to(const std::vector<std::string>& texts) {
    std::vector<const char*> pointers;
    for (const std::string& text : texts) pointers.push_back(text.c_str());
    return pointers;
}

void write_attribute(hid_t object, const TreeAttribute& attribute) {
    const TreeValues& v = attribute.values;
    const Handle space(v.shape.empty()
                           ? H5Screate(H5S_SCALAR)
                           : H5Screate_simple(static_cast<int>(v.shape.size()), v.shape.data(), nullptr),
                       attribute.name);
    const Handle written(H5Acreate2(object, attribute.name.c_str(), v.type, space, H5P_DEFAULT, H5P_DEFAULT),
                         attribute.name);
    if (count_of(v.shape) == 0) return;
    const std::vector<const char*> texts = pointers_to(v.texts);
    const void* values = v.members > 0 ? static_cast<const void*>(texts.data()) : v.bytes.data();
    hdf5::check(H5Awrite(written, v.type, values), attribute.name);
}

void write_attributes(hid_t object, const std::vector<TreeAttribute>& attributes) {
    bool sealed = false;
    for (const TreeAttribute& attribute : attributes) {
        sealed = sealed || attribute.name == "attributes_xxh3";
        if (attribute.name != "attributes_xxh3" && H5Aexists(object, attribute.name.c_str()) <= 0)
            write_attribute(object, attribute);
    }
    if (sealed) hdf5::seal(object);
}

/// Makes the values fit the shape again.
void fit(TreeValues& values) {
    const std::size_t count = count_of(values.shape);
    if (values.members > 0)
        values.texts.resize(count * values.members);
    else
        values.bytes.resize(count * H5Tget_size(values.type));
}

/// Numbers that readers may stumble over, in every type.
void set_number(TreeValues& values, std::size_t position, std::uint8_t choice) {
    const std::size_t wide = H5Tget_size(values.type), count = wide == 0 ? 0 : values.bytes.size() / wide;
    if (count == 0) return;
    std::byte* at = values.bytes.data() + position % count * wide;
    if (H5Tget_class(values.type) == H5T_FLOAT) {
        constexpr double kNumbers[] = {0.0,
                                       -1.0,
                                       1e308,
                                       -1e308,
                                       1e-308,
                                       1e150,
                                       std::numeric_limits<double>::quiet_NaN(),
                                       std::numeric_limits<double>::infinity()};
        const double number = kNumbers[choice % 8];
        const auto single = static_cast<float>(number);
        if (wide == 8) std::memcpy(at, &number, 8);
        if (wide == 4) std::memcpy(at, &single, 4);
        return;
    }
    const auto size = static_cast<std::int64_t>(count);
    const std::int64_t numbers[] = {0,
                                    -1,
                                    -2,
                                    std::numeric_limits<std::int32_t>::max(),
                                    std::numeric_limits<std::int32_t>::min(),
                                    size,
                                    size - 1,
                                    choice};
    const std::int64_t number = numbers[choice % 8];
    std::memcpy(at, &number, wide);
}

void set_text(TreeValues& values, std::size_t position, std::uint8_t choice) {
    if (values.texts.empty()) return;
    std::string& text = values.texts[position % values.texts.size()];
    switch (choice % 6) {
        case 0:
            text.clear();
            break;
        case 1:
            text = std::string(1000, 'a');
            break;
        case 2:
            text = "../\xff\x1b[2J";
            break;
        case 3:
            if (!text.empty()) text.pop_back();
            break;
        case 4:
            text += text;
            break;
        default:
            text += static_cast<char>(choice);
            break;
    }
}

void change_values(TreeValues& values, std::uint8_t what, std::size_t position, std::uint8_t choice) {
    switch (what % 8) {
        case 0:
            if (!values.shape.empty()) values.shape[position % values.shape.size()] = choice % 16;
            return fit(values);
        case 1:
            values.shape.push_back(1 + choice % 3);
            return fit(values);
        case 2:
            if (!values.shape.empty()) values.shape.pop_back();
            return fit(values);
        case 3:
            if (values.members == 0 && choice < 32) {
                const hid_t types[] = {H5T_STD_I32LE, H5T_IEEE_F64LE, H5T_STD_U8LE, H5T_STD_I64BE};
                values.type = Handle(H5Tcopy(types[choice % 4]), "type");
                return fit(values);
            }
            [[fallthrough]];
        default:
            return values.members > 0 ? set_text(values, position, choice)
                                      : set_number(values, position, choice);
    }
}

TreeValues copy_of(const TreeValues& values) {
    TreeValues copy{{}, values.shape, values.bytes, values.texts, values.members};
    if (values.type >= 0) copy.type = Handle(H5Tcopy(values.type), "type");
    return copy;
}

void change_one(Tree& tree, Bytes edit) {
    if (tree.empty()) return;
    TreeObject& object = tree[(edit[0] + std::size_t{edit[1]} * 256 / 8) % tree.size()];
    const std::size_t position = edit[2] * std::size_t{5};
    switch (edit[1] % 8) {
        case 0:
            if (object.path.empty()) return;
            tree.erase(tree.begin() + (&object - tree.data()));
            return;
        case 1:
        case 2:
            if (object.attributes.empty()) return;
            return change_values(object.attributes[edit[2] % object.attributes.size()].values, edit[3] % 32,
                                 edit[2], edit[3]);
        case 3:
            if (object.attributes.empty()) return;
            object.attributes.erase(object.attributes.begin() +
                                    static_cast<std::ptrdiff_t>(edit[2] % object.attributes.size()));
            return;
        default:
            if (!object.group) change_values(object.values, edit[3] < 48 ? edit[3] : 7, position, edit[3]);
            return;
    }
}

}  // namespace

Tree read_tree(const std::string& path) {
    const hdf5::Session session;
    const Handle file = hdf5::open_input(path);
    Tree tree;
    const Handle root(H5Gopen2(file, "/", H5P_DEFAULT), path);
    read_group(root, "", tree);
    return tree;
}

Tree copy_of(const Tree& tree) {
    Tree copy;
    for (const TreeObject& object : tree) {
        copy.push_back({object.path, object.group, copy_of(object.values), {}});
        for (const TreeAttribute& attribute : object.attributes)
            copy.back().attributes.push_back({attribute.name, copy_of(attribute.values)});
    }
    return copy;
}

void write_tree(const std::string& path, const Tree& tree) {
    const hdf5::Session session;
    hdf5::write_file(path, [&](hdf5::OutputFile& file) {
        std::set<std::string> groups{""};
        for (const TreeObject& object : tree) {
            if (object.path.empty()) {
                write_attributes(file.root(), object.attributes);
                continue;
            }
            const std::size_t slash = object.path.rfind('/');
            const std::string above = object.path.substr(0, slash), name = object.path.substr(slash + 1);
            if (!groups.contains(above)) continue;
            const Handle parent = hdf5::open_group(file.root(), above.empty() ? "/" : above);
            if (hdf5::has_link(parent, name)) continue;
            if (object.group) {
                write_attributes(hdf5::create_group(parent, name), object.attributes);
                groups.insert(object.path);
            } else if (object.values.members > 0) {
                hdf5::write_texts(parent, name, object.values.type, object.values.shape,
                                  pointers_to(object.values.texts));
            } else {
                hdf5::write_values(parent, name, object.values.type, object.values.shape,
                                   object.values.bytes);
            }
        }
    });
}

void change_tree(Tree& tree, Bytes edits) {
    const hdf5::Session session;
    for (std::size_t i = 0; i + 4 <= edits.size() && i < 64; i += 4) change_one(tree, edits.subspan(i, 4));
}

}  // namespace ricci::fuzz
