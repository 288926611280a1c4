// Reading a result file back.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "io/store/foreign_file.h"
#include "io/store/run_store.h"
#include "io/store/schema.h"

namespace ricci {
namespace {

// Rows ascend by vertex and belong to vertices of the mesh: whoever reads on uses them as indices.
void require_ascending(const std::vector<SweepRow>& rows, std::size_t vertex_count,
                       const std::string& where) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Index vertex = rows[i].vertex;
        if (vertex < 0 || static_cast<std::size_t>(vertex) >= vertex_count ||
            (i > 0 && vertex <= rows[i - 1].vertex))
            throw FileError(
                fmt::format("{}/vertex: row {} names no vertex, or not in ascending order", where, i));
    }
}

const SweepRow& row_of(const std::vector<SweepRow>& rows, Index vertex, const std::string& where) {
    const auto row = std::lower_bound(rows.begin(), rows.end(), vertex,
                                      [](const SweepRow& r, Index v) { return r.vertex < v; });
    if (row == rows.end() || row->vertex != vertex)
        throw FileError(where + ": conformal factor of a vertex without a row");
    return *row;
}

StoredSweep read_sweep(hid_t sweep, std::size_t vertex_count, const StatusNames& status) {
    StoredSweep stored;
    stored.rows = schema::read_rows(sweep, status);
    const std::string where = hdf5::name_of(sweep);
    require_ascending(stored.rows, vertex_count, where);
    stored.best = schema::read_extreme_vertex(sweep, "best");
    stored.worst = schema::read_extreme_vertex(sweep, "worst");
    if (stored.best) stored.kept.push_back(schema::read_extreme(sweep, "best", vertex_count));
    if (stored.worst && stored.worst != stored.best)
        stored.kept.push_back(schema::read_extreme(sweep, "worst", vertex_count));
    for (const KeptFactor& factor : stored.kept) row_of(stored.rows, factor.vertex, where);
    const std::vector<Index> vertices = schema::read_kept_vertices(sweep, vertex_count);
    if (vertices.empty()) return stored;
    const hdf5::Handle kept = hdf5::open_group(sweep, "kept");
    const hdf5::Input factors(kept, "conformal_factor");
    for (std::size_t i = 0; i < vertices.size(); ++i)
        stored.kept.push_back({vertices[i], row_of(stored.rows, vertices[i], factors.name()).area_distortion,
                               factors.read_row(i)});
    return stored;
}

StoredItem read_stored_item(hid_t items, const std::string& name, const StatusNames& status) {
    const hdf5::Handle group = hdf5::open_group(items, name);
    StoredItem stored;
    stored.item = schema::read_item(group, name);
    const std::size_t vertex_count = schema::vertex_slots(stored.item);
    if (hdf5::has_link(group, "sweep"))
        stored.sweep = read_sweep(hdf5::open_group(group, "sweep"), vertex_count, status);
    if (hdf5::has_link(group, "flow"))
        stored.flow = schema::read_flow(hdf5::open_group(group, "flow"), name, vertex_count, status);
    for (const std::string& kind : schema::result_kinds(group))
        stored.results.push_back(schema::read_result(hdf5::open_group(group, kind), name, kind, status));
    return stored;
}

StoredRun read_open_run(hid_t file) {
    StoredRun run;
    run.info = schema::read_run_info(file);
    run.complete =
        H5Aexists(file, "complete") > 0 && hdf5::read_attribute<std::int32_t>(file, "complete") == 1;
    const hdf5::Handle items = hdf5::open_group(file, "items");
    for (const std::string& name : hdf5::link_names(items))
        run.items.push_back(read_stored_item(items, name, run.info.status));
    run.failures = schema::read_failures(file);
    return run;
}

}  // namespace

StoredRun read_run(const std::string& path) {
    const hdf5::Session session;
    const hdf5::Handle file = hdf5::open_foreign(path);
    try {
        return read_open_run(file);
    } catch (const FileError& error) {
        throw FileError(path + ": " + error.what());
    }
}

}  // namespace ricci
