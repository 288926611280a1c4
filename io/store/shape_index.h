// The shape-space index on disk: one HDF5 file, shapes grouped by topological type so that each column of a
// type is one array (docs/hdf5.md, "Index"). The store knows numbers and names, nothing of spectra.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/store/run_store.h"

namespace ricci {

/// What a shape looks like at one resolution.
struct ShapeResolution {
    Index faces = 0;
    std::vector<double> fingerprint;
    std::vector<double> coordinates;  // empty: none
};

/// One described surface: a component of a file with these bytes.
struct ShapeRecord {
    std::uint64_t hash = 0;                      // of the file's bytes
    std::int32_t component = 0, components = 1;  // its number, and how many the file has
    std::uint8_t status = 0;                     // value of the run's status names
    std::string message;                         // why, where not converged; else notes
    Index genus = 0, boundaries = 0;
    Index vertices = 0, faces = 0;        // of the mesh that was described
    std::vector<double> fingerprint;      // K, one K per topological type; finite
    std::vector<double> coordinates;      // C, or empty: none
    std::vector<std::string> names;       // C, equal for all of one type
    std::vector<double> lengths;          // ascending
    std::vector<std::uint8_t> primitive;  // one per length
    double complete_up_to = 0.0, marking_gap = 0.0;
    // Of the metric it was described from: as in results. NaN and 0 where files of earlier versions lack
    // them.
    double residual_max = 0.0, gauss_bonnet_error = 0.0;
    std::int32_t precision_digits = 16;
    std::array<double, 4> seconds{};           // flow, surface, spectrum, coordinates
    std::vector<ShapeResolution> resolutions;  // those compared, the finest included; or empty
};

/// A shape of the index and where it came from.
struct IndexEntry {
    std::string file;  // path as given
    ShapeRecord shape;
};

/// A whole index.
struct ShapeIndex {
    RunInfo info;
    std::int32_t descriptor_version = 0;
    std::vector<IndexEntry> entries;  // in the order of the index
    std::vector<FailureRecord> failures;
};

/// What queries need of the shapes of one topological type, row by row.
struct IndexBucket {
    Index genus = 0, boundaries = 0;
    std::vector<std::string> files;                   // N, in the order of the index
    std::vector<std::int32_t> component, components;  // N
    std::vector<std::uint64_t> hash;                  // N
    std::size_t fingerprint_size = 0, coordinate_count = 0;
    std::vector<double> fingerprint;  // N x K
    std::vector<double> coordinates;  // N x C; rows of NaN where a shape has none
    std::vector<std::string> names;   // C
};

/// "g2b0".
std::string type_name(Index genus, Index boundaries);

/// Name of a shape for people: its file, with "#c1" where the file has several components.
std::string shape_name(const std::string& file, std::int32_t component, std::int32_t components);

/// An index opened for queries: reads what it is asked for and no more. Throws FileError.
class IndexReader {
  public:
    explicit IndexReader(const std::string& path);
    [[nodiscard]] const RunInfo& info() const { return info_; }
    [[nodiscard]] std::int32_t descriptor_version() const { return descriptor_version_; }
    /// Topological types that the index holds, as (genus, boundaries), ascending.
    [[nodiscard]] const std::vector<std::array<Index, 2>>& types() const { return types_; }
    /// Shapes of one type; none when the index holds none.
    [[nodiscard]] std::optional<IndexBucket> bucket(Index genus, Index boundaries) const;

  private:
    std::string path_;
    RunInfo info_;
    std::int32_t descriptor_version_ = 0;
    std::vector<std::array<Index, 2>> types_;
};

/// Reads a whole index. Throws FileError on anything that does not keep the contract, naming the object.
ShapeIndex read_shape_index(const std::string& path);

}  // namespace ricci
