// Output files that are made at once, without items and segments.
#pragma once

#include <functional>
#include <string>

#include "io/store/hdf5_file.h"
#include "io/store/run_store.h"

namespace ricci::schema {

/// Writes root attributes, `kind` among them, what fill(root) adds, and `complete` beside `path`, and renames
/// it into place. Throws FileError; then `path` is as it was.
void write_whole_file(const std::string& path, const RunInfo& info, const std::string& kind,
                      const std::function<void(hid_t)>& fill);

/// Opens a file of that kind, once a child process has walked over it (io/store/foreign_file.h), for
/// read(root). Throws FileError that begins with the path. The caller holds a Session.
void read_whole_file(const std::string& path, const std::string& kind,
                     const std::function<void(hid_t)>& read);

}  // namespace ricci::schema
