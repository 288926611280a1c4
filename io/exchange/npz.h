// Archives of arrays that numpy loads: zip files of .npy.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "kernels/connectivity.h"

namespace ricci {

/// An archive under construction. Arrays are stored, not compressed; all throw FileError, also beyond the
/// 4 GiB that a plain zip file may have, and std::invalid_argument for a shape that is not that of the
/// values.
class NpzFile {
  public:
    explicit NpzFile(const std::string& path);
    ~NpzFile();
    NpzFile(const NpzFile&) = delete;
    NpzFile& operator=(const NpzFile&) = delete;

    using Shape = std::vector<std::size_t>;
    /// Row order; `name` without .npy, slashes allowed.
    void add(const std::string& name, std::span<const double> values, const Shape& shape);
    void add(const std::string& name, std::span<const std::int32_t> values, const Shape& shape);
    void add(const std::string& name, std::span<const std::uint8_t> values, const Shape& shape);
    /// Writes the directory and puts the file into place.
    void close();

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace ricci
