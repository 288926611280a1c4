// A thin layer over HDF5's C interface: handles that close themselves, errors as FileError, and typed arrays
// and attributes as the result file writes them (little endian, no time stamps, a checksum beside every
// array).
//
// Every dataset carries the attribute `xxh3` (u8): XXH3-64 of its values' bytes in row order. Datasets above
// 64 KiB are chunked with shuffle, gzip and fletcher32. seal() gives a group the attribute `attributes_xxh3`.
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/mesh/mesh_file.h"
#include "io/store/checked_driver.h"
#include "io/store/stored_text.h"

namespace ricci::hdf5 {

/// Held during every use of HDF5 by the store: one writer at a time, and nobody is inside HDF5 while
/// verify_structure forks. Also keeps HDF5 from printing its errors while it lives.
class Session {
  public:
    Session();
    ~Session();
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

  private:
    std::unique_lock<std::recursive_mutex> lock_;
    H5E_auto2_t printer_ = nullptr;
    void* printer_data_ = nullptr;
};

/// Throws FileError "<what>: <HDF5's innermost message>" when `result` is negative; returns it otherwise.
hid_t check(hid_t result, const std::string& what);

/// An owned HDF5 identifier of any kind.
class Handle {
  public:
    Handle() = default;
    /// Takes `id` over. Throws FileError as check() does when it is negative.
    Handle(hid_t id, const std::string& what) : id_(check(id, what)) {}
    Handle(Handle&& other) noexcept;
    Handle& operator=(Handle&& other) noexcept;
    Handle(const Handle&) = delete;
    Handle& operator=(const Handle&) = delete;
    ~Handle() { reset(); }

    operator hid_t() const { return id_; }  // NOLINT: what HDF5's functions take
    void reset();

  private:
    hid_t id_ = H5I_INVALID_HID;
};

/// A new file, written through the checked driver. Destroyed without close(): abandoned.
class OutputFile {
  public:
    /// Creates or truncates. Throws FileError.
    explicit OutputFile(std::string path);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    [[nodiscard]] hid_t root() const { return file_; }
    /// Throws FileError when a write has failed so far (disk full, ...).
    void check_writes() const;
    /// Flushes what is written so far. Throws FileError when any write failed.
    void flush();
    /// Flushes, closes and fsyncs. Throws FileError when any write failed.
    void close();

  private:
    std::string path_;
    WriteOutcome outcome_;
    Handle file_;
};

/// Writes a file: creates it, lets `fill(file)` write, closes it durably. Errors name the path; the file is
/// removed when anything is thrown.
void write_file(const std::string& path, const std::function<void(OutputFile&)>& fill);

/// Opens a file for reading. Throws FileError.
Handle open_input(const std::string& path);

/// Creates a group, or opens one. Throws FileError.
Handle create_group(hid_t parent, const std::string& name);
Handle open_group(hid_t parent, const std::string& name);
[[nodiscard]] bool has_link(hid_t parent, const std::string& name);
[[nodiscard]] bool has_attribute(hid_t object, const std::string& name);
/// Names of all links, in order of creation where the group tracks it. Throws FileError.
std::vector<std::string> link_names(hid_t group);

/// Attributes: text (variable-length UTF-8), lists of texts, numbers. Reading checks kind and size of the
/// stored type. Throw FileError.
/// attribute_names() lists all in ascending order.
std::vector<std::string> attribute_names(hid_t object);
void write_text_attribute(hid_t object, const char* name, const std::string& text);
void write_texts_attribute(hid_t object, const char* name, const std::vector<std::string>& texts);
std::string read_text_attribute(hid_t object, const char* name);
std::vector<std::string> read_texts_attribute(hid_t object, const char* name);
template <class T>
void write_attribute(hid_t object, const char* name, T value);
template <class T>
T read_attribute(hid_t object, const char* name);

/// Text type of the file: variable length, UTF-8.
Handle text_type();
/// Number type as stored: T one of double, float, int32, int64, uint8, uint16, uint64.
template <class T>
hid_t stored_type();

/// XXH3-64 over all attributes of an object but its checksums and `complete`, in the order of their names.
std::uint64_t attribute_digest(hid_t object);
/// Writes attribute_digest() as the attribute `attributes_xxh3`.
void seal(hid_t object);

using Shape = std::vector<hsize_t>;

/// Values of `type` with shape `shape` ({}: scalar), bytes in row order. Throws FileError.
void write_values(hid_t parent, const std::string& name, hid_t type, const Shape& shape,
                  std::span<const std::byte> bytes);

/// An array of numbers.
template <class T>
void write_array(hid_t parent, const std::string& name, std::span<const T> values, const Shape& shape) {
    write_values(parent, name, stored_type<T>(), shape, std::as_bytes(values));
}
template <class T>
void write_array(hid_t parent, const std::string& name, const std::vector<T>& values) {
    write_array(parent, name, std::span<const T>(values), {values.size()});
}
template <class T>
void write_scalar(hid_t parent, const std::string& name, T value) {
    write_array(parent, name, std::span<const T>(&value, 1), {});
}

/// A matrix of doubles that is written row by row, so that it never lies in memory.
class RowWriter {
  public:
    RowWriter(hid_t parent, const std::string& name, hsize_t rows, hsize_t columns);
    void append(std::span<const double> row);
    /// Writes the checksum. Throws FileError when rows are missing.
    void finish();

  private:
    Handle dataset_, space_;
    hsize_t rows_, columns_, next_ = 0;
    std::shared_ptr<void> digest_;  // XXH3 state
};

/// A dataset opened for reading. Throws FileError when `name` is not a dataset.
class Input {
  public:
    Input(hid_t parent, const std::string& name);
    [[nodiscard]] const Shape& shape() const { return shape_; }
    [[nodiscard]] hid_t id() const { return dataset_; }
    [[nodiscard]] const std::string& name() const { return name_; }
    [[nodiscard]] hsize_t size() const;  // number of values
    /// Throws FileError unless the stored type is `type`.
    void expect_type(hid_t type) const;
    /// Throws FileError unless the shape is this.
    void expect_shape(const Shape& shape) const;
    /// All values, as stored.
    void read_into(hid_t type, void* values) const;
    /// One row of a matrix of doubles.
    [[nodiscard]] std::vector<double> read_row(hsize_t row) const;
    /// XXH3-64 of the values, read in pieces; of texts and tables of texts, of lengths and contents.
    [[nodiscard]] std::uint64_t digest() const;

  private:
    std::string name_;
    Handle dataset_;
    Shape shape_;
};

/// Values of a type made of variable-length texts (text_type() or a table of such columns), `texts` in row
/// order, and back (`members` texts per value).
void write_texts(hid_t parent, const std::string& name, hid_t type, const Shape& shape,
                 const std::vector<const char*>& texts);
/// A list of texts, each as stored_text keeps it.
void write_text_list(hid_t parent, const std::string& name, const std::vector<std::string>& texts,
                     const std::optional<Shape>& shape = std::nullopt);
std::vector<std::string> read_texts(const Input& input, hid_t type, std::size_t members);
/// A list of so many texts, or of any number. Throws FileError.
std::vector<std::string> read_text_list(hid_t parent, const std::string& name,
                                        std::optional<std::size_t> size = std::nullopt);

/// An array of numbers with exactly this shape, or (`std::nullopt`) any one-dimensional one.
template <class T>
std::vector<T> read_array(hid_t parent, const std::string& name, const std::optional<Shape>& shape) {
    const Input input(parent, name);
    input.expect_type(stored_type<T>());
    input.expect_shape(shape ? *shape : Shape{input.size()});
    std::vector<T> values(input.size());
    input.read_into(stored_type<T>(), values.data());
    return values;
}
template <class T>
T read_scalar(hid_t parent, const std::string& name) {
    return read_array<T>(parent, name, Shape{}).front();
}

/// While it lives, datasets that this thread creates are neither packed nor cut in chunks: for files that are
/// read once more and then removed.
class PlainDatasets {
  public:
    PlainDatasets();
    ~PlainDatasets();
    PlainDatasets(const PlainDatasets&) = delete;
    PlainDatasets& operator=(const PlainDatasets&) = delete;

  private:
    bool before_;
};

/// Compares every checksum below `object` (datasets' and groups') with the contents; one complaint per
/// mismatch.
std::vector<std::string> checksum_complaints(hid_t object, const std::string& name);

/// Name of an object within its file, for messages.
std::string name_of(hid_t object);

}  // namespace ricci::hdf5
