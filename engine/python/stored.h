// Results as Python holds them: records of the result file, in memory.
#pragma once

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "io/store/run_store.h"

namespace ricci::python {

/// One item with what was computed or read of it, and what files do not hold.
struct Stored {
    StoredItem item;
    std::shared_ptr<const RunInfo> info;
    std::vector<FailureRecord> failures;  // of this item, or what came of it
    KeepPolicy keep;                      // of item.sweep
    std::string message;                  // "" where read from a file
    double seconds = std::numeric_limits<double>::quiet_NaN();
    double area = std::numeric_limits<double>::quiet_NaN();
    double max_length_error = std::numeric_limits<double>::quiet_NaN();  // of an initial circle packing
    double mean_length_error = std::numeric_limits<double>::quiet_NaN();
};

/// A run: items, and failures of any stage.
struct Run {
    std::shared_ptr<const RunInfo> info;
    bool complete = false;
    std::vector<std::shared_ptr<Stored>> items;
    std::vector<FailureRecord> failures;
};

/// A run as read, or as swept in memory, item by item.
Run run_of(StoredRun stored);

}  // namespace ricci::python
