// Everything that an item says of its vertices, its faces and itself, with names and units.
#pragma once

#include <string>
#include <vector>

#include "io/exchange/geometry_block.h"
#include "io/store/run_store.h"

namespace ricci::app {

/// Number V of an item's vertices, unused ones included.
std::size_t vertex_count(const StoredItem& stored);

/// Of the sweep: columns by vertex (NaN, and -1 as the status, where a vertex has no row), conformal factors
/// of the best, the worst and further vertices; of the flow: conformal factor, curvature, target. // V rows
std::vector<DataArray> vertex_fields(const StoredItem& stored);

/// Of the quality of the map: image areas, logarithms of area ratios, angle ratios (three, one for each
/// corner). Of an atlas: the lowest chart that has the face, -1 for none. // F rows. Throws FileError.
std::vector<DataArray> face_fields(const StoredItem& stored);

/// Where the item came from and what holds for all of it: names, program, scalar attributes of every result,
/// coordinates in shape space, the spectrum.
std::vector<DataArray> item_data(const RunInfo& info, const StoredItem& stored);

/// Unit of lengths on the surface: as stored with the mesh, or "input unit".
std::string length_unit(const StoredItem& stored);

}  // namespace ricci::app
