// Queries of an index, for the command line and for the Python module.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "engine/app/index_config.h"
#include "engine/app/index_vectors.h"
#include "engine/shape_space/neighbours.h"
#include "io/mesh/mesh_file.h"
#include "io/store/shape_index.h"

namespace ricci::app {

/// A shape of one topological type that neighbours are sought of.
struct IndexQuery {
    std::string name;
    Index genus = 0, boundaries = 0;
    std::uint64_t hash = 0;
    std::vector<double> vector;
    double seconds = 0.0;  // of its own description
};

/// Types of the index, each read and made searchable when first asked for.
class IndexSearch {
  public:
    /// Throws FileError; UsageError where its shapes were described by another version.
    IndexSearch(const std::string& path, ShapeMetric metric);

    struct Type {
        IndexBucket bucket;
        NeighbourSearch search;
    };
    [[nodiscard]] const IndexReader& reader() const { return reader_; }
    [[nodiscard]] const IndexConfig& config() const { return config_; }
    [[nodiscard]] ShapeMetric metric() const { return metric_; }
    /// None when the index holds no shape of this type.
    const Type* type(Index genus, Index boundaries);

    /// The shapes of a file with these bytes as the index has them; empty unless it has all.
    std::vector<IndexQuery> known_shapes(const std::string& file, std::uint64_t hash);
    /// Describes the shapes of a file by the index's options; those that fail are logged and left out, which
    /// `failed` tells.
    std::vector<IndexQuery> describe(const std::string& file, const LoadedMesh& loaded,
                                     const std::function<bool()>& stop, bool& failed) const;

  private:
    IndexReader reader_;
    IndexConfig config_;
    ShapeMetric metric_;
    std::map<std::array<Index, 2>, Type> types_;
};

/// The nearest entries; with `others`, none with the query's own bytes.
std::vector<Neighbour> neighbours_of(const IndexQuery& query, const IndexSearch::Type& type,
                                     std::size_t count, bool others);

}  // namespace ricci::app
