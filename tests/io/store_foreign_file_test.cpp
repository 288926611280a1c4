// HDF5 files that nobody vouches for: each form that no result file has is refused before it is read.
#include <gtest/gtest.h>
#include <zlib.h>

#include <filesystem>
#include <fstream>
#include <functional>

#include "io/store/foreign_file.h"
#include "io/store/shape_index.h"
#include "tests/io/store_samples.h"

namespace ricci {
namespace {

using store_samples::TemporaryFolder;

/// What require_known_form says of a file that `fill` makes.
std::string complaint_about(const std::function<void(hid_t root)>& fill) {
    const TemporaryFolder folder;
    const std::string path = folder.file("foreign.h5");
    const hdf5::Session session;
    {
        const hdf5::Handle access(H5Pcreate(H5P_FILE_ACCESS), "test");
        H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_LATEST);
        const hdf5::Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access), "test");
        fill(file);
    }
    try {
        hdf5::require_known_form(path);
        return "";
    } catch (const FileError& error) {
        const std::string what = error.what();
        EXPECT_TRUE(what.starts_with(path)) << what;
        return what;
    }
}

void expect_complaint(const std::string& expected, const std::function<void(hid_t root)>& fill) {
    const std::string found = complaint_about(fill);
    EXPECT_NE(found.find(expected), std::string::npos) << "expected: " << expected << "\nfound: " << found;
}

/// A dataset of `extent` doubles as `creation` says; nothing is written.
hdf5::Handle make_dataset(hid_t root, const char* name, hsize_t extent, hid_t creation) {
    const hdf5::Handle space(H5Screate_simple(1, &extent, nullptr), "test");
    return {H5Dcreate2(root, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, creation, H5P_DEFAULT), "test"};
}

hdf5::Handle creation_list() {
    return {H5Pcreate(H5P_DATASET_CREATE), "test"};
}

TEST(ForeignFile, OfThisProgramIsLetIn) {
    const TemporaryFolder folder;
    const std::string path = folder.file("run.h5");
    store_samples::write_sample_run(path, false);
    const hdf5::Session session;
    EXPECT_NO_THROW(hdf5::require_known_form(path));
    EXPECT_EQ(read_run(path).items.size(), 2U);
}

TEST(ForeignFile, MayNotLinkElsewhere) {
    expect_complaint("/outside: is a soft or external link", [](hid_t root) {
        H5Lcreate_external("/etc/other.h5", "/", root, "outside", H5P_DEFAULT, H5P_DEFAULT);
    });
    expect_complaint("/loop: is a soft or external link",
                     [](hid_t root) { H5Lcreate_soft("/loop", root, "loop", H5P_DEFAULT, H5P_DEFAULT); });
    expect_complaint("/a/again: is linked twice", [](hid_t root) {
        const hdf5::Handle group = hdf5::create_group(root, "a");
        H5Lcreate_hard(root, "a", group, "again", H5P_DEFAULT, H5P_DEFAULT);
    });
}

TEST(ForeignFile, MayNotKeepValuesElsewhere) {
    const hdf5::Session session;
    expect_complaint("/x: keeps its values in another file", [](hid_t root) {
        const hdf5::Handle creation = creation_list();
        H5Pset_external(creation, "/etc/passwd", 0, 80);
        make_dataset(root, "x", 10, creation);
    });
    expect_complaint("/x: is a virtual dataset", [](hid_t root) {
        const hdf5::Handle creation = creation_list();
        const hsize_t extent = 10;
        const hdf5::Handle space(H5Screate_simple(1, &extent, nullptr), "test");
        H5Pset_virtual(creation, space, "/etc/other.h5", "/x", space);
        make_dataset(root, "x", extent, creation);
    });
}

TEST(ForeignFile, HasItsValues) {
    const hdf5::Session session;
    // Values that were never written are read as zeros, out of nothing: a file of some bytes may promise any
    // number.
    expect_complaint("/x: its values are not all in the file",
                     [](hid_t root) { make_dataset(root, "x", 1000, creation_list()); });
    expect_complaint("has 0 chunks of 100", [](hid_t root) {
        const hdf5::Handle creation = creation_list();
        const hsize_t chunk = 10;
        H5Pset_chunk(creation, 1, &chunk);
        make_dataset(root, "x", 1000, creation);
    });
    expect_complaint("/x: with it the contents unpack to more than", [](hid_t root) {
        const hdf5::Handle creation = creation_list();
        const hsize_t chunk = 10;
        H5Pset_chunk(creation, 1, &chunk);
        make_dataset(root, "x", hsize_t{1} << 60, creation);
    });
    expect_complaint("/x: its chunks are too large", [](hid_t root) {
        const hdf5::Handle creation = creation_list();
        const hsize_t chunk = hsize_t{1} << 21;
        H5Pset_chunk(creation, 1, &chunk);
        make_dataset(root, "x", chunk, creation);
    });
}

// Sixteen bytes each, and all of them the same text: what is read is far more than the file holds.
TEST(ForeignFile, HasNoMoreTextThanItMay) {
    const TemporaryFolder folder;
    const std::string path = folder.file("foreign.h5");
    const hdf5::Session session;
    constexpr std::size_t kCount = 300, kReference = 16;
    std::vector<std::string> texts(kCount, "short");
    texts.front() = std::string(std::size_t{1} << 20U, 'a');
    hdf5::write_file(path, [&](hdf5::OutputFile& file) { hdf5::write_text_list(file.root(), "x", texts); });
    EXPECT_NO_THROW(hdf5::require_known_form(path));
    haddr_t offset = 0;
    {
        const hdf5::Handle file = hdf5::open_input(path);
        offset = H5Dget_offset(hdf5::Input(file, "x").id());
    }
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    std::string first(kReference, '\0');
    file.seekg(static_cast<std::streamoff>(offset));
    file.read(first.data(), kReference);
    file.seekp(static_cast<std::streamoff>(offset));
    for (std::size_t i = 0; i < kCount; ++i) file.write(first.data(), kReference);
    file.close();
    try {
        hdf5::require_known_form(path);
        FAIL() << "let in";
    } catch (const FileError& error) {
        EXPECT_NE(std::string(error.what()).find("/x: its texts are longer than"), std::string::npos)
            << error.what();
    }
}

/// A chunk of 64 doubles whose packed bytes are `packed`.
void make_chunk(hid_t root, const std::string& packed, bool checksum) {
    const hsize_t length = 64, start = 0;
    const hdf5::Handle creation = creation_list();
    H5Pset_chunk(creation, 1, &length);
    H5Pset_shuffle(creation);
    H5Pset_deflate(creation, 6);
    if (checksum) H5Pset_fletcher32(creation);
    const hdf5::Handle dataset = make_dataset(root, "x", length, creation);
    ASSERT_GE(H5Dwrite_chunk(dataset, H5P_DEFAULT, 0, &start, packed.size(), packed.data()), 0);
}

std::string packed(std::size_t bytes) {
    const std::string plain(bytes, 'x');
    uLongf size = compressBound(bytes);
    std::string result(size, 0);
    compress2(reinterpret_cast<Bytef*>(result.data()), &size, reinterpret_cast<const Bytef*>(plain.data()),
              bytes, 9);
    result.resize(size);
    return result;
}

TEST(ForeignFile, ChunksUnpackToTheirValues) {
    const std::size_t right = 64 * sizeof(double);
    EXPECT_EQ(complaint_about([&](hid_t root) { make_chunk(root, packed(right), false); }), "");
    EXPECT_EQ(complaint_about([&](hid_t root) { make_chunk(root, packed(right) + "sums", true); }), "");
    for (const std::size_t wrong : {std::size_t{8}, right - 1, right + 1, std::size_t{1} << 28U})
        expect_complaint("does not unpack to its 512 bytes",
                         [&](hid_t root) { make_chunk(root, packed(wrong), false); });
    expect_complaint("does not unpack", [&](hid_t root) { make_chunk(root, "no gzip at all", false); });
    expect_complaint("is too short", [&](hid_t root) { make_chunk(root, "ab", true); });
}

TEST(ForeignFile, ValuesAreWhatTheirChecksumsSay) {
    const TemporaryFolder folder;
    const std::string path = folder.file("run.h5");
    store_samples::write_sample_run(path, false);
    {
        const hdf5::Session session;
        const hdf5::Handle file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), "test");
        const hdf5::Handle items = hdf5::open_group(file, "items");
        const hdf5::Handle item = hdf5::open_group(items, hdf5::link_names(items).front());
        const hdf5::Handle points(H5Dopen2(item, "mesh/points", H5P_DEFAULT), "test");
        std::vector<double> values(hdf5::Input(item, "mesh/points").size());
        ASSERT_GE(H5Dread(points, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
        values.at(1) += 1.0;
        ASSERT_GE(H5Dwrite(points, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
    }
    try {
        read_run(path);
        ADD_FAILURE() << "changed values were read";
    } catch (const FileError& error) {
        EXPECT_NE(std::string(error.what()).find("mesh/points"), std::string::npos) << error.what();
    }
}

TEST(ForeignFile, NeedsNoFilterButThree) {
    const hdf5::Session session;
    expect_complaint("is none of shuffle, gzip and fletcher32", [](hid_t root) {
        const hdf5::Handle creation = creation_list();
        const hsize_t chunk = 10;
        H5Pset_chunk(creation, 1, &chunk);
        H5Pset_scaleoffset(creation, H5Z_SO_FLOAT_DSCALE, 3);
        make_dataset(root, "x", 20, creation);
    });
}

TEST(ForeignFile, HasKnownTypesAlone) {
    const hdf5::Session session;
    const auto of_type = [](hid_t type) {
        return [type](hid_t root) {
            const hdf5::Handle space(H5Screate(H5S_SCALAR), "test");
            const hdf5::Handle made(H5Dcreate2(root, "x", type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                                    "test");
        };
    };
    const hdf5::Handle list(H5Tvlen_create(H5T_STD_I32LE), "test"),
        opaque(H5Tcreate(H5T_OPAQUE, 100), "test");
    const hdf5::Handle nested(H5Tvlen_create(list), "test");
    for (const hid_t type : {hid_t{list}, hid_t{opaque}, hid_t{nested}, hid_t{H5T_STD_REF_OBJ}})
        expect_complaint("/x: has a type that no result file holds", of_type(type));
    expect_complaint("/t: is neither a group nor a dataset", [](hid_t root) {
        const hdf5::Handle type(H5Tcopy(H5T_STD_I32LE), "test");
        H5Tcommit2(root, "t", type, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    });
    expect_complaint("/: attribute a: has a type that no result file holds", [&](hid_t root) {
        const hdf5::Handle space(H5Screate(H5S_SCALAR), "test");
        const hdf5::Handle made(H5Acreate2(root, "a", opaque, space, H5P_DEFAULT, H5P_DEFAULT), "test");
    });
}

TEST(ForeignFile, IsNotTooDeep) {
    const hdf5::Session session;
    expect_complaint("groups lie too deep", [](hid_t root) {
        hdf5::Handle group = hdf5::create_group(root, "g");
        for (int depth = 0; depth < 80; ++depth) group = hdf5::create_group(group, "g");
    });
}

TEST(ForeignFile, IsRefusedByEveryReaderNamingIt) {
    const TemporaryFolder folder;
    const std::string path = folder.file("run.h5");
    store_samples::write_sample_run(path, false);
    {
        const hdf5::Session session;
        const hdf5::Handle file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), "test");
        H5Lcreate_soft("/items", file, "more", H5P_DEFAULT, H5P_DEFAULT);
    }
    const auto refuses = [&](const std::function<void()>& read) {
        try {
            read();
            ADD_FAILURE() << "taken in";
        } catch (const FileError& error) {
            EXPECT_EQ(std::string(error.what()),
                      path + ": /more: is a soft or external link, which no result file holds");
        }
    };
    refuses([&] { read_run(path); });
    refuses([&] { const IndexReader reader(path); });
    refuses([&] { read_shape_index(path); });
    ASSERT_EQ(verify_structure(path).size(), 1U);
    EXPECT_EQ(verify_structure(path)[0],
              path + ": /more: is a soft or external link, which no result file holds");
}

}  // namespace
}  // namespace ricci
