// VTKHDF: what ParaView (5.11 and later) reads from HDF5.
#pragma once

#include <string>

#include "io/exchange/geometry_block.h"

namespace ricci {

/// Writes a VTKHDF 1.0 file of the type UnstructuredGrid, which is what that version has for any cells.
/// Units are the attribute `units` of each array. Throws std::invalid_argument as require_valid(), and for a
/// block without points; FileError.
void save_vtkhdf(const std::string& path, const GeometryBlock& block);

}  // namespace ricci
