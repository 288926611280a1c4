#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <stdexcept>

#include "io/store/durable.h"
#include "io/store/foreign_file.h"
#include "io/store/guarded_child.h"
#include "io/store/hdf5_file.h"
#include "io/store/journal.h"
#include "io/store/run_store.h"
#include "io/store/schema.h"
#include "io/store/schema_index.h"
#include "io/store/schema_shapes.h"
#include "io/store/schema_shard.h"
#include "io/store/verify_file.h"

namespace ricci {
namespace {

using Complaints = std::vector<std::string>;
using Rows = std::vector<SweepRow>;

void check_order(const Rows& rows, const std::string& where, std::size_t vertex_count,
                 Complaints& complaints) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (i > 0 && rows[i].vertex <= rows[i - 1].vertex) {
            complaints.push_back(fmt::format("{}/vertex: not ascending at row {}", where, i));
            return;
        }
        if (rows[i].vertex < 0 || static_cast<std::size_t>(rows[i].vertex) >= vertex_count) {
            complaints.push_back(fmt::format("{}/vertex: row {} names no vertex", where, i));
            return;
        }
    }
}

// The row best/ or worst/ must hold: the first of the extreme ones.
const SweepRow* extreme_row(const Rows& rows, std::uint8_t converged, bool best) {
    const SweepRow* extreme = nullptr;
    for (const SweepRow& row : rows) {
        if (row.status != converged) continue;
        const bool further = extreme == nullptr || (best ? row.area_distortion < extreme->area_distortion
                                                         : row.area_distortion > extreme->area_distortion);
        if (further) extreme = &row;
    }
    return extreme;
}

void check_extreme(hid_t sweep, const char* name, const SweepRow* expected, std::size_t vertex_count,
                   Complaints& complaints) {
    const std::string where = hdf5::name_of(sweep) + "/" + name;
    const bool stored = hdf5::has_link(sweep, name);
    if (stored != (expected != nullptr)) {
        complaints.push_back(where + (stored ? ": should not be there" : " is missing"));
        return;
    }
    if (!stored) return;
    const KeptFactor factor = schema::read_extreme(sweep, name, vertex_count);
    if (factor.vertex != expected->vertex || factor.area_distortion != expected->area_distortion)
        complaints.push_back(
            fmt::format("{}: vertex {}, but the rows say {}", where, factor.vertex, expected->vertex));
    if (!std::all_of(factor.conformal_factor.begin(), factor.conformal_factor.end(),
                     [](double u) { return std::isfinite(u); }))
        complaints.push_back(where + "/conformal_factor: not finite");
}

void check_kept(hid_t sweep, const Rows& rows, std::uint8_t converged, std::size_t vertex_count,
                std::int64_t wanted, Complaints& complaints) {
    const std::vector<Index> kept = schema::read_kept_vertices(sweep, vertex_count);
    const std::string where = hdf5::name_of(sweep) + "/kept";
    if (wanted >= 0 && kept.size() > static_cast<std::size_t>(wanted))
        complaints.push_back(where + ": more factors than keep_count");
    const SweepRow* previous = nullptr;
    for (const Index vertex : kept) {
        const auto row = std::lower_bound(rows.begin(), rows.end(), vertex,
                                          [](const SweepRow& r, Index v) { return r.vertex < v; });
        if (row == rows.end() || row->vertex != vertex || row->status != converged) {
            complaints.push_back(fmt::format("{}: vertex {} did not converge", where, vertex));
            return;
        }
        const auto key = [](const SweepRow& r) { return std::pair(r.area_distortion, r.vertex); };
        if (previous != nullptr && key(*row) <= key(*previous)) {
            complaints.push_back(fmt::format("{}: not the best first at vertex {}", where, vertex));
            return;
        }
        previous = &*row;
    }
}

void check_sweep(hid_t item, std::size_t vertex_count, const StatusNames& status, Complaints& complaints) {
    const hdf5::Handle sweep = hdf5::open_group(item, "sweep");
    const Rows rows = schema::read_rows(sweep, status);
    if (rows.empty()) complaints.push_back(hdf5::name_of(sweep) + ": no rows");
    check_order(rows, hdf5::name_of(sweep), vertex_count, complaints);
    const bool keep_best = hdf5::read_attribute<std::uint8_t>(sweep, "keep_best") != 0;
    const bool keep_worst = hdf5::read_attribute<std::uint8_t>(sweep, "keep_worst") != 0;
    const auto keep_count = hdf5::read_attribute<std::int64_t>(sweep, "keep_count");
    const auto converged = schema::converged_status(status);
    const auto expected = [&](bool kept, bool best) {
        return kept && converged ? extreme_row(rows, *converged, best) : nullptr;
    };
    check_extreme(sweep, "best", expected(keep_best, true), vertex_count, complaints);
    check_extreme(sweep, "worst", expected(keep_worst, false), vertex_count, complaints);
    if (converged) check_kept(sweep, rows, *converged, vertex_count, keep_count, complaints);
}

void check_results(hid_t item_group, const std::string& item, const StatusNames& status,
                   Complaints& complaints) {
    for (const std::string& kind : schema::result_kinds(item_group)) {
        try {
            schema::read_result(hdf5::open_group(item_group, kind), item, kind, status);
        } catch (const FileError& error) {
            complaints.emplace_back(error.what());
        }
    }
}

void check_item(hid_t items, const std::string& name, const StatusNames& status, Complaints& complaints) {
    try {
        const hdf5::Handle group = hdf5::open_group(items, name);
        const std::size_t vertex_count = schema::vertex_slots(schema::read_item(group, name));
        if (hdf5::has_link(group, "sweep")) check_sweep(group, vertex_count, status, complaints);
        if (hdf5::has_link(group, "flow")) {
            const FlowRecord flow =
                schema::read_flow(hdf5::open_group(group, "flow"), name, vertex_count, status);
            if (flow.status >= status.names.size())
                complaints.push_back("/items/" + name + "/flow: the status has no name");
        }
        check_results(group, name, status, complaints);
    } catch (const FileError& error) {
        complaints.emplace_back(error.what());
    }
}

void check_index(hid_t root, const StatusNames& status, Complaints& complaints) {
    schema::read_descriptor_version(root);
    try {
        const std::vector<IndexEntry> entries = schema::read_entries(root, status);
        schema::require_valid(entries, status);
        const auto converged = schema::converged_status(status);
        for (const IndexEntry& entry : entries)
            if (entry.shape.status != converged)
                complaints.push_back(entry.file + ": a shape that did not converge is among the entries");
    } catch (const std::invalid_argument& error) {
        complaints.emplace_back(error.what());
    }
}

// Runs in the child.
Complaints check_contents(const std::string& path, std::uint64_t bytes) {
    Complaints complaints;
    try {
        const hdf5::Handle file = hdf5::open_input(path);
        complaints = hdf5::form_complaints(file, bytes);
        if (!complaints.empty()) return complaints;  // nothing more can be read with safety
        complaints = hdf5::checksum_complaints(file, "/");
        const RunInfo info = schema::read_run_info(file);
        if (hdf5::read_attribute<std::int32_t>(file, "complete") != 1)
            complaints.emplace_back("attribute complete is not 1");
        const std::string kind = schema::read_kind(file);
        if (kind == "distances" || kind == "paths") {
            if (kind == "distances")
                schema::read_distances(file);
            else
                schema::read_paths(file);
            return complaints;
        }
        if (kind == "index") {
            check_index(file, info.status, complaints);
        } else {
            const hdf5::Handle items = hdf5::open_group(file, "items");
            for (const std::string& name : hdf5::link_names(items))
                check_item(items, name, info.status, complaints);
            schema::read_shard(file);
        }
        schema::read_failures(file);
    } catch (const FileError& error) {
        complaints.emplace_back(error.what());
    }
    return complaints;
}

// The journal left behind against its segments. A torn end is what a killed run leaves and no defect.
void check_parts(const std::string& folder, Complaints& complaints) {
    if (!std::filesystem::exists(journal_path(folder))) return;
    try {
        const JournalContents contents = read_journal(folder);
        for (const std::string& note : contents.notes)
            if (note.find("is damaged") != std::string::npos) complaints.push_back(note);
        std::set<std::string> dropped;
        for (const JournalEntry& entry : contents.entries)
            if (entry.kind == "drop") dropped.insert(entry.name);
        for (const JournalEntry& entry : contents.entries) {
            if (!entry.segment() || dropped.contains(entry.name)) continue;
            const std::string path = fmt::format("{}/{}", folder, entry.name);
            if (!std::filesystem::exists(path))
                complaints.push_back(path + ": segment is missing");
            else if (checksum_of_file(path) != entry.checksum)
                complaints.push_back(path + ": segment does not match its checksum");
        }
    } catch (const FileError& error) {
        complaints.emplace_back(error.what());
    }
}

}  // namespace

std::vector<std::string> verify_result_file(const std::string& path) {
    std::error_code error;
    const std::uintmax_t bytes = std::filesystem::file_size(path, error);
    if (error) return {system_error(path, "cannot read", error.value()).what()};
    const hdf5::Session session;
    Complaints complaints =
        run_guarded(foreign_file_limits(bytes), [&] { return check_contents(path, bytes); });
    for (std::string& complaint : complaints)
        if (!complaint.starts_with(path)) complaint.insert(0, path + ": ");
    return complaints;
}

std::vector<std::string> verify_structure(const std::string& path) {
    const std::string folder = path + ".parts";
    std::vector<std::string> complaints;
    if (std::filesystem::exists(path) || !std::filesystem::exists(journal_path(folder)))
        complaints = verify_result_file(path);
    else
        complaints.push_back(path + ": not assembled yet; " + folder + " holds an unfinished run");
    check_parts(folder, complaints);
    return complaints;
}

}  // namespace ricci
