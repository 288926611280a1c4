// Datasets of the result file and their checksums.
#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <utility>

#include "io/store/hdf5_file.h"

namespace ricci::hdf5 {
namespace {

static_assert(std::endian::native == std::endian::little, "checksums are over little-endian bytes");

constexpr std::size_t kContiguousBytes = std::size_t{1} << 16U;  // up to here unfiltered
constexpr hsize_t kChunkBytes = hsize_t{1} << 18U;               // well below HDF5's chunk cache of 1 MiB
constexpr unsigned kGzipLevel =
    1;  // higher levels gain little on shuffled doubles and cost several times as much

hsize_t count_of(const Shape& shape) {
    hsize_t count = 1;
    for (const hsize_t extent : shape) count *= extent;
    return count;
}

Handle make_space(const Shape& shape, const std::string& what) {
    if (shape.empty()) return {H5Screate(H5S_SCALAR), what};
    return {H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), what};
}

// Whole rows per chunk where they fit, pieces of one row otherwise.
Shape chunk_of(const Shape& shape, hsize_t value_bytes) {
    const hsize_t values = std::max<hsize_t>(1, kChunkBytes / value_bytes);
    Shape chunk(shape.size(), 1);
    hsize_t used = 1;
    for (std::size_t axis = shape.size(); axis-- > 0;) {
        chunk[axis] = std::clamp<hsize_t>(values / used, 1, shape[axis]);
        used *= chunk[axis];
    }
    return chunk;
}

thread_local bool plain_datasets = false;

Handle make_dataset(hid_t parent, const std::string& name, hid_t type, const Shape& shape) {
    const std::string what = "cannot create dataset " + name;
    const Handle creation(H5Pcreate(H5P_DATASET_CREATE), what);
    check(H5Pset_obj_track_times(creation, false), what);
    const hsize_t value_bytes = H5Tget_size(type);
    if (!plain_datasets && count_of(shape) * value_bytes > kContiguousBytes) {
        const Shape chunk = chunk_of(shape, value_bytes);
        check(H5Pset_chunk(creation, static_cast<int>(chunk.size()), chunk.data()), what);
        check(H5Pset_shuffle(creation), what);
        check(H5Pset_deflate(creation, kGzipLevel), what);
        check(H5Pset_fletcher32(creation), what);
    }
    const Handle space = make_space(shape, what);
    return {H5Dcreate2(parent, name.c_str(), type, space, H5P_DEFAULT, creation, H5P_DEFAULT), what};
}

std::shared_ptr<XXH3_state_t> new_digest() {
    std::shared_ptr<XXH3_state_t> state(XXH3_createState(), &XXH3_freeState);
    XXH3_64bits_reset(state.get());
    return state;
}

XXH3_state_t* digest_state(const std::shared_ptr<void>& digest) {
    return static_cast<XXH3_state_t*>(digest.get());
}

// The digest of texts covers lengths and contents.
void add_text(XXH3_state_t* state, std::string_view text) {
    const std::string piece = fmt::format("{}:{}", text.size(), text);
    XXH3_64bits_update(state, piece.data(), piece.size());
}

std::uint64_t digest_of_texts(const Input& input, hid_t type, std::size_t members) {
    const std::shared_ptr<XXH3_state_t> state = new_digest();
    for (const std::string& text : read_texts(input, type, members)) add_text(state.get(), text);
    return XXH3_64bits_digest(state.get());
}

}  // namespace

template <>
hid_t stored_type<double>() {
    return H5T_IEEE_F64LE;
}
template <>
hid_t stored_type<float>() {
    return H5T_IEEE_F32LE;
}
template <>
hid_t stored_type<std::int32_t>() {
    return H5T_STD_I32LE;
}
template <>
hid_t stored_type<std::int64_t>() {
    return H5T_STD_I64LE;
}
template <>
hid_t stored_type<std::uint8_t>() {
    return H5T_STD_U8LE;
}
template <>
hid_t stored_type<std::uint16_t>() {
    return H5T_STD_U16LE;
}
template <>
hid_t stored_type<std::uint64_t>() {
    return H5T_STD_U64LE;
}

void write_values(hid_t parent, const std::string& name, hid_t type, const Shape& shape,
                  std::span<const std::byte> bytes) {
    if (count_of(shape) * H5Tget_size(type) != bytes.size())
        throw std::invalid_argument(name + ": the values do not fill the shape");
    const Handle dataset = make_dataset(parent, name, type, shape);
    if (!bytes.empty())
        check(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()), "cannot write " + name);
    write_attribute<std::uint64_t>(dataset, "xxh3", XXH3_64bits(bytes.data(), bytes.size()));
}

void write_texts(hid_t parent, const std::string& name, hid_t type, const Shape& shape,
                 const std::vector<const char*>& texts) {
    const std::string what = "cannot create dataset " + name;
    const Handle creation(H5Pcreate(H5P_DATASET_CREATE), what);
    check(H5Pset_obj_track_times(creation, false), what);
    const Handle space = make_space(shape, what);
    const Handle dataset(H5Dcreate2(parent, name.c_str(), type, space, H5P_DEFAULT, creation, H5P_DEFAULT),
                         what);
    const std::shared_ptr<XXH3_state_t> state = new_digest();
    for (const char* text : texts) add_text(state.get(), text);
    if (!texts.empty())
        check(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, texts.data()), "cannot write " + name);
    write_attribute<std::uint64_t>(dataset, "xxh3", XXH3_64bits_digest(state.get()));
}

void write_text_list(hid_t parent, const std::string& name, const std::vector<std::string>& texts,
                     const std::optional<Shape>& shape) {
    std::vector<std::string> stored;
    stored.reserve(texts.size());
    for (const std::string& text : texts) stored.push_back(stored_text(text));
    std::vector<const char*> pointers;
    pointers.reserve(stored.size());
    for (const std::string& text : stored) pointers.push_back(text.c_str());
    write_texts(parent, name, text_type(), shape ? *shape : Shape{stored.size()}, pointers);
}

std::vector<std::string> read_texts(const Input& input, hid_t type, std::size_t members) {
    if (members == 0 || H5Tget_size(type) != members * sizeof(char*))
        throw FileError(input.name() + ": not a table of texts");
    std::vector<char*> pointers(input.size() * members);
    std::vector<std::string> texts;
    if (pointers.empty()) return texts;
    input.read_into(type, pointers.data());
    for (const char* pointer : pointers) texts.emplace_back(pointer == nullptr ? "" : pointer);
    const Handle space(H5Dget_space(input.id()), input.name());
    check(H5Dvlen_reclaim(type, space, H5P_DEFAULT, pointers.data()), input.name());
    return texts;
}

std::vector<std::string> read_text_list(hid_t parent, const std::string& name,
                                        std::optional<std::size_t> size) {
    const Input input(parent, name);
    const Handle text = text_type();
    input.expect_type(text);
    input.expect_shape({size.value_or(input.size())});
    return read_texts(input, text, 1);
}

RowWriter::RowWriter(hid_t parent, const std::string& name, hsize_t rows, hsize_t columns)
    : dataset_(make_dataset(parent, name, stored_type<double>(), {rows, columns})),
      space_(H5Dget_space(dataset_), name),
      rows_(rows),
      columns_(columns),
      digest_(new_digest()) {}

void RowWriter::append(std::span<const double> row) {
    if (row.size() != columns_ || next_ == rows_) throw std::invalid_argument("row does not fit the matrix");
    const std::string what = "cannot write " + name_of(dataset_);
    const hsize_t start[2] = {next_, 0};
    const hsize_t count[2] = {1, columns_};
    check(H5Sselect_hyperslab(space_, H5S_SELECT_SET, start, nullptr, count, nullptr), what);
    const Handle memory(H5Screate_simple(2, count, nullptr), what);
    check(H5Dwrite(dataset_, stored_type<double>(), memory, space_, H5P_DEFAULT, row.data()), what);
    XXH3_64bits_update(digest_state(digest_), row.data(), row.size_bytes());
    ++next_;
}

void RowWriter::finish() {
    if (next_ != rows_) throw std::invalid_argument("rows of the matrix are missing");
    write_attribute<std::uint64_t>(dataset_, "xxh3", XXH3_64bits_digest(digest_state(digest_)));
}

Input::Input(hid_t parent, const std::string& name)
    : name_(name_of(parent) + (name_of(parent) == "/" ? "" : "/") + name),
      dataset_(H5Dopen2(parent, name.c_str(), H5P_DEFAULT), name_ + " is missing") {
    const Handle space(H5Dget_space(dataset_), name_);
    const int rank = H5Sget_simple_extent_ndims(space);
    check(rank, name_);
    shape_.resize(static_cast<std::size_t>(rank));
    if (rank > 0) check(H5Sget_simple_extent_dims(space, shape_.data(), nullptr), name_);
}

hsize_t Input::size() const {
    return count_of(shape_);
}

void Input::expect_type(hid_t type) const {
    const Handle stored(H5Dget_type(dataset_), name_);
    if (H5Tequal(stored, type) <= 0) throw FileError(name_ + " has the wrong type");
}

void Input::expect_shape(const Shape& shape) const {
    if (shape_ != shape)
        throw FileError(fmt::format("{} has shape ({}), expected ({})", name_, fmt::join(shape_, ", "),
                                    fmt::join(shape, ", ")));
}

void Input::read_into(hid_t type, void* values) const {
    if (size() == 0) return;
    check(H5Dread(dataset_, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), "cannot read " + name_);
}

std::vector<double> Input::read_row(hsize_t row) const {
    expect_type(stored_type<double>());
    if (shape_.size() != 2 || row >= shape_[0]) throw FileError(fmt::format("{} has no row {}", name_, row));
    const hsize_t start[2] = {row, 0};
    const hsize_t count[2] = {1, shape_[1]};
    const Handle space(H5Dget_space(dataset_), name_);
    check(H5Sselect_hyperslab(space, H5S_SELECT_SET, start, nullptr, count, nullptr), name_);
    const Handle memory(H5Screate_simple(2, count, nullptr), name_);
    std::vector<double> values(shape_[1]);
    check(H5Dread(dataset_, stored_type<double>(), memory, space, H5P_DEFAULT, values.data()),
          "cannot read " + name_);
    return values;
}

std::uint64_t Input::digest() const {
    const Handle type(H5Dget_type(dataset_), name_);
    if (H5Tis_variable_str(type) > 0) return digest_of_texts(*this, type, 1);
    if (H5Tget_class(type) == H5T_COMPOUND)
        return digest_of_texts(*this, type, static_cast<std::size_t>(std::max(0, H5Tget_nmembers(type))));
    const std::size_t value_bytes = H5Tget_size(type);
    const std::shared_ptr<XXH3_state_t> state = new_digest();
    std::vector<char> buffer;
    if (shape_.empty()) {
        buffer.resize(value_bytes);
        read_into(type, buffer.data());
        return XXH3_64bits(buffer.data(), buffer.size());
    }
    const hsize_t row_bytes = shape_[0] == 0 ? 1 : std::max<hsize_t>(1, size() / shape_[0] * value_bytes);
    const hsize_t rows_at_once = std::max<hsize_t>(1, (hsize_t{1} << 23U) / row_bytes);
    const Handle space(H5Dget_space(dataset_), name_);
    for (hsize_t row = 0; row < shape_[0]; row += rows_at_once) {
        Shape start(shape_.size(), 0);
        Shape count = shape_;
        start[0] = row;
        count[0] = std::min(rows_at_once, shape_[0] - row);
        buffer.resize(count_of(count) * value_bytes);
        check(H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr),
              name_);
        const Handle memory = make_space(count, name_);
        check(H5Dread(dataset_, type, memory, space, H5P_DEFAULT, buffer.data()), "cannot read " + name_);
        XXH3_64bits_update(state.get(), buffer.data(), buffer.size());
    }
    return XXH3_64bits_digest(state.get());
}

PlainDatasets::PlainDatasets() : before_(std::exchange(plain_datasets, true)) {}

PlainDatasets::~PlainDatasets() {
    plain_datasets = before_;
}

std::vector<std::string> checksum_complaints(hid_t object, const std::string& name) {
    std::vector<std::string> complaints;
    try {
        const std::vector<std::string> attributes = attribute_names(object);
        const bool sealed =
            std::find(attributes.begin(), attributes.end(), "attributes_xxh3") != attributes.end();
        const bool to_seal = std::any_of(attributes.begin(), attributes.end(),
                                         [](const std::string& key) { return key != "complete"; });
        if (sealed && read_attribute<std::uint64_t>(object, "attributes_xxh3") != attribute_digest(object))
            complaints.push_back(name + ": the attributes do not match their checksum");
        if (!sealed && to_seal) complaints.push_back(name + ": the attributes have no checksum");
        for (const std::string& link : link_names(object)) {
            const std::string child_name = fmt::format("{}/{}", name == "/" ? "" : name, link);
            const Handle child(H5Oopen(object, link.c_str(), H5P_DEFAULT), child_name + ": cannot open");
            if (H5Iget_type(child) == H5I_GROUP) {
                for (std::string& complaint : checksum_complaints(child, child_name))
                    complaints.push_back(std::move(complaint));
            } else if (H5Iget_type(child) == H5I_DATASET) {
                const Input input(object, link);
                if (read_attribute<std::uint64_t>(child, "xxh3") != input.digest())
                    complaints.push_back(child_name + ": the values do not match their checksum");
            }
        }
    } catch (const FileError& error) {
        complaints.emplace_back(error.what());
    }
    return complaints;
}

}  // namespace ricci::hdf5
