// From what the engine computes to what the store keeps.
#pragma once

#include <string>

#include "engine/flow/flow.h"
#include "engine/sweep/sweep_solver.h"
#include "io/mesh/mesh_file.h"
#include "io/store/run_store.h"

namespace ricci::app {

/// Root attributes of a result file made by this program.
RunInfo make_run_info(const std::string& config, const std::string& fingerprint, int threads);

/// <stem>@<faces>.
std::string item_name(const std::string& stem, Index faces);

/// `source`: the file as given; `hash`: its content hash; `source_vertex`: empty for the mesh's own input
/// numbers.
ItemRecord make_item(const std::string& name, const std::string& source, std::uint64_t hash,
                     const SurfaceMesh& mesh, const std::vector<Index>& source_vertex = {});

/// The surface of a stored item.
SurfaceMesh surface_of(const ItemRecord& item);

FlowRecord make_flow_record(const std::string& item, const FlowResult& result, const FlowOptions& options,
                            double seconds);
SweepRow make_row(const SweepSolve& solve);

}  // namespace ricci::app
