// What the exports for ParaView have in common.
#pragma once

#include <vector>

#include "io/store/run_store.h"

namespace ricci {

/// Throws std::invalid_argument unless the item has points and each field V values and a name of its own
/// without a slash.
void require_exportable(const ItemRecord& item, const std::vector<PointField>& fields);

}  // namespace ricci
