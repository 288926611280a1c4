// An index under way: described shapes become durable in blocks, and the index file is written anew at the
// end. The same journal and segments as those of a run (io/store/segment_folder.h).
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "io/store/shape_index.h"

namespace ricci {

/// What an entry of the final index refers to: a component of a file with these bytes.
struct IndexSource {
    std::string file;
    std::uint64_t hash = 0;
    std::int32_t component = 0;
};

/// Shapes are known by the hash of their file's bytes and their component: two files with equal bytes are
/// one. Methods are thread-safe. Throws FileError and std::invalid_argument as RunStore does.
class IndexStore {
  public:
    /// Starts `output`.parts afresh or, with `resume`, continues what its journal proves finished. A sound
    /// index at `output` that was made with the same fingerprint and descriptor version lends its shapes; any
    /// other stays until assemble() and is named in the notes.
    IndexStore(std::string output, RunInfo info, std::int32_t descriptor_version, bool resume);
    /// Keeps the parts for a later resume, unless nothing was written.
    ~IndexStore();
    IndexStore(const IndexStore&) = delete;
    IndexStore& operator=(const IndexStore&) = delete;

    /// What resuming did not believe, and what became of an older index, for the log.
    [[nodiscard]] std::vector<std::string> notes() const;
    /// Components of a file with these bytes, when all of them are known; 0 otherwise.
    [[nodiscard]] std::int32_t known_components(std::uint64_t hash) const;
    /// Their numbers, ascending.
    [[nodiscard]] std::vector<std::int32_t> components_known(std::uint64_t hash) const;
    [[nodiscard]] bool knows(std::uint64_t hash, std::int32_t component) const;
    /// Throws std::invalid_argument for one that is not known.
    [[nodiscard]] ShapeRecord shape(std::uint64_t hash, std::int32_t component) const;

    /// Returns once the shapes are durable, in one segment; what did not converge goes to the journal itself.
    /// Throws std::invalid_argument on records that do not fit together and on shapes that are known.
    void write_shapes(const std::vector<ShapeRecord>& shapes);

    /// Writes the index of `sources`, in this order, verifies it, renames it into place and removes the
    /// parts. Sources whose shape did not converge become failures (stage "describe") after `failures`.
    /// Throws std::invalid_argument for a source that is not known, and when the sizes of fingerprints or the
    /// names of coordinates differ within a topological type.
    void assemble(const std::vector<IndexSource>& sources, const std::vector<FailureRecord>& failures);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace ricci
