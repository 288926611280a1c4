// What files of distances and of paths hold, below their root. Callers hold an hdf5::Session.
#pragma once

#include <vector>

#include "io/store/distance_file.h"
#include "io/store/hdf5_file.h"
#include "io/store/path_file.h"

namespace ricci::schema {

/// All records. Throw FileError on anything that does not keep the contract, naming the object.
std::vector<DistanceRecord> read_distances(hid_t root);
std::vector<PathRecord> read_paths(hid_t root);

}  // namespace ricci::schema
