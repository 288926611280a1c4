#include "tests/io/store_samples.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace ricci::store_samples {
namespace {

// Hexadecimal: no two different numbers look alike.
std::string exact(const std::vector<double>& values) {
    std::string text;
    for (const double value : values) text += fmt::format("{:a} ", value);
    return text;
}

std::string describe_sweep(const StoredSweep& sweep) {
    std::string text;
    for (const SweepRow& row : sweep.rows)
        text += fmt::format("{} {} {:a} {} {:a} {} {:a} {}\n", row.vertex, row.status, row.area_distortion,
                            row.newton_iterations, row.residual_max, row.flips, row.gauss_bonnet_error,
                            row.precision_digits);
    for (const KeptFactor& kept : sweep.kept)
        text +=
            fmt::format("kept {} {:a} {}\n", kept.vertex, kept.area_distortion, exact(kept.conformal_factor));
    return text + fmt::format("best {} worst {}\n", sweep.best.value_or(-1), sweep.worst.value_or(-1));
}

std::string describe_flow(const FlowRecord& flow) {
    return fmt::format("{} {} {} {} {} {} {} {:a} {:a} {} {} {}|{}|{}|{}|{} {} {}|{}|{} {}\n", flow.geometry,
                       flow.scheme, flow.method, flow.boundary, flow.status, flow.newton_iterations,
                       flow.flips, flow.residual_max, flow.gauss_bonnet_error, flow.precision_digits,
                       flow.doubled, exact(flow.conformal_factor), exact(flow.conformal_factor_low),
                       exact(flow.target_curvature), exact(flow.curvature), flow.triangles, flow.twin,
                       exact(flow.edge_length), exact(flow.log_residual_max), exact(flow.log_step),
                       flow.log_flips);
}

std::string describe_item(const ItemRecord& item) {
    std::string text =
        fmt::format("{} {} {} {} {} {} {} {} {}\n", item.name, item.source, item.source_hash, item.units,
                    item.vertices, item.faces, item.genus, item.boundaries, item.euler_characteristic);
    for (const Point& point : item.points) text += exact({point.begin(), point.end()});
    return text + fmt::format("{} {} {} {}\n", item.triangles, item.source_vertex, item.twin,
                              exact(item.edge_length));
}

// Every kind of value as text; `exact` for doubles.
struct Described {
    std::string operator()(double value) const { return exact({value}); }
    std::string operator()(const std::vector<double>& values) const { return exact(values); }
    template <class Value>
    std::string operator()(const Value& value) const {
        return fmt::format("{}", value);
    }
};

std::string describe_result(const ResultGroup& result) {
    std::string text = fmt::format("{} {} {}\n", result.item, result.kind, result.status);
    for (const ResultAttribute& attribute : result.attributes)
        text += fmt::format("{} [{}] {}\n", attribute.name, attribute.value.index(),
                            std::visit(Described(), attribute.value));
    for (const ResultArray& array : result.arrays)
        text += fmt::format("{} {} [{}] {}\n", array.path, array.shape, array.values.index(),
                            std::visit(Described(), array.values));
    return text;
}

}  // namespace

std::string describe(const StoredRun& run) {
    const RunInfo& info = run.info;
    std::string text =
        fmt::format("{} {} {} {} {} {} {} {} {}\n", info.software_version, info.git, info.command,
                    info.config, info.host, info.fingerprint, info.threads, info.status.names, run.complete);
    for (const StoredItem& item : run.items) {
        text += describe_item(item.item);
        if (item.sweep) text += describe_sweep(*item.sweep);
        if (item.flow) text += describe_flow(*item.flow);
        for (const ResultGroup& result : item.results) text += describe_result(result);
    }
    for (const FailureRecord& failure : run.failures)
        text += fmt::format("{} {} {} {}\n", failure.item, failure.stage, failure.status, failure.message);
    return text;
}

void write_sample_run(const std::string& path, bool resume) {
    RunStore store(path, sample_info(), resume);
    const ItemRecord a = sample_item("a@32", 4);
    const ItemRecord b = sample_item("b@18", 3);
    const auto unfinished = [&](const ItemRecord& item, Index from, Index to) {
        const std::vector<Index> done = store.finished_vertices(item.name);
        std::vector<Index> vertices;
        for (const Index v : range(from, to))
            if (std::find(done.begin(), done.end(), v) == done.end()) vertices.push_back(v);
        return vertices;
    };
    for (const ItemRecord* item : {&a, &b}) {
        if (!store.has_item(item->name)) store.write_item(*item);
        store.write_sweep_block(sample_block(*item, unfinished(*item, 0, item->vertices / 2)));
        store.write_sweep_block(sample_block(*item, unfinished(*item, item->vertices / 2, item->vertices)));
    }
    if (!store.has_flow(a.name)) store.write_flow(sample_flow(a));
    if (!store.has_result(a.name, "layout")) store.write_result(sample_result(a));
    const FailureRecord failure{"c", "load", "invalid_input", "c.off: line 3: not a number"};
    if (!store.has_failure(failure)) store.write_failure(failure);
    store.assemble({a.name, b.name}, kSampleKeep);
}

}  // namespace ricci::store_samples
