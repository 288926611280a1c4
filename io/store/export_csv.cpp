#include <fmt/format.h>

#include <iterator>

#include "io/store/csv_text.h"
#include "io/store/durable.h"
#include "io/store/run_store.h"

namespace ricci {
void export_csv(const std::string& path, const StoredRun& run) {
    std::string text =
        "item,vertex,status,area_distortion,newton_iterations,residual_max,flips,seconds,"
        "gauss_bonnet_error,precision_digits\n";
    for (const StoredItem& item : run.items) {
        if (!item.sweep) continue;
        const std::string name = csv_field(item.item.name);
        for (const SweepRow& row : item.sweep->rows)
            // Shortest decimals that read back as the same number.
            fmt::format_to(std::back_inserter(text), "{},{},{},{},{},{},{},{},{},{}\n", name, row.vertex,
                           run.info.status.names.at(row.status), row.area_distortion, row.newton_iterations,
                           row.residual_max, row.flips, row.seconds, row.gauss_bonnet_error,
                           row.precision_digits);
    }
    write_text_durably(path, text);
}

}  // namespace ricci
