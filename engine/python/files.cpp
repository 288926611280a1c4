// Result files: read, written, checked.
#include <fmt/format.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/app/records.h"
#include "engine/app/verify_results.h"
#include "engine/python/bindings.h"
#include "engine/python/long_call.h"
#include "engine/python/stored.h"
#include "engine/python/surface.h"
#include "kernels/parallel.h"

namespace py = pybind11;

namespace ricci::python {
namespace {

using StoredPtr = std::shared_ptr<Stored>;

bool same_mesh(const ItemRecord& a, const ItemRecord& b) {
    return a.points == b.points && a.triangles == b.triangles && a.twin == b.twin &&
           a.edge_length == b.edge_length;
}

bool has_kind(const StoredItem& item, const std::string& kind) {
    return std::any_of(item.results.begin(), item.results.end(),
                       [&](const ResultGroup& group) { return group.kind == kind; });
}

/// Whether nothing of `from` is in `into` already.
bool fits(const StoredItem& from, const StoredItem& into) {
    if ((from.sweep && into.sweep) || (from.flow && into.flow)) return false;
    return std::none_of(from.results.begin(), from.results.end(),
                        [&](const ResultGroup& group) { return has_kind(into, group.kind); });
}

/// One item of the file to be, made of results of one mesh.
struct Merged {
    StoredItem item;
    std::vector<FailureRecord> failures;
};

void add_results(const Stored& from, Merged& into) {
    if (from.item.sweep) into.item.sweep = from.item.sweep;
    if (from.item.flow) into.item.flow = from.item.flow;
    into.item.results.insert(into.item.results.end(), from.item.results.begin(), from.item.results.end());
    into.failures.insert(into.failures.end(), from.failures.begin(), from.failures.end());
}

void rename(Merged& merged, const std::string& name) {
    merged.item.item.name = name;
    if (merged.item.flow) merged.item.flow->item = name;
    for (ResultGroup& group : merged.item.results) group.item = name;
    for (FailureRecord& failure : merged.failures) failure.item = name;
}

/// Results of equal meshes of one name become one item; other meshes of that name get ~2, ~3.
std::vector<Merged> merged_items(const std::vector<StoredPtr>& results) {
    std::vector<Merged> items;
    std::vector<std::string> wanted;  // names before ~2
    for (const StoredPtr& result : results) {
        const ItemRecord& record = result->item.item;
        std::size_t k = 0;
        while (k < items.size() && !(wanted[k] == record.name && same_mesh(items[k].item.item, record) &&
                                     fits(result->item, items[k].item)))
            ++k;
        if (k == items.size()) {
            items.push_back({{record, {}, {}}, {}});
            wanted.push_back(record.name);
        }
        add_results(*result, items[k]);
    }
    std::vector<std::string> taken;
    for (std::size_t k = 0; k < items.size(); ++k) {
        std::string name = wanted[k];
        for (int use = 2; std::find(taken.begin(), taken.end(), name) != taken.end(); ++use)
            name = fmt::format("{}~{}", wanted[k], use);
        taken.push_back(name);
        rename(items[k], name);
    }
    return items;
}

/// The file has one rule for all sweeps.
KeepPolicy common_policy(const std::vector<StoredPtr>& results) {
    std::optional<KeepPolicy> common;
    for (const StoredPtr& result : results) {
        if (!result->item.sweep) continue;
        const KeepPolicy& k = result->keep;
        if (common && (common->best != k.best || common->worst != k.worst || common->count != k.count))
            throw std::invalid_argument(
                "these sweeps kept different conformal factors (keep); save them in files of their own");
        common = k;
    }
    return common.value_or(KeepPolicy{});
}

void write(const std::string& path, const std::vector<StoredPtr>& results,
           const std::vector<FailureRecord>& further) {
    if (results.empty()) throw std::invalid_argument("nothing to save");
    const KeepPolicy keep = common_policy(results);
    std::vector<Merged> items = merged_items(results);
    RunStore store(path, *results.front()->info, false);
    std::vector<std::string> names;
    for (const Merged& merged : items) {
        const StoredItem& item = merged.item;
        names.push_back(item.item.name);
        store.write_item(item.item);
        if (item.sweep) store.write_sweep_block({item.item.name, item.sweep->rows, item.sweep->kept});
        if (item.flow) store.write_flow(*item.flow);
        for (const ResultGroup& group : item.results) store.write_result(group);
        for (const FailureRecord& failure : merged.failures) store.write_failure(failure);
    }
    for (const FailureRecord& failure : further)
        if (!store.has_failure(failure)) store.write_failure(failure);
    store.assemble(names, keep);
}

py::list recompute(const std::string& path, int threads) {
    const auto solutions = run_long(py::none(), [&](Call&) {
        return app::recompute_solutions(read_run(path), threads > 0 ? threads : hardware_threads());
    });
    py::list list;
    for (const app::RecomputedSolution& s : solutions) {
        py::dict d;
        d["item"] = s.item;
        d["what"] = s.what;
        d["residual_stored"] = s.residual_stored;
        d["residual_recomputed"] = s.residual_recomputed;
        d["gauss_bonnet_error_stored"] = s.gauss_bonnet_stored;
        d["gauss_bonnet_error_recomputed"] = s.gauss_bonnet_recomputed;
        d["digits"] = s.digits;
        d["area_distortion_stored"] = s.distortion_stored;
        d["area_distortion_recomputed"] = s.distortion_recomputed;
        d["flips"] = s.flips;
        d["sound"] = s.sound;
        d["message"] = s.message;
        list.append(d);
    }
    return list;
}

}  // namespace

void add_files(py::module_& m) {
    m.def("read", [](const std::string& path) {
        return run_long(py::none(), [&](Call&) { return std::make_shared<Run>(run_of(read_run(path))); });
    });
    m.def("write", [](const std::string& path, const std::vector<StoredPtr>& results) {
        run_call(py::none(), [&](Call&) { write(path, results, {}); });
    });
    m.def("write_run", [](const std::string& path, const Run& run) {
        run_call(py::none(), [&](Call&) { write(path, run.items, run.failures); });
    });
    m.def("verify_structure", [](const std::string& path) {
        return run_long(py::none(), [&](Call&) { return verify_structure(path); });
    });
    m.def("recompute", &recompute);
}

}  // namespace ricci::python
