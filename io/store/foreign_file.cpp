#include "io/store/foreign_file.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <set>

#include "io/store/durable.h"
#include "io/store/guarded_child.h"

namespace ricci::hdf5 {
namespace {

constexpr int kMaxDepth = 64;
constexpr std::uint64_t kMaxChunkBytes = std::uint64_t{1} << 23;  // written chunks have 256 KiB, or one value
constexpr std::uint64_t kMaxAttributeValues = 1 << 16;

[[noreturn]] void refuse(const std::string& name, const std::string& what) {
    throw FileError(name + ": " + what);
}

/// The product, or anything above `limit`.
std::uint64_t bounded_product(std::uint64_t a, std::uint64_t b, std::uint64_t limit) {
    return a != 0 && b > limit / a ? limit + 1 : a * b;
}

bool is_text(hid_t type) {
    return H5Tis_variable_str(type) > 0;
}

/// A number of up to eight bytes, u1 by names, a text, or a table of texts.
bool known_type(hid_t type, const std::string& name) {
    switch (H5Tget_class(type)) {
        case H5T_INTEGER:
        case H5T_FLOAT:
            return H5Tget_size(type) <= 8;
        case H5T_ENUM:
            return H5Tget_size(type) == 1;
        case H5T_STRING:
            return is_text(type);
        case H5T_COMPOUND: {
            const int members = H5Tget_nmembers(type);
            for (int k = 0; k < members; ++k) {
                const Handle member(H5Tget_member_type(type, static_cast<unsigned>(k)), name);
                if (!is_text(member)) return false;
            }
            return members > 0 && members <= 16 &&
                   H5Tget_size(type) == static_cast<std::size_t>(members) * sizeof(char*);
        }
        default:
            return false;
    }
}

/// Texts and tables of texts: what lies in the file is a reference of 16 bytes each.
bool holds_texts(hid_t type) {
    return is_text(type) || H5Tget_class(type) == H5T_COMPOUND;
}

/// Memory for texts while they are read: HDF5 asks for it text by text.
struct TextBudget {
    std::uint64_t left = 0, refused = 0;  // bytes; what was asked for in vain
};

void* take_text(std::size_t bytes, void* of) {
    auto& budget = *static_cast<TextBudget*>(of);
    if (bytes > budget.left) {
        budget.refused = bytes;
        return nullptr;
    }
    budget.left -= bytes;
    return std::malloc(std::max<std::size_t>(bytes, 1));
}

void give_text_back(void* text, void* /*of*/) {
    std::free(text);
}

class FormWalk {
  public:
    explicit FormWalk(std::uint64_t file_bytes) : bytes_(file_bytes), limit_(contents_limit(file_bytes)) {}

    void group(hid_t group, const std::string& name, int depth) {
        if (depth > kMaxDepth) refuse(name, "groups lie too deep");
        visit(group, name);
        attributes(group, name);
        for (const std::string& link : link_names(group)) {
            const std::string path = (name == "/" ? "" : name) + "/" + link;
            if (link.empty() || link == "." || link.find('/') != std::string::npos)
                refuse(path, "the name of a link holds a slash or is empty");
            H5L_info_t info{};
            check(H5Lget_info(group, link.c_str(), &info, H5P_DEFAULT), path);
            if (info.type != H5L_TYPE_HARD)
                refuse(path, "is a soft or external link, which no result file holds");
            object(group, link, path, depth);
        }
    }

  private:
    void object(hid_t parent, const std::string& link, const std::string& path, int depth) {
        const Handle opened(H5Oopen(parent, link.c_str(), H5P_DEFAULT), path + ": cannot open");
        if (H5Iget_type(opened) == H5I_GROUP) return group(opened, path, depth + 1);
        if (H5Iget_type(opened) != H5I_DATASET) refuse(path, "is neither a group nor a dataset");
        visit(opened, path);
        attributes(opened, path);
        dataset(opened, path);
    }

    void visit(hid_t object, const std::string& name) {
        // All of it: what is asked for here is what other readers ask for, and it opens structures (the
        // heaps' free space) that nothing else here does.
        H5O_info_t info{};
        check(H5Oget_info2(object, &info, H5O_INFO_ALL), name);
        if (!seen_.insert(info.addr).second) refuse(name, "is linked twice, which no result file does");
    }

    /// Takes so many bytes of contents into account.
    void take(std::uint64_t bytes, const std::string& name) {
        if (bytes > limit_ - contents_)
            refuse(name, fmt::format(
                             "with it the contents unpack to more than {} bytes, the limit for a file of {}",
                             limit_, bytes_));
        contents_ += bytes;
    }

    void attributes(hid_t object, const std::string& name) {
        for (const std::string& key : attribute_names(object)) {
            const std::string where = fmt::format("{}: attribute {}", name, key);
            const Handle attribute(H5Aopen(object, key.c_str(), H5P_DEFAULT), where);
            const Handle type(H5Aget_type(attribute), where);
            const Handle space(H5Aget_space(attribute), where);
            const hssize_t count = H5Sget_simple_extent_npoints(space);
            if (!known_type(type, where) || H5Tget_class(type) == H5T_COMPOUND)
                refuse(where, "has a type that no result file holds");
            if (count < 0 || static_cast<std::uint64_t>(count) > kMaxAttributeValues)
                refuse(where, "is too large");
            const auto values = static_cast<std::uint64_t>(count);
            take(values * H5Tget_size(type), where);
            if (is_text(type)) take(text_bytes(attribute, values, where), where);
        }
    }

    static std::uint64_t text_bytes(hid_t attribute, std::uint64_t count, const std::string& where) {
        std::vector<char*> texts(count, nullptr);
        if (texts.empty()) return 0;
        const Handle type = text_type(), space(H5Aget_space(attribute), where);
        check(H5Aread(attribute, type, texts.data()), where);
        std::uint64_t bytes = 0;
        for (const char* text : texts) bytes += text == nullptr ? 0 : std::string_view(text).size();
        check(H5Dvlen_reclaim(type, space, H5P_DEFAULT, texts.data()), where);
        return bytes;
    }

    void dataset(hid_t dataset, const std::string& name) {
        const Handle type(H5Dget_type(dataset), name);
        const Handle space(H5Dget_space(dataset), name);
        if (!known_type(type, name)) refuse(name, "has a type that no result file holds");
        if (H5Sget_simple_extent_type(space) == H5S_NULL) refuse(name, "has no extent");
        const std::uint64_t values = value_count(space, name);
        take(bounded_product(values, H5Tget_size(type), limit_), name);
        const Handle creation(H5Dget_create_plist(dataset), name);
        if (H5Pget_external_count(creation) != 0) refuse(name, "keeps its values in another file");
        filters(creation, name);
        if (values > 0) storage(dataset, creation, type, space, values, name);
        if (values > 0 && holds_texts(type)) take(text_bytes(dataset, type, space, values, name), name);
    }

    /// Reads the texts into memory that ends where the contents' limit does: a reference takes 16 bytes, and
    /// any number of them may name the same long text.
    std::uint64_t text_bytes(hid_t dataset, hid_t type, hid_t space, std::uint64_t values,
                             const std::string& name) const {
        TextBudget budget{limit_ - contents_, 0};
        const Handle transfer(H5Pcreate(H5P_DATASET_XFER), name);
        check(H5Pset_vlen_mem_manager(transfer, take_text, &budget, give_text_back, nullptr), name);
        std::vector<char> references(values * H5Tget_size(type), 0);
        const herr_t read = H5Dread(dataset, type, H5S_ALL, H5S_ALL, transfer, references.data());
        if (read < 0 && budget.left < budget.refused)
            refuse(name, fmt::format("its texts are longer than {} bytes, what is left for a file of {}",
                                     budget.left, bytes_));
        check(read, name + ": cannot read");
        check(H5Dvlen_reclaim(type, space, transfer, references.data()), name);
        return limit_ - contents_ - budget.left;
    }

    [[nodiscard]] std::uint64_t value_count(hid_t space, const std::string& name) const {
        const int rank = H5Sget_simple_extent_ndims(space);
        check(rank, name);
        Shape shape(static_cast<std::size_t>(rank));
        if (rank > 0) check(H5Sget_simple_extent_dims(space, shape.data(), nullptr), name);
        if (std::find(shape.begin(), shape.end(), 0U) != shape.end()) return 0;
        std::uint64_t values = 1;
        for (const hsize_t extent : shape) values = bounded_product(values, extent, limit_);
        return values;
    }

    /// The dataset's filters, as they are applied when it is written.
    static std::vector<H5Z_filter_t> filters(hid_t creation, const std::string& name) {
        std::vector<H5Z_filter_t> found;
        const int count = H5Pget_nfilters(creation);
        check(count, name);
        if (count > 4) refuse(name, "has more filters than any result file");
        for (int k = 0; k < count; ++k) {
            unsigned flags = 0;
            std::size_t values = 0;
            const H5Z_filter_t filter = H5Pget_filter2(creation, static_cast<unsigned>(k), &flags, &values,
                                                       nullptr, 0, nullptr, nullptr);
            if (filter != H5Z_FILTER_DEFLATE && filter != H5Z_FILTER_SHUFFLE &&
                filter != H5Z_FILTER_FLETCHER32)
                refuse(name, fmt::format("filter {} is none of shuffle, gzip and fletcher32",
                                         static_cast<int>(filter)));
            found.push_back(filter);
        }
        if (std::count(found.begin(), found.end(), H5Z_FILTER_DEFLATE) > 1) refuse(name, "is packed twice");
        return found;
    }

    /// Every value is there, within the file.
    void storage(hid_t dataset, hid_t creation, hid_t type, hid_t space, std::uint64_t values,
                 const std::string& name) const {
        const H5D_layout_t layout = H5Pget_layout(creation);
        const std::uint64_t stored = H5Dget_storage_size(dataset);
        if (stored > bytes_) refuse(name, "claims more storage than the file has");
        if (layout == H5D_CHUNKED) return chunks(dataset, creation, type, space, name);
        if (layout != H5D_CONTIGUOUS && layout != H5D_COMPACT) refuse(name, "is a virtual dataset");
        const std::uint64_t wide =
            holds_texts(type) ? H5Tget_size(type) / sizeof(char*) * kReference : H5Tget_size(type);
        if (stored != bounded_product(values, wide, bytes_))
            refuse(name, "its values are not all in the file");
        if (layout == H5D_COMPACT) return;
        const haddr_t offset = H5Dget_offset(dataset);
        if (offset == HADDR_UNDEF || offset > bytes_ - stored)
            refuse(name, "its values lie beyond the end of the file");
    }

    void chunks(hid_t dataset, hid_t creation, hid_t type, hid_t space, const std::string& name) const {
        const int rank = H5Sget_simple_extent_ndims(space);
        Shape shape(static_cast<std::size_t>(rank)), chunk(shape.size());
        check(H5Sget_simple_extent_dims(space, shape.data(), nullptr), name);
        if (H5Pget_chunk(creation, rank, chunk.data()) != rank) refuse(name, "its chunks have another rank");
        std::uint64_t bytes = H5Tget_size(type), expected = 1;
        for (std::size_t axis = 0; axis < shape.size(); ++axis) {
            bytes = bounded_product(bytes, chunk[axis], kMaxChunkBytes);
            if (chunk[axis] == 0) refuse(name, "has empty chunks");
            expected *= (shape[axis] + chunk[axis] - 1) / chunk[axis];  // at most the number of values
        }
        if (bytes > kMaxChunkBytes) refuse(name, "its chunks are too large");
        hsize_t found = 0;
        check(H5Dget_num_chunks(dataset, space, &found), name + ": cannot count the chunks");
        if (found != expected) refuse(name, fmt::format("has {} chunks of {}", found, expected));
        const std::vector<H5Z_filter_t> pipeline = filters(creation, name);
        const std::uint64_t plain = bytes;
        Shape corner(shape.size(), 0);
        for (std::uint64_t k = 0; k < expected; ++k) {
            unpack(dataset, corner, pipeline, plain, name);
            for (std::size_t axis = corner.size(); axis-- > 0;) {
                corner[axis] += chunk[axis];
                if (corner[axis] < shape[axis]) break;
                corner[axis] = 0;
            }
        }
    }

    /// HDF5 inflates a chunk to whatever comes out, and reads its values from that: it must be a chunk's
    /// bytes.
    void unpack(hid_t dataset, const Shape& corner, const std::vector<H5Z_filter_t>& pipeline,
                std::uint64_t plain, const std::string& name) const {
        unsigned skipped = 0;
        haddr_t address = HADDR_UNDEF;
        hsize_t stored = 0;
        check(H5Dget_chunk_info_by_coord(dataset, corner.data(), &skipped, &address, &stored),
              name + ": cannot find a chunk");
        if (address == HADDR_UNDEF || stored > bytes_ || address > bytes_ - stored)
            refuse(name, "a chunk lies beyond the end of the file");
        const auto applied = [&](std::size_t k) { return (skipped >> k & 1U) == 0; };
        std::uint64_t before = plain, after = 0;  // bytes that go into gzip, and that are added to its output
        bool packed = false;
        for (std::size_t k = 0; k < pipeline.size(); ++k) {
            if (!applied(k)) continue;  // where packing gains nothing
            packed = packed || pipeline[k] == H5Z_FILTER_DEFLATE;
            if (pipeline[k] == H5Z_FILTER_FLETCHER32) (packed ? after : before) += kFletcher;
        }
        if (!packed) {
            if (stored != before) refuse(name, "a chunk has another size than its values");
            return;
        }
        if (stored < after) refuse(name, "a chunk is too short");
        std::vector<unsigned char> bytes(stored), values(before + 1);
        std::uint32_t mask = 0;
        check(H5Dread_chunk(dataset, H5P_DEFAULT, corner.data(), &mask, bytes.data()),
              name + ": cannot read a chunk");
        uLongf unpacked = values.size();
        const int status = uncompress(values.data(), &unpacked, bytes.data(), stored - after);
        if (status != Z_OK || unpacked != before)
            refuse(name, fmt::format("a chunk does not unpack to its {} bytes", before));
    }

    static constexpr std::uint64_t kFletcher = 4;
    static constexpr std::uint64_t kReference = 16;  // in the file: length, address of the heap, index
    std::uint64_t bytes_, limit_, contents_ = 0;
    std::set<haddr_t> seen_;
};

/// Runs in the child.
std::vector<std::string> complaints_of(const std::string& path, std::uint64_t bytes, bool values) {
    try {
        const Handle file = open_input(path);
        std::vector<std::string> complaints = form_complaints(file, bytes);
        if (complaints.empty() && values) complaints = checksum_complaints(file, "/");
        return complaints;
    } catch (const FileError& error) {
        return {error.what()};
    }
}

}  // namespace

std::uint64_t contents_limit(std::uint64_t file_bytes) {
    return std::max(std::uint64_t{1} << 28U, 64 * file_bytes);
}

std::vector<std::string> form_complaints(hid_t file, std::uint64_t file_bytes) {
    try {
        const Handle root(H5Gopen2(file, "/", H5P_DEFAULT), "/: cannot open");
        FormWalk(file_bytes).group(root, "/", 0);
    } catch (const FileError& error) {
        return {error.what()};
    }
    return {};
}

namespace {

void require_without_complaint(const std::string& path, bool values) {
    std::error_code error;
    const std::uintmax_t bytes = std::filesystem::file_size(path, error);
    if (error) throw system_error(path, "cannot open", error.value());
    const std::vector<std::string> complaints =
        run_guarded(foreign_file_limits(bytes), [&] { return complaints_of(path, bytes, values); });
    if (complaints.empty()) return;
    const std::string& first = complaints.front();
    throw FileError(first.starts_with(path) ? first : path + ": " + first);
}

}  // namespace

void require_known_form(const std::string& path) {
    require_without_complaint(path, false);
}

Handle open_foreign(const std::string& path) {
    require_without_complaint(path, true);
    return open_input(path);
}

}  // namespace ricci::hdf5
