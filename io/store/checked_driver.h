// A file driver for HDF5 that knows what went wrong. HDF5's own driver reports a full disk at close at best,
// and a file whose close failed can be neither closed nor forgotten. This one remembers the first failed
// system call and lets HDF5 believe that all is well, so that the handles close cleanly; the owner asks
// afterwards.
#pragma once

#include <hdf5.h>

namespace ricci::hdf5 {

/// Outcome of all writes of one file. Must outlive the file's handle.
struct WriteOutcome {
    int error_number = 0;  // errno of the first failure; 0: none
};

/// Makes files created with this access list write through the checked driver. Throws FileError when HDF5
/// refuses the driver.
void use_checked_driver(hid_t access_list, WriteOutcome& outcome);

}  // namespace ricci::hdf5
